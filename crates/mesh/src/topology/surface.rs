//! Faces as a mesh of their own: the boundary for drawing, contact, distances, tractions.

use super::{FaceId, Topology};
use crate::mesh::{Block, Mesh, sorted_set};
use crate::reference::side_element;
use std::collections::BTreeMap;

/// Faces of a mesh as elements of dimension one less.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Triangles and quadrangles (edges, for a flat mesh) with the interpolation of the faces; nodes are compact, in
    /// the order of the parent's. No regions.
    pub mesh: Mesh,
    /// The parent's node of each node.
    pub parent: Vec<u32>,
    /// The face that each element was, `[block][element]`.
    pub owners: Vec<Vec<FaceId>>,
}

/// The given faces as a mesh, each turning counter-clockwise seen from outside its element.
///
/// Faces of one kind follow each other in the order given. The ends of edges are points and give no element.
pub fn surface(mesh: &Mesh, topology: &Topology, faces: &[FaceId]) -> Surface {
    let mut blocks: Vec<Block> = Vec::new();
    let mut owners: Vec<Vec<FaceId>> = Vec::new();
    for &face in faces {
        let id = topology.id(face.element());
        let Some(side) = mesh.blocks[id.block as usize].element.faces.get(face.face()) else { continue };
        let element = side_element(side);
        let at = blocks.iter().position(|b| b.element.id == element.id).unwrap_or_else(|| {
            blocks.push(Block { element, connectivity: Vec::new() });
            owners.push(Vec::new());
            blocks.len() - 1
        });
        let nodes = mesh.nodes_of(id);
        blocks[at].connectivity.extend(side.nodes.iter().map(|&n| nodes[n as usize]));
        owners[at].push(face);
    }
    let parent = sorted_set(blocks.iter().flat_map(|b| b.connectivity.iter().copied()));
    for node in blocks.iter_mut().flat_map(|b| &mut b.connectivity) {
        *node = parent.binary_search(node).expect("the list was made of these") as u32;
    }
    let nodes = parent.iter().map(|&n| mesh.nodes[n as usize]).collect();
    Surface { mesh: Mesh { nodes, blocks, regions: BTreeMap::new() }, parent, owners }
}

/// The boundary of a mesh.
pub fn boundary(mesh: &Mesh, topology: &Topology) -> Surface {
    surface(mesh, topology, &topology.boundary())
}

/// V − E + F over the corners, edges and faces of the surface elements of a mesh: 2 for a sphere, 0 for a torus,
/// the sum over separate pieces.
pub fn euler_characteristic(surface: &Mesh) -> i64 {
    let blocks = || surface.blocks.iter().filter(|b| b.element.dimension() == 2);
    let corner_count = |b: &Block| b.element.family.corner_count();
    let corners = sorted_set(blocks().flat_map(|b| (0..b.len()).flat_map(move |e| &b.nodes(e)[..corner_count(b)])));
    let edges = sorted_set(blocks().flat_map(|b| {
        (0..b.len()).flat_map(move |e| {
            let nodes = b.nodes(e);
            b.element.edges.iter().map(move |side| {
                let [p, q] = [side.nodes[0], side.nodes[1]].map(|n| nodes[n as usize]);
                (p.min(q), p.max(q))
            })
        })
    }));
    let faces: usize = blocks().map(Block::len).sum();
    corners.len() as i64 - edges.len() as i64 + faces as i64
}
