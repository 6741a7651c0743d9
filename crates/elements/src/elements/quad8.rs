//! Serendipity quadrangle: N_a = (1 + ξ_a ξ)(1 + η_a η)(ξ_a ξ + η_a η − 1) / 4 at the corners, (1 − ξ²)(1 + η_a η) / 2
//! and (1 + ξ_a ξ)(1 − η²) / 2 in the middle of the edges.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "quad8",
    family: Family::Quadrangle,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &EDGES,
    edges: &EDGES,
    // Four points pass the patch test but leave one mode without energy.
    // One point is for comparison only.
    quadratures: &["quadrangle-9", "quadrangle-4", "quadrangle-1"],
    exchange: Exchange { vtk: 23, gmsh: 16, gmsh_order: None, abaqus: &["CPE8", "CPS8", "M3D8", "S8"], medit: None },
};

const NODES: [[f64; 3]; 8] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
];

const EDGES: [Side; 4] = [
    Side { element: "edge3", nodes: &[0, 1, 4] },
    Side { element: "edge3", nodes: &[1, 2, 5] },
    Side { element: "edge3", nodes: &[2, 3, 6] },
    Side { element: "edge3", nodes: &[3, 0, 7] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let (one, quarter, half) = (g.int(1), g.rational(1, 4), g.rational(1, 2));
    let x = [xi, eta];
    NODES
        .iter()
        .map(|node| {
            // Along an axis where the node sits in the middle: 1 − ξ²; at an end: 1 + ξ_a ξ.
            let factors: Vec<Expr> = (0..2)
                .map(|axis| match node[axis] {
                    0.0 => {
                        let square = g.powi(x[axis], 2);
                        g.sub(one, square)
                    }
                    end if end > 0.0 => g.add(one, x[axis]),
                    _ => g.sub(one, x[axis]),
                })
                .collect();
            if node[0] == 0.0 || node[1] == 0.0 {
                return g.product(&[half, factors[0], factors[1]]);
            }
            let signed = [0, 1].map(|axis| if node[axis] > 0.0 { x[axis] } else { g.neg(x[axis]) });
            let sum = g.add(signed[0], signed[1]);
            let less = g.sub(sum, one);
            g.product(&[quarter, factors[0], factors[1], less])
        })
        .collect()
}
