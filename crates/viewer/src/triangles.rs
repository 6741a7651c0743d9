//! How edges are cut into straight pieces, through all of their nodes, so that curved edges look curved, and solids into
//! tetrahedra, so that a plane can cut them. Triangles of faces: [`souple_simulation::surface`].

use souple_simulation::elements::{Element, Family, by_id};

/// Local nodes of the straight pieces of a face's edges, or of an edge itself.
pub fn outline(element: &Element) -> Vec<[u8; 2]> {
    let chain = |edge: &Element, nodes: &[u8]| {
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        order.sort_by(|&a, &b| edge.nodes[a][0].total_cmp(&edge.nodes[b][0]));
        order.windows(2).map(|w| [nodes[w[0]], nodes[w[1]]]).collect::<Vec<_>>()
    };
    if element.family == Family::Edge {
        let all: Vec<u8> = (0..element.node_count() as u8).collect();
        return chain(element, &all);
    }
    element.edges.iter().filter_map(|side| by_id(side.element).map(|edge| chain(edge, side.nodes))).flatten().collect()
}

/// Tetrahedra that fill an element between its corners, as local nodes; for cutting it with a plane.
///
/// A pyramid is cut through one diagonal of its base, a prism and a hexahedron through diagonals of their sides: for
/// pictures, where neighbours need not choose the same one.
pub fn tetrahedra(family: Family) -> &'static [[u8; 4]] {
    match family {
        Family::Tetrahedron => &[[0, 1, 2, 3]],
        Family::Pyramid => &[[0, 1, 2, 4], [0, 2, 3, 4]],
        Family::Prism => &[[0, 1, 2, 3], [1, 2, 3, 4], [2, 3, 4, 5]],
        Family::Hexahedron => &[[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]],
        Family::Edge | Family::Triangle | Family::Quadrangle => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_simulation::elements::all;

    /// The pieces of every outline touch each node of the rim, and only these.
    #[test]
    fn outlines_pass_through_the_rim() {
        for face in all().iter().filter(|e| e.dimension() == 2) {
            let pieces = outline(face);
            let inside = match (face.family, face.node_count()) {
                (Family::Triangle, 10) | (Family::Quadrangle, 9) => 1,
                _ => 0,
            };
            assert_eq!(pieces.len(), face.node_count() - inside, "{}", face.id);
        }
    }

    /// The tetrahedra of every solid fill the cell of its corners.
    #[test]
    fn tetrahedra_fill_the_cell() {
        for solid in all().iter().filter(|e| e.dimension() == 3) {
            let volume: f64 = tetrahedra(solid.family)
                .iter()
                .map(|t| {
                    let [o, a, b, c] = t.map(|n| solid.nodes[n as usize]);
                    let edge = |p: [f64; 3]| [p[0] - o[0], p[1] - o[1], p[2] - o[2]];
                    let (a, b, c) = (edge(a), edge(b), edge(c));
                    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                    (cross[0] * c[0] + cross[1] * c[1] + cross[2] * c[2]).abs() / 6.0
                })
                .sum();
            assert!((volume - solid.family.reference_measure()).abs() < 1e-12, "{}: {volume}", solid.id);
        }
    }
}
