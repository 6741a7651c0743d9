//! Quadratic edge: N = (−ξ (1 − ξ) / 2, ξ (1 + ξ) / 2, 1 − ξ²).

use crate::{Element, Exchange, Family};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "edge3",
    family: Family::Edge,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[],
    edges: &[],
    quadratures: &["edge-2", "edge-1", "edge-3"],
    exchange: Exchange {
        vtk: 21,
        gmsh: 8,
        gmsh_order: None,
        // Abaqus has three-node trusses, but runs through their nodes from end to end.
        abaqus: &[],
        medit: Some("EdgesP2"),
    },
};

const NODES: [[f64; 3]; 3] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];

fn shape(g: &mut Graph, [xi, ..]: [Expr; 3]) -> Vec<Expr> {
    let (one, half, minus_half) = (g.int(1), g.rational(1, 2), g.rational(-1, 2));
    let (minus, plus, square) = (g.sub(one, xi), g.add(one, xi), g.powi(xi, 2));
    vec![g.product(&[minus_half, xi, minus]), g.product(&[half, xi, plus]), g.sub(one, square)]
}
