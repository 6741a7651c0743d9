//! A compiler that refuses a text gets a shorter one.

use super::adapter;
use souple_kernels::oracle::{Precision, run_in};
use souple_kernels::{Backend as _, Input, LANES, Scratch};
use souple_kernels_gpu::{Gpu, GpuBackend, Options};

const POINTS: usize = 40;

/// Σ_q t_q (a + t_q)² with a table of forty values: short enough to be written out, longer then than twenty statements.
fn program() -> souple_program::Program {
    let table: String = (0..POINTS).map(|q| format!(" {}", 0.125 * (q as f64 - 17.0))).collect();
    let text = format!(
        "program sums\npoints {POINTS}\ninput a 1\noutput o 1\ntable{table}\nstraight\n  v0 = input a[0]\n  \
         v1 = accumulator\nloop\n  v2 = table 0\n  v3 = v0 + v2\n  v4 = v3 * v3\n  v1 += v2 * v4\nstraight\n  \
         output o[0] = v1\nend\n"
    );
    souple_program::parse(&text).unwrap_or_else(|e| panic!("{e}"))
}

/// What a device gave, or why not, and what it noted.
type Answer = (Result<Vec<f32>, String>, Vec<String>);

/// The answer of a device with this limit for lane values.
fn computed(longest: usize, given: &[f32]) -> Option<Answer> {
    let gpu = Gpu::with(&adapter()?, &Options { longest, ..Options::default() }).unwrap_or_else(|e| panic!("{e}"));
    let kernel = match GpuBackend::new(gpu.clone()).compile_singles(&program()) {
        Ok(kernel) => kernel,
        Err(error) => return Some((Err(error.to_string()), gpu.take_notes())),
    };
    let mut out = vec![f32::NAN; LANES];
    kernel.run(&mut Scratch::default(), 1, &[Input::Lanes(given)], &mut [&mut out]);
    Some((Ok(out), gpu.take_notes()))
}

/// A program that is refused written out runs with its loop, within the oracle's bound, and a note says what was refused
/// and what runs instead; without a limit nothing is noted; one that is too long in any form is an error with the numbers.
#[test]
fn refused_programs_run_rolled_and_say_so() {
    let given: Vec<f32> = (0..LANES).map(|lane| 0.3 * lane as f32 - 1.0).collect();
    let Some((plain, notes)) = computed(usize::MAX, &given) else { return };
    assert!(plain.is_ok() && notes.is_empty(), "{plain:?} {notes:?}");
    let (rolled, notes) = computed(20, &given).unwrap_or_else(|| panic!("there was an adapter"));
    let rolled = rolled.unwrap_or_else(|e| panic!("{e}"));
    assert!(notes.len() == 1 && notes[0].contains("at most 20") && notes[0].contains("rolled"), "{notes:?}");
    for (lane, got) in rolled.iter().enumerate() {
        let want = &run_in(&program(), &[vec![f64::from(given[lane])]], Precision::SINGLE)[0][0];
        assert!((f64::from(*got) - want.value).abs() <= want.error, "{got} is not {} ± {}", want.value, want.error);
    }
    let (none, _) = computed(2, &given).unwrap_or_else(|| panic!("there was an adapter"));
    let error = none.expect_err("two statements are too few");
    assert!(error.contains("sums") && error.contains("at most 2 "), "{error}");
}
