//! Finding mates by sorting the corner sets of all faces.
//!
//! Sorting (set, face) makes equal sets neighbours and the result independent of anything but the mesh.

use super::{FaceId, Topology};

/// Corners of a face in increasing order; unused places hold the largest number.
pub(crate) type CornerSet = [u32; 4];

pub(crate) fn corner_set(corners: impl Iterator<Item = u32>) -> CornerSet {
    let mut set = [u32::MAX; 4];
    for (place, corner) in set.iter_mut().zip(corners) {
        *place = corner;
    }
    set.sort_unstable();
    set
}

/// Fills `mate`, `non_manifold`, `folded` and `collapsed`.
pub(super) fn glue(topology: &mut Topology) {
    let mut sets: Vec<(CornerSet, FaceId)> = Vec::with_capacity(topology.mate.len());
    let mut collapsed = Vec::new();
    for face in topology.faces() {
        let set = corner_set(topology.face_material(face));
        let count = topology.face_corners(face).len();
        match set[..count].windows(2).any(|pair| pair[0] == pair[1]) {
            true => collapsed.push(face),
            false => sets.push((set, face)),
        }
    }
    topology.collapsed = collapsed;
    sets.sort_unstable();
    for group in sets.chunk_by(|a, b| a.0 == b.0) {
        match group {
            [_] => {}
            [(_, a), (_, b)] => {
                let (slot_a, slot_b) = (topology.slot(*a), topology.slot(*b));
                (topology.mate[slot_a], topology.mate[slot_b]) = (*b, *a);
                if !opposite(topology, *a, *b) {
                    topology.folded.push([*a, *b]);
                }
            }
            more => topology.non_manifold.push(more.iter().map(|(_, face)| *face).collect()),
        }
    }
    topology.folded.sort_unstable();
    topology.non_manifold.sort_unstable();
}

/// Whether two faces with the same corners turn opposite ways: the corner after a given one on one side comes before
/// it on the other. A point has no sense of turning; two ends of a line are opposite when one is its first end.
fn opposite(topology: &Topology, a: FaceId, b: FaceId) -> bool {
    let (p, q): (Vec<u32>, Vec<u32>) = (topology.face_material(a).collect(), topology.face_material(b).collect());
    let n = p.len();
    if n == 1 {
        return a.face() != b.face();
    }
    let at = q.iter().position(|&node| node == p[0]).expect("both faces have the same corners");
    (0..n).all(|i| p[i] == q[(at + n - i) % n]) && (n > 2 || at == 1)
}
