//! Promises of the critical step: the frequency of a chain is its closed form, and the bound of each method is sharp —
//! a hair below it nothing grows, a hair above it something does.

mod systems;

use souple_solver::{
    LanczosOptions, Method, SecondOrder, State, StepBound, StepOptions, StepWorkspace, critical_step, stable_step, step,
};
use std::f64::consts::PI;
use systems::Chain;

const SHARP: LanczosOptions = LanczosOptions { relative_tolerance: 1e-12, max_products: 400 };

/// ω = 2 √(k/m) sin(n π / (2 (n + 1))) for a chain of n masses between walls; with an end held, one mass fewer.
#[test]
fn frequency_of_a_chain() {
    for (n, k, m) in [(1, 4.0, 1.0), (2, 1.0, 1.0), (7, 2.5, 0.3), (60, 1e6, 1e-3)] {
        for held in [0, 1] {
            let mut chain = Chain::new(n + held);
            chain.stiffness = k;
            chain.mass.fill(m);
            if held == 1 {
                chain.moved = vec![(0, |_| (0.0, 0.0))];
            }
            let rest = vec![0.0; n + held];
            let found = critical_step(&mut chain, 0.0, &rest, &rest, Method::SymplecticEuler, &SHARP).expect("a chain");
            let expected = 2.0 * f64::sqrt(k / m) * (n as f64 * PI / (2.0 * (n as f64 + 1.0))).sin();
            assert!(found.converged, "{found:?}");
            assert!((found.frequency / expected - 1.0).abs() < 1e-9, "n = {n}: {} is not {expected}", found.frequency);
            let StepBound::UpTo(h) = found.bound else { panic!("{found:?}") };
            assert!((h * expected / 2.0 - 1.0).abs() < 1e-9);
        }
    }
}

/// A rough tolerance costs far fewer products than unknowns and errs on the short side by little.
#[test]
fn a_rough_estimate_is_safe_and_cheap() {
    let n = 2000;
    let mut chain = Chain::new(n);
    let rest = vec![0.0; n];
    let found = critical_step(&mut chain, 0.0, &rest, &rest, Method::SymplecticEuler, &LanczosOptions::default())
        .expect("a chain");
    let exact = 2.0 * (n as f64 * PI / (2.0 * (n as f64 + 1.0))).sin();
    assert!(found.converged && found.products < 150, "{found:?}");
    assert!(found.frequency > 0.995 * exact && found.frequency < 1.01 * exact, "{found:?} against {exact}");
}

/// The largest amplitude over the second half of a long run.
fn amplitude(chain: &mut Chain, h: f64, method: Method) -> f64 {
    let n = chain.len();
    // Excites every mode.
    let mut state = State { u: (0..n).map(|i| if i % 2 == 0 { 1.0 } else { -0.9 }).collect(), ..State::at_rest(n) };
    state.u[0] = 1.3;
    let mut workspace = StepWorkspace::new(n, method);
    let steps = 6000;
    let mut largest = 0.0f64;
    for k in 0..steps {
        if !step(chain, &mut state, h, method, &StepOptions::default(), &mut workspace).advanced() {
            return f64::INFINITY;
        }
        if k > steps / 2 {
            largest = state.u.iter().fold(largest, |largest, u| largest.max(u.abs()));
        }
    }
    largest
}

/// Run at 0.98 and 1.05 of the reported bound: bounded and growing. For explicit methods and Newmark's explicit member,
/// without damping and with damping of either kind.
#[test]
fn bounds_are_sharp() {
    let methods = [
        Method::ExplicitEuler,
        Method::SymplecticEuler,
        Method::Rk2,
        Method::Rk4,
        Method::Newmark { beta: 0.0, gamma: 0.5 },
        Method::Newmark { beta: 0.1, gamma: 0.5 },
    ];
    for method in methods {
        for (mass_damping, spring_damping) in [(0.0, 0.0), (0.3, 0.0), (0.0, 0.2), (0.0, 3.0)] {
            let mut chain = Chain::new(4);
            chain.mass_damping = mass_damping;
            chain.spring_damping = spring_damping;
            let rest = [0.0; 4];
            let found = critical_step(&mut chain, 0.0, &rest, &rest, method, &SHARP).expect("a chain");
            let damped = mass_damping + spring_damping > 0.0;
            let case = format!("{} with damping {mass_damping}, {spring_damping}: {found:?}", method.name());
            match found.bound {
                StepBound::UpTo(h) => {
                    let below = amplitude(&mut chain, 0.98 * h, method);
                    assert!(below < 10.0, "{case}: amplitude {below} below the bound");
                    // Newmark's bound leaves out what damping adds, and the two largest values together are cautious
                    // where they belong to different modes.
                    let sharp = !damped || !matches!(method, Method::Newmark { .. });
                    if sharp {
                        let above = amplitude(&mut chain, 1.05 * h, method);
                        assert!(above > 10.0, "{case}: amplitude {above} above the bound");
                    }
                }
                StepBound::NoStep => {
                    assert!(!damped && matches!(method, Method::ExplicitEuler | Method::Rk2), "{case}");
                    assert!(amplitude(&mut chain, 0.1, method) > 1.5, "{case}");
                }
                StepBound::Unconditional => panic!("{case}"),
            }
        }
    }
}

/// Closed forms of the single mode: RK4 on the imaginary axis, everything on the real one, no limit where nothing moves.
#[test]
fn bounds_of_a_single_mode() {
    let close =
        |bound: StepBound, expected: f64| matches!(bound, StepBound::UpTo(h) if (h / expected - 1.0).abs() < 1e-9);
    assert!(close(stable_step(Method::Rk4, 10.0, 0.0), 8f64.sqrt() / 10.0));
    assert!(close(stable_step(Method::Rk2, 0.0, 5.0), 2.0 / 5.0));
    assert!(close(stable_step(Method::ExplicitEuler, 0.0, 5.0), 2.0 / 5.0));
    assert!(close(stable_step(Method::SymplecticEuler, 10.0, 0.0), 0.2));
    assert_eq!(stable_step(Method::ExplicitEuler, 10.0, 0.0), StepBound::NoStep);
    assert_eq!(stable_step(Method::Rk2, 10.0, 0.0), StepBound::NoStep);
    for method in Method::ALL {
        assert_eq!(stable_step(method, 0.0, 0.0), StepBound::Unconditional);
        if !method.is_explicit() {
            assert_eq!(stable_step(method, 1e9, 3.0), StepBound::Unconditional);
        }
    }
}
