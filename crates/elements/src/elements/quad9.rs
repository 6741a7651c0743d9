//! Biquadratic quadrangle: products of the quadratic edge's functions −ξ (1 − ξ) / 2, 1 − ξ², ξ (1 + ξ) / 2.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "quad9",
    family: Family::Quadrangle,
    degree: 2,
    nodes: &NODES,
    shape,
    faces: &EDGES,
    edges: &EDGES,
    // Four points leave modes without energy; one point is for comparison only.
    quadratures: &["quadrangle-9", "quadrangle-4", "quadrangle-1"],
    exchange: Exchange { vtk: 28, gmsh: 10, gmsh_order: None, abaqus: &["M3D9"], medit: Some("QuadrilateralsQ2") },
};

const NODES: [[f64; 3]; 9] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
];

const EDGES: [Side; 4] = [
    Side { element: "edge3", nodes: &[0, 1, 4] },
    Side { element: "edge3", nodes: &[1, 2, 5] },
    Side { element: "edge3", nodes: &[2, 3, 6] },
    Side { element: "edge3", nodes: &[3, 0, 7] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let (one, half, minus_half) = (g.int(1), g.rational(1, 2), g.rational(-1, 2));
    NODES
        .iter()
        .map(|node| {
            let along: Vec<Expr> = node
                .iter()
                .zip([xi, eta])
                .map(|(&at, x)| match at {
                    0.0 => {
                        let square = g.powi(x, 2);
                        g.sub(one, square)
                    }
                    end if end > 0.0 => {
                        let plus = g.add(one, x);
                        g.product(&[half, x, plus])
                    }
                    _ => {
                        let minus = g.sub(one, x);
                        g.product(&[minus_half, x, minus])
                    }
                })
                .collect();
            g.product(&along)
        })
        .collect()
}
