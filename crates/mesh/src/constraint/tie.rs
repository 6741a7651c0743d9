//! Nodes glued to a surface: each keeps its place on the face nearest to it in the rest shape.

use super::near::{grown, inside};
use super::side::Shapes;
use super::{Cause, Constraint};
use crate::geometry::BoundingBox;
use souple_elements::Element;

/// A face that nodes may be tied to.
#[derive(Clone, Debug)]
pub struct TieFace {
    /// Its interpolation, of dimension one or two.
    pub element: &'static Element,
    /// Its nodes.
    pub nodes: Vec<u32>,
}

/// Ties each of these nodes to the face nearest to it, if one is within this distance in m. Nodes that are farther away
/// are left out; of several faces at the same distance the first one is taken.
///
/// `positions` are the rest positions in m of all nodes, `[node][axis]`.
pub fn tie(positions: &[[f64; 3]], nodes: &[u32], faces: &[TieFace], within: f64) -> Vec<Constraint> {
    let mut shapes = Shapes::default();
    let at = |node: u32| positions[node as usize];
    let points: Vec<[f64; 3]> = nodes.iter().map(|&n| at(n)).collect();
    let corners: Vec<Vec<[f64; 3]>> = faces.iter().map(|f| f.nodes.iter().map(|&n| at(n)).collect()).collect();
    let around = |positions: &Vec<[f64; 3]>| {
        let b = BoundingBox::around(positions).expect("a face has nodes");
        // A curved face bulges out of the box around its nodes; rounding must not lose a node in the face's plane.
        grown(b, within + 0.25 * b.diagonal())
    };
    let boxes: Vec<BoundingBox> = corners.iter().map(around).collect();
    let mut best: Vec<Option<(f64, u32, [f64; 3])>> = vec![None; nodes.len()];
    for (face, point) in inside(&points, &boxes) {
        let (f, p) = (face as usize, point as usize);
        if faces[f].nodes.contains(&nodes[p]) {
            continue;
        }
        if let Some(foot) = shapes.of(faces[f].element).foot(&corners[f], points[p])
            && foot.distance <= within.max(1e-9 * boxes[f].diagonal())
            && best[p].is_none_or(|(distance, ..)| foot.distance < distance)
        {
            best[p] = Some((foot.distance, face, foot.xi));
        }
    }
    let mut tied = Vec::new();
    for (&node, best) in nodes.iter().zip(best) {
        let Some((_, face, xi)) = best else { continue };
        let face = &faces[face as usize];
        let masters = shapes.of(face.element).masters(&face.nodes, xi);
        tied.push(Constraint { node, masters, cause: Cause::Tie });
    }
    tied
}
