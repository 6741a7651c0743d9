//! A whole motion: the tip of the mixed bar swings for two seconds on a device as on the processor.

use super::gpu;
use super::runs::{load, tip};

/// The scene that the project's guide runs first.
const BAR: &str = include_str!("../../../../scenes/mixed_bar.toml");
/// Length of the bar in m.
const LENGTH: f64 = 8.0;

/// With all four kinds of elements and both laws, the tip of the mixed bar, in single precision on a device, stays
/// within 10⁻⁶ of the bar's length of the one in double precision, after every step of two seconds: while it falls,
/// swings back and settles.
#[test]
fn the_tip_follows_for_two_seconds() {
    if gpu().is_none() {
        return;
    }
    let overrides = ["body.0.mesh.cells=[8, 1, 1]", "time.end=2", "time.stop.mean_kinetic_energy=1e-30"];
    let mut device = load(BAR, &overrides, "gpu").unwrap().0;
    let mut processor = load(BAR, &overrides, "cpu").unwrap().0;
    let kinds = device.summary().elements;
    assert!(["hex8", "prism6", "pyramid5", "tet4"].iter().all(|kind| kinds[*kind] > 0), "{kinds:?}");
    let (mut lowest, mut highest_after, mut steps) = (0.0f64, f64::NEG_INFINITY, 0);
    loop {
        let (a, b) = (device.advance().unwrap(), processor.advance().unwrap());
        assert_eq!((a.step, a.finished), (b.step, b.finished));
        let (x, y) = (tip(&mut device), tip(&mut processor));
        for k in 0..3 {
            let apart = (x[k] - y[k]).abs();
            assert!(apart < 1e-6 * LENGTH, "axis {k} at {} s: {} m and {} m", a.time, x[k], y[k]);
        }
        steps += 1;
        highest_after = if y[1] < lowest { y[1] } else { highest_after.max(y[1]) };
        lowest = lowest.min(y[1]);
        if a.finished.is_some() {
            break;
        }
    }
    // That it was a motion: the bar fell, and came back up from its lowest place.
    assert!(
        steps == 100 && lowest < -0.05 * LENGTH && highest_after > lowest + 1e-3,
        "{steps} {lowest} {highest_after}"
    );
}
