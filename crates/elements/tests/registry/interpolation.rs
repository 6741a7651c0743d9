//! Shape functions interpolate: they sum to one, belong to their nodes, and reproduce polynomials.

use crate::evaluation::{Interpolation, Point, centroid, combine, determinant, fine_rule, jacobian};
use souple_elements::{all, rules};

/// A node, or a point close to it where the functions are 0/0 there (the apex of a pyramid), with its distance from
/// the node.
fn approached(interpolation: &Interpolation, nodes: &[Point], node: usize) -> (Vec<f64>, f64) {
    let values = interpolation.values(nodes[node]);
    if values.iter().all(|v| v.is_finite()) {
        return (values, 0.0);
    }
    let step = 2.0_f64.powi(-30);
    let centre = centroid(nodes);
    let point = [0, 1, 2].map(|axis| nodes[node][axis] + step * (centre[axis] - nodes[node][axis]));
    (interpolation.values(point), step)
}

/// At every node its own shape function is one and all others are zero; only an apex may need to be approached.
#[test]
fn shape_functions_belong_to_their_nodes() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        let mut approached_nodes = 0;
        for node in 0..element.node_count() {
            let (values, distance) = approached(&interpolation, element.nodes, node);
            approached_nodes += usize::from(distance > 0.0);
            for (other, value) in values.iter().enumerate() {
                let expected = f64::from(u8::from(other == node));
                let error = (value - expected).abs();
                assert!(error <= 1e-14 + 10.0 * distance, "{}: N_{other} at node {node} is {value}", element.id);
            }
        }
        assert!(approached_nodes <= 1, "{}: singular at {approached_nodes} nodes", element.id);
    }
}

/// Everywhere in the cell the shape functions sum to one and their gradients to zero.
#[test]
fn shape_functions_sum_to_one() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        for (point, _) in fine_rule(element.family).into_iter().step_by(7) {
            let sum: f64 = interpolation.values(point).iter().sum();
            assert!((sum - 1.0).abs() < 1e-13, "{} at {point:?}: {sum}", element.id);
            let gradient = combine(&vec![1.0; element.node_count()], &interpolation.gradients(point));
            assert!(gradient.iter().all(|g| g.abs() < 1e-11), "{} at {point:?}: {gradient:?}", element.id);
        }
    }
}

/// Every monomial up to the element's degree is reproduced from its values at the nodes, and some of the next degree
/// is not: the stated degree is sharp.
#[test]
fn polynomials_up_to_the_degree_are_reproduced() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        let worst = |degree: u32| -> f64 {
            let points = fine_rule(element.family);
            let mut worst = 0.0_f64;
            for (point, _) in points.into_iter().step_by(31) {
                let values = interpolation.values(point);
                for e in monomials(element.dimension(), degree) {
                    let at_nodes = element.nodes.iter().zip(&values).map(|(&node, v)| v * monomial(node, e));
                    worst = worst.max((at_nodes.sum::<f64>() - monomial(point, e)).abs());
                }
            }
            worst
        };
        for degree in 0..=element.degree {
            assert!(worst(degree) < 1e-13, "{}: degree {degree} is off by {}", element.id, worst(degree));
        }
        let beyond = element.degree + 1;
        assert!(worst(beyond) > 1e-3, "{} reproduces degree {beyond} as well", element.id);
    }
}

/// The reference element maps to itself: its Jacobian is the identity at every point of every rule of its family.
#[test]
fn reference_element_has_unit_jacobian() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        for rule in rules().iter().filter(|r| r.family == element.family) {
            for &point in &rule.points {
                let position = combine(&interpolation.values(point), element.nodes);
                let there = (0..3).all(|axis| (position[axis] - point[axis]).abs() < 1e-13);
                assert!(there, "{} with {}: {point:?} maps to {position:?}", element.id, rule.id);
                let gradients = interpolation.gradients(point);
                let j = determinant(&jacobian(element.dimension(), &gradients, element.nodes));
                assert!((j - 1.0).abs() < 1e-12, "{} with {}: det J = {j} at {point:?}", element.id, rule.id);
            }
        }
    }
}

/// Exponents of the monomials of exactly this degree.
pub(crate) fn monomials(dimension: usize, degree: u32) -> Vec<[u32; 3]> {
    let mut found = Vec::new();
    for i in 0..=degree {
        for j in 0..=degree {
            for k in 0..=degree {
                let used = [i, j, k];
                if i + j + k == degree && used[dimension..].iter().all(|&e| e == 0) {
                    found.push(used);
                }
            }
        }
    }
    found
}

pub(crate) fn monomial(x: Point, e: [u32; 3]) -> f64 {
    (0..3).map(|axis| x[axis].powi(e[axis] as i32)).product()
}
