//! One step in time: the state, the report, and the function that advances one into the other.
//!
//! A [`State`] is plain arrays and holds *everything* that the next step depends on, histories and warm starts
//! included: a copy of it is a snapshot, and a run resumed from a snapshot repeats the same bits.
//! A step that fails leaves the state as it was and says why.

use crate::cg::LinearReport;
use crate::explicit::{RungeKutta, runge_kutta, symplectic_euler};
use crate::failure::{Failure, FailureKind, check_finite};
use crate::implicit::{bdf2, implicit_euler, implicit_midpoint, newmark};
use crate::method::Method;
use crate::newton::{LineSearch, NewtonStatus, NewtonWorkspace};
use crate::second_order::SecondOrder;

/// What moves, and what the methods remember of its past.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Time in seconds.
    pub t: f64,
    /// Displacements, one per unknown.
    pub u: Vec<f64>,
    /// Velocities, one per unknown.
    pub v: Vec<f64>,
    /// Accelerations that the last implicit step solved for: where the next solve starts from. Empty when unknown.
    pub guess: Vec<f64>,
    /// Acceleration at t, which Newmark's method carries from step to step. Empty when unknown.
    pub acceleration: Vec<f64>,
    /// The state one step ago, for multistep methods.
    pub previous: Option<Previous>,
}

/// The state one step ago.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Previous {
    /// Displacements.
    pub u: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Length in seconds of the step that led from there to the current state.
    pub step: f64,
}

impl State {
    /// At rest in the undeformed position, at time zero.
    pub fn at_rest(len: usize) -> Self {
        Self { u: vec![0.0; len], v: vec![0.0; len], ..Self::default() }
    }

    /// Forgets the past: to call after u or v were changed from outside, or when unknowns appear or vanish.
    pub fn forget(&mut self) {
        self.guess.clear();
        self.acceleration.clear();
        self.previous = None;
    }
}

/// How implicit methods solve for the end of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOptions {
    /// Linear solves per step: 1 linearises once about the beginning of the step; more are Newton iterations until
    /// the tolerance below.
    pub newton_iterations: usize,
    /// Newton stops when the unbalanced force is below this × the right-hand side of the first linear solve.
    pub newton_tolerance: f64,
    /// Newton stops when the norm of the unbalanced force is below this, in newtons.
    pub newton_absolute_tolerance: f64,
    /// Newton's line search.
    pub line_search: LineSearch,
    /// Where linear solves start from.
    pub warm_start: WarmStart,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self {
            newton_iterations: 1,
            newton_tolerance: 1e-6,
            newton_absolute_tolerance: 0.0,
            line_search: LineSearch::default(),
            warm_start: WarmStart::Previous,
        }
    }
}

/// Where the linear solve of an implicit step starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WarmStart {
    /// From nothing.
    Zero,
    /// From the acceleration of the step before.
    Previous,
}

/// What a step did.
#[derive(Clone, Debug, PartialEq)]
pub struct StepReport {
    /// Whether the state advanced.
    pub status: StepStatus,
    /// Linear systems solved.
    pub linear_solves: usize,
    /// Iterations of all of them together.
    pub linear_iterations: usize,
    /// The last linear solve, or the last that did not meet its tolerance.
    pub linear: Option<LinearReport>,
    /// Newton corrections accepted (a step that is linearised once counts one).
    pub newton_iterations: usize,
    /// Norm of the unbalanced force at the end, in newtons; known only when Newton iterated.
    pub unbalanced: Option<f64>,
}

/// Whether a step advanced the state.
#[derive(Clone, Debug, PartialEq)]
pub enum StepStatus {
    /// It did.
    Completed,
    /// It did, but Newton stopped above its tolerance: [`NewtonStatus::MaxIterations`], [`NewtonStatus::Stalled`] or
    /// [`NewtonStatus::LineSearchFailed`] (rounding hides any further decrease).
    Unconverged(NewtonStatus),
    /// It did not, and the state is as it was.
    Failed(Failure),
}

impl StepReport {
    pub(crate) fn new() -> Self {
        Self {
            status: StepStatus::Completed,
            linear_solves: 0,
            linear_iterations: 0,
            linear: None,
            newton_iterations: 0,
            unbalanced: None,
        }
    }

    /// Whether the state advanced.
    pub fn advanced(&self) -> bool {
        !matches!(self.status, StepStatus::Failed(_))
    }

    /// Takes note of a linear solve.
    ///
    /// # Errors
    /// When its answer cannot be used.
    pub(crate) fn record(&mut self, linear: LinearReport) -> Result<(), Failure> {
        self.linear_solves += 1;
        self.linear_iterations += linear.iterations;
        let usable = linear.usable();
        let failure = (!usable).then(|| Failure {
            kind: FailureKind::LinearSolve,
            place: None,
            message: format!(
                "the linear solve gave no usable answer after {} iterations: {:?}",
                linear.iterations, linear.status
            ),
        });
        if self.linear.as_ref().is_none_or(LinearReport::converged) || !linear.converged() {
            self.linear = Some(linear);
        }
        failure.map_or(Ok(()), Err)
    }
}

/// Vectors of all methods, sized once.
#[derive(Clone, Debug, Default)]
pub struct StepWorkspace {
    /// The state being computed.
    pub(crate) u: Vec<f64>,
    pub(crate) v: Vec<f64>,
    /// A stage inside the step.
    pub(crate) stage_u: Vec<f64>,
    pub(crate) stage_v: Vec<f64>,
    pub(crate) force: Vec<f64>,
    pub(crate) a: Vec<f64>,
    /// Further vectors of the implicit methods; empty until one of them is used.
    pub(crate) implicit: ImplicitWorkspace,
}

/// Vectors of the implicit methods.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImplicitWorkspace {
    pub(crate) known: Vec<f64>,
    pub(crate) total: Vec<f64>,
    pub(crate) product: Vec<f64>,
    pub(crate) trial_u: Vec<f64>,
    pub(crate) trial_v: Vec<f64>,
    pub(crate) newton: NewtonWorkspace,
}

impl StepWorkspace {
    /// For `len` unknowns and one method: explicit methods need fewer vectors.
    pub fn new(len: usize, method: Method) -> Self {
        let vector = || vec![0.0; len];
        let implicit = if method.is_explicit() {
            ImplicitWorkspace::default()
        } else {
            ImplicitWorkspace {
                known: vector(),
                total: vector(),
                product: vector(),
                trial_u: vector(),
                trial_v: vector(),
                newton: NewtonWorkspace::new(len),
            }
        };
        Self { u: vector(), v: vector(), stage_u: vector(), stage_v: vector(), force: vector(), a: vector(), implicit }
    }
}

/// Advances the state by h seconds, or leaves it as it was and reports why.
///
/// Prescribed unknowns hold their prescribed values exactly at the end.
///
/// # Panics
/// When the lengths of system, state and workspace differ, or the workspace was made for another kind of method.
pub fn step(
    system: &mut dyn SecondOrder,
    state: &mut State,
    h: f64,
    method: Method,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
) -> StepReport {
    let len = system.len();
    assert_eq!(state.u.len(), len, "the state has one displacement per unknown");
    assert_eq!(state.v.len(), len, "the state has one velocity per unknown");
    assert_eq!(workspace.u.len(), len, "the workspace was made for this number of unknowns");
    assert!(
        method.is_explicit() || workspace.implicit.known.len() == len,
        "the workspace was made for an explicit method"
    );
    let mut report = StepReport::new();
    match advance(system, state, h, method, options, workspace, &mut report) {
        Ok(()) => commit(state, h, method, workspace),
        Err(failure) => report.status = StepStatus::Failed(failure),
    }
    report
}

/// Computes the end of the step into the workspace and checks it; the state is only read.
fn advance(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    method: Method,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    if !(h > 0.0 && h.is_finite()) {
        return Err(Failure::other(format!("the time step must be a positive number of seconds, but it is {h}")));
    }
    method.validate().map_err(|error| Failure::other(error.to_string()))?;
    match method {
        Method::ExplicitEuler => runge_kutta(system, state, h, &RungeKutta::EULER, workspace, report)?,
        Method::SymplecticEuler => symplectic_euler(system, state, h, workspace, report)?,
        Method::Rk2 => runge_kutta(system, state, h, &RungeKutta::MIDPOINT, workspace, report)?,
        Method::Rk4 => runge_kutta(system, state, h, &RungeKutta::CLASSICAL, workspace, report)?,
        Method::ImplicitEuler => implicit_euler(system, state, h, options, workspace, report)?,
        Method::ImplicitMidpoint => implicit_midpoint(system, state, h, options, workspace, report)?,
        Method::Bdf2 => bdf2(system, state, h, options, workspace, report)?,
        Method::Newmark { beta, gamma } => newmark(system, state, h, beta, gamma, options, workspace, report)?,
    }
    let end = state.t + h;
    system.prescribe(end, &mut workspace.u, &mut workspace.v);
    check_finite("the displacement", &workspace.u)?;
    check_finite("the velocity", &workspace.v)?;
    system.admissible(end, &workspace.u, &workspace.v)
}

/// Makes the computed end of the step the state. Nothing can fail any more.
fn commit(state: &mut State, h: f64, method: Method, workspace: &mut StepWorkspace) {
    state.t += h;
    std::mem::swap(&mut state.u, &mut workspace.u);
    std::mem::swap(&mut state.v, &mut workspace.v);
    if matches!(method, Method::Bdf2) {
        // The old state is now in the workspace; what was there goes back as scratch.
        let previous = state.previous.get_or_insert_default();
        previous.u.resize(workspace.u.len(), 0.0);
        previous.v.resize(workspace.v.len(), 0.0);
        std::mem::swap(&mut previous.u, &mut workspace.u);
        std::mem::swap(&mut previous.v, &mut workspace.v);
        previous.step = h;
    } else {
        state.previous = None;
    }
    if method.is_explicit() {
        state.guess.clear();
    } else {
        state.guess.clone_from(&workspace.a);
    }
    if matches!(method, Method::Newmark { .. }) {
        state.acceleration.clone_from(&workspace.implicit.total);
    } else {
        state.acceleration.clear();
    }
}
