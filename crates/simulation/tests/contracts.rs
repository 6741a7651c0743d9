//! Promises of a simulation, whatever the scene: the same bits for any number of threads, checkpoints that continue
//! bit for bit, energy that stays, steps that are refused, failures that name what failed.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on says where")]

use souple_simulation::{Ending, ProbeValue, RunOptions, Simulation};

/// A small mixed bar: four kinds of elements, two laws, conforming interfaces.
const BAR: &str = r#"
gravity = [0.0, -9.81, 0.0]
[time]
step = 0.01
end = 0.1
[integrator]
method = "implicit-euler"
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
quantity = "mean displacement"
[[probe]]
name = "all"
quantity = ["energy", "kinetic energy", "volume"]
"#;

fn load(text: &str, overrides: &[&str], options: &RunOptions) -> Result<Simulation, String> {
    let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_string()).collect();
    let mut read = |name: &str| Err(format!("{name}: there are no files here"));
    Simulation::load(text, "scene.toml", &overrides, &mut read, options).map(|s| s.0).map_err(|e| e.to_string())
}

fn run(simulation: &mut Simulation) {
    while simulation.advance().unwrap().finished.is_none() {}
}

fn bits(simulation: &Simulation) -> Vec<u64> {
    simulation.displacement().iter().map(|x| x.to_bits()).collect()
}

/// One, two and five threads give the same bits, with assembled and with matrix-free products.
#[test]
fn threads_do_not_change_a_bit() {
    for operator in ["linear_solver.operator='assembled'", "linear_solver.operator='matrix-free'"] {
        let states: Vec<Vec<u64>> = [1, 2, 5]
            .into_iter()
            .map(|threads| {
                let options = RunOptions { threads, ..RunOptions::default() };
                let mut simulation = load(BAR, &[operator], &options).unwrap();
                run(&mut simulation);
                bits(&simulation)
            })
            .collect();
        assert!(states[0].iter().any(|&b| b != 0));
        assert!(states.iter().all(|s| *s == states[0]), "{operator}");
    }
}

/// The same on a mesh whose matrix has several parts and whose elements make several tasks, in double and in mixed
/// precision.
#[test]
fn threads_do_not_change_a_bit_of_a_larger_mesh() {
    for precision in ["linear_solver.precision='double'", "linear_solver.precision='mixed'"] {
        let state = |threads: usize| {
            let options = RunOptions { threads, ..RunOptions::default() };
            let overrides = ["body.bar.mesh.cells=[32, 8, 8]", "time.end=0.02", precision];
            let mut simulation = load(BAR, &overrides, &options).unwrap();
            run(&mut simulation);
            bits(&simulation)
        };
        let one = state(1);
        assert!(one.len() > 2 * 3 * 512 && one.iter().any(|&b| b != 0), "{} unknowns", one.len());
        for threads in [2, 3] {
            assert!(state(threads) == one, "{threads} threads, {precision}");
        }
    }
}

/// Assembled and matrix-free products are the same operator: trajectories agree to the solver's tolerance.
#[test]
fn assembled_and_matrix_free_agree() {
    let tip = |operator: &str| {
        let mut simulation = load(BAR, &[operator, "linear_solver.tolerance=1e-12"], &RunOptions::default()).unwrap();
        run(&mut simulation);
        match simulation.probes()["tip"]["mean displacement"] {
            ProbeValue::Vector(v) => v,
            _ => panic!("a mean displacement is a vector"),
        }
    };
    let (a, b) = (tip("linear_solver.operator='assembled'"), tip("linear_solver.operator='matrix-free'"));
    for k in 0..3 {
        assert!((a[k] - b[k]).abs() < 1e-9 * a[1].abs(), "{a:?} {b:?}");
    }
}

/// Every device that this machine has gives the same trajectory within rounding.
#[test]
fn devices_agree() {
    let state = |device: &str| {
        let options = RunOptions { device: device.into(), threads: 1 };
        load(BAR, &["linear_solver.tolerance=1e-12"], &options).map(|mut s| {
            run(&mut s);
            s.displacement().to_vec()
        })
    };
    let oracle = state("interpreter").unwrap();
    let size = oracle.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let mut compared = 0;
    for device in ["cpu", "cpu:avx512", "cpu:avx2", "cpu:baseline"] {
        if let Ok(u) = state(device) {
            compared += 1;
            assert!(u.iter().zip(&oracle).all(|(a, b)| (a - b).abs() < 1e-9 * size), "{device}");
        }
    }
    assert!(compared >= 2);
}

/// A run that stops, is written to bytes and goes on in another process ends in the same bits, for every method.
#[test]
fn checkpoints_continue_bit_for_bit() {
    for method in ["implicit-euler", "bdf2", "newmark", "implicit-midpoint"] {
        let set = format!("integrator.method='{method}'");
        let mut whole = load(BAR, &[&set], &RunOptions::default()).unwrap();
        let mut part = load(BAR, &[&set], &RunOptions::default()).unwrap();
        for _ in 0..4 {
            part.advance().unwrap();
        }
        let bytes = part.checkpoint();
        let mut rest = load(BAR, &[&set], &RunOptions::default()).unwrap();
        rest.restore(&bytes).unwrap();
        run(&mut whole);
        run(&mut rest);
        assert_eq!(bits(&whole), bits(&rest), "{method}");
    }
}

/// Bytes that are not a checkpoint, are truncated, or belong to another model are refused.
#[test]
fn bad_checkpoints_are_refused() {
    let mut simulation = load(BAR, &[], &RunOptions::default()).unwrap();
    let good = simulation.checkpoint();
    assert!(simulation.restore(b"hello").is_err());
    for end in [20, good.len() / 2, good.len() - 1] {
        assert!(simulation.restore(&good[..end]).is_err(), "{end} bytes");
    }
    let mut other = load(BAR, &["body.0.mesh.cells=[4, 1, 1]"], &RunOptions::default()).unwrap();
    let message = other.restore(&good).unwrap_err().to_string();
    assert!(message.contains("unknowns"), "{message}");
}

/// The symplectic integrator keeps the energy of a free vibration over ten thousand steps: it oscillates within a bound
/// that does not grow.
#[test]
fn symplectic_euler_conserves_energy() {
    let overrides = [
        "gravity=[0, 0, 0]",
        "integrator.method='symplectic-euler'",
        "body.0.mesh.cells=[4, 1, 1]",
        "body.0.initial_velocity=[0.0, 0.3, 0.1]",
        "time.step=2e-4",
        "time.end=2.0",
    ];
    let mut simulation = load(BAR, &overrides, &RunOptions { threads: 1, ..RunOptions::default() }).unwrap();
    let energy = |s: &mut Simulation| match s.probes()["all"]["energy"] {
        ProbeValue::Scalar(e) => e,
        _ => panic!("an energy is a number"),
    };
    let start = energy(&mut simulation);
    let mut early: f64 = 0.0;
    let mut late: f64 = 0.0;
    for step in 1..=10_000 {
        simulation.advance().unwrap();
        if step % 50 == 0 {
            let drift = (energy(&mut simulation) / start - 1.0).abs();
            if step <= 5_000 { early = early.max(drift) } else { late = late.max(drift) }
        }
    }
    assert!(early > 0.0 && early < 0.05, "the energy is off by {early}");
    assert!(late < 1.5 * early, "the error grows from {early} to {late}");
}

/// An explicit step beyond the critical one is refused, naming the critical step; a slightly smaller one than that runs.
#[test]
fn explicit_steps_are_checked() {
    let explicit = "integrator.method='symplectic-euler'";
    let message = load(BAR, &[explicit, "time.step=0.01"], &RunOptions::default()).err().unwrap();
    assert!(message.contains("critical step of") && message.contains("time.step"), "{message}");
    let limit: f64 = message.split("critical step of ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let step = format!("time.step={}", 0.98 * limit);
    let end = format!("time.end={}", 200.0 * limit);
    // A light load: the critical step is that of the state it was asked for.
    let gravity = "gravity=[0.0, -0.05, 0.0]";
    let mut simulation = load(BAR, &[explicit, &step, &end, gravity], &RunOptions::default()).unwrap();
    run(&mut simulation);
    assert!(simulation.displacement().iter().all(|x| x.abs() < 0.1));
}

/// A run that diverges stops, names element and time, and keeps the last good state.
#[test]
fn divergence_is_reported() {
    let overrides = [
        "integrator.method='symplectic-euler'",
        "time.step=0.01",
        "time.end=10.0",
        "integrator.allow_unstable_step=true",
    ];
    let mut simulation = load(BAR, &overrides, &RunOptions::default()).unwrap();
    let error = loop {
        match simulation.advance() {
            Ok(progress) => assert!(progress.finished.is_none(), "it must not survive"),
            Err(error) => break error.to_string(),
        }
    };
    assert!(
        error.contains("t = ") && error.contains("of body `bar`") && error.contains("smaller time step"),
        "{error}"
    );
    assert!(simulation.displacement().iter().all(|x| x.is_finite()));
    assert_eq!(simulation.advance().unwrap().finished, Some(Ending::Failed));
    assert!(!simulation.frame().unwrap().is_empty());
}

/// A scene that asks to stop at rest does, before its end.
#[test]
fn rest_is_noticed() {
    let text = BAR.replace("end = 0.1", "end = 100.0\n[time.stop]\nmean_kinetic_energy = 1e-6\ncheck_every = 0.1");
    let overrides = ["integrator.velocity_damping=20.0", "time.step=0.02"];
    let mut simulation = load(&text, &overrides, &RunOptions::default()).unwrap();
    let mut last = simulation.advance().unwrap();
    while last.finished.is_none() {
        last = simulation.advance().unwrap();
    }
    assert_eq!(last.finished, Some(Ending::AtRest));
    assert!(last.time < 50.0);
}

/// A clamped bar whose end is turned keeps its clamped nodes exactly and follows the turn exactly.
#[test]
fn moved_regions_follow_exactly() {
    let turn = "[[body.move]]\nregion = \"x_max\"\n\
        rotation = { axis = [1, 0, 0], through = [4, 0.5, 0.5], keys = [[0.0, 0.0], [0.1, 30.0]] }\n[[probe]]";
    let text = BAR.replacen("[[probe]]", turn, 1).replace("[0.0, -9.81, 0.0]", "[0.0, 0.0, 0.0]");
    for method in ["implicit-euler", "quasi-static"] {
        let set = format!("integrator.method='{method}'");
        let mut simulation = load(&text, &[&set], &RunOptions::default()).unwrap();
        run(&mut simulation);
        // Corner (4, 0, 0): arm (−½, −½) turned by 30° about x.
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let expected = [0.0, -0.5 * cos + 0.5 * sin + 0.5, -0.5 * sin - 0.5 * cos + 0.5];
        let u = &simulation.displacement()[8 * 3..9 * 3];
        assert!(u.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{method}: {u:?}, not {expected:?}");
        assert_eq!(simulation.displacement()[..3], [0.0; 3], "{method}");
    }
}

/// A law written in a scene moves like the built-in law with the same energy, to 1e-12 of the displacement.
#[test]
fn a_written_law_equals_the_built_in_one() {
    let built_in = "law = \"mooney-rivlin\"\nc10 = 1e5\nc01 = 4e4\nbulk = 1e6\n[[body.fix]]";
    let written =
        "energy = \"c1*(I1bar - 3) + c2*(I2bar - 3) + k/2*(J - 1)^2\"\nc1 = 1e5\nc2 = 4e4\nk = 1e6\n[[body.fix]]";
    let materials = BAR.find("[[body.material]]").unwrap()..BAR.find("[[body.fix]]\n").unwrap() + "[[body.fix]]".len();
    let state = |material: &str| {
        let mut text = BAR.to_string();
        text.replace_range(materials.clone(), &format!("[[body.material]]\n{material}"));
        let mut simulation = load(&text, &["linear_solver.method='direct'"], &RunOptions::default()).unwrap();
        run(&mut simulation);
        simulation.displacement().to_vec()
    };
    let (a, b) = (state(built_in), state(written));
    let size = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(size > 1e-3, "it moves");
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * size));
}

/// Every linear solver and preconditioner gives the same trajectory within its tolerance.
#[test]
fn linear_solvers_agree() {
    let state = |overrides: &[&str]| {
        let all: Vec<&str> = overrides.iter().copied().chain(["linear_solver.tolerance=1e-12"]).collect();
        let mut simulation = load(BAR, &all, &RunOptions::default()).unwrap();
        run(&mut simulation);
        simulation.displacement().to_vec()
    };
    let direct = state(&["linear_solver.method='direct'"]);
    let size = direct.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(size > 1e-3, "it moves");
    for preconditioner in ["none", "jacobi", "block-jacobi", "incomplete-cholesky"] {
        let u = state(&[&format!("linear_solver.preconditioner='{preconditioner}'")]);
        let gap = u.iter().zip(&direct).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(gap <= 1e-8 * size, "{preconditioner}: {gap:e} of {size:e}");
    }
}

/// Tangents made positive change the way to an equilibrium and not the equilibrium.
#[test]
fn projected_tangents_find_the_same_equilibrium() {
    let ends = ["exact", "projected"].map(|tangent| {
        let tangent = format!("integrator.tangent={tangent}");
        let overrides = ["integrator.method=quasi-static", "integrator.newton_tolerance=1e-9", &tangent];
        let mut simulation = load(BAR, &overrides, &RunOptions::default()).unwrap();
        run(&mut simulation);
        simulation.displacement().to_vec()
    });
    let largest = ends[0].iter().fold(0.0f64, |m, x| m.max(x.abs()));
    assert!(largest > 0.1, "the bar bends: {largest}");
    for (exact, projected) in ends[0].iter().zip(&ends[1]) {
        assert!((exact - projected).abs() < 1e-6 * largest, "{exact} and {projected}");
    }
}

/// A cube of a law for which inverted states have no meaning, crushed by a load far too large for one step: whatever
/// Newton's method makes of it, no state that it keeps is inside out. The energy has a number for inverted states (it
/// is one of I3 = J²), so that nothing but the refusal keeps the line search from them.
#[test]
fn no_state_is_kept_that_the_law_does_not_know() {
    for pressure in ["3e5", "1e6", "1e7"] {
        let text = format!(
            r#"
gravity = [0.0, 0.0, 0.0]
[time]
step = 1.0
end = 1.0
[integrator]
method = "quasi-static"
[linear_solver]
method = "direct"
[[body]]
name = "cube"
density = 1000.0
[body.mesh]
generator = "bar"
size = [1.0, 1.0, 1.0]
cells = [2, 2, 2]
element = "tet4"
[[body.material]]
energy = "mu/2*(I1 - 3) - mu/2*ln(I3) + lambda/8*ln(I3)^2"
mu = 1e5
lambda = 1e5
[[body.fix]]
region = "x_min"
[[body.traction]]
region = "x_max"
traction = [-{pressure}, 0.0, 0.0]
"#
        );
        let mut simulation = load(&text, &[], &RunOptions::default()).unwrap();
        match simulation.advance() {
            Ok(progress) => assert!(progress.warnings.is_empty(), "pressure {pressure}: {:?}", progress.warnings),
            // The state is still the one at rest: nothing was kept.
            Err(_) => assert!(simulation.displacement().iter().all(|u| *u == 0.0), "pressure {pressure}"),
        }
    }
}

/// A matrix in single precision takes nothing from the result: steps end where those with the matrix in double precision
/// end, as far as the tolerance of the linear solves goes, and with the same bits for any number of threads.
#[test]
fn mixed_precision_keeps_the_tolerance() {
    let end = |precision: &str, threads: usize| {
        let precision = format!("linear_solver.precision={precision}");
        let options = RunOptions { threads, ..RunOptions::default() };
        let mut simulation = load(BAR, &["linear_solver.tolerance=1e-9", &precision], &options).unwrap();
        run(&mut simulation);
        simulation.displacement().to_vec()
    };
    let (double, mixed) = (end("double", 1), end("mixed", 1));
    assert_eq!(mixed, end("mixed", 2));
    assert_ne!(double, mixed, "the matrix in single precision was used");
    let largest = double.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for (double, mixed) in double.iter().zip(&mixed) {
        assert!((double - mixed).abs() < 1e-7 * largest, "{double} and {mixed}");
    }
}
