//! Promises of stresses and strains in results: probes, expectations and fields of a bar that is drawn out and free to
//! contract give the closed form.
//!
//! Out of scope: means of single elements with every law and quadrature, which `souple-operators` tests.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

use souple_simulation::mesh::formats::{Field, Location, ReadOptions, Values, read_vtu_with_fields};
use souple_simulation::{ProbeValue, RunOptions, Simulation};

/// All four solids in one bar, drawn out by 5 %; three faces slide, the others are free.
const BAR: &str = r#"
[integrator]
method = "quasi-static"
newton_tolerance = 1e-11
[linear_solver]
tolerance = 1e-12
max_iterations = 20000
[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [4.0, 1.0, 1.0]
cells = [8, 2, 2]
transition = "pyramids"
sections = [
  { until = 0.25, element = "prism6" },
  { until = 0.50, element = "pyramid5" },
  { until = 0.75, element = "hex8" },
  { until = 1.00, element = "tet4" },
]
[[body.material]]
law = "stvk"
young = 1e8
poisson = 0.3
[[body.fix]]
region = "x_min"
axes = ["x"]
[[body.fix]]
region = "y_min"
axes = ["y"]
[[body.fix]]
region = "z_min"
axes = ["z"]
[[body.move]]
region = "x_max"
axes = ["x"]
translation = { keys = [[0.0, [0.0, 0.0, 0.0]], [1.0, [0.2, 0.0, 0.0]]] }
[[probe]]
name = "all"
quantity = "stress"
[[probe]]
name = "half"
region = { box = { min = [0, 0, 0], max = [2, 1, 1] } }
quantity = ["stress", "volume"]
[[expect]]
probe = "all"
component = "xx"
value = 5551973.175135416
relative_tolerance = 1e-8
[[expect]]
probe = "all"
component = "von mises"
value = "5.551973175135416 MPa"
relative_tolerance = 1e-8
[[expect]]
probe = "half"
quantity = "stress"
value = [5551973.175135416, 0.0, 0.0, 0.0, 0.0, 0.0]
relative_tolerance = 1e-8
[[expect]]
probe = "all"
component = "zz"
value = 0.0
tolerance = 0.1
[[expect]]
probe = "all"
component = "yz"
value = 1.0
tolerance = 0.5
[output]
fields = ["stress", "von mises stress", "strain", "principal stretches", "volume ratio", "energy density"]
"#;

/// Stretch λ = 1.05: S_xx = E (λ² − 1)/2 = 5.125 MPa and σ_xx = λ S_xx / (lateral stretch)², by an independent program.
const CAUCHY: f64 = 5_551_973.175_135_416;

/// √(1 − 2ν e) with the axial strain e = (λ² − 1)/2.
const LATERAL: f64 = 0.984_504_951_739_705_5;

fn load(text: &str, overrides: &[&str]) -> Simulation {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_string()).collect();
    let mut read = |name: &str| Err(format!("{name}: there are no files here"));
    Simulation::load(text, "scene.toml", &overrides, &mut read, &RunOptions::default()).unwrap().0
}

fn end(text: &str, overrides: &[&str]) -> Simulation {
    let mut simulation = load(text, overrides);
    while simulation.advance().unwrap().finished.is_none() {}
    simulation
}

fn stress(simulation: &mut Simulation, probe: &str) -> [f64; 6] {
    match simulation.probes()[probe]["stress"] {
        ProbeValue::Tensor(stress) => stress,
        _ => panic!("a stress is a tensor"),
    }
}

/// The mean over the whole bar and over half of it is the Cauchy stress of the closed form, free of stress across;
/// expectations compare single components, the equivalent stress and the whole tensor, and can fail.
#[test]
fn probes_of_a_bar_drawn_out_have_the_closed_form() {
    let mut simulation = end(BAR, &[]);
    for probe in ["all", "half"] {
        let found = stress(&mut simulation, probe);
        for (entry, wanted) in found.iter().zip([CAUCHY, 0.0, 0.0, 0.0, 0.0, 0.0]) {
            assert!((entry - wanted).abs() <= 1e-8 * CAUCHY, "{probe}: {found:?}");
        }
    }
    let expectations = simulation.expectations();
    let passed: Vec<bool> = expectations.iter().map(|e| e.passed).collect();
    assert_eq!(passed, [true, true, true, true, false], "{expectations:?}");
}

/// A small-strain law shows the stress that it states, E ε: no change of shape divides it.
#[test]
fn hooke_shows_the_stress_that_it_states() {
    let mut simulation = end(BAR, &["body.0.material.0.law='hooke'"]);
    let found = stress(&mut simulation, "all");
    for (entry, wanted) in found.iter().zip([5e6, 0.0, 0.0, 0.0, 0.0, 0.0]) {
        assert!((entry - wanted).abs() <= 1e-8 * 5e6, "{found:?}");
    }
}

/// A mean over parts that differ is weighted by their deformed volumes: of a bar with a softer first section, it is the
/// mean of what that section and the rest show.
#[test]
fn means_are_weighted_by_volume() {
    let soft = "[[body.material]]\nregion = \"section_0\"\nlaw = \"stvk\"\nyoung = 1e7\npoisson = 0.3\n";
    let probes = "[[probe]]\nname = \"soft\"\nregion = \"section_0\"\nquantity = [\"stress\", \"volume\"]\n\
                  [[probe]]\nname = \"hard\"\nregion = { not = \"section_0\" }\nquantity = [\"stress\", \"volume\"]\n";
    let text = BAR.replacen("[[body.fix]]", &format!("{soft}[[body.fix]]"), 1);
    let text = text.replacen("[[probe]]", &format!("{probes}[[probe]]"), 1);
    let mut simulation = end(&text, &[]);
    let volume = |s: &mut Simulation, probe: &str| match s.probes()[probe]["volume"] {
        ProbeValue::Scalar(v) => v,
        _ => panic!("a volume is a number"),
    };
    let (soft, hard) = (stress(&mut simulation, "soft"), stress(&mut simulation, "hard"));
    let (v, w) = (volume(&mut simulation, "soft"), volume(&mut simulation, "hard"));
    let all = stress(&mut simulation, "all");
    assert!((soft[1] - hard[1]).abs() > 1e3, "the parts differ: {soft:?} and {hard:?}");
    assert!((v - 1.0).abs() > 1e-3, "the softer part takes most of the stretch: {v}");
    for k in 0..6 {
        let wanted = (v * soft[k] + w * hard[k]) / (v + w);
        assert!((all[k] - wanted).abs() <= 1e-9 * all[0], "{all:?}, entry {k} should be {wanted}");
    }
}

/// Files hold the stress and the strain of every element as nine numbers, row by row, and its equivalent stress.
#[test]
fn fields_are_written_for_every_element() {
    let mut simulation = end(BAR, &[]);
    let (name, bytes) = simulation.frame().unwrap().remove(0);
    assert_eq!(name, "bar");
    let (mesh, fields, _) = read_vtu_with_fields(&bytes, ReadOptions::default()).unwrap();
    let count = mesh.element_count();
    assert!(count > 50, "{count} elements");
    let diagonal = |along: f64, across: f64| [along, 0.0, 0.0, 0.0, across, 0.0, 0.0, 0.0, across].to_vec();
    let strain = 0.5 * (1.05 * 1.05 - 1.0);
    let cases = [
        ("stress", diagonal(CAUCHY, 0.0), CAUCHY),
        ("von mises stress", vec![CAUCHY], CAUCHY),
        ("strain", diagonal(strain, -0.3 * strain), strain),
        ("principal stretches", vec![1.05, LATERAL, LATERAL], 1.05),
        ("volume ratio", vec![1.05 * LATERAL * LATERAL], 1.0),
        // ½ E e²: what a bar with free sides stores.
        ("energy density", vec![0.5e8 * strain * strain], 0.5e8 * strain * strain),
    ];
    for (name, wanted, size) in cases {
        let field: &Field = fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("no field `{name}`"));
        assert_eq!((field.location, field.components), (Location::Elements, wanted.len()), "{name}");
        let Values::F64(values) = &field.values else { panic!("`{name}` are reals") };
        assert_eq!(values.len(), count * wanted.len(), "{name}");
        for (element, found) in values.chunks(wanted.len()).enumerate() {
            let near = found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() <= 1e-6 * size);
            assert!(near, "{name} of element {element}: {found:?}, not {wanted:?}");
        }
    }
}

/// Probes give the strain, its principal stretches, the change of volume and the density of energy of their elements.
#[test]
fn probes_show_the_strain() {
    let quantities = "quantity = [\"strain\", \"principal stretches\", \"volume ratio\", \"energy density\"]";
    let probe = format!("[[probe]]\nname = \"strained\"\nregion = \"section_1\"\n{quantities}\n[[probe]]");
    let mut simulation = end(&BAR.replacen("[[probe]]", &probe, 1), &[]);
    let measured = simulation.probes().remove("strained").unwrap();
    let strain = 0.5 * (1.05 * 1.05 - 1.0);
    for (quantity, wanted) in [
        ("strain", vec![strain, -0.3 * strain, -0.3 * strain, 0.0, 0.0, 0.0]),
        ("principal stretches", vec![1.05, LATERAL, LATERAL]),
        ("volume ratio", vec![1.05 * LATERAL * LATERAL]),
        ("energy density", vec![0.5e8 * strain * strain]),
    ] {
        let found = match &measured[quantity] {
            ProbeValue::Scalar(x) => vec![*x],
            ProbeValue::Vector(v) => v.to_vec(),
            ProbeValue::Tensor(t) => t.to_vec(),
            ProbeValue::Vectors(_) => Vec::new(),
        };
        let near =
            found.len() == wanted.len() && found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() <= 1e-7 * wanted[0]);
        assert!(near, "{quantity}: {found:?}, not {wanted:?}");
    }
}

/// Any number of threads gives the same bits.
#[test]
fn threads_do_not_change_a_bit_of_a_stress() {
    let state = |threads: usize| {
        let options = RunOptions { threads, ..RunOptions::default() };
        let mut read = |name: &str| Err(format!("{name}: there are no files here"));
        let mut simulation = Simulation::load(BAR, "scene.toml", &[], &mut read, &options).unwrap().0;
        while simulation.advance().unwrap().finished.is_none() {}
        stress(&mut simulation, "all").map(f64::to_bits)
    };
    assert_eq!(state(1), state(3));
}
