//! Faces that cover each other without being the same: where a mesh of mixed elements does not conform.
//!
//! Found from corners alone, so it works on any mesh. On a quadrangle {a, b, c, d} without mate, triangles without
//! mate that use three of its corners lie on it; two pairs of neighbouring triangles on the same four corners lie on
//! each other when their diagonals cross and they belong to different elements. A void with the shape of a flat wedge
//! or of one tetrahedron looks the same; neither is a mesh that anybody wants.

use super::glue::corner_set;
use super::{FaceId, Topology};
use crate::reference::side_element;

/// Faces of two elements between which displacements are not continuous.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Interface {
    /// A quadrangle and the triangles on its corners: two for a whole cover, one where half of it is free.
    QuadrangleAgainstTriangles {
        /// The quadrangle.
        quadrangle: FaceId,
        /// The triangles, sorted.
        triangles: Vec<FaceId>,
    },
    /// Two triangles on one diagonal of four corners, two on the other.
    CrossedDiagonals {
        /// The pair with the lower faces.
        first: [FaceId; 2],
        /// The other pair.
        second: [FaceId; 2],
    },
    /// Glued faces whose elements interpolate them differently (`quad4` on `quad8`).
    DifferentInterpolation {
        /// The two faces, sorted.
        faces: [FaceId; 2],
        /// The ids of their interpolations.
        interpolations: [&'static str; 2],
    },
}

/// Every such interface, sorted. Empty for a conforming mesh.
pub fn interfaces(topology: &Topology) -> Vec<Interface> {
    let mut found = different_interpolations(topology);
    if topology.dimension == 3 {
        let (triangles, quadrangles): (Vec<FaceId>, Vec<FaceId>) =
            topology.boundary().into_iter().partition(|&f| topology.face_corners(f).len() == 3);
        found.extend(quadrangles_against_triangles(topology, &triangles, &quadrangles));
        found.extend(crossed_diagonals(topology, &triangles));
    }
    found.sort_unstable();
    found
}

/// The boundary without the faces that lie on other elements: the skin of the body even where the mesh does not
/// conform. A quadrangle half of which is free belongs to it.
pub fn exterior(topology: &Topology) -> Vec<FaceId> {
    let mut covered: Vec<FaceId> = Vec::new();
    for interface in interfaces(topology) {
        match interface {
            Interface::QuadrangleAgainstTriangles { quadrangle, triangles } => {
                covered.extend((triangles.len() > 1).then_some(quadrangle));
                covered.extend(triangles);
            }
            Interface::CrossedDiagonals { first, second } => covered.extend(first.into_iter().chain(second)),
            Interface::DifferentInterpolation { .. } => {}
        }
    }
    covered.sort_unstable();
    let mut faces = topology.boundary();
    faces.retain(|face| covered.binary_search(face).is_err());
    faces
}

fn different_interpolations(topology: &Topology) -> Vec<Interface> {
    let interpolation = |face: FaceId| {
        let side = topology.run(face.element()).element.faces.get(face.face());
        side.map(|side| side_element(side).id)
    };
    topology
        .faces()
        .filter_map(|face| {
            let mate = topology.mate(face);
            if mate.is_none() || mate < face {
                return None;
            }
            let interpolations = [interpolation(face)?, interpolation(mate)?];
            (interpolations[0] != interpolations[1])
                .then_some(Interface::DifferentInterpolation { faces: [face, mate], interpolations })
        })
        .collect()
}

fn quadrangles_against_triangles(topology: &Topology, triangles: &[FaceId], quadrangles: &[FaceId]) -> Vec<Interface> {
    let mut sets: Vec<([u32; 4], FaceId)> =
        triangles.iter().map(|&t| (corner_set(topology.face_material(t)), t)).collect();
    sets.sort_unstable();
    let mut found = Vec::new();
    for &quadrangle in quadrangles {
        let corners: Vec<u32> = topology.face_material(quadrangle).collect();
        let mut on: Vec<FaceId> = Vec::new();
        for left_out in 0..4 {
            let three = (0..4).filter(|&c| c != left_out).map(|c| corners[c]);
            let set = corner_set(three);
            let from = sets.partition_point(|entry| entry.0 < set);
            on.extend(sets[from..].iter().take_while(|entry| entry.0 == set).map(|entry| entry.1));
        }
        on.retain(|t| t.element() != quadrangle.element());
        on.sort_unstable();
        if !on.is_empty() {
            found.push(Interface::QuadrangleAgainstTriangles { quadrangle, triangles: on });
        }
    }
    found
}

fn crossed_diagonals(topology: &Topology, triangles: &[FaceId]) -> Vec<Interface> {
    // Pairs of neighbouring triangles with the corners that they span, their common edge and its number of elements.
    type Pair = ([u32; 4], [u32; 2], [FaceId; 2], usize);
    let mut pairs: Vec<Pair> = Vec::new();
    for &first in triangles {
        let [a, b, c, _] = corner_set(topology.face_material(first));
        for (diagonal, near) in [([a, b], c), ([a, c], b), ([b, c], a)] {
            let Some((second, length)) = topology.fan(first, diagonal).filter(|(s, _)| first < *s) else { continue };
            let mut ends = topology.face_material(second).filter(|n| !diagonal.contains(n));
            if let (Some(far), None) = (ends.next(), ends.next())
                && far != near
            {
                pairs.push((corner_set([a, b, c, far].into_iter()), diagonal, [first, second], length));
            }
        }
    }
    pairs.sort_unstable();
    let mut found = Vec::new();
    for group in pairs.chunk_by(|x, y| x.0 == y.0) {
        // Where everything around is glued, the four triangles pair up in three ways. A diagonal belongs to the
        // elements behind its two triangles only, an outline to those of both sides: the shortest fans are right.
        let mut best: Option<(usize, Interface)> = None;
        for (i, &(_, diagonal, first, length)) in group.iter().enumerate() {
            for &(_, other, second, other_length) in &group[i + 1..] {
                let crosses = other.iter().all(|n| !diagonal.contains(n));
                let apart = first.iter().all(|f| second.iter().all(|g| f.element() != g.element()));
                let length = length + other_length;
                if crosses && apart && best.as_ref().is_none_or(|(least, _)| length < *least) {
                    let (first, second) = (first.min(second), first.max(second));
                    best = Some((length, Interface::CrossedDiagonals { first, second }));
                }
            }
        }
        found.extend(best.map(|(_, interface)| interface));
    }
    found
}
