//! Linear prism (wedge): N_a = λ_a (1 ± ζ) / 2, the linear triangle times the linear edge.
//!
//! Nodes 0, 1, 2 are the triangle at ζ = −1 and 3, 4, 5 stand above them, so that the Jacobian is positive; some
//! versions of VTK draw their linear wedge the other way round, which is the writer's affair.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "prism6",
    family: Family::Prism,
    degree: 1,
    nodes: &[[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
    shape,
    faces: &[
        Side { element: "tri3", nodes: &[0, 2, 1] },
        Side { element: "tri3", nodes: &[3, 4, 5] },
        Side { element: "quad4", nodes: &[0, 1, 4, 3] },
        Side { element: "quad4", nodes: &[1, 2, 5, 4] },
        Side { element: "quad4", nodes: &[2, 0, 3, 5] },
    ],
    edges: &[
        Side { element: "edge2", nodes: &[0, 1] },
        Side { element: "edge2", nodes: &[1, 2] },
        Side { element: "edge2", nodes: &[2, 0] },
        Side { element: "edge2", nodes: &[3, 4] },
        Side { element: "edge2", nodes: &[4, 5] },
        Side { element: "edge2", nodes: &[5, 3] },
        Side { element: "edge2", nodes: &[0, 3] },
        Side { element: "edge2", nodes: &[1, 4] },
        Side { element: "edge2", nodes: &[2, 5] },
    ],
    // Two points pass the patch test but leave the twist u = ((η − 1/3) ζ, −(ξ − 1/3) ζ, 0) without energy.
    quadratures: &["prism-6", "prism-2", "prism-9"],
    exchange: Exchange { vtk: 13, gmsh: 6, gmsh_order: None, abaqus: &["C3D6"], medit: Some("Prisms") },
};

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, half) = (g.int(1), g.rational(1, 2));
    let sum = g.add(xi, eta);
    let triangle = [g.sub(one, sum), xi, eta];
    let (minus, plus) = (g.sub(one, zeta), g.add(one, zeta));
    [minus, plus]
        .into_iter()
        .flat_map(|along| triangle.map(|lambda| (lambda, along)))
        .map(|(lambda, along)| g.product(&[half, lambda, along]))
        .collect()
}
