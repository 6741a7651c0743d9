//! Cubic triangle: N = λᵢ (3 λᵢ − 1)(3 λᵢ − 2) / 2 at the corners, 9/2 λᵢ λⱼ (3 λᵢ − 1) at the edge node nearer to
//! corner i, 27 λ₀ λ₁ λ₂ in the middle.

use crate::{Element, Exchange, Family, Side};
use souple_symbols::{Expr, Graph};

/// The element.
pub const ELEMENT: Element = Element {
    id: "tri10",
    family: Family::Triangle,
    degree: 3,
    nodes: &NODES,
    shape,
    faces: &EDGES,
    edges: &EDGES,
    quadratures: &["triangle-6", "triangle-3", "triangle-7", "triangle-12"],
    exchange: Exchange { vtk: 69, gmsh: 21, gmsh_order: None, abaqus: &[], medit: None },
};

const NODES: [[f64; 3]; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0 / 3.0, 0.0, 0.0],
    [2.0 / 3.0, 0.0, 0.0],
    [2.0 / 3.0, 1.0 / 3.0, 0.0],
    [1.0 / 3.0, 2.0 / 3.0, 0.0],
    [0.0, 2.0 / 3.0, 0.0],
    [0.0, 1.0 / 3.0, 0.0],
    [1.0 / 3.0, 1.0 / 3.0, 0.0],
];

const EDGES: [Side; 3] = [
    Side { element: "edge4", nodes: &[0, 1, 3, 4] },
    Side { element: "edge4", nodes: &[1, 2, 5, 6] },
    Side { element: "edge4", nodes: &[2, 0, 7, 8] },
];

fn shape(g: &mut Graph, [xi, eta, _]: [Expr; 3]) -> Vec<Expr> {
    let (one, two, three) = (g.int(1), g.int(2), g.int(3));
    let (corner, edge_node, middle) = (g.rational(1, 2), g.rational(9, 2), g.int(27));
    let sum = g.add(xi, eta);
    let lambda = [g.sub(one, sum), xi, eta];
    let less = lambda.map(|at| {
        let thrice = g.mul(three, at);
        [g.sub(thrice, one), g.sub(thrice, two)]
    });
    let mut all = Vec::with_capacity(NODES.len());
    for (at, [less_one, less_two]) in lambda.into_iter().zip(less) {
        all.push(g.product(&[corner, at, less_one, less_two]));
    }
    for edge in &EDGES {
        let [i, j] = [edge.nodes[0], edge.nodes[1]].map(usize::from);
        for near in [i, j] {
            all.push(g.product(&[edge_node, lambda[i], lambda[j], less[near][0]]));
        }
    }
    all.push(g.product(&[middle, lambda[0], lambda[1], lambda[2]]));
    all
}
