//! Bilinear quadrangle: N_a = (1 + ξ_a ξ)(1 + η_a η) / 4.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "quad4",
    family: Family::Quadrangle,
    degree: 1,
    nodes: &NODES,
    shape,
    faces: &EDGES,
    edges: &EDGES,
    // One point leaves the two hourglass modes u ∝ ξη without energy; it needs hourglass control.
    quadratures: &["quadrangle-4", "quadrangle-1", "quadrangle-9"],
    exchange: Exchange {
        vtk: 9,
        gmsh: 3,
        gmsh_order: None,
        abaqus: &["CPE4", "CPS4", "M3D4", "S4"],
        medit: Some("Quadrilaterals"),
    },
};

const NODES: [[f64; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

const EDGES: [Side; 4] = [
    Side { element: "edge2", nodes: &[0, 1] },
    Side { element: "edge2", nodes: &[1, 2] },
    Side { element: "edge2", nodes: &[2, 3] },
    Side { element: "edge2", nodes: &[3, 0] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let (one, quarter) = (g.int(1), g.rational(1, 4));
    NODES
        .iter()
        .map(|node| {
            let a = if node[0] > 0.0 { g.add(one, xi) } else { g.sub(one, xi) };
            let b = if node[1] > 0.0 { g.add(one, eta) } else { g.sub(one, eta) };
            g.product(&[quarter, a, b])
        })
        .collect()
}
