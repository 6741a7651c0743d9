//! The suite of all backends, on the first adapter; functions of the printed language to the last digits; what is done
//! when a compiler refuses, what is kept of compiled pipelines, and what measurements run.
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_macros,
    reason = "a test that finds no adapter says so in a file and on standard output"
)]

#[path = "conformance/fallback.rs"]
mod fallback;
#[path = "conformance/measure.rs"]
mod measure;
#[path = "conformance/pipelines.rs"]
mod pipelines;

use souple_kernels_gpu::{Gpu, GpuBackend, OpenError};
use std::sync::OnceLock;

/// The backend of the first adapter; where there is none, says that the tests are skipped.
fn backend() -> Option<GpuBackend> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| match Gpu::open("", None) {
        Ok(gpu) => Some(gpu),
        Err(OpenError::None) => {
            skipped("kernels-gpu, every test on a device", "no adapter");
            None
        }
        Err(error) => panic!("{error}"),
    });
    gpu.clone().map(GpuBackend::new)
}

/// Says on standard output, and where all skips are collected, what was not tested and why.
fn skipped(what: &str, why: &str) {
    println!("skipped: {why}");
    if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
        let note = std::path::Path::new(&folder).join(format!("{what}.txt"));
        std::fs::write(note, why).expect("the folder of skipped tests can be written");
    }
}

/// The first adapter, where there is one.
fn adapter() -> Option<souple_kernels_gpu::Adapter> {
    backend()?;
    souple_kernels_gpu::adapters().into_iter().next()
}

souple_kernels::conformance_in_singles!(backend());

/// ln, eˣ and xʸ of the printed language are right to two units in the last place over their whole range.
#[test]
fn functions_are_right_to_two_units() {
    use souple_kernels::conformance::Random;
    use souple_kernels::{Backend as _, Input, LANES, Scratch};
    let Some(backend) = backend() else { return };
    let text = "program functions\npoints 1\ninput a 2\noutput o 3\nstraight\n  v0 = input a[0]\n  v1 = input a[1]\n  \
                v2 = ln v0\n  v3 = exp v1\n  v4 = pow v0 v1\n  output o[0] = v2\n  output o[1] = v3\n  output o[2] = v4\nend\n";
    let kernel = backend.compile_singles(&souple_program::parse(text).unwrap()).unwrap();
    let mut random = Random::new(9);
    let groups = 4000;
    let mut given = vec![0.0f32; groups * 2 * LANES];
    for (at, value) in given.iter_mut().enumerate() {
        let exponent = at / LANES % 2 == 1;
        *value = match at % 3 {
            _ if exponent => random.between(-30.0, 30.0) as f32,
            0 => random.between(0.5, 2.0) as f32,
            1 => 1.0 + random.between(-1e-3, 1e-3) as f32,
            _ => random.between(-2.8, 2.8).exp() as f32,
        };
    }
    let mut out = vec![0.0f32; groups * 3 * LANES];
    kernel.run(&mut Scratch::default(), groups, &[Input::Lanes(&given)], &mut [&mut out]);
    let mut worst = [0.0f64; 3];
    for group in 0..groups {
        for lane in 0..LANES {
            let [a, b] = [0, 1].map(|p| f64::from(given[(group * 2 + p) * LANES + lane]));
            for (p, want) in [a.ln(), b.exp(), a.powf(b)].into_iter().enumerate() {
                let got = f64::from(out[(group * 3 + p) * LANES + lane]);
                if want.abs() > f64::from(f32::MIN_POSITIVE) && want.abs() < f64::from(f32::MAX) {
                    worst[p] = worst[p].max(((got - want) / want).abs() / f64::from(f32::EPSILON));
                }
            }
        }
    }
    assert!(worst.iter().all(|w| *w <= 2.0), "errors in units of the last place: {worst:?}");
}
