//! Promises of Newton's method and of load stepping: quadratic convergence, line searches that rescue, states that are
//! never inadmissible, and an honest answer at a limit point.

use souple_solver::{
    Failure, LinearReport, LoadProblem, NewtonOptions, NewtonOutcome, NewtonProblem, NewtonStatus, NewtonWorkspace,
    Predictor, QuasiStaticOptions, QuasiStaticStatus, newton, quasi_static,
};
use std::ops::ControlFlow;

fn solve(problem: &mut dyn NewtonProblem, x: &mut [f64], options: &NewtonOptions) -> NewtonOutcome {
    newton(problem, x, options, &mut NewtonWorkspace::new(x.len()), &mut |_| ControlFlow::Continue(()))
}

/// Unknowns that do not couple: r_i = g(x_i), with the energy if `with_energy`.
struct Scalar<G> {
    /// (energy, residual, derivative) at x, or a failure outside the domain.
    law: G,
    with_energy: bool,
    derivative: Vec<f64>,
    /// Every x at which the residual was asked for and given.
    visited: Vec<f64>,
}

impl<G: Fn(f64) -> Result<(f64, f64, f64), Failure>> Scalar<G> {
    fn new(len: usize, law: G) -> Self {
        Self { law, with_energy: true, derivative: vec![0.0; len], visited: Vec::new() }
    }
}

impl<G: Fn(f64) -> Result<(f64, f64, f64), Failure>> NewtonProblem for Scalar<G> {
    fn len(&self) -> usize {
        self.derivative.len()
    }

    fn residual(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        for (out, &x) in out.iter_mut().zip(x) {
            *out = (self.law)(x)?.1;
            self.visited.push(x);
        }
        Ok(())
    }

    fn energy(&mut self, x: &[f64]) -> Result<Option<f64>, Failure> {
        if !self.with_energy {
            return Ok(None);
        }
        let mut sum = 0.0;
        for &x in x {
            sum += (self.law)(x)?.0;
        }
        Ok(Some(sum))
    }

    fn linearise(&mut self, x: &[f64]) -> Result<(), Failure> {
        for (derivative, &x) in self.derivative.iter_mut().zip(x) {
            *derivative = (self.law)(x)?.2;
        }
        Ok(())
    }

    fn solve_linear(&mut self, rhs: &[f64], dx: &mut [f64]) -> LinearReport {
        for ((dx, rhs), derivative) in dx.iter_mut().zip(rhs).zip(&self.derivative) {
            *dx = rhs / derivative;
        }
        LinearReport::direct(0.0)
    }
}

/// On a smooth convex energy the residuals square from one iteration to the next.
#[test]
fn quadratic_convergence() {
    let mut problem = Scalar::new(3, |x| Ok((x.exp() - 2.0 * x, x.exp() - 2.0, x.exp())));
    let mut x = [0.5, 0.9, 1.4];
    let options = NewtonOptions { relative_tolerance: 1e-14, ..NewtonOptions::default() };
    let outcome = solve(&mut problem, &mut x, &options);
    assert!(outcome.converged(), "{outcome:?}");
    assert!(x.iter().all(|x| (x - 2f64.ln()).abs() < 1e-14), "{x:?}");
    assert_eq!(outcome.history.len(), outcome.iterations + 1);
    let rates: Vec<f64> =
        outcome.history.windows(2).filter(|pair| pair[1] > 1e-13).map(|pair| pair[1] / (pair[0] * pair[0])).collect();
    assert!(rates.len() >= 3, "{outcome:?}");
    assert!(rates.iter().all(|rate| *rate < 1.0), "residuals do not square: {:?}", outcome.history);
}

/// Full Newton steps on √(1 + x²) diverge from |x| > 1; the line search brings them home, by energy or by residual.
#[test]
fn the_line_search_rescues() {
    for with_energy in [true, false] {
        let mut problem = Scalar::new(1, |x: f64| {
            let s = (1.0 + x * x).sqrt();
            Ok((s, x / s, 1.0 / (s * s * s)))
        });
        problem.with_energy = with_energy;
        let mut x = [2.0];
        let mut shortest = 1.0f64;
        let outcome =
            newton(&mut problem, &mut x, &NewtonOptions::default(), &mut NewtonWorkspace::new(1), &mut |iteration| {
                shortest = shortest.min(iteration.length);
                ControlFlow::Continue(())
            });
        assert!(outcome.converged() && x[0].abs() < 1e-7, "x = {}, {outcome:?}", x[0]);
        assert!(shortest < 1.0, "no step was shortened");
    }
}

/// An energy that becomes infinite at x = 0 (ln x) is never evaluated into acceptance beyond it, even when the full step
/// points there.
#[test]
fn inadmissible_states_are_never_accepted() {
    for with_energy in [true, false] {
        let mut problem = Scalar::new(1, |x: f64| {
            if x <= 0.0 {
                return Err(Failure::inadmissible(Some(7), format!("x is {x}, and must be positive")));
            }
            Ok((x - x.ln(), 1.0 - 1.0 / x, 1.0 / (x * x)))
        });
        problem.with_energy = with_energy;
        let mut x = [5.0];
        let outcome = solve(&mut problem, &mut x, &NewtonOptions::default());
        assert!(outcome.converged() && (x[0] - 1.0).abs() < 1e-6, "x = {}, {outcome:?}", x[0]);
        assert!(problem.visited.iter().all(|&x| x > 0.0));

        let mut outside = [-1.0];
        let outcome = solve(&mut problem, &mut outside, &NewtonOptions::default());
        assert!(matches!(&outcome.status, NewtonStatus::Failed(failure) if failure.place == Some(7)), "{outcome:?}");
        assert_eq!(outside, [-1.0]);
    }
}

/// Where the energy is concave the Newton direction leads uphill; its opposite is taken and a minimum is found.
#[test]
fn concave_regions_are_left_downhill() {
    // The double well (x² − 1)²/4 starts concave near 0.
    let mut problem = Scalar::new(1, |x: f64| Ok(((x * x - 1.0).powi(2) / 4.0, x * (x * x - 1.0), 3.0 * x * x - 1.0)));
    let mut x = [0.2];
    let outcome = solve(&mut problem, &mut x, &NewtonOptions::default());
    assert!(outcome.converged(), "{outcome:?}");
    assert!((x[0].abs() - 1.0).abs() < 1e-6, "x = {} is no minimum", x[0]);
}

/// What cannot converge ends with a word for it, and with the x of the smallest accepted residual.
#[test]
fn failures_have_names() {
    // No root: r = 1 + x².
    let mut rootless = Scalar::new(1, |x: f64| Ok((0.0, 1.0 + x * x, 2.0 * x)));
    rootless.with_energy = false;
    let mut x = [1.0];
    let outcome = solve(&mut rootless, &mut x, &NewtonOptions { max_iterations: 50, ..NewtonOptions::default() });
    assert!(
        matches!(
            outcome.status,
            NewtonStatus::MaxIterations
                | NewtonStatus::LineSearchFailed(None)
                | NewtonStatus::Stalled
                | NewtonStatus::LinearSolveFailed(_)
        ),
        "{outcome:?}"
    );
    assert!(outcome.residual >= 1.0 && outcome.residual <= 2.0 && x[0].is_finite());

    let mut poisoned = Scalar::new(1, |x: f64| Ok((0.0, if x < 2.0 { f64::NAN } else { x }, 1.0)));
    poisoned.with_energy = false;
    let mut x = [3.0];
    let outcome = solve(&mut poisoned, &mut x, &NewtonOptions::default());
    assert!(x[0] >= 2.0 && outcome.residual.is_finite(), "{outcome:?}");
    assert!(!outcome.converged());
    let mut x = [0.0];
    assert!(matches!(solve(&mut poisoned, &mut x, &NewtonOptions::default()).status, NewtonStatus::Failed(_)));

    let mut fine = Scalar::new(1, |x: f64| Ok((x.powi(4) / 4.0, x.powi(3), 3.0 * x * x)));
    let mut x = [1.0];
    let outcome =
        newton(&mut fine, &mut x, &NewtonOptions::default(), &mut NewtonWorkspace::new(1), &mut |iteration| {
            if iteration.iteration == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
    assert_eq!((outcome.status, outcome.iterations), (NewtonStatus::Interrupted, 2));
}

/// A shallow arch (von Mises truss) under a vertical load at its top, in one unknown:
/// r(x, λ) = k x (x − a)(x − 2a) − λ P, with a limit point at x = a (1 − 1/√3).
/// Beyond `wall` the state is refused.
struct Arch {
    load: f64,
    full_load: f64,
    wall: f64,
    derivative: f64,
}

impl Arch {
    fn new(full_load: f64) -> Self {
        Self { load: 0.0, full_load, wall: f64::INFINITY, derivative: 0.0 }
    }

    /// The load at the limit point, 2/(3√3), for k = a = 1.
    const LIMIT: f64 = 0.384_900_179_459_750_5;

    fn resistance(x: f64) -> f64 {
        x * (x - 1.0) * (x - 2.0)
    }
}

impl NewtonProblem for Arch {
    fn len(&self) -> usize {
        1
    }

    fn residual(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        if x[0] > self.wall {
            return Err(Failure::inadmissible(None, "the arch has snapped"));
        }
        out[0] = Self::resistance(x[0]) - self.load;
        Ok(())
    }

    fn energy(&mut self, x: &[f64]) -> Result<Option<f64>, Failure> {
        if x[0] > self.wall {
            return Err(Failure::inadmissible(None, "the arch has snapped"));
        }
        Ok(Some(x[0].powi(4) / 4.0 - x[0].powi(3) + x[0] * x[0] - self.load * x[0]))
    }

    fn linearise(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.derivative = 3.0 * x[0] * x[0] - 6.0 * x[0] + 2.0;
        Ok(())
    }

    fn solve_linear(&mut self, rhs: &[f64], dx: &mut [f64]) -> LinearReport {
        dx[0] = rhs[0] / self.derivative;
        LinearReport::direct(rhs[0].abs())
    }
}

impl LoadProblem for Arch {
    fn set_load(&mut self, factor: f64, _x: &mut [f64]) -> Result<(), Failure> {
        self.load = factor * self.full_load;
        Ok(())
    }
}

/// Below the limit load every equilibrium on the way is in balance, the steps grow, and the last factor is exactly one.
#[test]
fn loading_below_the_limit() {
    for predictor in [Predictor::Last, Predictor::Secant] {
        let mut arch = Arch::new(0.95 * Arch::LIMIT);
        let mut x = [0.0];
        let mut factors = Vec::new();
        let options = QuasiStaticOptions { predictor, initial_step: 0.05, ..QuasiStaticOptions::default() };
        let outcome = quasi_static(&mut arch, &mut x, &options, &mut |step, x| {
            let unbalanced = Arch::resistance(x[0]) - step.factor * 0.95 * Arch::LIMIT;
            assert!(unbalanced.abs() < 1e-7, "at {}: {unbalanced}", step.factor);
            factors.push(step.factor);
            ControlFlow::Continue(())
        });
        assert_eq!(outcome.status, QuasiStaticStatus::Finished);
        assert_eq!((outcome.factor, factors.last().copied()), (1.0, Some(1.0)));
        assert!(x[0] < 1.0 - 1.0 / 3f64.sqrt());
        assert!(factors.len() < 10, "steps did not grow: {factors:?}");
        assert_eq!(outcome.accepted, factors.len());
    }
}

/// Beyond the limit load the arch snaps through to the far branch, guided by the energy.
#[test]
fn snap_through_reaches_the_far_branch() {
    let mut arch = Arch::new(1.5 * Arch::LIMIT);
    let mut x = [0.0];
    let outcome =
        quasi_static(&mut arch, &mut x, &QuasiStaticOptions::default(), &mut |_, _| ControlFlow::Continue(()));
    assert_eq!(outcome.status, QuasiStaticStatus::Finished, "{outcome:?}");
    assert!(x[0] > 2.0, "x = {} is not on the far branch", x[0]);
    assert!((Arch::resistance(x[0]) - 1.5 * Arch::LIMIT).abs() < 1e-7);
}

/// Where the far branch is forbidden the steps are halved down to the smallest, and what comes back is the last state
/// in balance, just below the limit load, with the problem left at that load.
#[test]
fn a_limit_point_is_reported_with_the_last_good_state() {
    let mut arch = Arch::new(1.5 * Arch::LIMIT);
    arch.wall = 0.9;
    let mut x = [0.0];
    let options = QuasiStaticOptions { min_step: 1e-5, ..QuasiStaticOptions::default() };
    let outcome = quasi_static(&mut arch, &mut x, &options, &mut |_, _| ControlFlow::Continue(()));
    assert!(matches!(outcome.status, QuasiStaticStatus::StepTooSmall { .. }), "{outcome:?}");
    assert!(outcome.rejected > 5 && outcome.last_rejection.is_some());
    assert!(outcome.factor < 1.0 / 1.5 && outcome.factor > 0.999 / 1.5, "stopped at {}", outcome.factor);
    assert!((Arch::resistance(x[0]) - outcome.factor * 1.5 * Arch::LIMIT).abs() < 1e-7);
    assert_eq!(arch.load, outcome.factor * arch.full_load);
}

/// An observer can stop between equilibria.
#[test]
fn loading_can_be_interrupted() {
    let mut arch = Arch::new(0.5 * Arch::LIMIT);
    let mut x = [0.0];
    let outcome = quasi_static(&mut arch, &mut x, &QuasiStaticOptions::default(), &mut |_, _| ControlFlow::Break(()));
    assert_eq!((outcome.status, outcome.accepted), (QuasiStaticStatus::Interrupted, 1));
    assert_eq!(outcome.factor, 0.1);
}
