//! What measurements run computes what it says, and takes time.

use super::{adapter, backend};
use souple_kernels::Input;
use souple_kernels_gpu::measure::{Exercise, LANES, Loaded, chains_of, exercise};
use souple_kernels_gpu::{Gpu, resident::row_sums};

/// Exercises give what they should, and more work takes more time by a device's own clock.
#[test]
fn exercises_compute_what_they_say() {
    let Some(backend) = backend() else { return };
    let gpu = backend.gpu();
    for (which, value) in [(Exercise::Copy, 1.0), (Exercise::Triad, 7.0)] {
        let made = exercise(gpu, which, 5000).unwrap_or_else(|e| panic!("{e}"));
        made.work.run(2).unwrap_or_else(|e| panic!("{e}"));
        let a = made.work.output(0).unwrap_or_else(|e| panic!("{e}"));
        assert!(a.len() >= 5000 && a.iter().all(|a| *a == value), "{which:?}");
    }
    let made = exercise(gpu, Exercise::MultiplyAdds, 5000).unwrap_or_else(|e| panic!("{e}"));
    let one = made.work.run(1).unwrap_or_else(|e| panic!("{e}"));
    let sums = made.work.output(0).unwrap_or_else(|e| panic!("{e}"));
    for (k, sum) in sums[..256].iter().enumerate() {
        let want = chains_of(k);
        assert!((f64::from(*sum) - want).abs() < 1e-3 * want.abs(), "{k}: {sum} is not {want}");
    }
    assert_eq!(one.is_some(), gpu.description().features.timestamps);
    if let Some(one) = one {
        assert!(one > 0.0, "a device with a clock says how long it took");
    }
}

/// A program on data of the device, and sums of contributions per row, give what the host computes.
#[test]
fn loaded_work_gives_results() {
    let Some(backend) = backend() else { return };
    let text = "program twice\npoints 1\ninput a 2\ninput b 1\noutput o 2\nstraight\n  v0 = input a[0]\n  v1 = input a[1]\n  \
                v2 = input b[0]\n  v3 = v0 * v2\n  v4 = v1 * v2\n  output o[0] = v3\n  output o[1] = v4\nend\n";
    let program = souple_program::parse(text).unwrap_or_else(|e| panic!("{e}"));
    let values: Vec<f32> = (0..10).map(|k| k as f32).collect();
    // Rows of two numbers, of which item i takes number i mod 5.
    let rows: Vec<u32> = (0..2 * LANES as u32).map(|i| i % 5).collect();
    let inputs = [Input::Gathered { values: &values, rows: &rows, width: 2 }, Input::Uniform(&[3.0])];
    let loaded = Loaded::new(backend.gpu(), &program, 2, &inputs).unwrap_or_else(|e| panic!("{e}"));
    loaded.run(3).unwrap_or_else(|e| panic!("{e}"));
    let out = loaded.output(0).unwrap_or_else(|e| panic!("{e}"));
    let at = |item: usize, place: usize| (item / LANES * 2 + place) * LANES + item % LANES;
    for item in 0..2 * LANES {
        for place in 0..2 {
            assert_eq!(out[at(item, place)], 3.0 * (2 * (item % 5) + place) as f32, "item {item}");
        }
    }
    let sums = row_sums(backend.gpu(), &rows, 1, 5, 2, &out).unwrap_or_else(|e| panic!("{e}"));
    sums.run(2).unwrap_or_else(|e| panic!("{e}"));
    let got = sums.output(0).unwrap_or_else(|e| panic!("{e}"));
    let times = |row: usize| (0..2 * LANES).filter(|i| i % 5 == row).count() as f32;
    let want: Vec<f32> = (0..10).map(|k| times(k / 2) * 3.0 * k as f32).collect();
    assert_eq!(got, want);
}

/// A device is asked for all that its adapter allows, so that a large model is cut no more than it must be.
#[test]
fn devices_are_opened_with_the_limits_of_their_adapters() {
    let Some(adapter) = adapter() else { return };
    let gpu = Gpu::of(&adapter, None).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(gpu.granted(), adapter.description.limits);
}
