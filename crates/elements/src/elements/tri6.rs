//! Quadratic triangle: N = λᵢ (2 λᵢ − 1) at the corners, 4 λᵢ λⱼ in the middle of the edges.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tri6",
    family: Family::Triangle,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &EDGES,
    edges: &EDGES,
    quadratures: &["triangle-3", "triangle-1", "triangle-6", "triangle-7"],
    exchange: Exchange {
        vtk: 22,
        gmsh: 9,
        gmsh_order: None,
        abaqus: &["CPE6", "CPS6", "M3D6", "STRI65"],
        medit: Some("TrianglesP2"),
    },
};

const NODES: [[f64; 3]; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]];

const EDGES: [Side; 3] = [
    Side { element: "edge3", nodes: &[0, 1, 3] },
    Side { element: "edge3", nodes: &[1, 2, 4] },
    Side { element: "edge3", nodes: &[2, 0, 5] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, four) = (g.int(1), g.int(2), g.int(4));
    let sum = g.add(xi, eta);
    let lambda = [g.sub(one, sum), xi, eta];
    let mut all = Vec::with_capacity(NODES.len());
    for at in lambda {
        let twice = g.mul(two, at);
        let less = g.sub(twice, one);
        all.push(g.mul(at, less));
    }
    for edge in &EDGES {
        let [i, j] = [edge.nodes[0], edge.nodes[1]].map(usize::from);
        all.push(g.product(&[four, lambda[i], lambda[j]]));
    }
    all
}
