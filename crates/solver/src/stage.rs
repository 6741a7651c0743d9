//! One implicit stage: balance in a family of states, with some unknowns prescribed.
//!
//! ```text
//! u = û + b a,   v = v̂ + c a,   M a = F(t*, u, v)
//! ```
//!
//! Linearised about the beginning of the step, (u₀, v₀), balance reads
//!
//! ```text
//! (M + c D + b K) a = F(t*, u₀, v₀) − K (û − u₀) − D (v̂ − v₀)
//! ```
//!
//! Prescribed unknowns: the prescribed part of û and v̂ is overwritten by the values at t*, and a = a_free + a_known,
//! where a_known carries the inertia of the prescribed motion ([`Inertia`]). All three go to the right-hand side, and
//! the solve is for a_free, in the range of P.
//!
//! With more than one Newton iteration the linearised solution is the start of [`crate::newton()`] on M a − F = 0.

use crate::cg::LinearReport;
use crate::failure::{Failure, FailureKind, check_finite};
use crate::newton::{NewtonOptions, NewtonProblem, NewtonStatus, newton};
use crate::second_order::{Combination, SecondOrder};
use crate::step::{ImplicitWorkspace, State, StepOptions, StepReport, StepStatus, StepWorkspace, WarmStart};
use crate::vector::norm;
use std::ops::ControlFlow;

/// known ← Σ wₖ V(t₀ + k h/2) / h: a one-sided second-order derivative of the prescribed velocity, zero elsewhere.
pub(crate) fn prescribed_acceleration(
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
pub(crate) enum Inertia {
    /// (V(t*) − v̂)/c: the method's own difference quotient.
    OfStage,
    /// (V(t₀ + h) − v₀)/h: that of the middle of a step of h.
    MeanOfStep(f64),
    /// (3 V(t₀ + h) − 4 V(t₀ + h/2) + V(t₀))/h: that of its end. Why not the method's own quotient: Newmark's recurrence
    /// lets an error of the first acceleration alternate for ever.
    EndOfStep(f64),
}

/// The family u = û + b a, v = v̂ + c a at time t; û and v̂ are in the workspace.
pub(crate) struct Stage {
    pub(crate) t: f64,
    pub(crate) b: f64,
    pub(crate) c: f64,
    pub(crate) inertia: Inertia,
}

impl Stage {
    fn combination(&self) -> Combination {
        Combination { mass: 1.0, damping: self.c, stiffness: self.b }
    }

    /// Finds a, and writes u and v of the stage and a into the workspace (`a`: free part, `implicit.total`: all of it).
    pub(crate) fn solve(
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
        self.system.admissible(self.stage.t, self.u, self.v)?;
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

pub(crate) fn subtract(x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y -= x;
    }
}

fn subtract_into(x: &[f64], y: &[f64], out: &mut [f64]) {
    for ((out, x), y) in out.iter_mut().zip(x).zip(y) {
        *out = x - y;
    }
}

pub(crate) fn is_zero(x: &[f64]) -> bool {
    x.iter().all(|&value| value == 0.0)
}
