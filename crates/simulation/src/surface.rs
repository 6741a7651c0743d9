//! The surface of the bodies as triangles on numbered nodes: what tools touch and what is drawn.
//!
//! Faces are cut through all of their nodes, so that curved faces stay curved: along their lattice of nodes where there
//! is one, and around the middle of the rim where nodes lie on the rim only (8 nodes of a quadrangle). A kind that is not
//! known is cut by its corners.

use crate::prepare::{Prepared, PreparedBody};
use souple_elements::{Element, Family};
use souple_mesh::ElementId;
use souple_mesh::topology::{Topology, boundary};
use std::collections::BTreeSet;

/// A face of the surface.
#[derive(Clone, Debug)]
pub struct Face {
    /// What the face is (`"tri3"`, `"quad8"`).
    pub kind: &'static Element,
    /// Its nodes over all bodies; its corners turn counter-clockwise seen from outside.
    pub nodes: Vec<u32>,
    /// Number of the element that it belongs to.
    pub element: u32,
}

/// Faces of one solid element only, and elements that are surfaces themselves, body by body. A membrane that covers a
/// solid's face takes its place.
pub fn faces(prepared: &Prepared) -> Vec<Face> {
    let mut faces = Vec::new();
    for body in &prepared.bodies {
        add_faces(body, &mut faces);
    }
    faces
}

/// The nodes of the surface, ascending: what a picture of it needs to know the places of.
pub fn nodes(prepared: &Prepared) -> Vec<u32> {
    let all: BTreeSet<u32> = faces(prepared).into_iter().flat_map(|face| face.nodes).collect();
    all.into_iter().collect()
}

fn add_faces(body: &PreparedBody, faces: &mut Vec<Face>) {
    let numbers = body.numbers();
    let number_of = |id: ElementId| -> Option<u32> {
        numbers.binary_search_by_key(&id, |n| n.0).ok().map(|at| body.first_element + numbers[at].1)
    };
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let surfaces = || body.elements.iter().copied().filter(|&id| body.element(id).dimension() == 2);
    let covers: BTreeSet<Vec<u32>> = surfaces().map(|id| sorted(body.mesh.nodes_of(id))).collect();
    if body.mesh.dimension() == 3
        // A mesh that was prepared has no node out of range; what is too large to number has no surface here.
        && let Ok(topology) = Topology::new(&body.mesh)
    {
        let surface = boundary(&body.mesh, &topology);
        for (block, owners) in surface.mesh.blocks.iter().zip(&surface.owners) {
            for (index, face) in owners.iter().enumerate() {
                let Some(element) = number_of(topology.id(face.element())) else { continue };
                let nodes: Vec<u32> = block.nodes(index).iter().map(|&n| surface.parent[n as usize]).collect();
                if covers.contains(&sorted(&nodes)) {
                    continue;
                }
                let nodes = nodes.into_iter().map(|n| n + body.first_node).collect();
                faces.push(Face { kind: block.element, nodes, element });
            }
        }
    }
    for id in surfaces() {
        let Some(element) = number_of(id) else { continue };
        let nodes = body.mesh.nodes_of(id).iter().map(|n| n + body.first_node).collect();
        faces.push(Face { kind: body.element(id), nodes, element });
    }
}

/// Local nodes of the triangles of a face, each turning as the face does.
pub fn triangles(face: &Element) -> &'static [[u8; 3]] {
    match (face.family, face.node_count()) {
        (Family::Triangle, 6) => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        // Rim 0 3 4 1 5 6 2 7 8, middle 9.
        (Family::Triangle, 10) => {
            &[[0, 3, 8], [3, 4, 9], [4, 1, 5], [3, 9, 8], [4, 5, 9], [8, 9, 7], [9, 5, 6], [9, 6, 7], [7, 6, 2]]
        }
        (Family::Triangle, _) => &[[0, 1, 2]],
        (Family::Quadrangle, 8) => &[[0, 4, 7], [4, 1, 5], [5, 2, 6], [6, 3, 7], [4, 5, 6], [4, 6, 7]],
        (Family::Quadrangle, 9) => {
            &[[0, 4, 8], [4, 1, 8], [1, 5, 8], [5, 2, 8], [2, 6, 8], [6, 3, 8], [3, 7, 8], [7, 0, 8]]
        }
        (Family::Quadrangle, _) => &[[0, 1, 2], [0, 2, 3]],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_elements::all;

    /// The triangles of every face cover its reference cell exactly once and turn as it does.
    #[test]
    fn triangles_cover_the_face() {
        for face in all().iter().filter(|e| e.dimension() == 2) {
            let mut area = 0.0;
            for t in triangles(face) {
                let [a, b, c] = t.map(|n| face.nodes[n as usize]);
                let part = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
                assert!(part > 0.0, "{}: {t:?}", face.id);
                area += part;
            }
            assert!((area - face.family.reference_measure()).abs() < 1e-12, "{}: {area}", face.id);
            let used = |n: u8| triangles(face).iter().any(|t| t.contains(&n));
            assert!((0..face.node_count() as u8).all(used), "{}: a node is left out", face.id);
        }
    }
}
