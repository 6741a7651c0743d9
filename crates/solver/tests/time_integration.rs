//! Promises of the integrators: their orders, their energies, exact prescribed motion, failures that leave the state
//! alone, and snapshots that repeat the same bits.

mod systems;

use souple_solver::{
    FailureKind, LinearStatus, Method, SecondOrder, State, StepOptions, StepStatus, StepWorkspace, WarmStart, step,
};
use systems::Chain;

fn newton() -> StepOptions {
    StepOptions {
        newton_iterations: 20,
        newton_tolerance: 1e-13,
        newton_absolute_tolerance: 1e-13,
        ..StepOptions::default()
    }
}

/// Runs to time `end` in `steps` steps.
fn run(chain: &mut Chain, start: &State, end: f64, steps: usize, method: Method, options: &StepOptions) -> State {
    let mut state = start.clone();
    let mut workspace = StepWorkspace::new(start.u.len(), method);
    let h = end / steps as f64;
    for k in 0..steps {
        let report = step(chain, &mut state, h, method, options, &mut workspace);
        assert!(report.advanced(), "step {k} of {}: {report:?}", method.name());
    }
    state
}

/// Largest difference of displacement and velocity.
fn distance(a: &State, b: &State) -> f64 {
    a.u.iter().chain(&a.v).zip(b.u.iter().chain(&b.v)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Slope of the error against the step over two halvings.
fn observed_order(
    chain: &mut Chain,
    start: &State,
    exact: &State,
    end: f64,
    coarse: usize,
    method: Method,
    options: &StepOptions,
) -> f64 {
    let errors = [coarse, 4 * coarse].map(|steps| distance(&run(chain, start, end, steps, method, options), exact));
    assert!(errors[1] > 1e-12, "{} is at rounding: {errors:?}", method.name());
    (errors[0] / errors[1]).ln() / 4f64.ln()
}

fn all_methods() -> Vec<Method> {
    let mut methods = Method::ALL.to_vec();
    methods.push(Method::Newmark { beta: 0.0, gamma: 0.5 });
    methods.push(Method::Newmark { beta: 0.3025, gamma: 0.6 });
    methods
}

/// On a damped linear oscillator every method converges to the closed form with its order.
#[test]
fn order_on_a_linear_oscillator() {
    let (omega, damping) = (2f64.sqrt(), 0.3);
    let mut chain = Chain::new(1);
    chain.mass_damping = damping;
    let start = State { u: vec![1.0], v: vec![0.0], ..State::default() };
    let end = 2.0;
    let (decay, ring) = (0.5 * damping, (omega * omega - 0.25 * damping * damping).sqrt());
    let envelope = (-decay * end).exp();
    let (sin, cos) = (ring * end).sin_cos();
    let exact = State {
        u: vec![envelope * (cos + decay / ring * sin)],
        v: vec![-envelope * (ring + decay * decay / ring) * sin],
        ..State::default()
    };
    for method in all_methods() {
        let order = observed_order(&mut chain, &start, &exact, end, 50, method, &StepOptions::default());
        assert!((order - method.order() as f64).abs() < 0.1, "{} has order {order}", method.name());
    }
}

/// On a chain of pendulums with hardening springs every method keeps its order, linearised once and with Newton, against
/// a reference computed with steps far smaller.
#[test]
fn order_on_a_nonlinear_chain() {
    let mut chain = Chain::new(4);
    chain.cubic = 2.0;
    chain.gravity = 1.5;
    chain.mass_damping = 0.1;
    chain.mass = vec![1.0, 0.5, 2.0, 1.0];
    let start = State { u: vec![0.9, -0.4, 0.2, 1.1], v: vec![0.0, 0.5, -0.3, 0.0], ..State::default() };
    let end = 1.0;
    let exact = run(&mut chain, &start, end, 4000, Method::Rk4, &StepOptions::default());
    for method in all_methods() {
        for options in [StepOptions::default(), newton()] {
            let order = observed_order(&mut chain, &start, &exact, end, 100, method, &options);
            let linearisations = options.newton_iterations;
            assert!(
                (order - method.order() as f64).abs() < 0.15,
                "{} with at most {linearisations} Newton iterations has order {order}",
                method.name()
            );
        }
    }
}

/// A chain in which everything is switched on: unequal masses, hardening springs, pendulums, both dampings, a mass
/// matrix that is not diagonal, and an end that is moved.
fn rich_chain() -> (Chain, State) {
    let mut chain = Chain::new(6);
    chain.mass = vec![1.0, 0.7, 1.3, 0.9, 1.1, 1.0];
    chain.cubic = 1.0;
    chain.gravity = 0.5;
    chain.mass_damping = 0.05;
    chain.spring_damping = 0.02;
    chain.mass_coupling = 0.1;
    chain.moved = vec![(5, |t| (0.3 * (2.0 * t).sin(), 0.6 * (2.0 * t).cos()))];
    let start =
        State { u: vec![0.3, -0.2, 0.1, 0.4, -0.1, 0.0], v: vec![0.0, 0.1, 0.0, -0.2, 0.0, 0.6], ..State::default() };
    (chain, start)
}

/// Moved unknowns are where and as fast as they are told, to the last bit, after every step of every method.
#[test]
fn prescribed_motion_is_exact() {
    for method in all_methods() {
        for options in [StepOptions::default(), newton()] {
            let (mut chain, mut state) = rich_chain();
            let mut workspace = StepWorkspace::new(6, method);
            for _ in 0..20 {
                let report = step(&mut chain, &mut state, 0.01, method, &options, &mut workspace);
                assert!(report.advanced(), "{}: {report:?}", method.name());
                let (_, motion) = chain.moved[0];
                assert_eq!((state.u[5], state.v[5]), motion(state.t), "{} at {}", method.name(), state.t);
            }
        }
    }
}

/// A moved end drives the rest of the chain with the order of the method: the known motion is on the right-hand side
/// as it should be, inertia included for implicit methods.
#[test]
fn moved_unknowns_keep_the_order() {
    for method in all_methods() {
        let (mut chain, start) = rich_chain();
        if method.is_explicit() {
            chain.mass_coupling = 0.0;
        }
        // The reference is of a method of another kind where there is one that feels the same inertia.
        let reference = if method.is_explicit() { Method::Rk4 } else { Method::ImplicitMidpoint };
        let exact =
            run(&mut chain, &start, 1.0, if method.is_explicit() { 2000 } else { 12_000 }, reference, &newton());
        let expected = method.order() as f64;
        for options in [StepOptions::default(), newton()] {
            let order = observed_order(&mut chain, &start, &exact, 1.0, 60, method, &options);
            assert!(
                (order - expected).abs() < 0.2,
                "{} with at most {} Newton iterations has order {order} instead of {expected}",
                method.name(),
                options.newton_iterations
            );
        }
    }
}

/// Starting each linear solve from the last acceleration saves iterations while the motion is smooth.
#[test]
fn warm_starts_save_iterations() {
    let iterations = |warm_start: WarmStart| {
        let mut chain = Chain::new(40);
        chain.stiffness = 100.0;
        chain.options.relative_tolerance = 1e-4;
        chain.mass = (0..40).map(|i| 1.0 + 0.5 * (i as f64 * 0.37).sin()).collect();
        chain.mass_damping = 0.2;
        let shape = |i: usize| (i as f64 * 0.0766).sin() + 0.4 * (i as f64 * 0.1532).sin();
        let mut state = State { u: (1..=40).map(shape).collect(), ..State::at_rest(40) };
        let options = StepOptions { warm_start, ..StepOptions::default() };
        let mut workspace = StepWorkspace::new(40, Method::ImplicitEuler);
        (0..50)
            .map(|_| {
                step(&mut chain, &mut state, 0.05, Method::ImplicitEuler, &options, &mut workspace).linear_iterations
            })
            .sum::<usize>()
    };
    let (cold, warm) = (iterations(WarmStart::Zero), iterations(WarmStart::Previous));
    assert!(10 * warm < 9 * cold, "{warm} iterations warm, {cold} cold");
}

/// The energy of symplectic Euler oscillates but does not drift over ten thousand steps, while explicit Euler blows up.
#[test]
fn symplectic_euler_keeps_its_energy() {
    let mut chain = Chain::new(5);
    chain.cubic = 0.5;
    let start = State { u: vec![0.1, 0.4, -0.2, 0.0, 0.3], v: vec![0.0; 5], ..State::default() };
    let energy = chain.energy(&start.u, &start.v);
    let (mut state, mut workspace) = (start.clone(), StepWorkspace::new(5, Method::SymplecticEuler));
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    for _ in 0..10_000 {
        let report =
            step(&mut chain, &mut state, 0.05, Method::SymplecticEuler, &StepOptions::default(), &mut workspace);
        assert!(report.advanced());
        let now = chain.energy(&state.u, &state.v) / energy;
        (low, high) = (low.min(now), high.max(now));
    }
    assert!(low > 0.9 && high < 1.1, "energy between {low} and {high} of the initial one");
    let end = run(&mut chain, &start, 200.0 * 0.05, 200, Method::ExplicitEuler, &StepOptions::default());
    assert!(chain.energy(&end.u, &end.v) > 2.0 * energy);
}

/// Implicit Euler loses energy at every step, at any step size.
#[test]
fn implicit_euler_damps() {
    let mut chain = Chain::new(5);
    for h in [0.01, 0.5, 50.0] {
        let mut state = State { u: vec![0.1, 0.4, -0.2, 0.0, 0.3], v: vec![0.0; 5], ..State::default() };
        let mut workspace = StepWorkspace::new(5, Method::ImplicitEuler);
        let mut before = chain.energy(&state.u, &state.v);
        for _ in 0..50 {
            step(&mut chain, &mut state, h, Method::ImplicitEuler, &StepOptions::default(), &mut workspace);
            let now = chain.energy(&state.u, &state.v);
            assert!(now < before || now < 1e-25, "energy rises from {before} to {now} with h = {h}");
            before = now;
        }
    }
}

/// The implicit midpoint rule and the average acceleration conserve a quadratic energy to rounding, at any step size.
#[test]
fn quadratic_energy_is_conserved() {
    for method in [Method::ImplicitMidpoint, Method::AVERAGE_ACCELERATION] {
        for h in [0.05, 1.0, 20.0] {
            let mut chain = Chain::new(5);
            let start =
                State { u: vec![0.1, 0.4, -0.2, 0.0, 0.3], v: vec![0.2, 0.0, 0.0, -0.1, 0.0], ..State::default() };
            let energy = chain.energy(&start.u, &start.v);
            let end = run(&mut chain, &start, 1000.0 * h, 1000, method, &StepOptions::default());
            let drift = chain.energy(&end.u, &end.v) / energy - 1.0;
            assert!(drift.abs() < 1e-9, "{} drifts by {drift} with h = {h}", method.name());
        }
    }
}

/// Implicit Euler linearised once satisfies its published equation,
/// (M − h ∂F/∂V − h² ∂F/∂U) ΔV = h F + h² (∂F/∂U) V, on a nonlinear damped chain.
#[test]
fn implicit_euler_solves_the_published_equation() {
    let (mut chain, start) = rich_chain();
    chain.moved.clear();
    let h = 0.1;
    let mut state = start.clone();
    let report = step(
        &mut chain,
        &mut state,
        h,
        Method::ImplicitEuler,
        &StepOptions::default(),
        &mut StepWorkspace::new(6, Method::ImplicitEuler),
    );
    assert_eq!((report.linear_solves, report.newton_iterations), (1, 1));
    let dv: Vec<f64> = state.v.iter().zip(&start.v).map(|(new, old)| new - old).collect();
    let (mut force, mut left, mut part) = (vec![0.0; 6], vec![0.0; 6], vec![0.0; 6]);
    chain.force(h, &start.u, &start.v, &mut force).expect("admissible");
    chain.linearise(h, &start.u, &start.v).expect("admissible");
    chain.mass_apply(&dv, &mut left);
    chain.damping_apply(&dv, &mut part);
    (0..6).for_each(|i| left[i] += h * part[i]);
    chain.stiffness_apply(&dv, &mut part);
    (0..6).for_each(|i| left[i] += h * h * part[i]);
    chain.stiffness_apply(&start.v, &mut part);
    for i in 0..6 {
        let right = h * force[i] - h * h * part[i];
        assert!((left[i] - right).abs() < 1e-13, "row {i}: {} is not {right}", left[i]);
        assert!((state.u[i] - start.u[i] - h * state.v[i]).abs() < 1e-15);
    }
}

/// With Newton the end of an implicit Euler step satisfies M (v₁ − v₀) = h F(u₁, v₁), also with steps so long that the
/// linearised step alone is far off.
#[test]
fn newton_finds_the_balance() {
    let (mut chain, start) = rich_chain();
    chain.moved.clear();
    chain.cubic = 50.0;
    let h = 1.0;
    let unbalance = |chain: &mut Chain, options: &StepOptions| {
        let mut state = start.clone();
        let report = step(
            chain,
            &mut state,
            h,
            Method::ImplicitEuler,
            options,
            &mut StepWorkspace::new(6, Method::ImplicitEuler),
        );
        assert_eq!(report.status, StepStatus::Completed);
        let dv: Vec<f64> = state.v.iter().zip(&start.v).map(|(new, old)| (new - old) / h).collect();
        let (mut inertia, mut force) = (vec![0.0; 6], vec![0.0; 6]);
        chain.mass_apply(&dv, &mut inertia);
        chain.force(h, &state.u, &state.v, &mut force).expect("admissible");
        inertia.iter().zip(&force).map(|(inertia, force)| (inertia - force).abs()).fold(0.0, f64::max)
    };
    let once = unbalance(&mut chain, &StepOptions::default());
    let iterated = unbalance(&mut chain, &newton());
    assert!(once > 1e-2 && iterated < 1e-10, "linearised once {once}, with Newton {iterated}");
}

/// Backward differences keep their order when the step changes all the time.
#[test]
fn bdf2_with_changing_steps() {
    let mut chain = Chain::new(1);
    let start = State { u: vec![1.0], v: vec![0.0], ..State::default() };
    let error = |chain: &mut Chain, steps: usize| {
        let (mut state, mut workspace) = (start.clone(), StepWorkspace::new(1, Method::Bdf2));
        for k in 0..steps {
            let h = 2.0 / steps as f64 * if k % 2 == 0 { 1.4 } else { 0.6 };
            step(chain, &mut state, h, Method::Bdf2, &StepOptions::default(), &mut workspace);
        }
        (state.u[0] - (2f64.sqrt() * state.t).cos()).abs()
    };
    let order = (error(&mut chain, 100) / error(&mut chain, 400)).ln() / 4f64.ln();
    assert!((order - 2.0).abs() < 0.1, "order {order}");
}

/// A run resumed from a copy of the state, with fresh workspaces, repeats the bits of the run that went on.
#[test]
fn snapshots_resume_with_the_same_bits() {
    for method in all_methods() {
        for options in
            [StepOptions::default(), newton(), StepOptions { warm_start: WarmStart::Zero, ..StepOptions::default() }]
        {
            let (mut chain, start) = rich_chain();
            let half = run(&mut chain, &start, 0.2, 10, method, &options);
            let snapshot = half.clone();
            let straight = run(&mut chain, &half, 0.2, 10, method, &options);
            let (mut fresh, _) = rich_chain();
            let resumed = run(&mut fresh, &snapshot, 0.2, 10, method, &options);
            let bits = |state: &State| state.u.iter().chain(&state.v).map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&straight), bits(&resumed), "{}", method.name());
            assert_eq!(straight, resumed);
        }
    }
}

/// A step into a forbidden state fails with the system's own words and place, and leaves the state untouched; so does a
/// step that overflows, and a step that is not a positive number.
#[test]
fn a_failed_step_leaves_the_state_alone() {
    for method in all_methods() {
        let mut chain = Chain::new(3);
        chain.longest = 0.5;
        let start = State { u: vec![0.0; 3], v: vec![0.0, 10.0, 0.0], ..State::default() };
        let mut workspace = StepWorkspace::new(3, method);
        let mut state = start.clone();
        let report = step(&mut chain, &mut state, 0.2, method, &StepOptions::default(), &mut workspace);
        let StepStatus::Failed(failure) = report.status else { panic!("{}: {report:?}", method.name()) };
        assert_eq!(failure.kind, FailureKind::Inadmissible);
        assert!(failure.place.is_some());
        assert_eq!(state, start);

        chain.longest = f64::INFINITY;
        chain.cubic = 1.0;
        state.u[1] = 1e200;
        let huge = state.clone();
        let report = step(&mut chain, &mut state, 0.2, method, &StepOptions::default(), &mut workspace);
        assert!(!report.advanced(), "{}: {report:?}", method.name());
        assert_eq!(state, huge);

        for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let report = step(&mut chain, &mut state, h, method, &StepOptions::default(), &mut workspace);
            assert!(!report.advanced(), "h = {h}");
            assert_eq!(state, huge);
        }
    }
}

/// Newton's line search rescues a step whose linearised solution lies in the forbidden domain.
#[test]
fn newton_rescues_an_inadmissible_start() {
    let mut chain = Chain::new(1);
    chain.cubic = 400.0;
    chain.longest = 0.35;
    let start = State { u: vec![0.0], v: vec![4.0], ..State::default() };
    let attempt = |chain: &mut Chain, options: &StepOptions| {
        let mut state = start.clone();
        let mut workspace = StepWorkspace::new(1, Method::ImplicitEuler);
        (step(chain, &mut state, 0.2, Method::ImplicitEuler, options, &mut workspace), state)
    };
    let (once, _) = attempt(&mut chain, &StepOptions::default());
    assert!(!once.advanced(), "the linearised step ignores the hardening: {once:?}");
    let (iterated, state) = attempt(&mut chain, &newton());
    assert_eq!(iterated.status, StepStatus::Completed);
    let u = state.u[0];
    let balance = (u / 0.2 - 4.0) / 0.2 + 2.0 * (u + 400.0 * u.powi(3));
    assert!(balance.abs() < 1e-9 && u < 0.35, "u = {u}, unbalanced {balance}");
}

/// Linear solves that stop early are kept and reported, not hidden.
#[test]
fn unconverged_solves_are_reported() {
    let (mut chain, mut state) = rich_chain();
    chain.options.max_iterations = 1;
    let mut workspace = StepWorkspace::new(6, Method::ImplicitEuler);
    let report = step(&mut chain, &mut state, 0.5, Method::ImplicitEuler, &StepOptions::default(), &mut workspace);
    assert!(report.advanced());
    assert_eq!(report.linear.expect("one solve").status, LinearStatus::MaxIterations);
    assert_eq!((report.linear_solves, report.linear_iterations), (1, 1));
}
