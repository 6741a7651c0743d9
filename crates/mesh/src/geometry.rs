//! Vectors, boxes and tolerances of points in space.
//!
//! Three components in metres, also for flat meshes, whose last components are equal.

use crate::mesh::Mesh;

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn scaled(a: [f64; 3], s: f64) -> [f64; 3] {
    a.map(|x| x * s)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a · (b × c).
pub(crate) fn triple(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    dot(a, cross(b, c))
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// An axis-parallel box in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Lower corner.
    pub min: [f64; 3],
    /// Upper corner.
    pub max: [f64; 3],
}

impl BoundingBox {
    /// The smallest box around these points; `None` when there is none. Coordinates that are not numbers are ignored.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> Option<BoundingBox> {
        points.into_iter().fold(None, |bounds, p| {
            let b = bounds.unwrap_or(BoundingBox { min: *p, max: *p });
            Some(BoundingBox {
                min: std::array::from_fn(|a| b.min[a].min(p[a])),
                max: std::array::from_fn(|a| b.max[a].max(p[a])),
            })
        })
    }

    /// Lengths along the axes.
    pub fn extent(&self) -> [f64; 3] {
        minus(self.max, self.min)
    }

    /// Length of the diagonal: the size that tolerances are relative to.
    pub fn diagonal(&self) -> f64 {
        norm(self.extent())
    }
}

impl std::fmt::Display for BoundingBox {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [a, b, c] = self.min;
        let [x, y, z] = self.max;
        write!(f, "[{a}, {b}, {c}] to [{x}, {y}, {z}]")
    }
}

/// Two positions of a mesh closer than this are the same place: 10⁻⁹ of the diagonal of its bounding box.
///
/// Coordinates in files carry 6 to 17 digits and sums of a few of them lose one or two; nothing that a person would
/// call a feature of a body is nine orders of magnitude smaller than it.
pub fn tolerance(mesh: &Mesh) -> f64 {
    BoundingBox::around(&mesh.nodes).map_or(0.0, |b| 1e-9 * b.diagonal())
}
