//! Criteria for changing laws and for refining: what they are of a stretch that is known.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use souple_simulation::{ElementField, RunOptions, Simulation};

/// A bar between two plates, of which one is moved outwards by a tenth of its length; of hexahedra.
const DRAWN: &str = r#"
time = { step = 1.0, end = 1.0 }
integrator = { method = "quasi-static" }
linear_solver = { tolerance = 1e-12 }
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], element = "hex8" }
material = [{ law = "hooke", young = "50 kPa", poisson = 0.0 }]
fix = [{ region = "x_min" }]
move = [{ region = "x_max", translation = { keys = [[0.0, [0.0, 0.0, 0.0]], [1.0, [0.04, 0.0, 0.0]]] } }]
"#;

/// Drawn out by a tenth without narrowing, edges along the bar are a tenth longer, and so are volumes; forces on the nodes
/// of a cross-section add up to stress times area: E ε A, shared by the elements beside each other.
#[test]
fn a_drawn_bar_has_known_criteria() {
    let mut read = |file: &str| Err(format!("no file {file}"));
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    let (mut simulation, _) = Simulation::load(DRAWN, "test.toml", &[], &mut read, &options).unwrap();
    while simulation.advance().unwrap().finished.is_none() {}
    let lengths = simulation.element_field(ElementField::LengthChange).unwrap();
    let volumes = simulation.element_field(ElementField::VolumeChange).unwrap();
    let forces = simulation.element_field(ElementField::MeanForce).unwrap();
    for (element, (length, volume)) in lengths.iter().zip(&volumes).enumerate() {
        // As near as the equilibrium is found.
        assert!((length - 0.1).abs() < 1e-3, "element {element}: R_L = {length}");
        assert!((volume - 0.1).abs() < 1e-3, "element {element}: R_A = {volume}");
    }
    // Each of the eight nodes of a hexahedron carries a quarter of the force on its side.
    let quarter = 50e3 * 0.1 * 0.05 * 0.05 / 4.0;
    let like: Vec<f64> = forces.iter().copied().filter(|f| (f - quarter).abs() < 0.02 * quarter).collect();
    assert!(like.len() >= 8, "R_S of hexahedra is {quarter} N, found {forces:?}");
    let parts = simulation.parts_of_elements();
    assert!(parts.iter().all(|&p| p == 0), "so small a matrix has one part");
}
