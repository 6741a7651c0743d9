//! Preconditioned conjugate gradients on the range of a projection.
//!
//! Solves P A P y = P (b − A x₀) for x = x₀ + y, y in the range of P, where x₀ is what the caller passes in.
//! The part of x₀ outside the range of P (known values of eliminated unknowns) is therefore kept to the last bit and
//! its effect is accounted for.
//! A must be symmetric; where it turns out not to be positive definite on the range of P, the method stops and says so.
//!
//! References: M. R. Hestenes and E. Stiefel, "Methods of conjugate gradients for solving linear systems", 1952;
//! D. Baraff and A. Witkin, "Large steps in cloth simulation", 1998, §5.3, for the projection inside the iteration.
//!
//! The update of x lags behind that of the residual by half an iteration: it shares a pass over memory with the update
//! of the direction, and an iterate whose residual is not finite is never taken.

use crate::operator::{LinearOperator, Preconditioner, Projector};
use crate::vector::{PairwiseSum, SUM_BLOCK, VectorOps, block_dot};

/// When to stop.
#[derive(Clone, Debug, PartialEq)]
pub struct CgOptions {
    /// Stop when ‖r‖ ≤ this × ‖P b‖ (× the initial ‖r‖ where P b = 0).
    pub relative_tolerance: f64,
    /// Stop when ‖r‖ ≤ this, in units of the right-hand side.
    pub absolute_tolerance: f64,
    /// Stop after this many products with A (beyond the one for the initial residual).
    pub max_iterations: usize,
}

impl Default for CgOptions {
    fn default() -> Self {
        Self { relative_tolerance: 1e-6, absolute_tolerance: 0.0, max_iterations: 1000 }
    }
}

/// How a linear solve ended. Direct solvers report themselves in the same words.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearReport {
    /// Products with the matrix (0 for a direct solve).
    pub iterations: usize,
    /// ‖P (b − A x₀)‖
    pub initial_residual: f64,
    /// ‖P (b − A x)‖ as the recurrence knows it.
    pub residual: f64,
    /// Why it stopped.
    pub status: LinearStatus,
}

/// Why a linear solve stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum LinearStatus {
    /// The tolerance was met.
    Converged,
    /// The tolerance was not met in the allowed number of iterations; x is the best iterate so far.
    MaxIterations,
    /// A direction p with pᵀ A p ≤ 0 was met: A is not positive definite on the free directions. x is the last iterate
    /// before it; at the very first iteration it is the known part plus the preconditioned residual, a direction of
    /// descent for ½ xᵀAx − bᵀx.
    NegativeCurvature {
        /// pᵀ A p
        p_a_p: f64,
    },
    /// The preconditioner gave rᵀ M⁻¹ r ≤ 0: it is not positive definite on the free directions.
    IndefinitePreconditioner {
        /// rᵀ M⁻¹ r
        r_z: f64,
    },
    /// A factorisation met a pivot that is zero or of the wrong sign.
    Singular {
        /// Index of the unknown whose pivot it is.
        unknown: usize,
    },
    /// A product gave an infinity or a NaN. x is the last iterate before it.
    NotFinite,
}

impl LinearReport {
    /// Report of a solve that is exact up to rounding.
    pub fn direct(initial_residual: f64) -> Self {
        Self { iterations: 0, initial_residual, residual: 0.0, status: LinearStatus::Converged }
    }

    /// Whether the tolerance was met.
    pub fn converged(&self) -> bool {
        self.status == LinearStatus::Converged
    }

    /// Whether x is worth using although the tolerance may not be met.
    pub fn usable(&self) -> bool {
        match self.status {
            LinearStatus::Converged | LinearStatus::MaxIterations | LinearStatus::NegativeCurvature { .. } => true,
            LinearStatus::IndefinitePreconditioner { .. } => self.iterations > 0,
            LinearStatus::Singular { .. } | LinearStatus::NotFinite => false,
        }
    }
}

/// The four vectors of the method, sized once.
#[derive(Clone, Debug, Default)]
pub struct CgWorkspace {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl CgWorkspace {
    /// For `len` unknowns.
    pub fn new(len: usize) -> Self {
        Self { r: vec![0.0; len], z: vec![0.0; len], p: vec![0.0; len], q: vec![0.0; len] }
    }
}

/// Solves A x = b on the range of `projector`, starting from the x passed in.
///
/// `rhs` and `x` have the length of `operator`; so must the workspace.
/// x is always finite if it came in finite: see [`LinearStatus`] for what it holds when the solve did not converge.
///
/// # Panics
/// When lengths differ.
pub fn cg(
    operator: &dyn LinearOperator,
    preconditioner: &dyn Preconditioner,
    projector: &dyn Projector,
    ops: &dyn VectorOps,
    rhs: &[f64],
    x: &mut [f64],
    options: &CgOptions,
    workspace: &mut CgWorkspace,
) -> LinearReport {
    let len = operator.len();
    assert_eq!(rhs.len(), len, "the right-hand side has one entry per unknown");
    assert_eq!(x.len(), len, "the solution has one entry per unknown");
    assert_eq!(workspace.r.len(), len, "the workspace was made for this number of unknowns");
    let CgWorkspace { r, z, p, q } = workspace;

    // The right-hand side sets the scale of the tolerance, so that a good start is not asked for more digits.
    r.copy_from_slice(rhs);
    projector.project(r);
    let mut rr = ops.dot(r, r);
    let mut reference = rr.sqrt();
    if x.iter().any(|&value| value != 0.0) {
        residual(operator, projector, ops, rhs, x, q, r);
        rr = ops.dot(r, r);
        if reference == 0.0 {
            reference = rr.sqrt();
        }
    }
    let initial_residual = rr.sqrt();
    let tolerance = options.absolute_tolerance.max(options.relative_tolerance * reference);
    let report = |iterations, residual, status| LinearReport { iterations, initial_residual, residual, status };

    if !rr.is_finite() {
        return report(0, initial_residual, LinearStatus::NotFinite);
    }
    if initial_residual <= tolerance {
        return report(0, initial_residual, LinearStatus::Converged);
    }
    preconditioner.apply(r, z);
    projector.project(z);
    let mut rz = ops.dot(r, z);
    if let Some(status) = preconditioner_fault(rz) {
        return report(0, initial_residual, status);
    }
    p.copy_from_slice(z);

    let mut norm = initial_residual;
    for iteration in 0..options.max_iterations {
        let p_a_p = operator.apply_and_dot(projector, p, q);
        if !p_a_p.is_finite() {
            return report(iteration, norm, LinearStatus::NotFinite);
        }
        if p_a_p <= 0.0 {
            if iteration == 0 {
                norm = steepest_descent(operator, preconditioner, projector, ops, rhs, x, q, r, z);
            }
            return report(iteration, norm, LinearStatus::NegativeCurvature { p_a_p });
        }
        let alpha = rz / p_a_p;
        let descended = descend(preconditioner, projector, ops, -alpha, q, r, z);
        rr = descended.0;
        if !rr.is_finite() {
            return report(iteration, norm, LinearStatus::NotFinite);
        }
        norm = rr.sqrt();
        if norm <= tolerance {
            ops.axpy(alpha, p, x);
            return report(iteration + 1, norm, LinearStatus::Converged);
        }
        let rz_next = descended.1;
        if let Some(status) = preconditioner_fault(rz_next) {
            ops.axpy(alpha, p, x);
            return report(iteration + 1, norm, status);
        }
        ops.advance(alpha, rz_next / rz, z, p, x);
        rz = rz_next;
    }
    report(options.max_iterations, norm, LinearStatus::MaxIterations)
}

/// r ← r + a q, z ← P M⁻¹ r; returns r · r and r · z. One pass over memory where the preconditioner works part by part.
fn descend(
    preconditioner: &dyn Preconditioner,
    projector: &dyn Projector,
    ops: &dyn VectorOps,
    a: f64,
    q: &[f64],
    r: &mut [f64],
    z: &mut [f64],
) -> (f64, f64) {
    let (mut rr, mut rz) = (PairwiseSum::new(), PairwiseSum::new());
    let mut in_parts = true;
    let parts = q.chunks(SUM_BLOCK).zip(r.chunks_mut(SUM_BLOCK)).zip(z.chunks_mut(SUM_BLOCK));
    for (part, ((q, r), z)) in parts.enumerate() {
        ops.axpy(a, q, r);
        rr.push(block_dot(r, r));
        let first = part * SUM_BLOCK;
        in_parts = in_parts && preconditioner.apply_part(first, r, z) && projector.project_part(first, z);
        if in_parts {
            rz.push(block_dot(r, z));
        }
    }
    if in_parts {
        return (rr.total(), rz.total());
    }
    preconditioner.apply(r, z);
    projector.project(z);
    (rr.total(), ops.dot(r, z))
}

/// r ← P (b − A x), with `q` as scratch.
fn residual(
    operator: &dyn LinearOperator,
    projector: &dyn Projector,
    ops: &dyn VectorOps,
    rhs: &[f64],
    x: &[f64],
    q: &mut [f64],
    r: &mut [f64],
) {
    operator.apply(x, q);
    r.copy_from_slice(rhs);
    ops.axpy(-1.0, q, r);
    projector.project(r);
}

fn preconditioner_fault(r_z: f64) -> Option<LinearStatus> {
    if !r_z.is_finite() {
        Some(LinearStatus::NotFinite)
    } else if r_z <= 0.0 {
        Some(LinearStatus::IndefinitePreconditioner { r_z })
    } else {
        None
    }
}

/// Replaces x by its known part plus z = P M⁻¹ P (b − A x_known), and returns the norm of the residual there.
///
/// Why not from the warm start: only from the known part is z a direction of descent for the quadratic that the caller
/// minimises.
fn steepest_descent(
    operator: &dyn LinearOperator,
    preconditioner: &dyn Preconditioner,
    projector: &dyn Projector,
    ops: &dyn VectorOps,
    rhs: &[f64],
    x: &mut [f64],
    q: &mut [f64],
    r: &mut [f64],
    z: &mut [f64],
) -> f64 {
    // x ← (I − P) x
    q.copy_from_slice(x);
    projector.project(q);
    for (x, q) in x.iter_mut().zip(&*q) {
        *x -= q;
    }
    residual(operator, projector, ops, rhs, x, q, r);
    preconditioner.apply(r, z);
    projector.project(z);
    if z.iter().all(|value| value.is_finite()) {
        ops.axpy(1.0, z, x);
        residual(operator, projector, ops, rhs, x, q, r);
    }
    ops.dot(r, r).sqrt()
}
