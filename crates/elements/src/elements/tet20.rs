//! Cubic tetrahedron: N = λᵢ (3 λᵢ − 1)(3 λᵢ − 2) / 2 at the corners, 9/2 λᵢ λⱼ (3 λᵢ − 1) at the edge node nearer to
//! corner i, 27 λᵢ λⱼ λₖ in the middle of the faces.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tet20",
    family: Family::Tetrahedron,
    degree: 3,
    nodes: &NODES,
    shape,
    faces: &[
        Side { element: "tri10", nodes: &[0, 2, 1, 9, 8, 7, 6, 5, 4, 19] },
        Side { element: "tri10", nodes: &[0, 1, 3, 4, 5, 12, 13, 11, 10, 16] },
        Side { element: "tri10", nodes: &[1, 2, 3, 6, 7, 14, 15, 13, 12, 17] },
        Side { element: "tri10", nodes: &[0, 3, 2, 10, 11, 15, 14, 8, 9, 18] },
    ],
    edges: &[
        Side { element: "edge4", nodes: &[0, 1, 4, 5] },
        Side { element: "edge4", nodes: &[1, 2, 6, 7] },
        Side { element: "edge4", nodes: &[2, 0, 8, 9] },
        Side { element: "edge4", nodes: &[0, 3, 10, 11] },
        Side { element: "edge4", nodes: &[1, 3, 12, 13] },
        Side { element: "edge4", nodes: &[2, 3, 14, 15] },
    ],
    quadratures: &["tetrahedron-14", "tetrahedron-4", "tetrahedron-24"],
    exchange: Exchange {
        vtk: 71,
        gmsh: 29,
        gmsh_order: Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 10, 15, 14, 13, 12, 17, 19, 18, 16]),
        abaqus: &[],
        medit: None,
    },
};

const NODES: [[f64; 3]; 20] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0 / 3.0, 0.0, 0.0],
    [2.0 / 3.0, 0.0, 0.0],
    [2.0 / 3.0, 1.0 / 3.0, 0.0],
    [1.0 / 3.0, 2.0 / 3.0, 0.0],
    [0.0, 2.0 / 3.0, 0.0],
    [0.0, 1.0 / 3.0, 0.0],
    [0.0, 0.0, 1.0 / 3.0],
    [0.0, 0.0, 2.0 / 3.0],
    [2.0 / 3.0, 0.0, 1.0 / 3.0],
    [1.0 / 3.0, 0.0, 2.0 / 3.0],
    [0.0, 2.0 / 3.0, 1.0 / 3.0],
    [0.0, 1.0 / 3.0, 2.0 / 3.0],
    [1.0 / 3.0, 0.0, 1.0 / 3.0],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
    [0.0, 1.0 / 3.0, 1.0 / 3.0],
    [1.0 / 3.0, 1.0 / 3.0, 0.0],
];

fn shape(g: &mut Graph, [xi, eta, zeta]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, three) = (g.int(1), g.int(2), g.int(3));
    let (corner, edge_node, middle) = (g.rational(1, 2), g.rational(9, 2), g.int(27));
    let sum = g.sum(&[xi, eta, zeta]);
    let lambda = [g.sub(one, sum), xi, eta, zeta];
    let less = lambda.map(|at| {
        let thrice = g.mul(three, at);
        [g.sub(thrice, one), g.sub(thrice, two)]
    });
    let mut all = Vec::with_capacity(NODES.len());
    for (at, [less_one, less_two]) in lambda.into_iter().zip(less) {
        all.push(g.product(&[corner, at, less_one, less_two]));
    }
    for edge in ELEMENT.edges {
        let [i, j] = [edge.nodes[0], edge.nodes[1]].map(usize::from);
        for near in [i, j] {
            all.push(g.product(&[edge_node, lambda[i], lambda[j], less[near][0]]));
        }
    }
    for [i, j, k] in [[0, 1, 3], [1, 2, 3], [0, 2, 3], [0, 1, 2]] {
        all.push(g.product(&[middle, lambda[i], lambda[j], lambda[k]]));
    }
    all
}
