//! Linear edge: N_a = (1 + ξ_a ξ) / 2.

use crate::{Element, Exchange, Family};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "edge2",
    family: Family::Edge,
    degree: 1,
    nodes: &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
    shape,
    faces: &[],
    edges: &[],
    quadratures: &["edge-1", "edge-2", "edge-3"],
    exchange: Exchange { vtk: 3, gmsh: 1, gmsh_order: None, abaqus: &["T3D2", "T2D2"], medit: Some("Edges") },
};

fn shape(g: &mut Graph, [xi, ..]: [Expr; 3]) -> Vec<Expr> {
    let (one, half) = (g.int(1), g.rational(1, 2));
    let (minus, plus) = (g.sub(one, xi), g.add(one, xi));
    vec![g.mul(half, minus), g.mul(half, plus)]
}
