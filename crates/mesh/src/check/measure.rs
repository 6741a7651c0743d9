//! Lengths, areas and volumes of elements.
//!
//! Linear solids are bounded by triangles and bilinear quadrangles, so their volume is exact by the divergence
//! theorem, V = ⅓ ∮ x · n dA: a triangle gives det(a, b, c) / 2 and a bilinear quadrangle the mean of its two
//! triangulations. Segments and triangles are exact too. Everything else is Σ w √det(JᵀJ) over the element's quadrature
//! rule with the most points (det J, with its sign, where there is one).

use super::jacobian::{shape_gradients, tangents};
use crate::geometry::{cross, dot, minus, norm, plus, scaled, triple};
use crate::reference::corner_faces;
use souple_elements::{Element, Family, Rule};

/// Measures elements of one kind.
pub(super) struct Meter {
    element: &'static Element,
    flat: bool,
    faces: Vec<&'static [u8]>,
    /// Weight and shape gradients of each quadrature point; empty for elements measured exactly.
    points: Vec<(f64, Vec<[f64; 3]>)>,
}

impl Meter {
    pub(super) fn new(element: &'static Element, flat: bool) -> Meter {
        let linear = element.node_count() == element.family.corner_count();
        let exact = linear && element.family != Family::Quadrangle;
        let points = if exact { Vec::new() } else { quadrature(element) };
        Meter { element, flat, faces: corner_faces(element), points }
    }

    /// Length in m, area in m² or volume in m³; negative for an inverted solid or an inverted element of a flat mesh.
    pub(super) fn measure(&self, x: &[[f64; 3]]) -> f64 {
        if !self.points.is_empty() {
            return self.points.iter().map(|(weight, gradients)| weight * self.density(&tangents(x, gradients))).sum();
        }
        match self.element.family {
            Family::Edge => norm(minus(x[1], x[0])),
            Family::Triangle => self.area_of(cross(minus(x[1], x[0]), minus(x[2], x[0]))) / 2.0,
            _ => solid_volume(x, &self.faces),
        }
    }

    fn density(&self, columns: &[[f64; 3]; 3]) -> f64 {
        match self.element.dimension() {
            1 => norm(columns[0]),
            2 => self.area_of(cross(columns[0], columns[1])),
            _ => triple(columns[0], columns[1], columns[2]),
        }
    }

    fn area_of(&self, normal: [f64; 3]) -> f64 {
        if self.flat { normal[2] } else { norm(normal) }
    }
}

fn quadrature(element: &'static Element) -> Vec<(f64, Vec<[f64; 3]>)> {
    let finest = element.quadratures.iter().filter_map(|id| Rule::by_id(id)).max_by_key(|rule| rule.points.len());
    let rule = finest.unwrap_or_else(|| element.default_rule());
    rule.weights.iter().copied().zip(shape_gradients(element, &rule.points)).collect()
}

/// Volume inside bilinear faces, exact to rounding: positions are taken relative to the centre of the corners, so that
/// nothing cancels far from the origin.
fn solid_volume(x: &[[f64; 3]], faces: &[&[u8]]) -> f64 {
    let centre = scaled(x.iter().copied().fold([0.0; 3], plus), 1.0 / x.len() as f64);
    let mut six = 0.0;
    for face in faces {
        let at = |i: usize| minus(x[face[i] as usize], centre);
        let det = |i: usize, j: usize, k: usize| dot(at(i), cross(at(j), at(k)));
        six += match face.len() {
            3 => det(0, 1, 2),
            _ => (det(0, 1, 2) + det(0, 2, 3) + det(0, 1, 3) + det(1, 2, 3)) / 2.0,
        };
    }
    six / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_elements::all;

    /// A smooth map that is not affine, so that faces bend and det J varies.
    fn distorted([x, y, z]: [f64; 3]) -> [f64; 3] {
        [x + 0.1 * y * z, y + 0.15 * x * z, z + 0.05 * x * y]
    }

    /// The exact volumes of linear solids agree with quadrature of det J.
    #[test]
    fn divergence_agrees_with_quadrature() {
        for element in all().iter().filter(|e| e.dimension() == 3 && e.degree == 1) {
            let x: Vec<[f64; 3]> = element.nodes.iter().map(|&n| distorted(n)).collect();
            let exact = solid_volume(&x, &corner_faces(element));
            let meter = Meter { element, flat: false, faces: Vec::new(), points: quadrature(element) };
            // The pyramid's determinant is rational: its rule is not exact for it.
            let tolerance = if element.family == Family::Pyramid { 1e-3 } else { 1e-12 };
            assert!((meter.measure(&x) - exact).abs() < tolerance, "{}: {} {exact}", element.id, meter.measure(&x));
        }
    }

    /// Every element has the measure of its reference cell at its reference nodes, and its negative when mirrored.
    #[test]
    fn reference_cells_have_their_measure() {
        for element in all() {
            let expected = element.family.reference_measure();
            let meter = Meter::new(element, true);
            assert!((meter.measure(element.nodes) - expected).abs() < 1e-12, "{}", element.id);
            let order = crate::reference::mirror(element).expect("every element is symmetric");
            let mirrored: Vec<[f64; 3]> = order.iter().map(|&n| element.nodes[n as usize]).collect();
            let sign = if element.dimension() == 1 { 1.0 } else { -1.0 };
            assert!((meter.measure(&mirrored) - sign * expected).abs() < 1e-12, "{}", element.id);
        }
    }
}
