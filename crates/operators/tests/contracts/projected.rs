//! What is promised of tangents with positive moduli, for every element × law.

use crate::sample::{assert_close, dot, largest, one_element, skewed, with_default_rules};
use souple_kernels::Interpreter;
use souple_kernels::conformance::Random;
use souple_operators::{Elements, Tangent};
use souple_program::Costs;
use souple_solver::LinearOperator as _;

/// `−(∂f/∂u) v` after a linearisation at `u`.
fn stiffness(elements: &mut Elements, u: &[f64], v: &[f64]) -> Vec<f64> {
    elements.linearise(u);
    let mut out = vec![0.0; v.len()];
    elements.add_tangent(-1.0, v, &mut out);
    out
}

/// Projected tangents are positive in every direction and give the same with and without a matrix, in states where the
/// exact tangent of some law is not positive; and such states are really among those looked at.
#[test]
fn projected_tangents_are_positive_where_exact_ones_are_not() {
    let mut indefinite = Vec::new();
    for (k, (element, law, rule)) in with_default_rules().enumerate() {
        let name = format!("{} / {}", element.id, law.id);
        let mut random = Random::new(k as u64);
        let nodes = skewed(element, element.dimension());
        let d = element.dimension();
        let (mut elements, _) = one_element(element, law, rule, element.dimension(), &nodes, 1.0);
        // Shortened by a third along the first axis: stiff, and short of every buckling load but that of the material.
        let u: Vec<f64> = nodes.iter().flat_map(|x| (0..d).map(|i| if i == 0 { -0.35 * x[0] } else { 0.0 })).collect();
        let directions: Vec<Vec<f64>> =
            (0..6).map(|_| (0..u.len()).map(|_| random.between(-1.0, 1.0)).collect()).collect();
        let exact: Vec<f64> = directions.iter().map(|v| dot(v, &stiffness(&mut elements, &u, v))).collect();
        elements.set_tangent(Tangent::Projected, &Interpreter::default(), Costs::default()).unwrap();
        for (v, exact) in directions.iter().zip(&exact) {
            let kv = stiffness(&mut elements, &u, v);
            let curvature = dot(v, &kv);
            assert!(curvature >= -1e-12 * largest(&kv), "{name}: {curvature:e}");
            assert!(curvature >= exact - 1e-9 * exact.abs(), "{name}: projection only adds: {curvature:e} < {exact:e}");
            if *exact < -1e-9 * largest(&kv) {
                indefinite.push(name.clone());
            }
            let (mut matrix, map) = elements.pattern();
            elements.assemble(&u, &map, &mut matrix);
            let mut assembled = vec![0.0; v.len()];
            matrix.apply(v, &mut assembled);
            assert_close(&name, &assembled, &kv, 1e-12, largest(&kv));
        }
    }
    assert!(!indefinite.is_empty(), "no exact tangent was indefinite: this test shows nothing");
}

/// Where the exact tangent is positive at every point, as at rest, the projected one is the exact one.
#[test]
fn projected_tangents_are_the_exact_ones_at_rest() {
    for (k, (element, law, rule)) in with_default_rules().enumerate() {
        let mut random = Random::new(k as u64);
        let nodes = skewed(element, element.dimension());
        let (mut elements, _) = one_element(element, law, rule, element.dimension(), &nodes, 1.0);
        let rest = vec![0.0; elements.len()];
        let v: Vec<f64> = rest.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let exact = stiffness(&mut elements, &rest, &v);
        elements.set_tangent(Tangent::Projected, &Interpreter::default(), Costs::default()).unwrap();
        let projected = stiffness(&mut elements, &rest, &v);
        assert_close(&format!("{} / {}", element.id, law.id), &projected, &exact, 1e-12, largest(&exact));
    }
}
