//! Contact of the bodies' surface with a sphere or a capsule, by penalty.
//!
//! ```text
//! surface triangles ── R*-tree of their boxes ──► those near the tool ──► closest point on each to the tool's axis
//!   ──► one contact per corner, edge or face ──► force along the line between the closest points
//! ```
//!
//! Contacts are found anew at the start of every step and linearised there; the normal stays during the step. What is not
//! here: contact of bodies with each other.

use super::controls::Tool;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

type Point = [f64; 3];

/// A contact of the tool with the surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Nodes with weights that add up to 1.
    pub(crate) nodes: Vec<(u32, f64)>,
    /// Unit vector from the tool to the surface.
    pub(crate) normal: Point,
    /// How deep the surface is inside the tool in m, positive.
    pub(crate) depth: f64,
}

/// Contacts of a tool with triangles at these positions; triangles name nodes.
pub(crate) fn contacts(tool: &Tool, triangles: &[[u32; 3]], positions: &dyn Fn(u32) -> Point) -> Vec<Contact> {
    let boxes = triangles.iter().enumerate().map(|(t, triangle)| {
        let corners = triangle.map(positions);
        GeomWithData::new(Rectangle::from_aabb(AABB::from_points(&corners)), t)
    });
    let tree = RTree::bulk_load(boxes.collect());
    let reach = |sign: f64| -> Point {
        std::array::from_fn(|k| {
            let (a, b) = (tool.ends[0][k], tool.ends[1][k]);
            if sign < 0.0 { a.min(b) - tool.radius } else { a.max(b) + tool.radius }
        })
    };
    let around = AABB::from_corners(reach(-1.0), reach(1.0));
    let mut near: Vec<usize> = tree.locate_in_envelope_intersecting(around).map(|found| found.data).collect();
    // The tree's own order depends on how it was built.
    near.sort_unstable();
    let mut seen: Vec<Vec<u32>> = Vec::new();
    let mut contacts = Vec::new();
    for t in near {
        let corners = triangles[t].map(positions);
        let (weights, axis) = closest(tool.ends, corners);
        let point = combined(weights, corners);
        let arm = minus(point, axis);
        let distance = dot(arm, arm).sqrt();
        // A surface that passes through the axis itself has no side to be pushed to.
        if distance >= tool.radius || distance < 1e-9 * tool.radius {
            continue;
        }
        // Corners and edges are shared by triangles: each gives one contact.
        let mut feature: Vec<u32> =
            triangles[t].iter().zip(weights).filter(|(_, w)| *w > 1e-9).map(|(&n, _)| n).collect();
        feature.sort_unstable();
        if seen.contains(&feature) {
            continue;
        }
        seen.push(feature);
        let nodes = triangles[t].iter().copied().zip(weights).filter(|(_, w)| *w > 1e-9).collect();
        contacts.push(Contact { nodes, normal: arm.map(|x| x / distance), depth: tool.radius - distance });
    }
    contacts
}

/// Force in N along the normal and its slope with the depth in N/m, at a depth in m and its rate in m/s.
pub(crate) fn hunt_crossley(tool: &Tool, depth: f64, rate: f64) -> (f64, f64) {
    // Beyond twice the elastic force the linear damping term is not meant to be used; below zero it would pull.
    let factor = (1.0 + 1.5 * tool.damping * rate).clamp(0.0, 2.0);
    let root = depth.sqrt();
    (tool.stiffness * depth * root * factor, 1.5 * tool.stiffness * root * factor)
}

/// The weights of the point of a triangle that is closest to a segment, and the closest point of the segment.
fn closest(ends: [Point; 2], corners: [Point; 3]) -> ([f64; 3], Point) {
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0], ends[0]);
    let mut offer = |weights: [f64; 3], axis: Point| {
        let arm = minus(combined(weights, corners), axis);
        let square = dot(arm, arm);
        if square < best.0 {
            best = (square, weights, axis);
        }
    };
    // The closest pair has an end of the segment, or a point of the triangle's rim, unless they meet.
    for end in ends {
        offer(closest_in_triangle(end, corners), end);
    }
    if ends[0] != ends[1] {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let (s, t) = closest_of_segments([corners[a], corners[b]], ends);
            let mut weights = [0.0; 3];
            (weights[a], weights[b]) = (1.0 - s, s);
            offer(weights, along(ends, t));
        }
    }
    (best.1, best.2)
}

/// Weights of the point of a triangle that is closest to a point (C. Ericson, Real-Time Collision Detection, 5.1.5).
fn closest_in_triangle(p: Point, [a, b, c]: [Point; 3]) -> [f64; 3] {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let side = |q: Point| (dot(ab, minus(p, q)), dot(ac, minus(p, q)));
    let (d1, d2) = side(a);
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let (d3, d4) = side(b);
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return [1.0 - v, v, 0.0];
    }
    let (d5, d6) = side(c);
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return [1.0 - w, 0.0, w];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - w, w];
    }
    let sum = va + vb + vc;
    [va / sum, vb / sum, vc / sum]
}

/// Parameters from 0 to 1 of the closest points of two segments (the same book, 5.1.9).
fn closest_of_segments(p: [Point; 2], q: [Point; 2]) -> (f64, f64) {
    let (d1, d2, r) = (minus(p[1], p[0]), minus(q[1], q[0]), minus(p[0], q[0]));
    let (a, e, f) = (dot(d1, d1), dot(d2, d2), dot(d2, r));
    if a <= 0.0 {
        return (0.0, (f / e).clamp(0.0, 1.0));
    }
    let c = dot(d1, r);
    let b = dot(d1, d2);
    let area = a * e - b * b;
    let s = if area > 0.0 { ((b * f - c * e) / area).clamp(0.0, 1.0) } else { 0.0 };
    let t = (b * s + f) / e;
    if t < 0.0 {
        ((-c / a).clamp(0.0, 1.0), 0.0)
    } else if t > 1.0 {
        (((b - c) / a).clamp(0.0, 1.0), 1.0)
    } else {
        (s, t)
    }
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn along(ends: [Point; 2], t: f64) -> Point {
    std::array::from_fn(|k| ends[0][k] + t * (ends[1][k] - ends[0][k]))
}

fn combined(weights: [f64; 3], corners: [Point; 3]) -> Point {
    std::array::from_fn(|k| (0..3).map(|n| weights[n] * corners[n][k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

    fn tool(ends: [Point; 2], radius: f64) -> Tool {
        Tool { ends, velocity: [0.0; 3], radius, stiffness: 1e3, damping: 0.5 }
    }

    fn touched(tool: &Tool) -> Vec<Contact> {
        contacts(tool, &[[0, 1, 2], [0, 2, 3]], &|n| SQUARE[n as usize])
    }

    /// A sphere above the middle of a triangle touches it once, at the foot of its centre, as deep as it reaches below.
    #[test]
    fn a_sphere_touches_below_its_centre() {
        let centre = [0.7, 0.2, 0.08];
        let found = touched(&tool([centre; 2], 0.1));
        assert_eq!(found.len(), 1);
        assert!((found[0].depth - 0.02).abs() < 1e-12 && found[0].normal == [0.0, 0.0, -1.0]);
        let foot: Point = std::array::from_fn(|k| found[0].nodes.iter().map(|&(n, w)| w * SQUARE[n as usize][k]).sum());
        assert!((foot[0] - 0.7).abs() < 1e-12 && (foot[1] - 0.2).abs() < 1e-12);
    }

    /// Over the edge that two triangles share there is one contact, not two, and far away none.
    #[test]
    fn shared_edges_count_once() {
        assert_eq!(touched(&tool([[0.5, 0.5, 0.05]; 2], 0.1)).len(), 1);
        assert_eq!(touched(&tool([[0.5, 0.5, 0.5]; 2], 0.1)).len(), 0);
    }

    /// A capsule's depth is measured from its axis: nowhere on the triangle is a point deeper than what is found.
    #[test]
    fn a_capsule_touches_where_it_is_deepest() {
        let ends = [[-0.3, 0.25, 0.2], [0.8, 0.15, 0.02]];
        let tool = tool(ends, 0.15);
        let deepest = touched(&tool).iter().map(|c| c.depth).fold(0.0, f64::max);
        let mut sampled: f64 = 0.0;
        for i in 0..=100 {
            for j in 0..=100 {
                for k in 0..=50 {
                    let p = [f64::from(i) / 100.0, f64::from(j) / 100.0, 0.0];
                    let arm = minus(p, along(ends, f64::from(k) / 50.0));
                    sampled = sampled.max(tool.radius - dot(arm, arm).sqrt());
                }
            }
        }
        assert!(deepest >= sampled - 1e-9 && deepest < sampled + 2e-3, "{deepest} {sampled}");
    }

    /// The force grows with the depth as Hertz says, is larger on the way in than on the way out, and never pulls.
    #[test]
    fn contact_forces_push() {
        let tool = tool([[0.0; 3]; 2], 0.1);
        let at = |depth: f64, rate: f64| hunt_crossley(&tool, depth, rate).0;
        assert!((at(0.04, 0.0) / at(0.01, 0.0) - 8.0).abs() < 1e-12);
        assert!(at(0.01, 0.1) > at(0.01, 0.0) && at(0.01, -0.1) < at(0.01, 0.0));
        assert!(at(0.01, -1e6) >= 0.0);
        let h = 1e-7;
        let slope = (at(0.01 + h, 0.0) - at(0.01 - h, 0.0)) / (2.0 * h);
        assert!((slope / hunt_crossley(&tool, 0.01, 0.0).1 - 1.0).abs() < 1e-6);
    }
}
