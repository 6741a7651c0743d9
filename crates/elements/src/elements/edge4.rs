//! Cubic edge: N = ((1 ∓ ξ)(9 ξ² − 1) / 16, 9 (1 − ξ²)(1 ∓ 3 ξ) / 16), the ends first.

use crate::{Element, Exchange, Family};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "edge4",
    family: Family::Edge,
    degree: 3,
    nodes: &NODES,
    shape,
    faces: &[],
    edges: &[],
    quadratures: &["edge-3", "edge-2", "edge-4"],
    exchange: Exchange { vtk: 68, gmsh: 26, gmsh_order: None, abaqus: &[], medit: None },
};

const NODES: [[f64; 3]; 4] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0 / 3.0, 0.0, 0.0], [1.0 / 3.0, 0.0, 0.0]];

fn shape(g: &mut Graph, [xi, ..]: [Expr; 3]) -> Vec<Expr> {
    let (one, three, nine) = (g.int(1), g.int(3), g.int(9));
    let (end, inner) = (g.rational(1, 16), g.rational(9, 16));
    let square = g.powi(xi, 2);
    let nine_square = g.mul(nine, square);
    let (at_ends, at_inner) = (g.sub(one, square), g.sub(nine_square, one));
    let triple = g.mul(three, xi);
    let (minus, plus) = (g.sub(one, xi), g.add(one, xi));
    let (minus_three, plus_three) = (g.sub(one, triple), g.add(one, triple));
    vec![
        g.product(&[end, minus, at_inner]),
        g.product(&[end, plus, at_inner]),
        g.product(&[inner, at_ends, minus_three]),
        g.product(&[inner, at_ends, plus_three]),
    ]
}
