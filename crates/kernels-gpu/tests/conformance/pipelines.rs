//! Compiled pipelines that are kept.

use super::{adapter, skipped};
use souple_kernels::Backend as _;
use souple_kernels_gpu::{Gpu, GpuBackend, Options};

const TEXT: &str = "program kept\npoints 1\ninput a 2\noutput o 1\nstraight\n  v0 = input a[0]\n  v1 = input a[1]\n  \
                    v2 = v0 * v1\n  v3 = v2 + v1\n  output o[0] = v3\nend\n";

fn opened(cache: Option<&[u8]>) -> Option<Gpu> {
    let gpu = Gpu::with(&adapter()?, &Options { cache, ..Options::default() });
    Some(gpu.unwrap_or_else(|e| panic!("{e}")))
}

/// What one run compiled, the driver of the next one takes: its cache holds as much before anything is compiled, and
/// compiling the same adds nothing. Data that is none makes an empty cache, not a failure. (Mesa's driver on the
/// processor gives a head and nothing behind it: there, that head goes the whole way, and the skip is said.)
#[test]
fn a_second_run_takes_what_the_first_one_kept() {
    let Some(first) = opened(None) else { return };
    let Some(empty) = first.cache_data() else {
        return skipped("kernels-gpu, pipelines on disk", "the driver has no cache");
    };
    let compile = |gpu: &Gpu| {
        let program = souple_program::parse(TEXT).unwrap_or_else(|e| panic!("{e}"));
        GpuBackend::new(gpu.clone()).compile_singles(&program).map(|_| ()).unwrap_or_else(|e| panic!("{e}"));
        gpu.cache_data().map_or(0, |d| d.len())
    };
    let full = compile(&first);
    assert!(full >= empty.len(), "compiling does not empty the cache: {} to {full} bytes", empty.len());
    if full == empty.len() {
        skipped("kernels-gpu, pipelines on disk", "the driver's cache stays empty");
    }
    let data = first.cache_data().unwrap_or_default();
    let second = opened(Some(&data)).unwrap_or_else(|| panic!("there was an adapter"));
    assert_eq!(second.cache_data().map(|d| d.len()), Some(full));
    assert_eq!(compile(&second), full);
    let third = opened(Some(b"no such data")).unwrap_or_else(|| panic!("there was an adapter"));
    assert_eq!(third.cache_data().map(|d| d.len()), Some(empty.len()));
    assert_eq!(compile(&third), full);
}
