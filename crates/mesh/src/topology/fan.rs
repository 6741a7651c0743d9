//! Walking around an edge through the elements that share it.

use super::{FaceId, Topology};

impl Topology {
    /// The face that ends the fan of elements around an edge, started at a face without mate on that edge.
    ///
    /// `edge` holds the material nodes at its ends; `face` contains both. Walks from element to element across glued
    /// faces until one has no mate. This pairs the boundary's faces across its edges without looking at positions:
    /// the pairing is symmetric and has no fixed point, so the boundary is a closed surface whatever touches it.
    /// For solids; `None` for elements of lower dimension, and where degenerate elements make the walk ambiguous.
    pub fn across_edge(&self, face: FaceId, edge: [u32; 2]) -> Option<FaceId> {
        self.fan(face, edge).map(|(end, _)| end)
    }

    /// The same with the number of elements in the fan.
    pub(super) fn fan(&self, face: FaceId, edge: [u32; 2]) -> Option<(FaceId, usize)> {
        if self.dimension != 3 {
            return None;
        }
        let mut at = face;
        // A fan has at most as many elements as there are; only degenerate elements could make it longer.
        for length in 1..=self.element_count() {
            let element = at.element();
            let mut others = (0..self.run(element).faces.len())
                .map(|f| FaceId::new(element, f))
                .filter(|&f| f != at && edge.iter().all(|&n| self.face_material(f).any(|m| m == n)));
            let (Some(other), None) = (others.next(), others.next()) else { return None };
            match self.mate(other) {
                mate if mate.is_none() => return Some((other, length)),
                mate => at = mate,
            }
        }
        None
    }
}
