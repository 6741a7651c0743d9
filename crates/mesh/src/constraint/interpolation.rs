//! Edges and faces with the same corners and different interpolations: the nodes that only the richer side has follow
//! the poorer one.
//!
//! ```text
//! edge3 on edge2:  u_m = ½ (u_a + u_b)          quad9 on quad8:  u_m = Σ_a N_a(0, 0) u_a
//! ```
//!
//! Two elements that share an edge and no face count as well: whatever shares the edge must agree on it.

use super::side::Shapes;
use super::{Cause, Constraint, Rows};
use crate::mesh::Mesh;
use crate::reference::{corner_weights, side_element};
use crate::topology::{Topology, corner_set};
use souple_elements::{Element, Side};

/// A side of an element, ordered by its corners, then from the poorest interpolation to the richest.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    corners: [u32; 4],
    /// Degree and number of nodes of the interpolation.
    rank: (u32, usize),
    element: u32,
    /// Edges first, then faces.
    side: u32,
}

/// Degree first, then number of nodes: what a richer interpolation has more of.
pub(super) fn rank(element: &Element) -> (u32, usize) {
    (element.degree, element.node_count())
}

/// The sides on which elements must agree: edges, and the faces of solids.
fn sides(element: &'static Element) -> impl Iterator<Item = &'static Side> {
    element.edges.iter().chain(if element.dimension() == 3 { element.faces } else { &[] })
}

/// Adds a row for each node that only the richer side has; the number of sides that they are tied to.
pub(super) fn find(mesh: &Mesh, topology: &Topology, shapes: &mut Shapes, rows: &mut Rows) -> usize {
    // Most meshes have one interpolation for each family of sides and need no search.
    let mut kinds: Vec<&'static Element> =
        topology.runs.iter().filter(|r| r.count > 0).flat_map(|r| sides(r.element)).map(side_element).collect();
    kinds.sort_by_key(|e| (e.family, e.id));
    kinds.dedup_by_key(|e| e.id);
    let mixed = |element: &Element| kinds.iter().filter(|e| e.family == element.family).count() > 1;

    let mut places: Vec<Place> = Vec::new();
    for run in &topology.runs {
        for (side, number) in sides(run.element).zip(0u32..) {
            let lower = side_element(side);
            if !mixed(lower) {
                continue;
            }
            for index in 0..run.count {
                let nodes = mesh.blocks[run.block as usize].nodes(index as usize);
                let corners = side.nodes[..lower.family.corner_count()].iter().map(|&n| nodes[n as usize]);
                places.push(Place {
                    corners: corner_set(corners),
                    rank: rank(lower),
                    element: run.first + index,
                    side: number,
                });
            }
        }
    }
    places.sort_unstable();
    let mut tied_to = 0;
    let side_of = |place: &Place| -> (&'static Element, Vec<u32>) {
        let id = topology.id(place.element);
        let element = topology.run(place.element).element;
        let side = sides(element).nth(place.side as usize).expect("the place was made from this side");
        (side_element(side), side.nodes.iter().map(|&n| mesh.nodes_of(id)[n as usize]).collect())
    };
    // Edges come before faces: on a face the nodes of its edges are then already tied.
    let edges = places.chunk_by(|a, b| a.corners == b.corners);
    let (edges, faces): (Vec<&[Place]>, Vec<&[Place]>) = edges.partition(|group| group[0].corners[2] == u32::MAX);
    for group in edges.into_iter().chain(faces).filter(|group| group[0].rank != group[group.len() - 1].rank) {
        let (poorer, masters) = side_of(&group[0]);
        let before = rows.len();
        for place in group.iter().filter(|place| place.rank != group[0].rank) {
            let (richer, nodes) = side_of(place);
            let corner_count = richer.family.corner_count();
            for (local, &node) in nodes.iter().enumerate().skip(corner_count) {
                if masters.contains(&node) || rows.contains_key(&node) {
                    continue;
                }
                let xi = carried_over(richer, &nodes, local, poorer, &masters);
                let masters = shapes.of(poorer).masters(&masters, xi);
                rows.insert(node, Constraint { node, masters, cause: Cause::Interpolation });
            }
        }
        tied_to += usize::from(rows.len() > before);
    }
    tied_to
}

/// The reference point, on another side with the same corners in another order, of a node of a side.
fn carried_over(from: &Element, from_nodes: &[u32], local: usize, to: &Element, to_nodes: &[u32]) -> [f64; 3] {
    let weights = corner_weights(from.family, from.nodes[local]);
    let mut xi = [0.0; 3];
    for (corner, weight) in from_nodes.iter().zip(weights) {
        let at = to_nodes.iter().position(|n| n == corner).expect("both sides have the same corners");
        (0..3).for_each(|a| xi[a] += weight * to.nodes[at][a]);
    }
    xi
}
