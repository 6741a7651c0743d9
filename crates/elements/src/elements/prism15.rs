//! Serendipity prism (wedge): N = λᵢ (1 ± ζ)(2 λᵢ ± ζ − 2) / 2 at the corners, 2 λᵢ λⱼ (1 ± ζ) in the middle of the
//! triangles' edges, λᵢ (1 − ζ²) in the middle of the upright ones.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "prism15",
    family: Family::Prism,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "tri6", nodes: &[0, 2, 1, 8, 7, 6] },
        Side { element: "tri6", nodes: &[3, 4, 5, 9, 10, 11] },
        Side { element: "quad8", nodes: &[0, 1, 4, 3, 6, 13, 9, 12] },
        Side { element: "quad8", nodes: &[1, 2, 5, 4, 7, 14, 10, 13] },
        Side { element: "quad8", nodes: &[2, 0, 3, 5, 8, 12, 11, 14] },
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
    // Six points pass the patch test but leave three modes without energy.
    quadratures: &["prism-9", "prism-6", "prism-18"],
    exchange: Exchange {
        vtk: 26,
        gmsh: 18,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11]),
        abaqus: &["C3D15"],
        medit: None,
    },
};

const NODES: [[f64; 3]; 15] = [
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
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, half) = (g.int(1), g.int(2), g.rational(1, 2));
    let sum = g.add(xi, eta);
    let lambda = [g.sub(one, sum), xi, eta];
    let below = g.neg(zeta);
    let (down, up) = (g.sub(one, zeta), g.add(one, zeta));
    let mut all = Vec::with_capacity(NODES.len());
    for (signed, along) in [(below, down), (zeta, up)] {
        for at in lambda {
            let twice = g.mul(two, at);
            let sum = g.add(twice, signed);
            let less = g.sub(sum, two);
            all.push(g.product(&[half, at, along, less]));
        }
    }
    for along in [down, up] {
        for [i, j] in [[0, 1], [1, 2], [2, 0]] {
            all.push(g.product(&[two, lambda[i], lambda[j], along]));
        }
    }
    let square = g.powi(zeta, 2);
    let middle = g.sub(one, square);
    all.extend(lambda.map(|at| g.mul(at, middle)));
    all
}
