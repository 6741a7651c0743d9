//! A face or an edge as a map from its reference cell into space, and the way back.
//!
//! ```text
//! x(ξ) = Σ_a N_a(ξ) x_a        foot of a point p: min_ξ |x(ξ) − p|
//! ```
//!
//! The foot is found by Gauss–Newton steps, which end after one on straight edges and flat triangles.

use crate::geometry::{BoundingBox, dot, minus, norm};
use souple_elements::{Element, Family};
use souple_symbols::{Expr, Graph, Time};

/// A foot within this of the rim of the reference cell is put on the rim: a node on a coarse edge then follows that
/// edge's nodes only, whatever the last digits of its position are.
const RIM: f64 = 1e-6;

/// Gauss–Newton steps at most: curved faces far from the point converge linearly.
const STEPS: usize = 60;

/// Weights below this are rounding.
const NO_WEIGHT: f64 = 1e-12;

/// Shape functions of the side elements met so far.
#[derive(Default)]
pub(super) struct Shapes {
    known: Vec<Shape>,
}

impl Shapes {
    pub(super) fn of(&mut self, element: &'static Element) -> &Shape {
        let at = self.known.iter().position(|shape| shape.element.id == element.id).unwrap_or(self.known.len());
        if at == self.known.len() {
            self.known.push(Shape::new(element));
        }
        &self.known[at]
    }
}

/// Shape functions of one side element and their derivatives, for evaluation.
pub(super) struct Shape {
    pub(super) element: &'static Element,
    graph: Graph,
    xi: [Expr; 3],
    /// N_a, then ∂N_a/∂ξ_k axis by axis.
    roots: Vec<Expr>,
}

/// Where a point lies on a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    /// Inside the reference cell.
    pub(super) xi: [f64; 3],
    /// Distance between the point and the side there, in m.
    pub(super) distance: f64,
}

impl Shape {
    fn new(element: &'static Element) -> Shape {
        let mut graph = Graph::new();
        let xi = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Derive));
        let mut roots = (element.shape)(&mut graph, xi);
        let (one, shape) = (graph.int(1), roots.clone());
        for &axis in &xi[..element.dimension()] {
            roots.extend(graph.directional(&shape, &[(axis, one)]));
        }
        Shape { element, graph, xi, roots }
    }

    fn values(&self, xi: [f64; 3]) -> Vec<f64> {
        let values: Vec<(Expr, f64)> = self.xi.into_iter().zip(xi).collect();
        self.graph.evaluate(&self.roots, &values)
    }

    /// The nodes that have a weight at ξ, with it, ascending.
    pub(super) fn masters(&self, nodes: &[u32], xi: [f64; 3]) -> Vec<(u32, f64)> {
        let values = self.values(xi);
        let mut masters: Vec<(u32, f64)> =
            nodes.iter().copied().zip(values).filter(|(_, weight)| weight.abs() > NO_WEIGHT).collect();
        masters.sort_unstable_by_key(|m| m.0);
        masters
    }

    /// The nearest place of the side to a point, as far as Gauss–Newton steps from the middle lead to it.
    /// `None` where the side is degenerate.
    pub(super) fn foot(&self, positions: &[[f64; 3]], point: [f64; 3]) -> Option<Foot> {
        let (n, dimension) = (positions.len(), self.element.dimension());
        let at = |weights: &[f64]| -> [f64; 3] {
            std::array::from_fn(|a| weights.iter().zip(positions).map(|(w, x)| w * x[a]).sum())
        };
        let mut xi = middle(self.element.family);
        for _ in 0..STEPS {
            let values = self.values(xi);
            let apart = minus(point, at(&values[..n]));
            let tangent: Vec<[f64; 3]> = (0..dimension).map(|k| at(&values[(k + 1) * n..(k + 2) * n])).collect();
            let step = least_squares(&tangent, apart)?;
            (0..dimension).for_each(|k| xi[k] += step[k]);
            // A side is at most a few reference cells away from anything that lies on it.
            if !xi.iter().all(|x| x.abs() < 1e3) {
                return None;
            }
            if step.iter().all(|s| s.abs() < 1e-13) {
                break;
            }
        }
        let xi = into_cell(self.element.family, xi);
        let distance = norm(minus(point, at(&self.values(xi)[..n])));
        Some(Foot { xi, distance })
    }
}

/// The s that makes |a − Σ s_k t_k| least; `None` when the t_k do not span.
fn least_squares(tangent: &[[f64; 3]], a: [f64; 3]) -> Option<[f64; 2]> {
    match *tangent {
        [t] => {
            let square = dot(t, t);
            (square > 0.0).then(|| [dot(t, a) / square, 0.0])
        }
        [s, t] => {
            let (ss, st, tt) = (dot(s, s), dot(s, t), dot(t, t));
            let determinant = ss * tt - st * st;
            let (sa, ta) = (dot(s, a), dot(t, a));
            (determinant > 1e-12 * ss * tt)
                .then(|| [(tt * sa - st * ta) / determinant, (ss * ta - st * sa) / determinant])
        }
        _ => None,
    }
}

fn middle(family: Family) -> [f64; 3] {
    match family {
        Family::Triangle => [1.0 / 3.0, 1.0 / 3.0, 0.0],
        _ => [0.0; 3],
    }
}

/// The point moved into the reference cell of an edge, a triangle or a quadrangle, and onto its rim when it is near.
fn into_cell(family: Family, [x, y, _]: [f64; 3]) -> [f64; 3] {
    let line = |t: f64| if t.abs() > 1.0 - RIM { t.signum() } else { t };
    match family {
        Family::Edge => [line(x), 0.0, 0.0],
        Family::Triangle => {
            let least = |t: f64| if t < RIM { 0.0 } else { t };
            let (x, y) = (least(x), least(y));
            if x + y <= 1.0 - RIM {
                return [x, y, 0.0];
            }
            // Onto the slanted edge along its normal.
            let x = (0.5 * (1.0 + x - y)).clamp(0.0, 1.0);
            [x, 1.0 - x, 0.0]
        }
        _ => [line(x), line(y), 0.0],
    }
}

/// Length of the diagonal of the box around a side: what distances are relative to.
pub(super) fn size(positions: &[[f64; 3]]) -> f64 {
    BoundingBox::around(positions).map_or(0.0, |b| b.diagonal())
}
