//! Triquadratic hexahedron: products of the quadratic edge's functions −ξ (1 − ξ) / 2, 1 − ξ², ξ (1 + ξ) / 2.
//!
//! After the 20 nodes of the serendipity hexahedron come the faces ∓ξ, ∓η, ∓ζ and the centre.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "hex27",
    family: Family::Hexahedron,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "quad9", nodes: &[0, 3, 2, 1, 11, 10, 9, 8, 24] },
        Side { element: "quad9", nodes: &[4, 5, 6, 7, 12, 13, 14, 15, 25] },
        Side { element: "quad9", nodes: &[0, 1, 5, 4, 8, 17, 12, 16, 22] },
        Side { element: "quad9", nodes: &[1, 2, 6, 5, 9, 18, 13, 17, 21] },
        Side { element: "quad9", nodes: &[2, 3, 7, 6, 10, 19, 14, 18, 23] },
        Side { element: "quad9", nodes: &[3, 0, 4, 7, 11, 16, 15, 19, 20] },
    ],
    edges: &[
        Side { element: "edge3", nodes: &[0, 1, 8] },
        Side { element: "edge3", nodes: &[1, 2, 9] },
        Side { element: "edge3", nodes: &[2, 3, 10] },
        Side { element: "edge3", nodes: &[3, 0, 11] },
        Side { element: "edge3", nodes: &[4, 5, 12] },
        Side { element: "edge3", nodes: &[5, 6, 13] },
        Side { element: "edge3", nodes: &[6, 7, 14] },
        Side { element: "edge3", nodes: &[7, 4, 15] },
        Side { element: "edge3", nodes: &[0, 4, 16] },
        Side { element: "edge3", nodes: &[1, 5, 17] },
        Side { element: "edge3", nodes: &[2, 6, 18] },
        Side { element: "edge3", nodes: &[3, 7, 19] },
    ],
    // Eight points leave modes without energy; one point is for comparison only.
    quadratures: &["hexahedron-27", "hexahedron-8", "hexahedron-1"],
    exchange: Exchange {
        vtk: 29,
        gmsh: 12,
        gmsh_order: Some(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26,
        ]),
        // Abaqus has C3D27, but puts the centre before the faces.
        abaqus: &[],
        medit: None,
    },
};

const NODES: [[f64; 3]; 27] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, half, minus_half) = (g.int(1), g.rational(1, 2), g.rational(-1, 2));
    let x = [xi, eta, zeta];
    NODES
        .iter()
        .map(|node| {
            let along = [0, 1, 2].map(|axis| match node[axis] {
                0.0 => {
                    let square = g.powi(x[axis], 2);
                    g.sub(one, square)
                }
                end if end > 0.0 => {
                    let plus = g.add(one, x[axis]);
                    g.product(&[half, x[axis], plus])
                }
                _ => {
                    let minus = g.sub(one, x[axis]);
                    g.product(&[minus_half, x[axis], minus])
                }
            });
            g.product(&along)
        })
        .collect()
}
