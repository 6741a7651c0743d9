//! Linear triangle: N = (λ₀, λ₁, λ₂) with λ₀ = 1 − ξ − η, λ₁ = ξ, λ₂ = η.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tri3",
    family: Family::Triangle,
    degree: 1,
    nodes: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    shape,
    faces: &EDGES,
    edges: &EDGES,
    quadratures: &["triangle-1", "triangle-3", "triangle-7"],
    exchange: Exchange {
        vtk: 5,
        gmsh: 2,
        gmsh_order: None,
        abaqus: &["CPE3", "CPS3", "M3D3", "S3", "STRI3"],
        medit: Some("Triangles"),
    },
};

const EDGES: [Side; 3] = [
    Side { element: "edge2", nodes: &[0, 1] },
    Side { element: "edge2", nodes: &[1, 2] },
    Side { element: "edge2", nodes: &[2, 0] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let one = g.int(1);
    let sum = g.add(xi, eta);
    vec![g.sub(one, sum), xi, eta]
}
