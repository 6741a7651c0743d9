//! Which way round an element is, and how to turn it.
//!
//! Formats disagree about the order of a wedge's nodes, and meshers mirror parts.
//! The sign comes from the corners alone: at each corner with as many edges as dimensions, the determinant of the edge
//! vectors has the sign of det ∂x/∂ξ there; the sum over the corners decides.
//!
//! This is no quality check: an element that is positive at one corner and negative at another keeps its order here.

use crate::geometry::{cross, minus, triple};
use crate::reference::{corner_frames, mirror};
use souple_elements::Element;

/// How to judge and turn the elements of one kind.
pub(super) struct Orientation {
    dimension: usize,
    /// Corners with the ends of their edges, positive in the reference cell.
    frames: Vec<(u8, Vec<u8>)>,
    /// `turned[i] = nodes[mirror[i]]`; empty when the nodes have no such symmetry.
    mirror: Vec<u8>,
    corners: Vec<[f64; 3]>,
}

impl Orientation {
    pub(super) fn of(element: &Element) -> Self {
        let frames = (0u8..).zip(corner_frames(element)).filter_map(|(corner, ends)| Some((corner, ends?)));
        Orientation {
            dimension: element.dimension(),
            frames: frames.collect(),
            mirror: mirror(element).unwrap_or_default(),
            corners: vec![[0.0; 3]; element.family.corner_count()],
        }
    }

    /// Sum of the corner determinants; its sign is the element's (in dimension 2, seen from above).
    pub(super) fn measure(&mut self, nodes: &[u32], positions: &[[f64; 3]]) -> f64 {
        for (corner, &node) in self.corners.iter_mut().zip(nodes) {
            *corner = positions[node as usize];
        }
        let corners = &self.corners;
        let determinant = |(corner, ends): &(u8, Vec<u8>)| {
            let edge = |k: usize| minus(corners[ends[k] as usize], corners[*corner as usize]);
            match self.dimension {
                2 => cross(edge(0), edge(1))[2],
                3 => triple(edge(0), edge(1), edge(2)),
                _ => 0.0,
            }
        };
        self.frames.iter().map(determinant).sum()
    }

    /// Turns the element round; `false` when its nodes have no mirror symmetry.
    pub(super) fn turn(&self, nodes: &mut [u32]) -> bool {
        if self.mirror.is_empty() {
            return false;
        }
        let old = nodes.to_vec();
        for (node, &from) in nodes.iter_mut().zip(&self.mirror) {
            *node = old[from as usize];
        }
        true
    }
}
