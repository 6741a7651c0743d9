//! Implicit methods, all by the same stage.
//!
//! Each method is a family of states in the unknown acceleration a, and asks for balance in that family; the private
//! module `stage` solves for it:
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
//! with ȳ = ((1 + r)² y₀ − r² y₋₁) / (1 + 2 r) and τ = h (1 + r) / (1 + 2 r), r the ratio of this step to the last.
//!
//! For implicit Euler, a = ΔV/h, and the stage linearised once is the well-known
//! (M − h ∂F/∂V − h² ∂F/∂U) ΔV = h F + h² (∂F/∂U) V: D. Baraff and A. Witkin, "Large steps in cloth simulation", 1998,
//! eq. 6.
//! Why the acceleration as unknown rather than ΔV: its scale does not change with h, so the acceleration of the last
//! step is a good start for the next one.
//!
//! References: E. Hairer, S. Nørsett and G. Wanner, "Solving Ordinary Differential Equations I", §III.5, for variable
//! step BDF; N. M. Newmark, "A method of computation for structural dynamics", 1959.

use crate::failure::{Failure, check_finite};
use crate::second_order::SecondOrder;
use crate::stage::{Inertia, Stage, is_zero, prescribed_acceleration, subtract};
use crate::step::{State, StepOptions, StepReport, StepWorkspace};

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
