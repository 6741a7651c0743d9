//! What a traction test says of its material: Young's modulus and Poisson's ratio, from forces and lengths alone.
//!
//! ```text
//! E = F L₀ / (A₀ ΔL)        ν = − (Δw / w₀) / (ΔL / L₀)
//! ```
//!
//! A scene is a traction test when its first body is a generated bar that is held at `x_min` and moved at `x_max`, both
//! along x only, and probes measure the `reaction` on `x_min` and the `mean displacement` of `x_max`; with those of
//! `y_min` and `y_max`, which move towards each other by Δw, it gives Poisson's ratio too.
//!
//! Both are those of small strains: a law that stiffens or softens gives the secant of the strain that was reached. A bar
//! in the plane (strain, thickness 1 m) gives E / (1 − ν²) and ν / (1 − ν) of its material.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use souple_simulation::lists::find_element;
use souple_simulation::scene::mesh::Mesh;
use souple_simulation::scene::probe::Quantity;
use souple_simulation::scene::{ParameterValue, Scene, Selection};

/// A traction test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traction {
    /// Length at rest, L₀ (m).
    pub length: f64,
    /// Width along y at rest, w₀ (m).
    pub width: f64,
    /// Area of the section at rest, A₀ (m²).
    pub area: f64,
    /// Name of the probe with the reaction.
    pub held: String,
    /// Name of the probe with the displacement of the other end.
    pub pulled: String,
    /// Names of the probes with the displacements of `y_min` and `y_max`.
    pub sides: Option<[String; 2]>,
    /// E and ν that the test must give where all materials agree.
    pub expected: Option<[f64; 2]>,
}

/// The traction test that a scene is.
pub fn traction(scene: &Scene) -> Option<Traction> {
    let body = &scene.bodies.first()?.value;
    let Mesh::Bar(bar) = &body.mesh.value else { return None };
    let along_x = |axes: [bool; 3]| axes == [true, false, false];
    let on = |region: &Selection, wanted: &str| matches!(region, Selection::Name(name) if name == wanted);
    let held = body.fixes.iter().any(|f| on(&f.value.region.value, "x_min") && along_x(f.value.axes));
    let moved = body.moves.iter().any(|m| on(&m.value.region.value, "x_max") && along_x(m.value.axes));
    if !held || !moved {
        return None;
    }
    let probe = |quantity: Quantity, region: &str| {
        let mut fitting = scene
            .probes
            .iter()
            .filter(|p| on(&p.region.value, region) && p.quantities.iter().any(|q| q.value == quantity));
        fitting.next().map(|p| p.name.value.clone())
    };
    let plane = bar.sections.iter().any(|s| find_element(&s.value.element.value).is_ok_and(|e| e.dimension() == 2));
    let [length, width, height] = bar.size.value;
    let expected = expected(scene, plane);
    let displaced = |region: &str| probe(Quantity::MeanDisplacement, region);
    Some(Traction {
        length,
        width,
        area: width * if plane { 1.0 } else { height },
        held: probe(Quantity::Reaction, "x_min")?,
        pulled: displaced("x_max")?,
        sides: displaced("y_min").and_then(|low| Some([low, displaced("y_max")?])),
        expected,
    })
}

fn expected(scene: &Scene, plane: bool) -> Option<[f64; 2]> {
    let materials = &scene.bodies.first()?.value.materials;
    let of = |at: usize, name: &str| match materials.get(at)?.value.parameter(name)?.value {
        ParameterValue::Number(x) => Some(x),
        _ => None,
    };
    let constants = |at: usize| Some([of(at, "young")?, of(at, "poisson")?]);
    let [young, poisson] = constants(0)?;
    let same = (1..materials.len()).all(|at| constants(at) == Some([young, poisson]));
    let plane_strain = [young / (1.0 - poisson * poisson), poisson / (1.0 - poisson)];
    same.then_some(if plane { plane_strain } else { [young, poisson] })
}

/// What the test gives: quantities and their values, from the probes of a summary.
pub fn moduli(test: &Traction, summary: &Json) -> Vec<(String, f64)> {
    let of = |probe: &str, quantity: &str, axis: usize| summary["probes"][probe][quantity][axis].as_f64();
    let displacement = |probe: &str, axis: usize| of(probe, "mean displacement", axis);
    let (Some(force), Some(longer)) = (of(&test.held, "reaction", 0), displacement(&test.pulled, 0)) else {
        return Vec::new();
    };
    if longer == 0.0 {
        return Vec::new();
    }
    let strain = longer / test.length;
    // The force that holds one end pulls against the displacement of the other.
    let young = -force / (test.area * strain);
    let mut all = vec![("Young's modulus".to_owned(), young)];
    if let Some([young_expected, _]) = test.expected {
        all.push(("error of Young's modulus".to_owned(), young / young_expected - 1.0));
    }
    if let Some([low, high]) = &test.sides
        && let (Some(low), Some(high)) = (displacement(low, 1), displacement(high, 1))
    {
        let poisson = -(high - low) / test.width / strain;
        all.push(("Poisson's ratio".to_owned(), poisson));
        if let Some([_, poisson_expected]) = test.expected {
            all.push(("error of Poisson's ratio".to_owned(), poisson - poisson_expected));
        }
    }
    all
}
