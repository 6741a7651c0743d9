//! Serendipity pyramid, with w = 1 − ζ: N = (ξ_a ξ + η_a η − 1)(w + ξ_a ξ)(w + η_a η) / (4 w) at the base's corners,
//! ζ (2 ζ − 1) at the apex, (w − ξ)(w + ξ)(w + η_a η) / (2 w) in the middle of a base edge along ξ (likewise along η), and
//! ζ (w ± ξ)(w ± η) / w in the middle of the edges to the apex.
//!
//! Bedrosian, Shape functions and integration formulas for three-dimensional finite element analysis, 1992.
//! Rational so that its base is the serendipity quadrangle and its other faces the quadratic triangle: it fits 20-node
//! hexahedra, 15-node prisms and 10-node tetrahedra without a gap.
//! At the apex itself the formula is 0/0; no rule has a point there.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "pyramid13",
    family: Family::Pyramid,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "quad8", nodes: &[0, 3, 2, 1, 8, 7, 6, 5] },
        Side { element: "tri6", nodes: &[0, 1, 4, 5, 10, 9] },
        Side { element: "tri6", nodes: &[1, 2, 4, 6, 11, 10] },
        Side { element: "tri6", nodes: &[2, 3, 4, 7, 12, 11] },
        Side { element: "tri6", nodes: &[3, 0, 4, 8, 9, 12] },
    ],
    edges: &[
        Side { element: "edge3", nodes: &[0, 1, 5] },
        Side { element: "edge3", nodes: &[1, 2, 6] },
        Side { element: "edge3", nodes: &[2, 3, 7] },
        Side { element: "edge3", nodes: &[3, 0, 8] },
        Side { element: "edge3", nodes: &[0, 4, 9] },
        Side { element: "edge3", nodes: &[1, 4, 10] },
        Side { element: "edge3", nodes: &[2, 4, 11] },
        Side { element: "edge3", nodes: &[3, 4, 12] },
    ],
    // Eight points pass the patch test but leave one mode without energy.
    quadratures: &["pyramid-18", "pyramid-8", "pyramid-27"],
    exchange: Exchange {
        vtk: 27,
        gmsh: 19,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 8, 10, 6, 7, 9, 11, 12]),
        // Abaqus has no pyramid with 13 nodes.
        abaqus: &[],
        medit: None,
    },
};

const NODES: [[f64; 3]; 13] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [-0.5, -0.5, 0.5],
    [0.5, -0.5, 0.5],
    [0.5, 0.5, 0.5],
    [-0.5, 0.5, 0.5],
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, quarter, half) = (g.int(1), g.int(2), g.rational(1, 4), g.rational(1, 2));
    let w = g.sub(one, zeta);
    let along_xi = [g.sub(w, xi), g.add(w, xi)];
    let along_eta = [g.sub(w, eta), g.add(w, eta)];
    let (corner, base_edge, side_edge) = (g.div(quarter, w), g.div(half, w), g.div(zeta, w));
    // The four corners of the base: which sign of ξ and of η, 0 for minus.
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    let mut all = Vec::with_capacity(NODES.len());
    for [i, j] in corners {
        let a = if i == 1 { xi } else { g.neg(xi) };
        let b = if j == 1 { eta } else { g.neg(eta) };
        let sum = g.add(a, b);
        let less = g.sub(sum, one);
        all.push(g.product(&[corner, less, along_xi[i], along_eta[j]]));
    }
    let twice = g.mul(two, zeta);
    let less = g.sub(twice, one);
    all.push(g.mul(zeta, less));
    all.push(g.product(&[base_edge, along_xi[0], along_xi[1], along_eta[0]]));
    all.push(g.product(&[base_edge, along_eta[0], along_eta[1], along_xi[1]]));
    all.push(g.product(&[base_edge, along_xi[0], along_xi[1], along_eta[1]]));
    all.push(g.product(&[base_edge, along_eta[0], along_eta[1], along_xi[0]]));
    for [i, j] in corners {
        all.push(g.product(&[side_edge, along_xi[i], along_eta[j]]));
    }
    all
}
