//! Implicit methods, all by the same stage.
//!
//! Each method is a family of states in the unknown acceleration a, and asks for balance in that family:
//!
//! ```text
//! u = û + b a,   v = v̂ + c a,   M a = F(t*, u, v)
//!
//!                     û                               v̂                    b          c        t*
//! implicit Euler      u₀ + h v₀                       v₀                   h²         h        t₀ + h
//! implicit midpoint   u₀ + h/2 v₀                     v₀                   h²/4       h/2      t₀ + h/2
//! BDF2                ū + τ v̄                         v̄                    τ²         τ        t₀ + h
//! Newmark             u₀ + h v₀ + h² (½ − β) a₀       v₀ + h (1 − γ) a₀    β h²       γ h      t₀ + h
//! ```
//!
//! with ū, v̄, τ of BDF2 in [`bdf2`]. Linearised about the beginning of the step, (u₀, v₀), balance reads
//!
//! ```text
//! (M + c D + b K) a = F(t*, u₀, v₀) − K (û − u₀) − D (v̂ − v₀)
//! ```
//!
//! For implicit Euler, a = ΔV/h, that is (M − h ∂F/∂V − h² ∂F/∂U) ΔV = h F + h² (∂F/∂U) V of D. Baraff and A. Witkin,
//! "Large steps in cloth simulation", 1998, eq. 6.
//! Why the acceleration as unknown rather than ΔV: its scale does not change with h, so the acceleration of the last
//! step is a good start for the next one.
//!
//! Prescribed unknowns: the prescribed part of û and v̂ is overwritten by the values at t*, and a = a_free + a_known,
//! where a_known carries the inertia of the prescribed motion ([`Inertia`]). All three go to the right-hand side, and
//! the solve is for a_free, in the range of P.
//!
//! References: E. Hairer and G. Wanner, "Solving Ordinary Differential Equations II", §III.5 of volume I for variable
//! step BDF; N. M. Newmark, "A method of computation for structural dynamics", 1959.

use crate::cg::LinearReport;
use crate::failure::{Failure, FailureKind, check_finite};
use crate::newton::{NewtonOptions, NewtonProblem, NewtonStatus, newton};
use crate::second_order::{Combination, SecondOrder};
use crate::step::{ImplicitWorkspace, State, StepOptions, StepReport, StepStatus, StepWorkspace, WarmStart};
use crate::vector::norm;
use std::ops::ControlFlow;

pub(crate) fn implicit_euler(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    for i in 0..state.u.len() {
        workspace.stage_u[i] = state.u[i] + h * state.v[i];
        workspace.stage_v[i] = state.v[i];
    }
    let stage = Stage { t: state.t + h, b: h * h, c: h, inertia: Inertia::OfStage };
    stage.solve(system, state, options, workspace, report)
}

pub(crate) fn implicit_midpoint(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    let half = 0.5 * h;
    for i in 0..state.u.len() {
        workspace.stage_u[i] = state.u[i] + half * state.v[i];
        workspace.stage_v[i] = state.v[i];
    }
    let stage = Stage { t: state.t + half, b: half * half, c: half, inertia: Inertia::MeanOfStep(h) };
    stage.solve(system, state, options, workspace, report)?;
    // From the middle to the end: u₁ = 2 u − u₀, v₁ = 2 v − v₀.
    for i in 0..state.u.len() {
        workspace.u[i] = 2.0 * workspace.u[i] - state.u[i];
        workspace.v[i] = 2.0 * workspace.v[i] - state.v[i];
    }
    Ok(())
}

/// Backward differences over the last two steps, the last one r times shorter than the one to come:
/// y₁ = ȳ + τ y₁', ȳ = ((1 + r)² y₀ − r² y₋₁) / (1 + 2 r), τ = h (1 + r) / (1 + 2 r).
///
/// The first step has no past and is one of the implicit midpoint rule, of the same order.
pub(crate) fn bdf2(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    let Some(previous) = &state.previous else {
        return implicit_midpoint(system, state, h, options, workspace, report);
    };
    let ratio = h / previous.step;
    let scale = 1.0 / (1.0 + 2.0 * ratio);
    let (now, before) = ((1.0 + ratio) * (1.0 + ratio) * scale, -ratio * ratio * scale);
    let tau = h * (1.0 + ratio) * scale;
    for i in 0..state.u.len() {
        let v_bar = now * state.v[i] + before * previous.v[i];
        workspace.stage_u[i] = now * state.u[i] + before * previous.u[i] + tau * v_bar;
        workspace.stage_v[i] = v_bar;
    }
    let stage = Stage { t: state.t + h, b: tau * tau, c: tau, inertia: Inertia::OfStage };
    stage.solve(system, state, options, workspace, report)
}

pub(crate) fn newmark(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    beta: f64,
    gamma: f64,
    options: &StepOptions,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    // The first step finds its acceleration from the forces.
    if state.acceleration.is_empty() {
        initial_acceleration(system, state, h, workspace, report)?;
    } else {
        workspace.a.copy_from_slice(&state.acceleration);
    }
    for i in 0..state.u.len() {
        let a = workspace.a[i];
        workspace.stage_u[i] = state.u[i] + h * state.v[i] + h * h * (0.5 - beta) * a;
        workspace.stage_v[i] = state.v[i] + h * (1.0 - gamma) * a;
    }
    let stage = Stage { t: state.t + h, b: beta * h * h, c: gamma * h, inertia: Inertia::EndOfStep(h) };
    stage.solve(system, state, options, workspace, report)
}

/// a ← P M⁻¹ P (F(t₀, u₀, v₀) − M a_known), with the inertia of the prescribed motion at the start of the step.
fn initial_acceleration(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    let StepWorkspace { force, a, implicit, .. } = workspace;
    prescribed_acceleration(system, state, h, [-3.0, 4.0, -1.0], implicit);
    system.force(state.t, &state.u, &state.v, force)?;
    if !is_zero(&implicit.known) {
        system.mass_apply(&implicit.known, &mut implicit.product);
        subtract(&implicit.product, force);
    }
    system.project(force);
    check_finite("the force", force)?;
    a.fill(0.0);
    let linear = system.mass_solve(force, a);
    report.record(linear)
}

/// known ← Σ wₖ V(t₀ + k h/2) / h: a one-sided second-order derivative of the prescribed velocity, zero elsewhere.
fn prescribed_acceleration(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    weights: [f64; 3],
    implicit: &mut ImplicitWorkspace,
) {
    let ImplicitWorkspace { known, product: start, total: velocity, trial_u, .. } = implicit;
    trial_u.copy_from_slice(&state.u);
    start.copy_from_slice(&state.v);
    system.prescribe(state.t, trial_u, start);
    known.fill(0.0);
    // The weights sum to zero: differences from the start leave free unknowns at zero exactly.
    for (weight, fraction) in weights.into_iter().zip([0.0, 0.5, 1.0]).skip(1) {
        velocity.copy_from_slice(start);
        system.prescribe(state.t + fraction * h, trial_u, velocity);
        for i in 0..known.len() {
            known[i] += weight * (velocity[i] - start[i]) / h;
        }
    }
}

/// How the acceleration of prescribed unknowns follows from their prescribed velocities V; to the order of the method.
enum Inertia {
    /// (V(t*) − v̂)/c: the method's own difference quotient.
    OfStage,
    /// (V(t₀ + h) − v₀)/h: that of the middle of a step of h.
    MeanOfStep(f64),
    /// (3 V(t₀ + h) − 4 V(t₀ + h/2) + V(t₀))/h: that of its end. Why not the method's own quotient: Newmark's recurrence
    /// lets an error of the first acceleration alternate for ever.
    EndOfStep(f64),
}

/// The family u = û + b a, v = v̂ + c a at time t; û and v̂ are in the workspace.
struct Stage {
    t: f64,
    b: f64,
    c: f64,
    inertia: Inertia,
}

impl Stage {
    fn combination(&self) -> Combination {
        Combination { mass: 1.0, damping: self.c, stiffness: self.b }
    }

    /// Finds a, and writes u and v of the stage and a into the workspace (`a`: free part, `implicit.total`: all of it).
    fn solve(
        &self,
        system: &mut dyn SecondOrder,
        state: &State,
        options: &StepOptions,
        workspace: &mut StepWorkspace,
        report: &mut StepReport,
    ) -> Result<(), Failure> {
        let StepWorkspace { u, v, stage_u, stage_v, force, a, implicit } = workspace;

        self.set_prescribed(system, state, stage_u, stage_v, implicit);

        let rhs = force;
        self.linearised_rhs(system, state, stage_u, stage_v, implicit, rhs)?;
        match options.warm_start {
            WarmStart::Previous if state.guess.len() == a.len() => {
                a.copy_from_slice(&state.guess);
                system.project(a);
            }
            _ => a.fill(0.0),
        }
        let linear = system.solve(self.combination(), rhs, a);
        report.record(linear)?;
        report.newton_iterations = 1;
        check_finite("the acceleration", a)?;
        if options.newton_iterations > 1 {
            let scale = norm(rhs);
            self.iterate(system, state, options, scale, stage_u, stage_v, a, implicit, report)?;
        }

        for i in 0..a.len() {
            implicit.total[i] = a[i] + implicit.known[i];
            u[i] = stage_u[i] + self.b * a[i];
            v[i] = stage_v[i] + self.c * a[i];
        }
        Ok(())
    }

    /// Sets the prescribed parts of û, v̂ and a.
    fn set_prescribed(
        &self,
        system: &mut dyn SecondOrder,
        state: &State,
        stage_u: &mut [f64],
        stage_v: &mut [f64],
        implicit: &mut ImplicitWorkspace,
    ) {
        let known = &mut implicit.known;
        match self.inertia {
            Inertia::OfStage => {
                known.copy_from_slice(stage_v);
                system.prescribe(self.t, stage_u, stage_v);
                for (known, prescribed) in known.iter_mut().zip(&*stage_v) {
                    *known = (prescribed - *known) / self.c;
                }
            }
            Inertia::MeanOfStep(h) => {
                implicit.trial_u.copy_from_slice(&state.u);
                known.copy_from_slice(&state.v);
                system.prescribe(state.t + h, &mut implicit.trial_u, known);
                for (known, start) in known.iter_mut().zip(&state.v) {
                    *known = (*known - start) / h;
                }
                system.prescribe(self.t, stage_u, stage_v);
            }
            Inertia::EndOfStep(h) => {
                prescribed_acceleration(system, state, h, [1.0, -4.0, 3.0], implicit);
                system.prescribe(self.t, stage_u, stage_v);
            }
        }
    }

    /// rhs ← P (F(t, u₀, v₀) − K (û − u₀) − D (v̂ − v₀) − M a_known)
    fn linearised_rhs(
        &self,
        system: &mut dyn SecondOrder,
        state: &State,
        stage_u: &[f64],
        stage_v: &[f64],
        implicit: &mut ImplicitWorkspace,
        rhs: &mut [f64],
    ) -> Result<(), Failure> {
        let ImplicitWorkspace { known, product, total: difference, .. } = implicit;
        system.force(self.t, &state.u, &state.v, rhs)?;
        system.linearise(self.t, &state.u, &state.v)?;
        subtract_into(stage_u, &state.u, difference);
        if !is_zero(difference) {
            system.stiffness_apply(difference, product);
            subtract(product, rhs);
        }
        subtract_into(stage_v, &state.v, difference);
        if !is_zero(difference) {
            system.damping_apply(difference, product);
            subtract(product, rhs);
        }
        if !is_zero(known) {
            system.mass_apply(known, product);
            subtract(product, rhs);
        }
        system.project(rhs);
        check_finite("the force", rhs)
    }

    /// Newton iterations on M a − F = 0 from the linearised solution.
    fn iterate(
        &self,
        system: &mut dyn SecondOrder,
        state: &State,
        options: &StepOptions,
        scale: f64,
        stage_u: &[f64],
        stage_v: &[f64],
        a: &mut [f64],
        implicit: &mut ImplicitWorkspace,
        report: &mut StepReport,
    ) -> Result<(), Failure> {
        let ImplicitWorkspace { known, total, product, trial_u, trial_v, newton: newton_workspace } = implicit;
        let newton_options = NewtonOptions {
            relative_tolerance: 0.0,
            absolute_tolerance: options.newton_absolute_tolerance.max(options.newton_tolerance * scale),
            max_iterations: options.newton_iterations - 1,
            line_search: options.line_search.clone(),
            ..NewtonOptions::default()
        };
        let mut linear_solves = 0;
        let mut problem = Balance {
            system,
            stage: self,
            stage_u,
            stage_v,
            known,
            total,
            product,
            u: trial_u,
            v: trial_v,
            linear_solves: &mut linear_solves,
        };
        let watch = &mut |_: &_| ControlFlow::Continue(());
        let mut outcome = newton(&mut problem, a, &newton_options, newton_workspace, watch);
        let refused_start = matches!(&outcome.status, NewtonStatus::Failed(failure) if failure.shorter_may_help())
            && outcome.iterations == 0;
        if refused_start && self.b > 0.0 {
            // The linearised step went where the system refuses to be: start again from the old position.
            for i in 0..a.len() {
                a[i] = (state.u[i] - stage_u[i]) / self.b;
            }
            problem.system.project(a);
            outcome = newton(&mut problem, a, &newton_options, newton_workspace, watch);
        }
        report.linear_solves += linear_solves;
        report.linear_iterations += outcome.linear_iterations;
        report.newton_iterations += outcome.iterations;
        report.unbalanced = Some(outcome.residual);
        if outcome.linear_fault.is_some() {
            report.linear = outcome.linear_fault;
        }
        match outcome.status {
            NewtonStatus::Converged | NewtonStatus::Interrupted => Ok(()),
            // Not worse than the linearised step, which is kept without asking; the report says that it is not balanced.
            status @ (NewtonStatus::MaxIterations | NewtonStatus::Stalled | NewtonStatus::LineSearchFailed(None)) => {
                report.status = StepStatus::Unconverged(status);
                Ok(())
            }
            NewtonStatus::Failed(failure) | NewtonStatus::LineSearchFailed(Some(failure)) => Err(failure),
            status => Err(Failure {
                kind: FailureKind::Nonlinear,
                place: None,
                message: format!(
                    "Newton's iterations ended with {status:?}: the unbalanced force is {:.3e} N and should be below {:.3e} N; \
                     a shorter time step makes the balance easier to find",
                    outcome.residual, newton_options.absolute_tolerance
                ),
            }),
        }
    }
}

/// The balance M a − F(t, û + b a, v̂ + c a) = 0 of a stage, in the free part of a.
struct Balance<'a> {
    system: &'a mut dyn SecondOrder,
    stage: &'a Stage,
    stage_u: &'a [f64],
    stage_v: &'a [f64],
    known: &'a [f64],
    total: &'a mut [f64],
    product: &'a mut [f64],
    u: &'a mut [f64],
    v: &'a mut [f64],
    linear_solves: &'a mut usize,
}

impl Balance<'_> {
    fn set_state(&mut self, a: &[f64]) {
        for i in 0..a.len() {
            self.total[i] = a[i] + self.known[i];
            self.u[i] = self.stage_u[i] + self.stage.b * a[i];
            self.v[i] = self.stage_v[i] + self.stage.c * a[i];
        }
    }
}

impl NewtonProblem for Balance<'_> {
    fn len(&self) -> usize {
        self.stage_u.len()
    }

    fn residual(&mut self, a: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        self.set_state(a);
        self.system.force(self.stage.t, self.u, self.v, self.product)?;
        self.system.mass_apply(self.total, out);
        subtract(self.product, out);
        self.system.project(out);
        Ok(())
    }

    fn linearise(&mut self, a: &[f64]) -> Result<(), Failure> {
        self.set_state(a);
        self.system.linearise(self.stage.t, self.u, self.v)
    }

    fn solve_linear(&mut self, rhs: &[f64], dx: &mut [f64]) -> LinearReport {
        *self.linear_solves += 1;
        self.system.solve(self.stage.combination(), rhs, dx)
    }
}

fn subtract(x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= x;
    }
}

fn subtract_into(x: &[f64], y: &[f64], out: &mut [f64]) {
    for ((out, x), y) in out.iter_mut().zip(x).zip(y) {
        *out = x - y;
    }
}

fn is_zero(x: &[f64]) -> bool {
    x.iter().all(|&value| value == 0.0)
}
