//! Quadratic tetrahedron: N = λᵢ (2 λᵢ − 1) at the corners, 4 λᵢ λⱼ in the middle of the edges.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tet10",
    family: Family::Tetrahedron,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "tri6", nodes: &[0, 2, 1, 6, 5, 4] },
        Side { element: "tri6", nodes: &[0, 1, 3, 4, 8, 7] },
        Side { element: "tri6", nodes: &[1, 2, 3, 5, 9, 8] },
        Side { element: "tri6", nodes: &[0, 3, 2, 7, 9, 6] },
    ],
    edges: &[
        Side { element: "edge3", nodes: &[0, 1, 4] },
        Side { element: "edge3", nodes: &[1, 2, 5] },
        Side { element: "edge3", nodes: &[2, 0, 6] },
        Side { element: "edge3", nodes: &[0, 3, 7] },
        Side { element: "edge3", nodes: &[1, 3, 8] },
        Side { element: "edge3", nodes: &[2, 3, 9] },
    ],
    // One point sees a constant strain only: for terms that are meant to be under-integrated, such as a bulk penalty.
    quadratures: &["tetrahedron-4", "tetrahedron-1", "tetrahedron-14"],
    exchange: Exchange {
        vtk: 24,
        gmsh: 11,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        abaqus: &["C3D10"],
        medit: Some("TetrahedraP2"),
    },
};

const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, four) = (g.int(1), g.int(2), g.int(4));
    let sum = g.sum(&[xi, eta, zeta]);
    let lambda = [g.sub(one, sum), xi, eta, zeta];
    let mut all = Vec::with_capacity(NODES.len());
    for at in lambda {
        let twice = g.mul(two, at);
        let less = g.sub(twice, one);
        all.push(g.mul(at, less));
    }
    for edge in ELEMENT.edges {
        let [i, j] = [edge.nodes[0], edge.nodes[1]].map(usize::from);
        all.push(g.product(&[four, lambda[i], lambda[j]]));
    }
    all
}
