//! Linear pyramid: N_a = (w + ξ_a ξ)(w + η_a η) / (4 w) at the base, ζ at the apex, with w = 1 − ζ.
//!
//! Rational, because no polynomial is bilinear on the base and linear on the four triangles: it is what makes the
//! pyramid fit hexahedra, prisms and tetrahedra without a gap.
//! With u = ξ / w and v = η / w it reads w (1 + ξ_a u)(1 + η_a v) / 4, hence the gradient depends on u and v only: the
//! 2 × 2 × 1 points of `pyramid-4` integrate the forces exactly as 2 × 2 × 2 do, for half the work.
//! At the apex itself the formula is 0/0; no rule has a point there.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "pyramid5",
    family: Family::Pyramid,
    degree: 1,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "quad4", nodes: &[0, 3, 2, 1] },
        Side { element: "tri3", nodes: &[0, 1, 4] },
        Side { element: "tri3", nodes: &[1, 2, 4] },
        Side { element: "tri3", nodes: &[2, 3, 4] },
        Side { element: "tri3", nodes: &[3, 0, 4] },
    ],
    edges: &[
        Side { element: "edge2", nodes: &[0, 1] },
        Side { element: "edge2", nodes: &[1, 2] },
        Side { element: "edge2", nodes: &[2, 3] },
        Side { element: "edge2", nodes: &[3, 0] },
        Side { element: "edge2", nodes: &[0, 4] },
        Side { element: "edge2", nodes: &[1, 4] },
        Side { element: "edge2", nodes: &[2, 4] },
        Side { element: "edge2", nodes: &[3, 4] },
    ],
    quadratures: &["pyramid-4", "pyramid-5", "pyramid-8", "pyramid-27"],
    exchange: Exchange { vtk: 14, gmsh: 7, gmsh_order: None, abaqus: &["C3D5"], medit: Some("Pyramids") },
};

const NODES: [[f64; 3]; 5] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let one = g.int(1);
    let w = g.sub(one, zeta);
    let quarter = g.rational(1, 4);
    let scale = g.div(quarter, w);
    let mut all: Vec<Expr> = NODES[..4]
        .iter()
        .map(|node| {
            let a = if node[0] > 0.0 { g.add(w, xi) } else { g.sub(w, xi) };
            let b = if node[1] > 0.0 { g.add(w, eta) } else { g.sub(w, eta) };
            g.product(&[scale, a, b])
        })
        .collect();
    all.push(zeta);
    all
}
