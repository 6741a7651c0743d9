//! What the parameters of a `params.csv` mean to a scene.
//!
//! | parameter | meaning |
//! |---|---|
//! | `nbCube` | number of cells; their edge is that of N equal cubes: h³ = length · side² / N (in the plane h² = length · side / N), and the bar has length / h, side / h (, side / h) of them, rounded |
//! | `longueur`, `largeurSection` | length and side of the square section (m) |
//! | `densite`, `moduleYoung`, `poissonRatio` | density, Young's modulus, Poisson's ratio of every section |
//! | `typeIntegration` | 0: explicit Euler; else implicit Euler |
//! | `pas`, `epsilonStable` | time step; at rest below this kinetic energy per node |
//! | `typeSimulation` | 0: traction, without gravity; else: bending under gravity |
//! | `pourcentage`, `tempsEtirement` | traction only: elongation as a part of the length, and the time that it takes |

use crate::group::{Bar, Value};
use souple_simulation::lists::find_element;

/// The base scene.
pub const SCENE: &str = include_str!("folder_scene.toml");

/// The changes of [`SCENE`] that make one simulation of parameters and a bar.
pub fn overrides(values: &[(&str, &Value)], bar: &Bar) -> Vec<String> {
    let of = |name: &str| values.iter().find(|(n, _)| *n == name).and_then(|(_, v)| v.number()).unwrap_or(0.0);
    let plane = bar.sections.iter().any(|s| find_element(&s.element).is_ok_and(|e| e.dimension() == 2));
    let (length, side) = (of("longueur"), of("largeurSection"));
    let edge = if plane { (length * side / of("nbCube")).sqrt() } else { (length * side * side / of("nbCube")).cbrt() };
    // What is no number of cells is left to the scene to refuse, which names the value.
    let cells = |size: f64| (size / edge).round().max(1.0);
    let across = cells(side);
    let sections: Vec<String> =
        bar.sections.iter().map(|s| format!("{{ until = {:?}, element = {:?} }}", s.until, s.element)).collect();
    let material = |(index, law): (usize, &str)| {
        format!(
            "{{ region = \"section_{index}\", law = {law:?}, young = {:?}, poisson = {:?} }}",
            of("moduleYoung"),
            of("poissonRatio")
        )
    };
    let materials: Vec<String> = bar.sections.iter().map(|s| s.law.as_str()).enumerate().map(material).collect();
    let method = if of("typeIntegration") == 0.0 { "explicit-euler" } else { "implicit-euler" };
    let mut all = vec![
        format!("time.step={:?}", of("pas")),
        format!("time.stop.mean_kinetic_energy={:?}", of("epsilonStable")),
        format!("integrator.method={method}"),
        format!("body.0.density={:?}", of("densite")),
        format!("body.0.mesh.size=[{length:?}, {side:?}, {side:?}]"),
        format!("body.0.mesh.cells=[{}, {across}, {across}]", cells(length)),
        format!("body.0.mesh.sections=[{}]", sections.join(", ")),
        format!("body.0.material=[{}]", materials.join(", ")),
    ];
    if of("typeSimulation") == 0.0 {
        let (stretch, time) = (length * of("pourcentage"), of("tempsEtirement"));
        let keys = format!("[[0.0, [0.0, 0.0, 0.0]], [{time:?}, [{stretch:?}, 0.0, 0.0]]]");
        all.push("body.0.fix=[{ region = \"x_min\", axes = [\"x\"] }]".to_owned());
        all.push(format!("body.0.move=[{{ region = \"x_max\", axes = [\"x\"], translation = {{ keys = {keys} }} }}]"));
        // The bar is not at rest before it has been stretched.
        all.push(format!("time.stop.check_every={:?}", time.max(0.05)));
    } else {
        all.push("gravity=[0.0, -9.81, 0.0]".to_owned());
    }
    all
}
