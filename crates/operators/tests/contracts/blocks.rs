//! The assembled stiffness is the operator that the matrix-free products apply.

use crate::sample::{assert_close, dot, each, largest, plus};
use souple_solver::LinearOperator as _;

/// K v from assembled blocks is −(∂f/∂u) v, at rest and deformed.
#[test]
fn assembled_blocks_times_a_vector_is_minus_the_tangent_product() {
    each(|sample| {
        let rest = vec![0.0; sample.elements.len()];
        for u in [rest, sample.displacement()] {
            sample.elements.linearise(&u);
            let v = sample.direction();
            let product = sample.tangent(&v);
            let (mut matrix, map) = sample.elements.pattern();
            sample.elements.assemble(&u, &map, &mut matrix);
            let mut kv = vec![0.0; v.len()];
            matrix.apply(&v, &mut kv);
            let minus = product.iter().map(|x| -x).collect::<Vec<_>>();
            assert_close(&sample.name(), &kv, &minus, 1e-12, largest(&minus));
        }
    });
}

/// `add_tangent` adds, scaled, to what is there; so does `add_force`, unscaled.
#[test]
fn products_are_added() {
    each(|sample| {
        let (u, v) = (sample.displacement(), sample.direction());
        sample.elements.linearise(&u);
        let (product, force) = (sample.tangent(&v), sample.force(&u));
        let start = sample.direction();
        let mut out = start.clone();
        sample.elements.add_tangent(-2.5, &v, &mut out);
        assert_eq!(out, plus(&start, -2.5, &product), "{}", sample.name());
        let mut out = start.clone();
        sample.elements.add_force(&u, &mut out);
        assert_eq!(out, plus(&start, 1.0, &force), "{}", sample.name());
        assert!(dot(&force, &force) > 0.0, "{}", sample.name());
    });
}
