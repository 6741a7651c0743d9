//! Serendipity hexahedron: N_a = (1 + ξ_a ξ)(1 + η_a η)(1 + ζ_a ζ)(ξ_a ξ + η_a η + ζ_a ζ − 2) / 8 at the corners,
//! (1 − ξ²)(1 + η_a η)(1 + ζ_a ζ) / 4 in the middle of an edge along ξ, and likewise along η and ζ.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "hex20",
    family: Family::Hexahedron,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "quad8", nodes: &[0, 3, 2, 1, 11, 10, 9, 8] },
        Side { element: "quad8", nodes: &[4, 5, 6, 7, 12, 13, 14, 15] },
        Side { element: "quad8", nodes: &[0, 1, 5, 4, 8, 17, 12, 16] },
        Side { element: "quad8", nodes: &[1, 2, 6, 5, 9, 18, 13, 17] },
        Side { element: "quad8", nodes: &[2, 3, 7, 6, 10, 19, 14, 18] },
        Side { element: "quad8", nodes: &[3, 0, 4, 7, 11, 16, 15, 19] },
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
    // Eight points (reduced integration) pass the patch test but leave six modes without energy.
    // One point is for comparison only.
    quadratures: &["hexahedron-27", "hexahedron-8", "hexahedron-1"],
    exchange: Exchange {
        vtk: 25,
        gmsh: 17,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]),
        abaqus: &["C3D20"],
        medit: None,
    },
};

const NODES: [[f64; 3]; 20] = [
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
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, eighth, quarter) = (g.int(1), g.int(2), g.rational(1, 8), g.rational(1, 4));
    let x = [xi, eta, zeta];
    NODES
        .iter()
        .map(|node| {
            // Along the axis where the node sits in the middle: 1 − ξ²; at an end: 1 + ξ_a ξ.
            let [a, b, c] = [0, 1, 2].map(|axis| match node[axis] {
                0.0 => {
                    let square = g.powi(x[axis], 2);
                    g.sub(one, square)
                }
                end if end > 0.0 => g.add(one, x[axis]),
                _ => g.sub(one, x[axis]),
            });
            if node.contains(&0.0) {
                return g.product(&[quarter, a, b, c]);
            }
            let signed = [0, 1, 2].map(|axis| if node[axis] > 0.0 { x[axis] } else { g.neg(x[axis]) });
            let sum = g.sum(&signed);
            let less = g.sub(sum, two);
            g.product(&[eighth, a, b, c, less])
        })
        .collect()
}
