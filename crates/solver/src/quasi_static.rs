//! Equilibria under a load that grows: r(x, λ) = 0 for λ from 0 to 1, with steps that adapt.
//!
//! ```text
//! λ ─●───●───────●───────────────●──── 1      a step that Newton does not bring to balance is halved,
//!     ½    easy: ×2                            an easy one lets the next one grow
//! ```
//!
//! What comes back is always the last state in balance, whatever happened after it.
//! Not an arc-length method: beyond a limit point there is no equilibrium at a larger load near by.
//! Newton then either lands on a far one (snap-through) or the steps shrink to the smallest allowed and the outcome
//! says how far the load could be raised.

use crate::failure::Failure;
use crate::newton::{NewtonOptions, NewtonOutcome, NewtonProblem, NewtonStatus, NewtonWorkspace, newton};
use std::ops::ControlFlow;

/// A residual that depends on a load factor.
pub trait LoadProblem: NewtonProblem {
    /// Sets the load factor of what follows, and overwrites the prescribed part of x by its value at that load.
    ///
    /// # Errors
    /// A [`Failure`] when the load cannot be set.
    fn set_load(&mut self, factor: f64, x: &mut [f64]) -> Result<(), Failure>;
}

/// How the load grows.
#[derive(Clone, Debug, PartialEq)]
pub struct QuasiStaticOptions {
    /// First increment of the load factor, in (0, 1].
    pub initial_step: f64,
    /// Give up when an increment would become smaller than this.
    pub min_step: f64,
    /// Increments never grow beyond this.
    pub max_step: f64,
    /// Factor by which the increment grows after an easy step; at least 1.
    pub growth: f64,
    /// A step is easy when Newton took at most this many iterations.
    pub easy_iterations: usize,
    /// Attempts at most, failed ones included.
    pub max_attempts: usize,
    /// Where Newton starts from.
    pub predictor: Predictor,
    /// Newton at each load. Its relative tolerance refers to the largest initial residual met so far, so that a good
    /// start is not asked for more digits than a bad one.
    pub newton: NewtonOptions,
}

impl Default for QuasiStaticOptions {
    fn default() -> Self {
        Self {
            initial_step: 0.1,
            min_step: 1e-4,
            max_step: 1.0,
            growth: 2.0,
            easy_iterations: 6,
            max_attempts: 10_000,
            predictor: Predictor::Secant,
            newton: NewtonOptions::default(),
        }
    }
}

/// Where Newton starts from at a new load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Predictor {
    /// From the last equilibrium.
    Last,
    /// From the line through the last two equilibria; from the last one where the problem refuses that start.
    Secant,
}

/// An equilibrium that was reached, as the observer sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    /// Equilibria reached so far, this one included.
    pub index: usize,
    /// The load factor.
    pub factor: f64,
    /// The increment that led there.
    pub increment: f64,
    /// How Newton fared.
    pub newton: NewtonOutcome,
}

/// How the loading ended.
#[derive(Clone, Debug, PartialEq)]
pub struct QuasiStaticOutcome {
    /// Why it stopped.
    pub status: QuasiStaticStatus,
    /// Load factor of the state handed back.
    pub factor: f64,
    /// Equilibria reached.
    pub accepted: usize,
    /// Attempts that failed.
    pub rejected: usize,
    /// Newton iterations of all attempts together.
    pub newton_iterations: usize,
    /// Linear iterations of all attempts together.
    pub linear_iterations: usize,
    /// The last attempt that failed, if any.
    pub last_rejection: Option<NewtonStatus>,
}

/// Why the loading stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum QuasiStaticStatus {
    /// The full load is balanced.
    Finished,
    /// The increment fell below the smallest allowed.
    StepTooSmall {
        /// The increment that was refused.
        step: f64,
    },
    /// The allowed number of attempts is used up.
    MaxAttempts,
    /// The problem failed in a way that no smaller increment cures.
    Failed(Failure),
    /// The observer asked to stop.
    Interrupted,
}

/// Raises the load from 0 to 1, starting from an x in balance at load 0, and leaves the last equilibrium in x.
///
/// The problem is left at the load factor of the outcome.
/// The observer sees every equilibrium and may stop.
///
/// # Panics
/// When x has not one entry per unknown.
pub fn quasi_static(
    problem: &mut dyn LoadProblem,
    x: &mut [f64],
    options: &QuasiStaticOptions,
    observer: &mut dyn FnMut(&LoadStep, &[f64]) -> ControlFlow<()>,
) -> QuasiStaticOutcome {
    assert_eq!(x.len(), problem.len(), "x has one entry per unknown");
    let mut outcome = QuasiStaticOutcome {
        status: QuasiStaticStatus::Finished,
        factor: 0.0,
        accepted: 0,
        rejected: 0,
        newton_iterations: 0,
        linear_iterations: 0,
        last_rejection: None,
    };
    outcome.status = load(problem, x, options, observer, &mut outcome);
    // Leave the problem at the load that x balances; it was accepted there once, so this cannot fail anew.
    if let Err(failure) = problem.set_load(outcome.factor, x)
        && outcome.status == QuasiStaticStatus::Finished
    {
        outcome.status = QuasiStaticStatus::Failed(failure);
    }
    outcome
}

fn load(
    problem: &mut dyn LoadProblem,
    x: &mut [f64],
    options: &QuasiStaticOptions,
    observer: &mut dyn FnMut(&LoadStep, &[f64]) -> ControlFlow<()>,
    outcome: &mut QuasiStaticOutcome,
) -> QuasiStaticStatus {
    let mut workspace = NewtonWorkspace::new(x.len());
    let mut trial = x.to_vec();
    let mut before = x.to_vec();
    let mut before_increment = 0.0;
    let mut reference = 0.0;
    let mut step = options.initial_step.clamp(options.min_step, options.max_step);

    for _ in 0..options.max_attempts {
        // Land on 1 exactly, and leave no crumb for a last step.
        let remaining = 1.0 - outcome.factor;
        let (factor, increment) =
            if step >= remaining * (1.0 - 1e-9) { (1.0, remaining) } else { (outcome.factor + step, step) };

        let stretch = match options.predictor {
            Predictor::Secant if before_increment > 0.0 => increment / before_increment,
            _ => 0.0,
        };
        let mut newton_options = options.newton.clone();
        newton_options.absolute_tolerance =
            newton_options.absolute_tolerance.max(newton_options.relative_tolerance * reference);
        let mut result = attempt(problem, x, &before, stretch, factor, &mut trial, &newton_options, &mut workspace);
        if stretch != 0.0 && refused_start(&result) {
            outcome.rejected += 1;
            result = attempt(problem, x, &before, 0.0, factor, &mut trial, &newton_options, &mut workspace);
        }
        outcome.newton_iterations += result.iterations;
        outcome.linear_iterations += result.linear_iterations;

        match result.status {
            NewtonStatus::Converged => {
                before.copy_from_slice(x);
                before_increment = increment;
                x.copy_from_slice(&trial);
                outcome.factor = factor;
                outcome.accepted += 1;
                reference = result.history.first().copied().unwrap_or(0.0).max(reference);
                if result.iterations <= options.easy_iterations {
                    step = (increment * options.growth).min(options.max_step);
                }
                let seen = LoadStep { index: outcome.accepted, factor, increment, newton: result };
                let flow = observer(&seen, x);
                if factor == 1.0 {
                    return QuasiStaticStatus::Finished;
                }
                if flow.is_break() {
                    return QuasiStaticStatus::Interrupted;
                }
            }
            NewtonStatus::Failed(failure) if !failure.shorter_may_help() => return QuasiStaticStatus::Failed(failure),
            status => {
                outcome.rejected += 1;
                outcome.last_rejection = Some(status);
                step = 0.5 * increment;
                if step < options.min_step {
                    return QuasiStaticStatus::StepTooSmall { step };
                }
            }
        }
    }
    QuasiStaticStatus::MaxAttempts
}

/// Newton at one load, from x + stretch × (x − before).
fn attempt(
    problem: &mut dyn LoadProblem,
    x: &[f64],
    before: &[f64],
    stretch: f64,
    factor: f64,
    trial: &mut [f64],
    options: &NewtonOptions,
    workspace: &mut NewtonWorkspace,
) -> NewtonOutcome {
    for i in 0..x.len() {
        trial[i] = x[i] + stretch * (x[i] - before[i]);
    }
    match problem.set_load(factor, trial) {
        Ok(()) => newton(problem, trial, options, workspace, &mut |_| ControlFlow::Continue(())),
        Err(failure) => NewtonOutcome {
            status: NewtonStatus::Failed(failure),
            iterations: 0,
            residual: f64::NAN,
            history: Vec::new(),
            linear_iterations: 0,
            linear_fault: None,
        },
    }
}

fn refused_start(result: &NewtonOutcome) -> bool {
    result.iterations == 0 && matches!(&result.status, NewtonStatus::Failed(failure) if failure.shorter_may_help())
}
