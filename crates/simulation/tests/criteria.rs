//! Criteria for changing laws and for refining: what they are of a stretch that is known.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use souple_simulation::{ElementField, RunOptions, Simulation};

/// A bar between two plates, of which one is moved outwards by a tenth of its length.
const DRAWN: &str = r#"
time = { step = 1.0, end = 1.0 }
integrator = { method = "quasi-static" }
linear_solver = { tolerance = 1e-12 }
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], ELEMENTS }
material = [{ law = "hooke", young = "50 kPa", poisson = 0.0 }]
fix = [{ region = "x_min" }]
move = [{ region = "x_max", translation = { keys = [[0.0, [0.0, 0.0, 0.0]], [1.0, [0.04, 0.0, 0.0]]] } }]
"#;

/// Drawn out by a tenth without narrowing, edges along the bar are a tenth longer, and so are volumes; forces on the nodes
/// of a cross-section add up to stress times area: E ε A, shared by the elements beside each other.
#[test]
fn a_drawn_bar_has_known_criteria() {
    let mut simulation = drawn(r#"element = "hex8""#);
    for (element, change) in simulation.element_field(ElementField::LengthChange).unwrap().into_iter().enumerate() {
        assert!((change - 0.1).abs() < 1e-9, "element {element}: R_L = {change}");
    }
    volumes_grow_by_a_tenth(&mut simulation);
    let forces = simulation.element_field(ElementField::MeanForce).unwrap();
    // Each of the eight nodes of a hexahedron carries a quarter of the force on its side.
    let quarter = 50e3 * 0.1 * 0.05 * 0.05 / 4.0;
    for (element, force) in forces.iter().enumerate() {
        assert!((force / quarter - 1.0).abs() < 1e-9, "element {element}: R_S = {force}, expected {quarter}");
    }
    let parts = simulation.parts_of_elements();
    assert!(parts.iter().all(|&p| p == 0), "so small a matrix has one part");
}

/// A layer of pyramids between hexahedra and prisms lets the same stretch pass as it is.
#[test]
fn a_drawn_bar_of_several_elements_has_the_same_criteria() {
    let sections = r#"sections = [{ until = 0.5, element = "hex8" }, { until = 1.0, element = "prism6" }]"#;
    let mut simulation = drawn(&format!(r#"transition = "pyramids", {sections}"#));
    assert!(simulation.prepared().blocks.len() > 2);
    volumes_grow_by_a_tenth(&mut simulation);
    let lengths = simulation.element_field(ElementField::LengthChange).unwrap();
    // Edges of pyramids lie across the bar or aslant: they lengthen less.
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    assert!((longest - 0.1).abs() < 1e-9, "R_L is {longest} at most");
    assert!(lengths.iter().filter(|l| (*l - 0.1).abs() < 1e-9).count() >= 20, "{lengths:?}");
}

fn drawn(elements: &str) -> Simulation {
    let mut read = |file: &str| Err(format!("no file {file}"));
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    let text = DRAWN.replace("ELEMENTS", elements);
    let (mut simulation, warnings) = Simulation::load(&text, "test.toml", &[], &mut read, &options).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    while simulation.advance().unwrap().finished.is_none() {}
    simulation
}

fn volumes_grow_by_a_tenth(simulation: &mut Simulation) {
    for (element, change) in simulation.element_field(ElementField::VolumeChange).unwrap().into_iter().enumerate() {
        assert!((change - 0.1).abs() < 1e-9, "element {element}: R_A = {change}");
    }
}
