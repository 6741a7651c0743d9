//! Newton's method with a backtracking line search, for r(x) = 0.
//!
//! ```text
//! J(x) Δx = −r(x),   x ← x + α Δx,   α = 1, ½, ¼ … until the merit falls enough
//! ```
//!
//! The merit is the energy E with r = ∇E when the problem has one (Armijo: E(x + αΔx) ≤ E(x) + c α rᵀΔx), else ‖r‖.
//! A trial state that the problem refuses, or that is not finite, is never accepted: α shrinks instead.
//! The x that comes back is always the last accepted one.
//!
//! Reference: J. Nocedal and S. Wright, "Numerical Optimization", 2nd ed., §3.1 and §11.2.

use crate::cg::{LinearReport, LinearStatus};
use crate::failure::{Failure, check_finite};
use crate::vector::{Serial, VectorOps, norm};
use std::ops::ControlFlow;

/// A residual that Newton's method can bring to zero.
///
/// Constraints are the problem's own affair: it zeroes the residual on unknowns that are not free and returns
/// corrections that leave them alone.
pub trait NewtonProblem {
    /// Number of unknowns.
    fn len(&self) -> usize;

    /// Whether there is nothing to solve for.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// out ← r(x)
    ///
    /// # Errors
    /// A [`Failure`] when x lies outside the domain of the problem.
    fn residual(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), Failure>;

    /// The energy whose gradient is r, if there is one.
    ///
    /// # Errors
    /// A [`Failure`] when x lies outside the domain of the problem.
    fn energy(&mut self, _x: &[f64]) -> Result<Option<f64>, Failure> {
        Ok(None)
    }

    /// Prepares [`Self::solve_linear`] at x.
    ///
    /// # Errors
    /// A [`Failure`] when the derivative cannot be evaluated there.
    fn linearise(&mut self, x: &[f64]) -> Result<(), Failure>;

    /// Solves J dx = rhs at the state given to the last [`Self::linearise`]; `dx` comes in as zeros.
    fn solve_linear(&mut self, rhs: &[f64], dx: &mut [f64]) -> LinearReport;
}

/// When to stop, and how to search along a correction.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonOptions {
    /// Converged when ‖r‖ ≤ this × the initial ‖r‖.
    pub relative_tolerance: f64,
    /// Converged when ‖r‖ ≤ this, in units of the residual.
    pub absolute_tolerance: f64,
    /// Linear solves at most.
    pub max_iterations: usize,
    /// Stalled when a correction has ‖α Δx‖ ≤ this × ‖x‖ (or no length along it is acceptable and ‖Δx‖ is that small)
    /// and the residual is still above its tolerance.
    pub step_tolerance: f64,
    /// Diverged when ‖r‖ exceeds this × the initial ‖r‖ (an energy can fall while the residual grows, but not forever).
    pub divergence_factor: f64,
    /// The search along a correction.
    pub line_search: LineSearch,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            relative_tolerance: 1e-8,
            absolute_tolerance: 0.0,
            max_iterations: 30,
            step_tolerance: 1e-13,
            divergence_factor: 1e10,
            line_search: LineSearch::default(),
        }
    }
}

/// Backtracking along a correction.
#[derive(Clone, Debug, PartialEq)]
pub struct LineSearch {
    /// Share c of the predicted decrease that is asked for, in (0, ½).
    pub sufficient_decrease: f64,
    /// Factor in (0, 1) by which a refused length shrinks.
    pub shrink: f64,
    /// Refusals before giving up.
    pub max_shrinks: usize,
}

impl Default for LineSearch {
    fn default() -> Self {
        Self { sufficient_decrease: 1e-4, shrink: 0.5, max_shrinks: 30 }
    }
}

/// One accepted correction, as the observer sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonIteration {
    /// Number of corrections accepted so far, this one included.
    pub iteration: usize,
    /// ‖r‖ after it.
    pub residual: f64,
    /// The accepted length α.
    pub length: f64,
    /// The energy after it, if the problem has one and the search asked for it.
    pub energy: Option<f64>,
    /// The linear solve.
    pub linear: LinearReport,
}

/// How the iterations ended.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonOutcome {
    /// Why they stopped.
    pub status: NewtonStatus,
    /// Accepted corrections.
    pub iterations: usize,
    /// ‖r‖ at the x handed back.
    pub residual: f64,
    /// ‖r‖ at the start and after each accepted correction.
    pub history: Vec<f64>,
    /// Linear iterations of all solves together.
    pub linear_iterations: usize,
    /// The last linear solve that did not meet its tolerance, if any.
    pub linear_fault: Option<LinearReport>,
}

/// Why Newton's iterations stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum NewtonStatus {
    /// The tolerance was met.
    Converged,
    /// The tolerance was not met in the allowed number of iterations.
    MaxIterations,
    /// Corrections became too small to matter while the residual stays above its tolerance.
    Stalled,
    /// No length along the correction was acceptable; the failure of the last trial if it was refused by the problem.
    LineSearchFailed(Option<Failure>),
    /// The residual grew beyond the allowed factor.
    Diverged,
    /// The linear solve gave no usable correction.
    LinearSolveFailed(LinearStatus),
    /// The problem refused the state that it was started from, or failed in a way that no shorter step cures.
    Failed(Failure),
    /// The observer asked to stop.
    Interrupted,
}

impl NewtonOutcome {
    /// Whether the tolerance was met.
    pub fn converged(&self) -> bool {
        self.status == NewtonStatus::Converged
    }
}

/// Vectors of the method, sized once.
#[derive(Clone, Debug, Default)]
pub struct NewtonWorkspace {
    residual: Vec<f64>,
    trial_residual: Vec<f64>,
    rhs: Vec<f64>,
    correction: Vec<f64>,
    trial: Vec<f64>,
}

impl NewtonWorkspace {
    /// For `len` unknowns.
    pub fn new(len: usize) -> Self {
        let vector = || vec![0.0; len];
        Self { residual: vector(), trial_residual: vector(), rhs: vector(), correction: vector(), trial: vector() }
    }
}

/// Iterates from x until the residual is small, and leaves the last accepted state in x.
///
/// The observer sees every accepted correction and may stop the iterations.
///
/// # Panics
/// When the lengths of problem, x and workspace differ.
pub fn newton(
    problem: &mut dyn NewtonProblem,
    x: &mut [f64],
    options: &NewtonOptions,
    workspace: &mut NewtonWorkspace,
    observer: &mut dyn FnMut(&NewtonIteration) -> ControlFlow<()>,
) -> NewtonOutcome {
    assert_eq!(x.len(), problem.len(), "x has one entry per unknown");
    assert_eq!(workspace.trial.len(), problem.len(), "the workspace was made for this number of unknowns");
    let mut outcome = NewtonOutcome {
        status: NewtonStatus::Converged,
        iterations: 0,
        residual: f64::NAN,
        history: Vec::with_capacity(options.max_iterations.min(100) + 1),
        linear_iterations: 0,
        linear_fault: None,
    };
    outcome.status = iterate(problem, x, options, workspace, observer, &mut outcome);
    outcome
}

fn iterate(
    problem: &mut dyn NewtonProblem,
    x: &mut [f64],
    options: &NewtonOptions,
    workspace: &mut NewtonWorkspace,
    observer: &mut dyn FnMut(&NewtonIteration) -> ControlFlow<()>,
    outcome: &mut NewtonOutcome,
) -> NewtonStatus {
    if let Err(failure) =
        problem.residual(x, &mut workspace.residual).and_then(|()| check_finite("the residual", &workspace.residual))
    {
        return NewtonStatus::Failed(failure);
    }
    let initial = norm(&workspace.residual);
    outcome.residual = initial;
    outcome.history.push(initial);
    let tolerance = options.absolute_tolerance.max(options.relative_tolerance * initial);

    loop {
        if outcome.residual <= tolerance {
            return NewtonStatus::Converged;
        }
        if outcome.iterations == options.max_iterations {
            return NewtonStatus::MaxIterations;
        }
        if outcome.residual > options.divergence_factor * initial {
            return NewtonStatus::Diverged;
        }

        if let Err(failure) = problem.linearise(x) {
            return NewtonStatus::Failed(failure);
        }
        for (rhs, r) in workspace.rhs.iter_mut().zip(&workspace.residual) {
            *rhs = -r;
        }
        workspace.correction.fill(0.0);
        let linear = problem.solve_linear(&workspace.rhs, &mut workspace.correction);
        outcome.linear_iterations += linear.iterations;
        if !linear.converged() {
            outcome.linear_fault = Some(linear.clone());
        }
        if !linear.usable() || check_finite("the correction", &workspace.correction).is_err() {
            return NewtonStatus::LinearSolveFailed(linear.status);
        }

        let accepted = match search(problem, x, outcome.residual, &options.line_search, workspace) {
            Ok(accepted) => accepted,
            // What remains is rounding: no length can be seen to help.
            Err(NewtonStatus::LineSearchFailed(None))
                if norm(&workspace.correction) <= options.step_tolerance * norm(x) =>
            {
                return NewtonStatus::Stalled;
            }
            Err(status) => return status,
        };
        // The trial becomes the state.
        let size = norm(x);
        x.copy_from_slice(&workspace.trial);
        std::mem::swap(&mut workspace.residual, &mut workspace.trial_residual);
        outcome.iterations += 1;
        outcome.residual = accepted.residual;
        outcome.history.push(accepted.residual);
        let step = accepted.length * norm(&workspace.correction);

        let seen = observer(&NewtonIteration {
            iteration: outcome.iterations,
            residual: accepted.residual,
            length: accepted.length,
            energy: accepted.energy,
            linear,
        });
        if outcome.residual > tolerance && step <= options.step_tolerance * size {
            return NewtonStatus::Stalled;
        }
        if outcome.residual > tolerance && seen.is_break() {
            return NewtonStatus::Interrupted;
        }
    }
}

struct Accepted {
    length: f64,
    residual: f64,
    energy: Option<f64>,
}

/// Finds an acceptable length along the correction; the trial state and its residual are left in the workspace.
fn search(
    problem: &mut dyn NewtonProblem,
    x: &[f64],
    residual: f64,
    options: &LineSearch,
    workspace: &mut NewtonWorkspace,
) -> Result<Accepted, NewtonStatus> {
    let energy = match problem.energy(x) {
        Ok(energy) => energy.filter(|value| value.is_finite()),
        Err(failure) => return Err(NewtonStatus::Failed(failure)),
    };
    let mut slope = Serial.dot(&workspace.residual, &workspace.correction);
    // At an indefinite tangent the correction may lead uphill; its opposite then leads down.
    if energy.is_some() && slope > 0.0 {
        workspace.correction.iter_mut().for_each(|value| *value = -*value);
        slope = -slope;
    }

    let mut length = 1.0;
    let mut refusal = None;
    for _ in 0..=options.max_shrinks {
        for ((trial, x), dx) in workspace.trial.iter_mut().zip(x).zip(&workspace.correction) {
            *trial = x + length * dx;
        }
        let merit = Merit { energy, slope, residual, length, sufficient_decrease: options.sufficient_decrease };
        match evaluate(problem, &merit, workspace) {
            Ok(Some((trial_residual, trial_energy))) => {
                return Ok(Accepted { length, residual: trial_residual, energy: trial_energy });
            }
            Ok(None) => refusal = None,
            Err(failure) if failure.shorter_may_help() => refusal = Some(failure),
            Err(failure) => return Err(NewtonStatus::Failed(failure)),
        }
        length *= options.shrink;
    }
    Err(NewtonStatus::LineSearchFailed(refusal))
}

/// What a trial is compared with.
struct Merit {
    energy: Option<f64>,
    slope: f64,
    residual: f64,
    length: f64,
    sufficient_decrease: f64,
}

/// Residual norm and energy of the trial if it is good enough, nothing if it is not.
fn evaluate(
    problem: &mut dyn NewtonProblem,
    merit: &Merit,
    workspace: &mut NewtonWorkspace,
) -> Result<Option<(f64, Option<f64>)>, Failure> {
    let share = merit.sufficient_decrease * merit.length;
    let mut energy = None;
    let mut must_reduce_residual = true;
    if let Some(before) = merit.energy
        && let Some(after) = problem.energy(&workspace.trial)?
    {
        if !after.is_finite() {
            return Ok(None);
        }
        energy = Some(after);
        // Near the solution the decrease drowns in the rounding of the energy itself; the residual then decides.
        let rounding = 16.0 * f64::EPSILON * before.abs().max(after.abs());
        let visible = -merit.length * merit.slope > rounding;
        if visible && after > before + share * merit.slope {
            return Ok(None);
        }
        must_reduce_residual = !visible;
    }
    problem.residual(&workspace.trial, &mut workspace.trial_residual)?;
    check_finite("the residual", &workspace.trial_residual)?;
    let residual = norm(&workspace.trial_residual);
    if must_reduce_residual && residual > (1.0 - share) * merit.residual {
        return Ok(None);
    }
    Ok(Some((residual, energy)))
}
