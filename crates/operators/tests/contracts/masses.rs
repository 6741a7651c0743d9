//! Masses that the elements give to their nodes.

use crate::sample::{SECTION, SKEW, assert_close, each, one_element, skewed};

/// Both masses of an element are its density times its volume: det A times the reference cell's under an affine map A,
/// √det AᵀA times that and the thickness or cross-section where there are fewer columns than rows.
#[test]
fn masses_are_density_times_volume() {
    let law = souple_laws::by_id("hooke").unwrap();
    let done = std::cell::RefCell::new(std::collections::BTreeSet::new());
    each(|sample| {
        // Masses know no law.
        if !done.borrow_mut().insert((sample.element.id, sample.rule.id, sample.space)) {
            return;
        }
        let (d, space) = (sample.element.dimension(), sample.space);
        // AᵀA, and ones on the diagonal beyond it.
        let a = |i: usize, j: usize| -> f64 {
            match (i < d && j < d, i == j) {
                (true, _) => (0..space).map(|k| SKEW[k][i] * SKEW[k][j]).sum(),
                (false, same) => f64::from(u8::from(same)),
            }
        };
        let minor = |i: usize, j: usize| a(1, i) * a(2, j) - a(1, j) * a(2, i);
        let squared = a(0, 0) * minor(1, 2) + a(0, 1) * minor(2, 0) + a(0, 2) * minor(0, 1);
        let determinant = squared.sqrt() * if sample.embedded() { SECTION } else { 1.0 };
        let expected = sample.density * determinant * sample.element.family.reference_measure();
        let nodes = skewed(sample.element, sample.space);
        let (_, masses) = one_element(sample.element, law, sample.rule, sample.space, &nodes, sample.density);
        for mass in [masses.shape, masses.lumped] {
            assert_close(&sample.name(), &[mass.iter().sum()], &[expected], 1e-13, expected);
        }
    });
}

/// Lumped masses are positive, and sum to what the consistent loads sum to, on distorted elements too.
#[test]
fn lumped_masses_are_positive_and_complete() {
    each(|sample| {
        let total: f64 = sample.masses.shape.iter().sum();
        assert!(total > 0.0, "{}", sample.name());
        let least = sample.masses.lumped.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > 1e-4 * total, "{}: {least:e} of {total:e}", sample.name());
        assert_close(&sample.name(), &[sample.masses.lumped.iter().sum()], &[total], 1e-13, total);
    });
}
