//! Touching a running simulation: what hands, tools and knobs do, and that a session is repeated to the last bit.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use souple_simulation::interaction::{Pull, Tool};
use souple_simulation::session::{Change, Command, Session, SessionOptions, replay};
use souple_simulation::{RunOptions, Simulation};
use std::sync::mpsc::channel;
use std::time::Duration;

/// A bar of one kind of element, held at one end, without gravity.
fn bar(more: &str) -> Simulation {
    let text = format!(
        r#"
        {more}
        [time]
        step = 0.01
        end = 100.0
        [integrator]
        method = "implicit-euler"
        velocity_damping = 5.0
        [[body]]
        name = "bar"
        density = 1000.0
        mesh = {{ generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], element = "hex8" }}
        material = [{{ law = "stvk", young = "50 kPa", poisson = 0.3 }}]
        fix = [{{ region = "x_min" }}]
        "#
    );
    load(&text)
}

fn load(text: &str) -> Simulation {
    let mut read = |file: &str| Err(format!("no file {file}"));
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    Simulation::load(text, "test.toml", &[], &mut read, &options).unwrap().0
}

/// The node nearest to a point at rest.
fn node_at(simulation: &Simulation, point: [f64; 3]) -> u32 {
    let distance = |n: &[f64; 3]| (0..3).map(|k| (n[k] - point[k]).powi(2)).sum::<f64>();
    let nodes = &simulation.prepared().nodes;
    (0..nodes.len()).min_by(|&a, &b| distance(&nodes[a]).total_cmp(&distance(&nodes[b]))).unwrap() as u32
}

fn pull(simulation: &Simulation, stiffness: f64) -> Change {
    let node = node_at(simulation, [0.4, 0.1, 0.1]);
    Change::Pull { number: 0, pull: Pull { anchor: vec![(node, 1.0)], target: [0.4, 0.2, 0.1], stiffness } }
}

fn steps(simulation: &mut Simulation, count: usize) {
    (0..count).for_each(|_| drop(simulation.advance().unwrap()));
}

/// Sum over fixed nodes of what holds them, from the balance of a body at rest: minus all other forces.
fn rest_of(simulation: &mut Simulation) {
    for _ in 0..2000 {
        if simulation.advance().unwrap().kinetic_energy < 1e-14 {
            return;
        }
    }
    panic!("the body did not come to rest");
}

/// A pulled corner comes towards the hand, the further the stiffer the spring; let go, the bar comes back.
#[test]
fn a_pull_moves_the_body_and_lets_it_go() {
    let mut reached = Vec::new();
    for stiffness in [1.0, 10.0, 1e6] {
        let mut simulation = bar("");
        let change = pull(&simulation, stiffness);
        change.make(&mut simulation).unwrap();
        rest_of(&mut simulation);
        let state = simulation.pull(0).unwrap();
        let force = state.force[1];
        assert!(force > 0.0, "{stiffness}: {state:?}");
        assert!((force - stiffness * (0.2 - state.point[1])).abs() <= 1e-9 * stiffness);
        reached.push(state.point[1]);
        Change::Release { number: 0 }.make(&mut simulation).unwrap();
        rest_of(&mut simulation);
        assert!(simulation.displacement().iter().all(|u| u.abs() < 1e-5));
    }
    assert!(reached.windows(2).all(|w| w[0] < w[1]) && (reached[2] - 0.2).abs() < 1e-4, "{reached:?}");
}

/// A spring far stiffer than the body stays stable with every way to multiply by the matrix, and all agree.
#[test]
fn stiff_springs_agree_between_operators() {
    let mut ends = Vec::new();
    for operator in ["assembled", "matrix-free"] {
        let mut simulation =
            bar(&format!("[linear_solver]\noperator = \"{operator}\"\ntolerance = 1e-12\nmax_iterations = 5000"));
        pull(&simulation, 1e5).make(&mut simulation).unwrap();
        steps(&mut simulation, 50);
        ends.push(simulation.displacement().to_vec());
    }
    let apart = ends[0].iter().zip(&ends[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart}");
}

/// A sphere pressed onto the bar pushes it away, and feels the force that the bar's clamp must take: without gravity and
/// at rest, the reaction there is minus the force on the tool's counterpart.
#[test]
fn a_tool_pushes_and_feels_the_body() {
    for capsule in [false, true] {
        let mut simulation = bar("[[probe]]\nname = \"clamp\"\nregion = \"x_min\"\nquantity = \"reaction\"");
        let half = if capsule { 0.03 } else { 0.0 };
        let ends = [[0.35, 0.14, 0.05 - half], [0.35, 0.14, 0.05 + half]];
        let tool = Tool { ends, velocity: [0.0; 3], radius: 0.05, stiffness: 2e4, damping: 1.0 };
        Change::Tool(Some(tool)).make(&mut simulation).unwrap();
        rest_of(&mut simulation);
        let force = simulation.tool_force();
        assert!(force[1] > 1e-3, "{force:?}");
        let u = simulation.displacement();
        let below = node_at(&simulation, [0.3, 0.1, 0.05]) as usize;
        assert!(u[3 * below + 1] < -1e-4, "{}", u[3 * below + 1]);
        let probes = simulation.probes();
        let souple_simulation::ProbeValue::Vector(reaction) = probes["clamp"]["reaction"] else { panic!() };
        assert!((reaction[1] - force[1]).abs() < 1e-3 * force[1], "clamp {reaction:?}, tool {force:?}");
        Change::Tool(None).make(&mut simulation).unwrap();
        rest_of(&mut simulation);
        assert!(simulation.displacement().iter().all(|u| u.abs() < 1e-5));
    }
}

/// A held face stays where it was taken; a freed clamp lets the bar fall.
#[test]
fn regions_are_held_and_freed() {
    let mut simulation = bar("gravity = [0.0, -9.81, 0.0]");
    steps(&mut simulation, 20);
    let tip = node_at(&simulation, [0.4, 0.0, 0.0]);
    let at = |s: &Simulation| s.displacement()[3 * tip as usize + 1];
    let before = at(&simulation);
    Change::Hold(vec![tip]).make(&mut simulation).unwrap();
    steps(&mut simulation, 20);
    assert_eq!(at(&simulation), before);
    let clamp: Vec<u32> = (0..simulation.prepared().nodes.len() as u32)
        .filter(|&n| simulation.prepared().nodes[n as usize][0] == 0.0)
        .collect();
    let mut let_go = clamp.clone();
    let_go.push(tip);
    Change::Free(let_go).make(&mut simulation).unwrap();
    steps(&mut simulation, 20);
    let mean: f64 = clamp.iter().map(|&n| simulation.displacement()[3 * n as usize + 1]).sum::<f64>();
    assert!(mean / (clamp.len() as f64) < -0.05, "the bar does not fall: {mean}");
}

/// New parameters give what a scene with these parameters gives, and so do gravity and damping.
#[test]
fn changes_are_what_a_scene_would_say() {
    let settings = "gravity = [0.0, -9.81, 0.0]";
    let mut changed = bar(settings);
    Change::Parameter { block: 0, parameter: 0, value: 2e4 }.make(&mut changed).unwrap();
    Change::Gravity([0.0, 0.0, 3.0]).make(&mut changed).unwrap();
    Change::VelocityDamping(1.0).make(&mut changed).unwrap();
    let text = r#"
        gravity = [0.0, 0.0, 3.0]
        time = { step = 0.01, end = 100.0 }
        integrator = { method = "implicit-euler", velocity_damping = 1.0 }
        [[body]]
        name = "bar"
        density = 1000.0
        mesh = { generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], element = "hex8" }
        material = [{ law = "stvk", young = "20 kPa", poisson = 0.3 }]
        fix = [{ region = "x_min" }]
        "#;
    let mut written = load(text);
    steps(&mut changed, 30);
    steps(&mut written, 30);
    assert_eq!(changed.displacement(), written.displacement());
}

/// Half the step makes half the time, from where it was changed.
#[test]
fn the_step_can_be_changed() {
    let mut simulation = bar("gravity = [0.0, -9.81, 0.0]");
    steps(&mut simulation, 10);
    Change::TimeStep(0.005).make(&mut simulation).unwrap();
    steps(&mut simulation, 10);
    assert!((simulation.time() - 0.15).abs() < 1e-15);
}

/// What cannot be is refused in words, and changes nothing.
#[test]
fn impossible_changes_are_refused() {
    let mut simulation = bar("");
    let before = simulation.controls().clone();
    for (change, word) in [
        (Change::TimeStep(0.0), "time step"),
        (Change::Parameter { block: 0, parameter: 1, value: 0.7 }, "poisson"),
        (Change::Parameter { block: 3, parameter: 0, value: 0.7 }, "block 3"),
        (Change::Gravity([f64::NAN, 0.0, 0.0]), "gravity"),
        (Change::Hold(vec![9999]), "9999"),
        (Change::Free(vec![9999]), "9999"),
        (pull(&bar(""), -1.0), "stiffness"),
    ] {
        let error = change.make(&mut simulation).unwrap_err().to_string();
        assert!(error.contains(word), "{change:?}: {error}");
        assert_eq!(*simulation.controls(), before);
    }
}

/// A fresh session over a bar, with something to wait for its snapshots by.
fn session(playing: bool) -> (Session, std::sync::mpsc::Receiver<()>) {
    let (waker, woken) = channel();
    let options = SessionOptions { playing, speed: None, ..SessionOptions::default() };
    // Nobody is woken any more once the test has what it wants.
    let wake = Box::new(move || {
        let _ = waker.send(());
    });
    (Session::start(bar("gravity = [0.0, -9.81, 0.0]"), Vec::new(), options, wake).unwrap(), woken)
}

/// Waits until a snapshot is as wanted.
fn until(session: &mut Session, woken: &std::sync::mpsc::Receiver<()>, wanted: impl Fn(u64, bool) -> bool) -> u64 {
    loop {
        let snapshot = session.snapshot();
        if wanted(snapshot.step, snapshot.playing) {
            return snapshot.step;
        }
        woken.recv_timeout(Duration::from_secs(60)).expect("the session goes on");
    }
}

/// A session that was pulled, pushed and changed at steps that only the clock decided is repeated without it, bit for bit.
#[test]
fn a_session_is_repeated_to_the_last_bit() {
    let (mut live, woken) = session(true);
    let shape = bar("");
    live.send(Command::Change(pull(&shape, 200.0)));
    let step = until(&mut live, &woken, |step, _| step > 5);
    live.send(Command::Change(Change::Parameter { block: 0, parameter: 0, value: 3e4 }));
    let tool = Tool { ends: [[0.3, 0.13, 0.05]; 2], velocity: [0.0; 3], radius: 0.04, stiffness: 1e4, damping: 0.5 };
    live.send(Command::Change(Change::Tool(Some(tool))));
    until(&mut live, &woken, |now, _| now > step + 5);
    live.send(Command::Change(Change::TimeStep(0.008)));
    live.send(Command::Change(Change::Hold(vec![node_at(&shape, [0.4, 0.0, 0.0])])));
    live.send(Command::Change(Change::Release { number: 0 }));
    live.send(Command::Step(7));
    until(&mut live, &woken, |_, playing| !playing);
    let (checkpoint, script) = live.state().unwrap();
    assert_eq!(script.len(), 6);
    let last = live.snapshot().step;
    let mut headless = bar("gravity = [0.0, -9.81, 0.0]");
    headless.run_on();
    replay(&mut headless, &script, last).unwrap();
    assert!(headless.checkpoint() == checkpoint, "another trajectory");
}

/// A checkpoint carries what was changed by hand: a run that begins with it takes the same steps, to the last bit. One
/// without changes undoes those that were made since, and a damaged one changes nothing.
#[test]
fn checkpoints_carry_what_was_changed_by_hand() {
    let mut live = bar("gravity = [0.0, -9.81, 0.0]");
    live.run_on();
    let untouched = live.checkpoint();
    steps(&mut live, 3);
    let corner = node_at(&live, [0.4, 0.0, 0.0]);
    let tool = Tool { ends: [[0.3, 0.13, 0.05]; 2], velocity: [0.0; 3], radius: 0.04, stiffness: 1e4, damping: 0.5 };
    let changes = [
        pull(&live, 123.456_789_012_345_67),
        Change::Gravity([0.1, -1.6, 0.3]),
        Change::TimeStep(0.007),
        Change::VelocityDamping(0.3),
        Change::Parameter { block: 0, parameter: 0, value: 1e5 / 3.0 },
        Change::Tool(Some(tool)),
        Change::Hold(vec![corner]),
        Change::Free(vec![node_at(&live, [0.0, 0.0, 0.0])]),
    ];
    changes.iter().for_each(|change| change.make(&mut live).unwrap());
    steps(&mut live, 4);
    assert_eq!(live.changed_by_hand().words().len(), 8);
    let checkpoint = live.checkpoint();

    let mut resumed = bar("gravity = [0.0, -9.81, 0.0]");
    resumed.run_on();
    resumed.restore(&checkpoint).unwrap();
    assert_eq!(resumed.controls(), live.controls());
    steps(&mut live, 5);
    steps(&mut resumed, 5);
    assert!(resumed.checkpoint() == live.checkpoint(), "another trajectory");

    for end in [25, 40, checkpoint.len() - 8] {
        let before = resumed.controls().clone();
        assert!(resumed.restore(&checkpoint[..end]).is_err(), "{end} bytes");
        assert_eq!(*resumed.controls(), before);
    }
    resumed.restore(&untouched).unwrap();
    assert!(resumed.changed_by_hand().is_empty());
    assert!(resumed.checkpoint() == untouched);
}

/// Pause stops time, steps by number make exactly these, and going back shows the past; going on from there forgets what
/// came after.
#[test]
fn time_obeys() {
    let (mut session, woken) = session(false);
    session.send(Command::Step(12));
    until(&mut session, &woken, |step, playing| step == 12 && !playing);
    let (later, _) = session.state().unwrap();
    session.send(Command::Change(Change::Gravity([0.0; 3])));
    session.send(Command::Step(8));
    until(&mut session, &woken, |step, playing| step == 20 && !playing);
    session.send(Command::Seek(12));
    until(&mut session, &woken, |step, _| step == 12);
    assert!(session.state().unwrap().0 == later, "going back leads elsewhere");
    assert_eq!(session.snapshot().history.last, 20);
    session.send(Command::Seek(20));
    until(&mut session, &woken, |step, _| step == 20);
    session.send(Command::Seek(5));
    session.send(Command::Step(1));
    until(&mut session, &woken, |step, playing| step == 6 && !playing);
    assert_eq!(session.snapshot().history.last, 6);
    assert!(session.state().unwrap().1.is_empty());
    session.send(Command::Reset);
    until(&mut session, &woken, |step, _| step == 0);
    let (start, _) = session.state().unwrap();
    assert!(start == bar("gravity = [0.0, -9.81, 0.0]").checkpoint());
}

/// A recording is a series of one list and as many frames as it says.
#[test]
fn recordings_are_series() {
    let folder = std::env::temp_dir().join(format!("souple-recording-{}", std::process::id()));
    let (mut session, woken) = session(false);
    session.send(Command::Record(Some((folder.clone(), 0.05))));
    session.send(Command::Step(20));
    until(&mut session, &woken, |step, playing| step == 20 && !playing);
    assert_eq!(session.snapshot().recorded, Some(5));
    session.send(Command::Save(folder.join("checkpoint.bin")));
    let (checkpoint, _) = session.state().unwrap();
    drop(session);
    let list = std::fs::read_to_string(folder.join("bar.pvd")).unwrap();
    assert_eq!(list.matches("<DataSet").count(), 5);
    assert!((0..5).all(|n| folder.join(format!("bar_{n:04}.vtu")).is_file()));
    assert!(std::fs::read(folder.join("checkpoint.bin")).unwrap() == checkpoint);
    std::fs::remove_dir_all(folder).unwrap();
}

/// Without a thread nothing happens but where `work` is called: what was asked for, and one step at least. The steps lead
/// to the same state as those of a thread, to the last bit, and a time that was asked for is reached and not passed.
#[test]
fn a_session_without_a_thread_makes_the_same_steps() {
    let (mut threaded, woken) = session(false);
    let options = SessionOptions { playing: false, speed: None, ..SessionOptions::default() };
    let simulation = bar("gravity = [0.0, -9.81, 0.0]");
    let mut here = Session::start_here(simulation, Vec::new(), options, Box::new(|| {}));
    let ask = |session: &Session| {
        session.send(Command::Change(pull(&bar(""), 200.0)));
        session.send(Command::Step(5));
    };
    ask(&threaded);
    ask(&here);
    assert_eq!(here.snapshot().number, 0);
    for step in 1..=5 {
        let wait = here.work(Duration::ZERO);
        assert_eq!((here.snapshot().step, here.snapshot().playing), (step, step < 5));
        assert_eq!(wait, (step < 5).then_some(Duration::ZERO));
    }
    assert_eq!((here.work(Duration::from_secs(60)), here.snapshot().step), (None, 5));
    for session in [&threaded, &here] {
        session.send(Command::Until(0.2));
    }
    assert_eq!(here.work(Duration::from_secs(60)), None);
    assert!((here.snapshot().time - 0.2).abs() < 1e-9);
    until(&mut threaded, &woken, |step, playing| step == 20 && !playing);
    assert!(here.state().unwrap() == threaded.state().unwrap(), "another trajectory");
    // A time that has passed is reached already.
    here.send(Command::Until(0.1));
    assert_eq!((here.work(Duration::ZERO), here.snapshot().step, here.snapshot().playing), (None, 20, false));
}
