//! Whole runs on a device.

use super::gpu;
use souple_simulation::{Ending, ProbeValue, RunOptions, Simulation};

/// A small mixed bar: four kinds of elements, two laws.
pub(crate) const BAR: &str = r#"
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
    let saved = simulation.checkpoint();
    let kept = tip(&mut simulation);
    simulation.advance().unwrap();
    simulation.lose_device();
    let error = simulation.advance().unwrap_err().to_string();
    assert!(error.contains("lost") && error.contains("0.02 s"), "{error}");
    assert_eq!(tip(&mut simulation), kept);
    assert_eq!(simulation.checkpoint(), saved, "what is saved after the loss is the state that came back last");
    let mut next = load(BAR, &[], "cpu").unwrap().0;
    next.restore(&simulation.checkpoint()).unwrap();
    assert_eq!(next.advance().unwrap().step, 3);
}

/// A device that is lost between a step and the reading of its state is found out by the reading, which gives the state
/// that came back last with its own time, never an old state with the new time; the next step says what happened.
#[test]
fn a_device_lost_before_reading_is_noticed() {
    if gpu().is_none() {
        return;
    }
    let mut simulation = load(BAR, &[], "gpu").unwrap().0;
    simulation.advance().unwrap();
    let first = simulation.displacement().to_vec();
    simulation.advance().unwrap();
    simulation.lose_device();
    let saved = simulation.checkpoint();
    simulation.frame().unwrap();
    assert!((simulation.time() - 0.01).abs() < 1e-12, "{}", simulation.time());
    assert_eq!(simulation.displacement(), first);
    let error = simulation.advance().unwrap_err().to_string();
    assert!(error.contains("lost") && error.contains("0.01 s"), "{error}");
    let mut next = load(BAR, &[], "cpu").unwrap().0;
    next.restore(&saved).unwrap();
    assert_eq!(next.displacement(), first);
    assert_eq!(next.advance().unwrap().step, 2);
    // A device that is lost before the output that is due fails in the step, before anybody writes anything.
    let mut simulation = load(BAR, &["output.every=0.02"], "gpu").unwrap().0;
    assert!(!simulation.advance().unwrap().output_due);
    assert!(simulation.advance().unwrap().output_due);
    simulation.lose_device();
    assert_eq!(simulation.frame().unwrap().len(), 1, "what is due came back with its step");
}

/// Where the first direction of a solve has no positive curvature, the step is made with the preconditioned right-hand
/// side, and where a later one has none, with what was known before it, as on the processor; both say so.
#[test]
fn negative_curvature_is_met_as_on_the_processor() {
    if gpu().is_none() {
        return;
    }
    // St. Venant and Kirchhoff's law gives way when it is pressed below 1/√3 of its length: a bar that is pressed to half of
    // it has a tangent of negative curvature in its own direction, the only one that gravity pulls in.
    let squeezed = r#"
gravity = [2.0, 0.0, 0.0]
[time]
step = 0.5
end = 2.0
[integrator]
method = "implicit-euler"
[[body]]
name = "bar"
density = 10.0
[body.mesh]
generator = "bar"
size = [2.0, 1.0, 1.0]
cells = [2, 1, 1]
sections = [{ until = 1.0, element = "hex8" }]
[[body.material]]
law = "stvk"
young = 1e5
poisson = 0.0
[[body.fix]]
region = "x_min"
[[body.move]]
region = "x_max"
translation = { keys = [[0.0, [0, 0, 0]], [0.5, [-1.0, 0, 0]], [2.0, [-1.0, 0, 0]]] }
[[probe]]
name = "middle"
region = "all"
quantity = "displacement"
"#;
    for start in ["linear_solver.warm_start=true", "linear_solver.warm_start=false"] {
        let mut device = load(squeezed, &[start], "gpu").unwrap().0;
        let mut processor = load(squeezed, &[start], "cpu").unwrap().0;
        let mut met = 0;
        for _ in 0..3 {
            let (a, b) = (device.advance().unwrap(), processor.advance().unwrap());
            let says = |warnings: &[String], words: &str| warnings.iter().any(|w| w.contains(words));
            let [x, y] = [says(&a.warnings, "negative curvature"), says(&b.warnings, "NegativeCurvature")];
            assert_eq!(x, y, "{start}, step {}: {:?} and {:?}", a.step, a.warnings, b.warnings);
            if x {
                assert_eq!(a.cg_iterations, b.cg_iterations, "{start}, step {}", a.step);
            }
            met += usize::from(x && a.cg_iterations == 0);
            let (u, v) = (device.displacement(), processor.displacement());
            let largest = v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (u, v) in u.iter().zip(v) {
                assert!((u - v).abs() < 1e-4 * largest, "{start}, step {}: {u} and {v}", a.step);
            }
        }
        assert!(met > 0, "{start}: no solve met it in its first direction");
    }
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
