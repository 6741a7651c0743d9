//! Faces and edges: lower elements on the parent's nodes, turned outwards, with the lower element's interpolation.
//!
//! The restriction of the parent to a side is the side's own interpolation: that is what makes elements of different
//! families fit, a hexahedron's face and a pyramid's base being the same quadrangle.

use crate::evaluation::{Interpolation, Point, centroid, combine, cross, dot, fine_rule};
use souple_elements::{Element, Side, all, by_id};
use std::collections::BTreeMap;

fn lower(side: &Side) -> &'static Element {
    by_id(side.element).unwrap_or_else(|| panic!("no element is called {}", side.element))
}

/// The parent's reference positions of the side's nodes.
fn positions(parent: &Element, side: &Side) -> Vec<Point> {
    side.nodes.iter().map(|&n| parent.nodes[usize::from(n)]).collect()
}

fn all_sides() -> impl Iterator<Item = (&'static Element, &'static Side)> {
    all().iter().flat_map(|e| e.faces.iter().chain(e.edges).map(move |side| (*e, side)))
}

/// A side names an element of the right dimension, as many distinct nodes as it has, and its corners are corners.
#[test]
fn sides_are_lower_elements() {
    for element in all() {
        for (sides, dimension) in [(element.faces, element.dimension() - 1), (element.edges, 1)] {
            for side in sides {
                let lower = lower(side);
                assert_eq!(lower.dimension(), dimension, "{}: {side:?}", element.id);
                assert_eq!(lower.node_count(), side.nodes.len(), "{}: {side:?}", element.id);
                assert_eq!(lower.degree, element.degree, "{}: {side:?}", element.id);
                for (at, node) in side.nodes.iter().enumerate() {
                    assert!(usize::from(*node) < element.node_count(), "{}: {side:?}", element.id);
                    assert!(!side.nodes[..at].contains(node), "{}: {side:?} repeats a node", element.id);
                    let is_corner = usize::from(*node) < element.family.corner_count();
                    assert_eq!(is_corner, at < lower.family.corner_count(), "{}: {side:?}", element.id);
                }
            }
        }
        let expected = element.dimension() > 1;
        assert_eq!(!element.faces.is_empty(), expected, "{}", element.id);
        assert_eq!(!element.edges.is_empty(), expected, "{}", element.id);
    }
}

/// On a side the parent's shape functions are the lower element's, and those of all other nodes vanish; likewise the
/// reference position is the one that the lower element interpolates.
#[test]
fn parent_restricted_to_a_side_is_the_lower_element() {
    for (parent, side) in all_sides() {
        let (whole, part) = (Interpolation::of(parent), Interpolation::of(lower(side)));
        let corners = positions(parent, side);
        for (point, _) in fine_rule(lower(side).family).into_iter().step_by(37) {
            let expected = part.values(point);
            let found = whole.values(combine(&expected, &corners));
            for (node, value) in found.iter().enumerate() {
                let at = side.nodes.iter().position(|&n| usize::from(n) == node);
                let wanted = at.map_or(0.0, |at| expected[at]);
                let error = (value - wanted).abs();
                assert!(error < 1e-13, "{} on {side:?}: N_{node} is {value}, not {wanted}", parent.id);
            }
        }
    }
}

/// Faces look outwards: the normal of the lower element points away from the parent's centre.
#[test]
fn faces_look_outwards() {
    for parent in all() {
        let centre = centroid(&parent.nodes[..parent.family.corner_count()]);
        for side in parent.faces {
            let part = Interpolation::of(lower(side));
            let x = positions(parent, side);
            for (point, _) in fine_rule(lower(side).family).into_iter().step_by(37) {
                let position = combine(&part.values(point), &x);
                let away = [0, 1, 2].map(|axis| position[axis] - centre[axis]);
                let outwards = dot(normal(&part, point, &x), away);
                assert!(outwards > 0.1, "{}: {side:?} looks inwards ({outwards})", parent.id);
            }
        }
    }
}

/// Normal of a side, with the measure as its length: x_s × x_t for a face, the tangent turned right for an edge in 2D.
pub(crate) fn normal(side: &Interpolation, point: Point, positions: &[Point]) -> Point {
    let gradients = side.gradients(point);
    let along = |axis: usize| {
        let weights: Vec<f64> = gradients.iter().map(|g| g[axis]).collect();
        combine(&weights, positions)
    };
    let (s, t) = (along(0), along(1));
    if t == [0.0; 3] { [s[1], -s[0], 0.0] } else { cross(s, t) }
}

/// The faces close the cell: every edge of a solid belongs to exactly two of its faces, which run along it in opposite
/// directions and share its inner nodes; the listed edges are exactly these.
#[test]
fn faces_close_the_cell() {
    for parent in all().iter().filter(|e| e.dimension() == 3) {
        let mut runs: BTreeMap<[u8; 2], Vec<u8>> = BTreeMap::new();
        for face in parent.faces {
            for edge in lower(face).edges {
                let nodes: Vec<u8> = edge.nodes.iter().map(|&n| face.nodes[usize::from(n)]).collect();
                let twice = runs.insert([nodes[0], nodes[1]], nodes[2..].to_vec());
                assert!(twice.is_none(), "{}: two faces run along {nodes:?} in the same direction", parent.id);
            }
        }
        for (&[a, b], inner) in &runs {
            let back = runs.get(&[b, a]).unwrap_or_else(|| panic!("{}: edge {a}-{b} has one face only", parent.id));
            assert!(inner.iter().eq(back.iter().rev()), "{}: faces disagree on edge {a}-{b}", parent.id);
        }
        assert_eq!(parent.edges.len() * 2, runs.len(), "{}", parent.id);
        for edge in parent.edges {
            let found = runs.get(&[edge.nodes[0], edge.nodes[1]]);
            assert_eq!(found.map(Vec::as_slice), Some(&edge.nodes[2..]), "{}: {edge:?}", parent.id);
        }
    }
}
