//! Explicit methods: forces only, no linear system but the mass.
//!
//! Prescribed unknowns take their values at the time of each stage; the accelerations of the others come from
//! P M P a = P F. With a mass that couples prescribed and free unknowns (a consistent mass) the inertia of the
//! prescribed motion is therefore not felt by its neighbours; with a diagonal mass there is none to feel.

use crate::failure::{Failure, check_finite};
use crate::second_order::SecondOrder;
use crate::step::{State, StepReport, StepWorkspace};

/// A Runge–Kutta method in which each stage starts from the derivative of the stage before only:
/// yᵢ = y₀ + cᵢ h f(yᵢ₋₁), y₁ = y₀ + h Σ bᵢ f(yᵢ).
pub(crate) struct RungeKutta {
    nodes: &'static [f64],
    weights: &'static [f64],
}

impl RungeKutta {
    pub(crate) const EULER: Self = Self { nodes: &[0.0], weights: &[1.0] };
    pub(crate) const MIDPOINT: Self = Self { nodes: &[0.0, 0.5], weights: &[0.0, 1.0] };
    pub(crate) const CLASSICAL: Self =
        Self { nodes: &[0.0, 0.5, 0.5, 1.0], weights: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0] };
}

/// a ← M⁻¹ F(t, u, v) on the free directions.
fn acceleration(
    system: &mut dyn SecondOrder,
    t: f64,
    u: &[f64],
    v: &[f64],
    force: &mut [f64],
    a: &mut [f64],
    report: &mut StepReport,
) -> Result<(), Failure> {
    system.force(t, u, v, force)?;
    system.project(force);
    check_finite("the force", force)?;
    a.fill(0.0);
    let linear = system.mass_solve(force, a);
    report.record(linear)
}

pub(crate) fn runge_kutta(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    method: &RungeKutta,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    let StepWorkspace { u, v, stage_u, stage_v, force, a, .. } = workspace;
    u.copy_from_slice(&state.u);
    v.copy_from_slice(&state.v);
    stage_u.copy_from_slice(&state.u);
    stage_v.copy_from_slice(&state.v);
    for (stage, (node, weight)) in method.nodes.iter().zip(method.weights).enumerate() {
        if stage > 0 {
            // The derivative of the stage before is (stage_v, a).
            for i in 0..u.len() {
                stage_u[i] = state.u[i] + node * h * stage_v[i];
                stage_v[i] = state.v[i] + node * h * a[i];
            }
            system.prescribe(state.t + node * h, stage_u, stage_v);
        }
        acceleration(system, state.t + node * h, stage_u, stage_v, force, a, report)?;
        for i in 0..u.len() {
            u[i] += weight * h * stage_v[i];
            v[i] += weight * h * a[i];
        }
    }
    Ok(())
}

pub(crate) fn symplectic_euler(
    system: &mut dyn SecondOrder,
    state: &State,
    h: f64,
    workspace: &mut StepWorkspace,
    report: &mut StepReport,
) -> Result<(), Failure> {
    let StepWorkspace { u, v, force, a, .. } = workspace;
    acceleration(system, state.t, &state.u, &state.v, force, a, report)?;
    for i in 0..u.len() {
        v[i] = state.v[i] + h * a[i];
        u[i] = state.u[i] + h * v[i];
    }
    Ok(())
}
