//! Nodes in the middle of a face of the boundary that is not theirs: a fine side on a coarse one.
//!
//! Around an edge or a face at which nodes hang, some face has no mate. So it is enough to look at the nodes of faces
//! without mate and, for each, at such faces of other elements that it lies on.
//!
//! Coarse faces come first: a node of the coarse side that lies on a fine face whose nodes follow the coarse side would
//! follow itself, and stays free. Where the two sides do not nest (3 cells against 2) the fine nodes follow, and the
//! coarse side is free.

use super::interpolation::rank;
use super::near::{grown, inside};
use super::side::{Shapes, size};
use super::{Cause, Constraint, Rows};
use crate::geometry::{BoundingBox, cross, dot, minus, norm, plus, scaled};
use crate::mesh::Mesh;
use crate::reference::side_element;
use crate::topology::{FaceId, Topology};
use souple_elements::{Element, Family, all};

/// A node lies on a face when it is nearer than this times the face's size: coordinates in files have six digits, and
/// a face may be a hundredth of the body.
const TOLERANCE: f64 = 1e-4;

/// Part of a face that must be covered before the face counts as inside the body.
const COVERED: f64 = 0.95;

/// A face without mate.
struct Face {
    id: FaceId,
    element: &'static Element,
    nodes: Vec<u32>,
    positions: Vec<[f64; 3]>,
    size: f64,
    /// Mean of its corners, and the unit normal of the plane (direction of the line) through them.
    centre: [f64; 3],
    axis: [f64; 3],
    /// How far from that plane (line) a point of the face may be.
    thickness: f64,
}

impl Face {
    fn new(id: FaceId, element: &'static Element, nodes: Vec<u32>, positions: Vec<[f64; 3]>) -> Face {
        let corners = &positions[..element.family.corner_count()];
        let mean = corners.iter().fold([0.0; 3], |sum, &p| plus(sum, p));
        let across = match *corners {
            [a, b] => minus(b, a),
            [a, b, c] => cross(minus(b, a), minus(c, a)),
            [a, b, c, d] => cross(minus(c, a), minus(d, b)),
            _ => [0.0; 3],
        };
        let length = norm(across);
        let axis = if length > 0.0 { scaled(across, 1.0 / length) } else { [0.0; 3] };
        let size = size(&positions);
        let centre = scaled(mean, 1.0 / corners.len() as f64);
        let mut face = Face { id, element, nodes, positions, size, centre, axis, thickness: 0.0 };
        // Between its nodes a side of low degree bulges out less than once more.
        let most = face.positions.iter().map(|&p| face.off(p)).fold(0.0, f64::max);
        face.thickness = 2.0 * most + TOLERANCE * size;
        face
    }

    /// Distance of a point from the plane (line) through the corners.
    fn off(&self, point: [f64; 3]) -> f64 {
        let arm = minus(point, self.centre);
        let along = dot(arm, self.axis);
        if self.element.dimension() == 1 { norm(minus(arm, scaled(self.axis, along))) } else { along.abs() }
    }
}

/// A node on a face that is not its own.
struct Hit {
    node: u32,
    face: u32,
    xi: [f64; 3],
}

/// What was found besides the rows.
#[derive(Default)]
pub(super) struct Found {
    /// Number of faces that nodes are tied to.
    pub(super) sides: usize,
    /// Number of faces that other elements lie on without being able to follow them between their nodes.
    pub(super) rough: usize,
    /// Faces inside the body, sorted.
    pub(super) inner: Vec<FaceId>,
}

/// Adds the rows of hanging nodes.
pub(super) fn find(mesh: &Mesh, topology: &Topology, shapes: &mut Shapes, rows: &mut Rows) -> Found {
    let mut found = Found::default();
    if topology.dimension < 2 {
        return found;
    }
    let faces = unmatched(mesh, topology);
    let hits = hits(mesh, topology, &faces, shapes);
    for (face, covers) in faces.iter().zip(&covers(&faces, &hits)) {
        let covering = || covers.iter().map(|&f| &faces[f as usize]);
        found.inner.extend(covering().map(|f| f.id));
        if covering().map(area).sum::<f64>() >= COVERED * area(face) {
            found.inner.push(face.id);
        }
        if let Some(poorest) = covering().map(|f| f.element).min_by_key(|e| rank(e)) {
            let left = reduce(face, poorest, shapes, rows);
            found.rough += usize::from(!covering().all(|f| can_follow(f.element, left)));
        }
    }
    found.inner.sort_unstable();
    found.inner.dedup();
    found.sides = tie_down(&faces, hits, shapes, rows);
    found
}

fn unmatched(mesh: &Mesh, topology: &Topology) -> Vec<Face> {
    let face = |id: FaceId| {
        let of_element = mesh.nodes_of(topology.id(id.element()));
        let side = &topology.run(id.element()).element.faces[id.face()];
        let nodes: Vec<u32> = side.nodes.iter().map(|&n| of_element[n as usize]).collect();
        let positions: Vec<[f64; 3]> = nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
        Face::new(id, side_element(side), nodes, positions)
    };
    topology.boundary().into_iter().map(face).collect()
}

/// All nodes on faces of other elements, ordered by face, then by node.
fn hits(mesh: &Mesh, topology: &Topology, faces: &[Face], shapes: &mut Shapes) -> Vec<Hit> {
    let mut nodes: Vec<u32> = faces.iter().flat_map(|f| f.nodes.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let points: Vec<[f64; 3]> = nodes.iter().map(|&n| mesh.nodes[n as usize]).collect();
    let around = |f: &Face| {
        let b = BoundingBox::around(&f.positions).expect("a face has nodes");
        // A curved face bulges out of the box around its nodes.
        grown(b, f.thickness)
    };
    let boxes: Vec<BoundingBox> = faces.iter().map(around).collect();
    let mut hits = Vec::new();
    for (number, point) in inside(&points, &boxes) {
        let (face, node, position) = (&faces[number as usize], nodes[point as usize], points[point as usize]);
        let near = TOLERANCE * face.size;
        if face.off(position) > face.thickness
            || mesh.nodes_of(topology.id(face.id.element())).contains(&node)
            || face.positions.iter().any(|&p| norm(minus(p, position)) <= near)
        {
            continue;
        }
        if let Some(foot) = shapes.of(face.element).foot(&face.positions, position)
            && foot.distance <= near
        {
            hits.push(Hit { node, face: number, xi: foot.xi });
        }
    }
    hits
}

/// For each face, the faces of other elements all of whose nodes lie on it, ascending.
fn covers(faces: &[Face], hits: &[Hit]) -> Vec<Vec<u32>> {
    let mut faces_of: Vec<(u32, u32)> =
        faces.iter().zip(0u32..).flat_map(|(face, f)| face.nodes.iter().map(move |&n| (n, f))).collect();
    faces_of.sort_unstable();
    let mut covers = vec![Vec::new(); faces.len()];
    for (number, face) in faces.iter().enumerate() {
        let first = hits.partition_point(|hit| (hit.face as usize) < number);
        let group = hits[first..].iter().take_while(|hit| hit.face as usize == number);
        let mut on: Vec<u32> = face.nodes.iter().copied().chain(group.map(|hit| hit.node)).collect();
        // With its corners alone a face is covered by nothing smaller than halves of itself (`topology::interfaces`).
        if on.len() == face.element.family.corner_count() {
            continue;
        }
        on.sort_unstable();
        let mut found: Vec<u32> = Vec::new();
        for &node in &on {
            let from = faces_of.partition_point(|entry| entry.0 < node);
            found.extend(faces_of[from..].iter().take_while(|entry| entry.0 == node).map(|entry| entry.1));
        }
        found.sort_unstable();
        found.dedup();
        found.retain(|&f| {
            let other = &faces[f as usize];
            other.id.element() != face.id.element() && other.nodes.iter().all(|n| on.binary_search(n).is_ok())
        });
        covers[number] = found;
    }
    covers
}

/// Area of a face between its corners, or length of an edge.
fn area(face: &Face) -> f64 {
    let corners = &face.positions[..face.element.family.corner_count()];
    let triangle = |a, b, c| 0.5 * norm(cross(minus(b, a), minus(c, a)));
    match *corners {
        [a, b] => norm(minus(b, a)),
        [a, b, c] => triangle(a, b, c),
        [a, b, c, d] => {
            let middle = scaled(plus(plus(a, b), plus(c, d)), 0.25);
            [(a, b), (b, c), (c, d), (d, a)].into_iter().map(|(p, q)| triangle(p, q, middle)).sum()
        }
        _ => 0.0,
    }
}

/// Takes from a coarse face what the fine faces on it cannot represent: where linear sides lie on a quadratic one, its
/// own extra nodes follow its corners as well. Returns the interpolation that is left: the face's own where no element
/// of the registry is that much poorer.
fn reduce(face: &Face, fine: &'static Element, shapes: &mut Shapes, rows: &mut Rows) -> &'static Element {
    let own = face.element;
    if can_follow(fine, own) {
        return own;
    }
    let local = |at: [f64; 3]| own.nodes.iter().position(|&n| norm(minus(n, at)) < 1e-9);
    let poorer = |e: &&Element| {
        e.family == own.family
            && rank(e) < rank(own)
            && e.degree == own.degree.min(fine.degree)
            && (e.family != fine.family || can_follow(fine, e))
            && e.nodes.iter().all(|&at| local(at).is_some())
    };
    let Some(left) = all().iter().copied().filter(poorer).max_by_key(|e| e.node_count()) else { return own };
    let kept: Vec<usize> = left.nodes.iter().filter_map(|&at| local(at)).collect();
    let masters: Vec<u32> = kept.iter().map(|&k| face.nodes[k]).collect();
    for (k, &node) in face.nodes.iter().enumerate() {
        if !kept.contains(&k) && !rows.contains_key(&node) {
            let masters = shapes.of(left).masters(&masters, own.nodes[k]);
            rows.insert(node, Constraint { node, masters, cause: Cause::Interpolation });
        }
    }
    left
}

/// Whether a fine side on part of a coarse one can represent every function of the coarse one there.
///
/// Within a family, more nodes of no lower degree contain fewer. A triangle on a quadrangle must contain its highest
/// product: ξη of four nodes, ξ²η of eight, ξ²η² of nine.
fn can_follow(fine: &Element, coarse: &Element) -> bool {
    if fine.family == coarse.family {
        return rank(fine) >= rank(coarse);
    }
    let tensor = coarse.node_count() as u32 == (coarse.degree + 1).pow(2);
    let highest = match coarse.family {
        Family::Quadrangle if tensor => 2 * coarse.degree,
        Family::Quadrangle => coarse.degree + 1,
        _ => coarse.degree,
    };
    fine.degree >= highest
}

/// Adds one row for each node that was hit and is not yet tied; the number of faces that rows refer to.
fn tie_down(faces: &[Face], hits: Vec<Hit>, shapes: &mut Shapes, rows: &mut Rows) -> usize {
    struct Candidate {
        node: u32,
        face: u32,
        masters: Vec<(u32, f64)>,
    }
    let mut candidates: Vec<Candidate> = Vec::with_capacity(hits.len());
    for hit in hits.into_iter().filter(|hit| !rows.contains_key(&hit.node)) {
        let face = &faces[hit.face as usize];
        let masters = shapes.of(face.element).masters(&face.nodes, hit.xi);
        candidates.push(Candidate { node: hit.node, face: hit.face, masters });
    }
    let size = |c: &Candidate| faces[c.face as usize].size;
    // Large faces first; of several faces with a node, one with an edge through it: that is where the others meet.
    candidates.sort_by(|a, b| {
        size(b)
            .total_cmp(&size(a))
            .then(a.masters.len().cmp(&b.masters.len()))
            .then(a.face.cmp(&b.face))
            .then(a.node.cmp(&b.node))
    });
    let mut used = Vec::new();
    for candidate in candidates {
        if rows.contains_key(&candidate.node) || follows(rows, &candidate.masters, candidate.node) {
            continue;
        }
        used.push(candidate.face);
        let Candidate { node, masters, .. } = candidate;
        rows.insert(node, Constraint { node, masters, cause: Cause::Hanging });
    }
    used.sort_unstable();
    used.dedup();
    used.len()
}

/// Whether one of these masters is this node, or follows it, directly or through others.
fn follows(rows: &Rows, masters: &[(u32, f64)], node: u32) -> bool {
    let mut open: Vec<u32> = masters.iter().map(|m| m.0).collect();
    let mut seen = Vec::new();
    while let Some(next) = open.pop() {
        if next == node {
            return true;
        }
        if let Some(row) = rows.get(&next)
            && !seen.contains(&next)
        {
            seen.push(next);
            open.extend(row.masters.iter().map(|m| m.0));
        }
    }
    false
}
