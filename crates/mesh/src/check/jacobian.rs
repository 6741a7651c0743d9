//! Orientation of elements: signs of det J.

use super::quality::IdealCorner;
use crate::geometry::{cross, dot, minus, norm, plus, scaled, triple};
use crate::reference::{corner_frames, edge_vectors, ideal_corners};
use souple_elements::{Element, Family};
use souple_symbols::{Graph, Time};

/// Gradients of the shape functions in reference coordinates at each point: `[point][node][axis]`.
///
/// Taken from the element's expressions by the expression graph.
pub(super) fn shape_gradients(element: &Element, points: &[[f64; 3]]) -> Vec<Vec<[f64; 3]>> {
    let mut graph = Graph::new();
    let coordinates = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Apply));
    let shape = (element.shape)(&mut graph, coordinates);
    let one = graph.int(1);
    let by_axis = coordinates.map(|coordinate| graph.directional(&shape, &[(coordinate, one)]));
    points
        .iter()
        .map(|point| {
            let values: Vec<_> = coordinates.into_iter().zip(*point).collect();
            let columns = by_axis.each_ref().map(|roots| graph.evaluate(roots, &values));
            (0..shape.len()).map(|node| columns.each_ref().map(|column| column[node])).collect()
        })
        .collect()
}

/// Columns of the Jacobian: ∂x/∂ξ_a = Σ_n x_n ∂N_n/∂ξ_a, `[axis]`.
pub(super) fn tangents(points: &[[f64; 3]], gradients: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut columns = [[0.0; 3]; 3];
    for (&point, gradient) in points.iter().zip(gradients) {
        for axis in 0..3 {
            columns[axis] = plus(columns[axis], scaled(point, gradient[axis]));
        }
    }
    columns
}

/// How an element lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    Good,
    Inverted,
    Tangled,
    Degenerate,
}

pub(super) struct Judgement {
    pub orientation: Orientation,
    /// Mean ratio; 0 unless the orientation is good.
    pub quality: f64,
}

/// A corner where as many edges meet as there are axes.
struct Corner {
    corner: u8,
    /// The corners at the far ends; the first `dimension` of them.
    far: [u8; 3],
    ideal: IdealCorner,
}

/// Judges elements of one kind.
pub(super) struct Judge {
    element: &'static Element,
    flat: bool,
    corners: Vec<Corner>,
    /// Shape gradients at corners and quadrature points, for elements with more nodes than corners.
    gradients: Vec<Vec<[f64; 3]>>,
}

/// A determinant below this fraction of the cube (square) of the longest edge at the corner is rounding.
const FLAT: f64 = 1e-12;

/// The signs of det J met so far.
#[derive(Default)]
struct Signs {
    positive: bool,
    negative: bool,
    zero: bool,
}

impl Signs {
    fn count(&mut self, vectors: &[[f64; 3]], determinant: f64) {
        let longest = vectors.iter().map(|v| norm(*v)).fold(0.0, f64::max);
        match determinant.abs() <= FLAT * longest.powi(vectors.len() as i32) {
            true => self.zero = true,
            false if determinant > 0.0 => self.positive = true,
            false => self.negative = true,
        }
    }

    fn orientation(&self) -> Orientation {
        match (self.positive, self.negative, self.zero) {
            (true, true, _) => Orientation::Tangled,
            (_, _, true) | (false, false, _) => Orientation::Degenerate,
            (false, true, _) => Orientation::Inverted,
            (true, false, _) => Orientation::Good,
        }
    }
}

impl Judge {
    pub(super) fn new(element: &'static Element, flat: bool) -> Judge {
        let ideal = ideal_corners(element.family);
        let corner = |(corner, frame): (u8, Option<Vec<u8>>)| {
            let frame = frame?;
            let mut far = [0; 3];
            far[..frame.len()].copy_from_slice(&frame);
            Some(Corner { corner, far, ideal: IdealCorner::new(&edge_vectors(&ideal, corner, &frame)) })
        };
        let corners: Vec<Corner> = (0u8..).zip(corner_frames(element)).filter_map(corner).collect();
        let curved = element.node_count() > element.family.corner_count();
        let gradients = if curved {
            // Not at the apex of a pyramid, where rational functions have no gradient.
            let at_corners = corners.iter().map(|c| element.nodes[c.corner as usize]);
            let points: Vec<[f64; 3]> = at_corners.chain(element.default_rule().points.iter().copied()).collect();
            shape_gradients(element, &points)
        } else {
            Vec::new()
        };
        Judge { element, flat, corners, gradients }
    }

    pub(super) fn judge(&self, points: &[[f64; 3]]) -> Judgement {
        let dimension = self.element.dimension();
        let up = self.up(points);
        let determinant = |v: &[[f64; 3]; 3]| match dimension {
            1 => norm(v[0]),
            2 => dot(cross(v[0], v[1]), up),
            _ => triple(v[0], v[1], v[2]),
        };
        let mut signs = Signs::default();
        let mut quality = f64::INFINITY;
        for corner in &self.corners {
            let from = points[corner.corner as usize];
            let vectors = corner.far.map(|far| minus(points[far as usize], from));
            let value = determinant(&vectors);
            signs.count(&vectors[..dimension], value);
            quality = quality.min(corner.ideal.mean_ratio(&vectors[..dimension], value));
        }
        for gradients in &self.gradients {
            let columns = tangents(points, gradients);
            signs.count(&columns[..dimension], determinant(&columns));
        }
        let orientation = signs.orientation();
        let quality = if orientation == Orientation::Good { quality } else { 0.0 };
        Judgement { orientation, quality }
    }

    /// The side that surfaces are looked at from: z for a flat mesh, else the element's own mean normal.
    fn up(&self, points: &[[f64; 3]]) -> [f64; 3] {
        let corners = &points[..self.element.family.corner_count()];
        match self.element.family {
            Family::Triangle | Family::Quadrangle if !self.flat => {
                let from = corners[0];
                let normal = corners[1..]
                    .windows(2)
                    .map(|pair| cross(minus(pair[0], from), minus(pair[1], from)))
                    .fold([0.0; 3], plus);
                let length = norm(normal);
                if length > 0.0 { scaled(normal, 1.0 / length) } else { normal }
            }
            _ => [0.0, 0.0, 1.0],
        }
    }
}
