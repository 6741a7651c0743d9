//! Nodes as orbits: corners of elements joined across glued faces (union-find).

use super::Topology;

/// Finds the nodes of the present gluing: fills `corner_node` and `node_material`.
///
/// `material_nodes` is the number of nodes of the mesh. The orbit that holds the first corner over a material node
/// keeps that node's number, so an unopened manifold mesh has `corner_node == corner_material`.
pub(super) fn renew(topology: &mut Topology, material_nodes: usize) {
    let mut parent: Vec<u32> = (0..topology.corner_material.len() as u32).collect();
    for face in topology.faces() {
        let mate = topology.mate(face);
        if mate.is_none() || mate < face {
            continue;
        }
        for corner in topology.face_corners(face) {
            let material = topology.corner_material[corner];
            let other = topology.face_corners(mate).find(|&c| topology.corner_material[c] == material);
            let other = other.expect("glued faces have the same corners");
            let (a, b) = (root(&mut parent, corner as u32), root(&mut parent, other as u32));
            // The lower corner leads, so that the leader is met first below.
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut node_material: Vec<u32> = (0..material_nodes as u32).collect();
    let mut taken = vec![false; material_nodes];
    let mut corner_node = vec![0; parent.len()];
    for corner in 0..parent.len() {
        let leader = root(&mut parent, corner as u32) as usize;
        if leader < corner {
            corner_node[corner] = corner_node[leader];
            continue;
        }
        let material = topology.corner_material[corner];
        corner_node[corner] = match std::mem::replace(&mut taken[material as usize], true) {
            false => material,
            true => {
                node_material.push(material);
                (node_material.len() - 1) as u32
            }
        };
    }
    (topology.corner_node, topology.node_material) = (corner_node, node_material);
}

fn root(parent: &mut [u32], mut at: u32) -> u32 {
    while parent[at as usize] != at {
        let above = parent[parent[at as usize] as usize];
        parent[at as usize] = above;
        at = above;
    }
    at
}
