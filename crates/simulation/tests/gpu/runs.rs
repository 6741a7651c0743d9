//! Whole runs on a device.

use super::gpu;
use souple_simulation::{Ending, ProbeValue, RunOptions, Simulation};

/// A small mixed bar: four kinds of elements, two laws.
const BAR: &str = r#"
gravity = [0.0, -9.81, 0.0]
[time]
step = 0.01
end = 0.1
[integrator]
method = "implicit-euler"
velocity_damping = 1.0
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
young = 1e6
poisson = 0.3
[[body.material]]
region = { element = "prism6" }
law = "hooke"
young = 1e6
poisson = 0.3
[[body.fix]]
region = "x_min"
[[probe]]
name = "tip"
region = "x_max"
quantity = ["mean displacement", "kinetic energy"]
"#;

pub(crate) fn load(text: &str, overrides: &[&str], device: &str) -> Result<(Simulation, Vec<String>), String> {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
    let mut read = |name: &str| Err(format!("{name}: there are no files here"));
    let options = RunOptions { device: device.into(), threads: 1 };
    Simulation::load(text, "scene.toml", &overrides, &mut read, &options).map_err(|e| e.to_string())
}

pub(crate) fn tip(simulation: &mut Simulation) -> [f64; 3] {
    match simulation.probes()["tip"]["mean displacement"] {
        ProbeValue::Vector(v) => v,
        _ => panic!("a mean displacement is a vector"),
    }
}

/// Largest distance of two runs' tips over all steps.
fn distance(text: &str, overrides: &[&str]) -> f64 {
    let mut device = load(text, overrides, "gpu").unwrap().0;
    let mut processor = load(text, overrides, "cpu").unwrap().0;
    let mut worst: f64 = 0.0;
    loop {
        let (a, b) = (device.advance().unwrap(), processor.advance().unwrap());
        let (x, y) = (tip(&mut device), tip(&mut processor));
        worst = (0..3).map(|k| (x[k] - y[k]).abs()).fold(worst, f64::max);
        let scale = b.kinetic_energy.abs().max(1e-6);
        assert!((a.kinetic_energy - b.kinetic_energy).abs() < 1e-3 * scale, "{a:?} {b:?}");
        assert_eq!(a.finished, b.finished);
        if a.finished.is_some() {
            return worst;
        }
    }
}

/// The tip of the bar follows that of the processor to 10⁻⁵ of its length, for every method that devices have, with
/// every preconditioner, damping, moved nodes and loads that change.
#[test]
fn tips_follow_those_of_the_processor() {
    if gpu().is_none() {
        return;
    }
    let methods: [&[&str]; 5] = [
        &[],
        &["integrator.method='implicit-midpoint'", "linear_solver.preconditioner='jacobi'"],
        &["linear_solver.preconditioner='none'", "integrator.rayleigh={ mass = 0.5, stiffness = 0.002 }"],
        &["integrator.method='symplectic-euler'", "time.step=1e-3", "time.end=0.05"],
        &[
            "body.0.material.0.law='neo-hookean'",
            "body.0.move=[{ region = 'x_max', axes = ['x'], translation = { keys = [[0.0, [0, 0, 0]], [0.1, [0.2, 0, 0]]] } }]",
            "body.0.traction=[{ region = 'y_max', traction = [0.0, 0.0, 200.0], factor = [[0.0, 0.0], [0.1, 1.0]] }]",
        ],
    ];
    for overrides in methods {
        let d = distance(BAR, overrides);
        assert!(d < 4e-5, "{overrides:?}: {d:e} m");
    }
}

/// A step moves as many bytes for a large model as for a small one, and reading the state is what moves it.
#[test]
fn steps_move_few_bytes() {
    if gpu().is_none() {
        return;
    }
    let moved = |cells: &str| {
        let mut simulation = load(BAR, &[cells, "time.end=1.0"], "gpu").unwrap().0;
        let before = simulation.transfers().unwrap();
        for _ in 0..3 {
            simulation.advance().unwrap();
        }
        let after = simulation.transfers().unwrap();
        let _ = tip(&mut simulation);
        let read = simulation.transfers().unwrap().downloaded - after.downloaded;
        let _ = tip(&mut simulation);
        assert_eq!(
            simulation.transfers().unwrap().downloaded - after.downloaded,
            read,
            "one reading per step is enough"
        );
        assert!(read >= 8 * simulation.unknowns() as u64, "{read} bytes for the state");
        (after.uploaded - before.uploaded) + (after.downloaded - before.downloaded)
    };
    let (small, large) = (moved("body.0.mesh.cells=[4, 1, 1]"), moved("body.0.mesh.cells=[12, 3, 3]"));
    // A solve that takes longer than the last waits more often, for 64 bytes each time.
    assert!(small < 3 * 1024 && large < 3 * 1024, "{small} and {large} bytes in three steps");
}

/// The same run gives the same bits.
#[test]
fn runs_repeat_bit_for_bit() {
    if gpu().is_none() {
        return;
    }
    let run = || {
        let mut simulation = load(BAR, &["time.end=0.03"], "gpu").unwrap().0;
        while simulation.advance().unwrap().finished.is_none() {}
        simulation.displacement().iter().map(|u| u.to_bits()).collect::<Vec<_>>()
    };
    let first = run();
    assert!(first.iter().any(|b| *b != 0));
    assert_eq!(first, run());
}

/// What a device does not do is refused, with what to do instead.
#[test]
fn what_is_missing_is_refused() {
    if gpu().is_none() {
        return;
    }
    for (overrides, words) in [
        (&["integrator.method='quasi-static'"][..], "quasi-static"),
        (&["integrator.method='bdf2'"], "bdf2"),
        (&["integrator.newton_iterations=5"], "newton_iterations = 1"),
        (&["linear_solver.method='direct'"], "direct solver"),
        (&["integrator.tangent='projected'"], "projected"),
        (&["body.0.material.0.viscosity={ shear = 100.0 }"], "viscous"),
    ] {
        let message = load(BAR, overrides, "gpu").err().unwrap_or_default();
        assert!(message.contains(words) && message.contains("--device cpu"), "{overrides:?}: {message}");
    }
    let message = load(BAR, &[], "gpu:nosuchcard").err().unwrap();
    assert!(message.contains("nosuchcard") && message.contains("gpu:0"), "{message}");
    let (_, warnings) = load(BAR, &["linear_solver.preconditioner='incomplete-cholesky'"], "gpu").unwrap();
    assert!(warnings.iter().any(|w| w.contains("block-jacobi")), "{warnings:?}");
}

/// A device that is lost ends the run with an error that says so; the state that came back last is kept and a run on the
/// processor goes on from it.
#[test]
fn a_lost_device_leaves_the_last_state() {
    if gpu().is_none() {
        return;
    }
    let mut simulation = load(BAR, &[], "gpu").unwrap().0;
    simulation.advance().unwrap();
    simulation.advance().unwrap();
    let kept = tip(&mut simulation);
    simulation.advance().unwrap();
    simulation.lose_device();
    let error = simulation.advance().unwrap_err().to_string();
    assert!(error.contains("lost") && error.contains("0.02 s"), "{error}");
    assert_eq!(tip(&mut simulation), kept);
    let mut next = load(BAR, &[], "cpu").unwrap().0;
    next.restore(&simulation.checkpoint()).unwrap();
    assert_eq!(next.advance().unwrap().step, 3);
}

/// A step that fails leaves the state before it and names what failed, as on the processor.
#[test]
fn a_failed_step_is_undone() {
    if gpu().is_none() {
        return;
    }
    // Pulled through itself within a step.
    let overrides = [
        "body.0.material.0.law='neo-hookean'",
        "body.0.material.1.law='neo-hookean'",
        "body.0.move=[{ region = 'x_max', translation = { keys = [[0.0, [0, 0, 0]], [0.02, [0, 0, 0]], [0.03, [-9.0, 0, 0]]] } }]",
    ];
    let mut simulation = load(BAR, &overrides, "gpu").unwrap().0;
    simulation.advance().unwrap();
    simulation.advance().unwrap();
    let before = tip(&mut simulation);
    let error = simulation.advance().unwrap_err().to_string();
    assert!(error.contains("inside out") || error.contains("finite"), "{error}");
    assert_eq!(tip(&mut simulation), before);
}

/// A checkpoint of a device goes on there, and ends where the run that was not interrupted ends.
#[test]
fn checkpoints_go_on() {
    if gpu().is_none() {
        return;
    }
    let mut whole = load(BAR, &["time.end=0.06"], "gpu").unwrap().0;
    let mut part = load(BAR, &["time.end=0.06"], "gpu").unwrap().0;
    for _ in 0..3 {
        part.advance().unwrap();
    }
    let mut rest = load(BAR, &["time.end=0.06"], "gpu").unwrap().0;
    rest.restore(&part.checkpoint()).unwrap();
    while whole.advance().unwrap().finished.is_none() {}
    while rest.advance().unwrap().finished != Some(Ending::Finished) {}
    assert_eq!(tip(&mut whole), tip(&mut rest));
}
