//! What beam theory says of a bar that is held at one end and bends under its own weight.
//!
//! ```text
//! Euler–Bernoulli  w(x) = q x² (6 L² − 4 L x + x²) / (24 E I)
//! Timoshenko       w(x) + q (2 L x − x²) / (2 κ G A),   κ = 10 (1 + ν) / (12 + 11 ν)
//! q = ρ g A,   A = b h,   I = b h³ / 12,   G = E / (2 (1 + ν))
//! ```
//!
//! Both are exact for small deflections of slender beams only: whoever shows them beside a simulation says how large
//! the deflection is. κ of a rectangle is that of G. R. Cowper, *The shear coefficient in Timoshenko's beam theory*,
//! Journal of Applied Mechanics 33 (1966), p. 335. In the plane (strain), E and ν are those of plane stress that give the
//! same plane problem: E / (1 − ν²) and ν / (1 − ν).

use super::data::Material;
use serde_json::Value as Json;
use souple_simulation::lists::find_element;
use souple_simulation::scene::mesh::{Bar, Mesh};
use souple_simulation::scene::{Scene, Selection};

/// A beam of rectangular section along x, held at its lower end, under its own weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cantilever {
    /// Length (m).
    pub length: f64,
    /// Height of the section along gravity (m).
    pub height: f64,
    /// Mass per volume (kg/m³).
    pub density: f64,
    /// Component of gravity along `axis` (m/s²), with its sign.
    pub gravity: f64,
    /// Axis of gravity: 1 (y) or 2 (z).
    pub axis: usize,
    /// Young's modulus (Pa), in the plane that of plane stress.
    pub young: f64,
    /// Poisson's ratio, in the plane that of plane stress.
    pub poisson: f64,
}

impl Cantilever {
    /// Deflection (m) at x (m) from the support, by bending alone.
    pub fn euler_bernoulli(&self, x: f64) -> f64 {
        // q / (E I) = 12 ρ g / (E h²): the width falls out.
        let load = 12.0 * self.density * self.gravity / (self.young * self.height * self.height);
        load * x * x * (6.0 * self.length * self.length - 4.0 * self.length * x + x * x) / 24.0
    }

    /// Deflection (m) at x (m) from the support, by bending and shear.
    pub fn timoshenko(&self, x: f64) -> f64 {
        let kappa = 10.0 * (1.0 + self.poisson) / (12.0 + 11.0 * self.poisson);
        let shear = self.young / (2.0 * (1.0 + self.poisson));
        let by_shear = self.density * self.gravity * (2.0 * self.length * x - x * x) / (2.0 * kappa * shear);
        self.euler_bernoulli(x) + by_shear
    }
}

/// The generated bar of a scene with one body, and the number of dimensions of its elements.
pub fn bar(scene: &Scene) -> Option<(&Bar, usize)> {
    let [body] = scene.bodies.as_slice() else { return None };
    let Mesh::Bar(bar) = &body.value.mesh.value else { return None };
    let dimensions: Option<Vec<usize>> =
        bar.sections.iter().map(|s| Some(find_element(&s.value.element.value).ok()?.dimension())).collect();
    let dimensions = dimensions?;
    let first = *dimensions.first()?;
    dimensions.iter().all(|&d| d == first).then_some((bar, first))
}

/// The beam that a scene describes; none where it is no cantilever of one isotropic material under its own weight alone.
pub fn cantilever(scene: &Scene, materials: &[Material]) -> Option<Cantilever> {
    let (bar, dimension) = bar(scene)?;
    let body = &scene.bodies[0].value;
    let alone = body.moves.is_empty()
        && body.forces.is_empty()
        && body.tractions.is_empty()
        && body.pressures.is_empty()
        && scene.ties.is_empty()
        && body.materials.iter().all(|m| m.value.thickness.is_none() && m.value.section.is_none());
    let [fix] = body.fixes.as_slice() else { return None };
    let held = matches!(&fix.value.region.value, Selection::Name(name) if name == "x_min")
        && fix.value.axes.iter().take(dimension).all(|&axis| axis);
    let axis = match scene.gravity {
        [0.0, y, 0.0] if y != 0.0 => 1,
        [0.0, 0.0, z] if z != 0.0 && dimension == 3 => 2,
        _ => return None,
    };
    if !alone || !held || dimension < 2 {
        return None;
    }
    let mut constants = materials.iter().map(elastic_constants);
    let (young, poisson) = constants.next()??;
    if constants.any(|other| other != Some((young, poisson))) {
        return None;
    }
    let (young, poisson) =
        if dimension == 2 { (young / (1.0 - poisson * poisson), poisson / (1.0 - poisson)) } else { (young, poisson) };
    let [length, height] = [bar.size.value[0], bar.size.value[axis]];
    let (density, gravity) = (body.density.value, scene.gravity[axis]);
    Some(Cantilever { length, height, density, gravity, axis, young, poisson })
}

/// Young's modulus (Pa) and Poisson's ratio of small strains, where the parameters give them.
fn elastic_constants(material: &Material) -> Option<(f64, f64)> {
    let parameters: Json = serde_json::from_str(&material.parameters).ok()?;
    let of = |name: &str| parameters.as_array()?.iter().find(|p| p["name"] == name)?["value"].as_f64();
    if let (Some(young), Some(poisson)) = (of("young"), of("poisson")) {
        return Some((young, poisson));
    }
    let mu = of("mu")?;
    let lambda = of("lambda").or_else(|| Some(of("bulk")? - 2.0 * mu / 3.0))?;
    let young = mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu);
    Some((young, lambda / (2.0 * (lambda + mu))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEAM: Cantilever =
        Cantilever { length: 2.0, height: 0.1, density: 1000.0, gravity: -9.81, axis: 1, young: 1e7, poisson: 0.25 };

    /// The curve satisfies E I w'''' = q, is held at one end and free at the other, and ends at q L⁴ / 8 E I.
    #[test]
    fn bending_solves_the_beam_equation() {
        let stiffness = 1e7 * 0.1f64.powi(3) / 12.0;
        let load = -1000.0 * 9.81 * 0.1;
        assert!((BEAM.euler_bernoulli(2.0) / (load * 16.0 / (8.0 * stiffness)) - 1.0).abs() < 1e-14);
        assert_eq!((BEAM.euler_bernoulli(0.0), BEAM.timoshenko(0.0)), (0.0, 0.0));
        let h = 0.1;
        let w = |k: i32| BEAM.euler_bernoulli(1.0 + h * f64::from(k));
        // The fourth difference of a polynomial of degree four is its fourth derivative.
        let fourth = (w(-2) - 4.0 * w(-1) + 6.0 * w(0) - 4.0 * w(1) + w(2)) / h.powi(4);
        assert!((fourth * stiffness / load - 1.0).abs() < 1e-8, "{fourth}");
    }

    /// Shear makes a beam softer, the more so the higher it is, as (h / L)².
    #[test]
    fn shear_counts_with_the_square_of_the_height() {
        let part = |height: f64| {
            let beam = Cantilever { height, ..BEAM };
            beam.timoshenko(2.0) / beam.euler_bernoulli(2.0) - 1.0
        };
        assert!(part(0.1) > 0.0);
        assert!((part(0.2) / part(0.1) - 4.0).abs() < 1e-9);
    }

    /// Both pairs of constants describe the same material.
    #[test]
    fn constants_are_converted() {
        let material = |parameters: &str| Material { law: "hooke".to_owned(), parameters: parameters.to_owned() };
        let direct = material(r#"[{"name":"young","value":1e6},{"name":"poisson","value":0.25}]"#);
        assert_eq!(elastic_constants(&direct), Some((1e6, 0.25)));
        let lame = material(r#"[{"name":"lambda","value":4e5},{"name":"mu","value":4e5}]"#);
        let (young, poisson) = elastic_constants(&lame).unwrap();
        assert!((young / 1e6 - 1.0).abs() < 1e-14 && (poisson - 0.25).abs() < 1e-15);
        assert_eq!(elastic_constants(&material("[]")), None);
    }
}
