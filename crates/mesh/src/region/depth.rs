//! Distance to a surface: a tree of boxes over its triangles (or segments, for the outline of a flat mesh).
//!
//! The tree halves the primitives by their centres along the longest axis of the centres, down to four; a query
//! descends into the nearer child first and skips boxes that are farther than the best distance so far.
//! Quadrangles count as their two triangles on the diagonal 0–2; nodes that are not corners are not looked at.

use crate::geometry::{BoundingBox, cross, dot, minus, norm, plus, scaled};
use crate::mesh::Mesh;

const LEAF: usize = 4;
/// Halving a number of primitives that fits in memory ends before this.
const DEEPEST: usize = 64;

/// The distance of points to a surface.
#[derive(Clone, Debug)]
pub struct SurfaceDistance {
    primitives: Vec<Primitive>,
    tree: Vec<Branch>,
}

/// A triangle, or a segment when the last two corners are equal.
type Primitive = [[f64; 3]; 3];

#[derive(Clone, Debug)]
struct Branch {
    bounds: BoundingBox,
    /// Primitives below this branch.
    first: usize,
    count: usize,
    /// The second child; the first one follows its parent. 0 for a leaf.
    second: usize,
}

impl SurfaceDistance {
    /// Takes the elements of dimension 1 and 2 of a mesh.
    pub fn new(surface: &Mesh) -> SurfaceDistance {
        let mut primitives: Vec<Primitive> = Vec::new();
        for block in &surface.blocks {
            let corner_count = block.element.family.corner_count();
            for e in 0..block.len() {
                let c: Vec<[f64; 3]> =
                    block.nodes(e)[..corner_count].iter().map(|&n| surface.nodes[n as usize]).collect();
                match (block.element.dimension(), c.as_slice()) {
                    (1, &[a, b]) => primitives.push([a, b, b]),
                    (2, &[a, b, c]) => primitives.push([a, b, c]),
                    (2, &[a, b, c, d]) => primitives.extend([[a, b, c], [a, c, d]]),
                    _ => {}
                }
            }
        }
        let mut tree = Vec::new();
        if !primitives.is_empty() {
            let count = primitives.len();
            grow(&mut tree, &mut primitives, 0, count);
        }
        SurfaceDistance { primitives, tree }
    }

    /// Distance in metres; infinite when the surface is empty.
    pub fn distance(&self, point: [f64; 3]) -> f64 {
        self.search(point, f64::INFINITY, 0.0)
    }

    /// Whether the distance is at most `depth`.
    pub fn within(&self, point: [f64; 3], depth: f64) -> bool {
        self.search(point, depth.next_up(), depth) <= depth
    }

    /// The distance, or any value found that is at most `enough`; `limit` when nothing is nearer than that.
    fn search(&self, point: [f64; 3], limit: f64, enough: f64) -> f64 {
        // Each level of the tree leaves at most one branch open beside the one descended into.
        let mut open = [0; DEEPEST + 1];
        let mut waiting = usize::from(!self.tree.is_empty());
        let mut best = limit;
        while waiting > 0 && best > enough {
            waiting -= 1;
            let at = open[waiting];
            let branch = &self.tree[at];
            if distance_to_box(point, &branch.bounds) >= best {
                continue;
            }
            if branch.second == 0 {
                for primitive in &self.primitives[branch.first..branch.first + branch.count] {
                    best = best.min(distance_to(point, primitive));
                }
                continue;
            }
            let (a, b) = (at + 1, branch.second);
            let [to_a, to_b] = [a, b].map(|child| distance_to_box(point, &self.tree[child].bounds));
            let (near, far) = if to_a <= to_b { (a, b) } else { (b, a) };
            open[waiting..waiting + 2].copy_from_slice(&[far, near]);
            waiting += 2;
        }
        best
    }
}

fn grow(tree: &mut Vec<Branch>, primitives: &mut [Primitive], first: usize, count: usize) {
    let below = &mut primitives[first..first + count];
    let bounds = BoundingBox::around(below.iter().flatten()).expect("a branch holds a primitive");
    let at = tree.len();
    tree.push(Branch { bounds, first, count, second: 0 });
    if count <= LEAF {
        return;
    }
    let centre = |p: &Primitive| scaled(plus(plus(p[0], p[1]), p[2]), 1.0 / 3.0);
    let centres: Vec<[f64; 3]> = below.iter().map(centre).collect();
    let extent = BoundingBox::around(&centres).expect("a branch holds a primitive").extent();
    let axis = (0..3).reduce(|a, b| if extent[b] > extent[a] { b } else { a }).expect("there are three axes");
    below.sort_by(|p, q| centre(p)[axis].total_cmp(&centre(q)[axis]));
    let half = count / 2;
    grow(tree, primitives, first, half);
    tree[at].second = tree.len();
    grow(tree, primitives, first + half, count - half);
}

fn distance_to_box(p: [f64; 3], bounds: &BoundingBox) -> f64 {
    norm(std::array::from_fn(|a| (bounds.min[a] - p[a]).max(p[a] - bounds.max[a]).max(0.0)))
}

/// Distance of a point to a triangle: to its plane where the foot lies inside, else to the nearest edge.
fn distance_to(p: [f64; 3], &[a, b, c]: &Primitive) -> f64 {
    let normal = cross(minus(b, a), minus(c, a));
    let area = norm(normal);
    let inside = |from: [f64; 3], to: [f64; 3]| dot(cross(minus(to, from), minus(p, from)), normal) >= 0.0;
    if area > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        return (dot(minus(p, a), normal) / area).abs();
    }
    [(a, b), (b, c), (c, a)]
        .into_iter()
        .map(|(from, to)| distance_to_segment(p, from, to))
        .fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let along = minus(b, a);
    let square = dot(along, along);
    let t = if square > 0.0 { (dot(minus(p, a), along) / square).clamp(0.0, 1.0) } else { 0.0 };
    norm(minus(p, plus(a, scaled(along, t))))
}
