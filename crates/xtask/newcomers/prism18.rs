//! Complete quadratic prism (wedge): N = T_b(ξ, η) L_k(ζ), a quadratic triangle times a quadratic line.
//!
//! T = λᵢ (2 λᵢ − 1) at the corners and 4 λᵢ λⱼ in the middle of the edges; L = ζ (ζ ∓ 1) / 2 at ζ = ±1 and 1 − ζ²
//! between.
//! Its quadrangles are `quad9`: it fits beside `hex27`, where `prism15` fits beside `hex20`.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "prism18",
    family: Family::Prism,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "tri6", nodes: &[0, 2, 1, 8, 7, 6] },
        Side { element: "tri6", nodes: &[3, 4, 5, 9, 10, 11] },
        Side { element: "quad9", nodes: &[0, 1, 4, 3, 6, 13, 9, 12, 15] },
        Side { element: "quad9", nodes: &[1, 2, 5, 4, 7, 14, 10, 13, 16] },
        Side { element: "quad9", nodes: &[2, 0, 3, 5, 8, 12, 11, 14, 17] },
    ],
    edges: &[
        Side { element: "edge3", nodes: &[0, 1, 6] },
        Side { element: "edge3", nodes: &[1, 2, 7] },
        Side { element: "edge3", nodes: &[2, 0, 8] },
        Side { element: "edge3", nodes: &[3, 4, 9] },
        Side { element: "edge3", nodes: &[4, 5, 10] },
        Side { element: "edge3", nodes: &[5, 3, 11] },
        Side { element: "edge3", nodes: &[0, 3, 12] },
        Side { element: "edge3", nodes: &[1, 4, 13] },
        Side { element: "edge3", nodes: &[2, 5, 14] },
    ],
    quadratures: &["prism-9", "prism-18"],
    exchange: Exchange {
        vtk: 32,
        gmsh: 13,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11, 15, 17, 16]),
        abaqus: &[],
        medit: None,
    },
};

const NODES: [[f64; 3]; 18] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, -1.0],
    [0.5, 0.5, -1.0],
    [0.0, 0.5, -1.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, four, half) = (g.int(1), g.int(4), g.rational(1, 2));
    let sum = g.add(xi, eta);
    let lambda = [g.sub(one, sum), xi, eta];
    let corners = lambda.map(|at| {
        let twice = g.add(at, at);
        let less = g.sub(twice, one);
        g.mul(at, less)
    });
    let edges = [[0, 1], [1, 2], [2, 0]].map(|[i, j]| g.product(&[four, lambda[i], lambda[j]]));
    let (down, up) = (g.sub(zeta, one), g.add(zeta, one));
    let square = g.powi(zeta, 2);
    let [below, above, middle] = [g.product(&[half, zeta, down]), g.product(&[half, zeta, up]), g.sub(one, square)];
    // The nodes stand in six layers of three: corners, edges, then both again in the middle plane.
    let layers =
        [(corners, below), (corners, above), (edges, below), (edges, above), (corners, middle), (edges, middle)];
    layers.iter().flat_map(|(plane, along)| plane.map(|at| g.mul(at, *along))).collect()
}
