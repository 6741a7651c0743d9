//! Trilinear hexahedron: N_a = (1 + ξ_a ξ)(1 + η_a η)(1 + ζ_a ζ) / 8.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "hex8",
    family: Family::Hexahedron,
    degree: 1,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "quad4", nodes: &[0, 3, 2, 1] },
        Side { element: "quad4", nodes: &[4, 5, 6, 7] },
        Side { element: "quad4", nodes: &[0, 1, 5, 4] },
        Side { element: "quad4", nodes: &[1, 2, 6, 5] },
        Side { element: "quad4", nodes: &[2, 3, 7, 6] },
        Side { element: "quad4", nodes: &[3, 0, 4, 7] },
    ],
    edges: &[
        Side { element: "edge2", nodes: &[0, 1] },
        Side { element: "edge2", nodes: &[1, 2] },
        Side { element: "edge2", nodes: &[2, 3] },
        Side { element: "edge2", nodes: &[3, 0] },
        Side { element: "edge2", nodes: &[4, 5] },
        Side { element: "edge2", nodes: &[5, 6] },
        Side { element: "edge2", nodes: &[6, 7] },
        Side { element: "edge2", nodes: &[7, 4] },
        Side { element: "edge2", nodes: &[0, 4] },
        Side { element: "edge2", nodes: &[1, 5] },
        Side { element: "edge2", nodes: &[2, 6] },
        Side { element: "edge2", nodes: &[3, 7] },
    ],
    // One point needs hourglass control: the twelve modes u ∝ ξη, ηζ, ζξ, ξηζ deform without energy. Its gradient is that
    // of the centre, not the mean, so that it misses the patch test unless the opposite faces are parallel.
    quadratures: &["hexahedron-8", "hexahedron-1", "hexahedron-27"],
    exchange: Exchange { vtk: 12, gmsh: 5, gmsh_order: None, abaqus: &["C3D8"], medit: Some("Hexahedra") },
};

const NODES: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

fn shape(g: &mut Graph, x: [Expr; 3]) -> Vec<Expr> {
    let one = g.int(1);
    NODES
        .iter()
        .map(|node| {
            let mut factors = vec![g.rational(1, 8)];
            for (&at, &coordinate) in node.iter().zip(&x) {
                factors.push(if at > 0.0 { g.add(one, coordinate) } else { g.sub(one, coordinate) });
            }
            g.product(&factors)
        })
        .collect()
}
