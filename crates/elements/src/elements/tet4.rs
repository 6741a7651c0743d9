//! Linear tetrahedron: N = (λ₀, λ₁, λ₂, λ₃) with λ₀ = 1 − ξ − η − ζ, λ₁ = ξ, λ₂ = η, λ₃ = ζ.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tet4",
    family: Family::Tetrahedron,
    degree: 1,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    shape,
    faces: &[
        Side { element: "tri3", nodes: &[0, 2, 1] },
        Side { element: "tri3", nodes: &[0, 1, 3] },
        Side { element: "tri3", nodes: &[1, 2, 3] },
        Side { element: "tri3", nodes: &[0, 3, 2] },
    ],
    edges: &[
        Side { element: "edge2", nodes: &[0, 1] },
        Side { element: "edge2", nodes: &[1, 2] },
        Side { element: "edge2", nodes: &[2, 0] },
        Side { element: "edge2", nodes: &[0, 3] },
        Side { element: "edge2", nodes: &[1, 3] },
        Side { element: "edge2", nodes: &[2, 3] },
    ],
    quadratures: &["tetrahedron-1", "tetrahedron-4", "tetrahedron-14"],
    exchange: Exchange { vtk: 10, gmsh: 4, gmsh_order: None, abaqus: &["C3D4"], medit: Some("Tetrahedra") },
};

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let one = g.int(1);
    let sum = g.sum(&[xi, eta, zeta]);
    vec![g.sub(one, sum), xi, eta, zeta]
}
