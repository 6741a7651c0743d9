//! Promises of the integrators: their orders, their energies, exact prescribed motion, failures that leave the state
//! alone, and snapshots that repeat the same bits.

mod systems;

use souple_solver::{Method, State, StepOptions, StepWorkspace, step};
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
