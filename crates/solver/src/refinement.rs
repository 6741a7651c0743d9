//! Conjugate gradients with a cheaper matrix, corrected with the true one.
//!
//! ```text
//! r = P (b − A x)      with the true matrix
//! Ã d ≈ r              conjugate gradients with the cheap one
//! x ← x + d
//! ```
//!
//! Ã differs from A by rounding, as a copy in single precision does: products then read half the memory, and one
//! correction is usually enough. The tolerance is that of the true residual; where corrections stop helping (the matrix
//! is too ill-conditioned for Ã), the true matrix finishes alone.
//!
//! Reference: J. H. Wilkinson, "Rounding errors in algebraic processes", 1963, on iterative refinement.

use crate::cg::{CgOptions, CgWorkspace, LinearReport, LinearStatus, cg};
use crate::operator::{LinearOperator, Preconditioner, Projector};
use crate::vector::VectorOps;

/// Corrections at most; each should shrink the residual by orders of magnitude.
const CORRECTIONS: usize = 5;

/// A correction that leaves more than this share of the residual is not worth another one.
const WORTH: f64 = 0.1;

/// Share of the tolerance that a correction aims at: the true residual differs from the one that its recurrence knows.
const AIM: f64 = 0.5;

/// Vectors of the corrections, sized once.
#[derive(Clone, Debug, Default)]
pub struct RefinementWorkspace {
    residual: Vec<f64>,
    correction: Vec<f64>,
}

impl RefinementWorkspace {
    /// For `len` unknowns.
    pub fn new(len: usize) -> Self {
        Self { residual: vec![0.0; len], correction: vec![0.0; len] }
    }
}

/// Solves A x = b on the range of `projector` as [`cg`] does, with products of `cheap` wherever they are good enough.
///
/// The report counts the iterations of all conjugate gradients, and one more for each product with A.
///
/// # Panics
/// When lengths differ.
pub fn refined_cg(
    operator: &dyn LinearOperator,
    cheap: &dyn LinearOperator,
    preconditioner: &dyn Preconditioner,
    projector: &dyn Projector,
    ops: &dyn VectorOps,
    rhs: &[f64],
    x: &mut [f64],
    options: &CgOptions,
    workspace: &mut CgWorkspace,
    refinement: &mut RefinementWorkspace,
) -> LinearReport {
    assert_eq!(refinement.residual.len(), operator.len(), "the workspace was made for this number of unknowns");
    let RefinementWorkspace { residual, correction } = refinement;
    residual.copy_from_slice(rhs);
    projector.project(residual);
    let reference = ops.dot(residual, residual).sqrt();
    let mut iterations = 0;
    let measure = |x: &[f64], residual: &mut [f64], scratch: &mut [f64]| -> f64 {
        if x.iter().any(|&value| value != 0.0) {
            operator.apply(x, scratch);
            residual.copy_from_slice(rhs);
            ops.axpy(-1.0, scratch, residual);
            projector.project(residual);
        }
        ops.dot(residual, residual).sqrt()
    };
    let initial_residual = measure(x, residual, correction);
    let scale = if reference == 0.0 { initial_residual } else { reference };
    let tolerance = options.absolute_tolerance.max(options.relative_tolerance * scale);
    let mut norm = initial_residual;
    for _ in 0..CORRECTIONS {
        if norm <= tolerance {
            return LinearReport { iterations, initial_residual, residual: norm, status: LinearStatus::Converged };
        }
        if !norm.is_finite() || iterations >= options.max_iterations {
            break;
        }
        let inner = CgOptions {
            relative_tolerance: 0.0,
            absolute_tolerance: AIM * tolerance,
            max_iterations: options.max_iterations - iterations,
        };
        correction.fill(0.0);
        let report = cg(cheap, preconditioner, projector, ops, residual, correction, &inner, workspace);
        iterations += report.iterations + 1;
        if !matches!(report.status, LinearStatus::Converged | LinearStatus::MaxIterations) {
            break;
        }
        ops.axpy(1.0, correction, x);
        let before = norm;
        norm = measure(x, residual, correction);
        if norm > tolerance && norm > WORTH * before {
            break;
        }
    }
    if norm <= tolerance {
        return LinearReport { iterations, initial_residual, residual: norm, status: LinearStatus::Converged };
    }
    let options = CgOptions {
        relative_tolerance: 0.0,
        absolute_tolerance: tolerance,
        max_iterations: options.max_iterations.saturating_sub(iterations),
    };
    let report = cg(operator, preconditioner, projector, ops, rhs, x, &options, workspace);
    LinearReport { iterations: iterations + report.iterations, initial_residual, ..report }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::{Identity, NoProjection, OperatorFromFn};
    use crate::vector::{Serial, norm};

    /// −u'' with `n` points, plus `shift`: as ill-conditioned as asked for.
    fn product(n: usize, shift: f64, x: &[f64], y: &mut [f64]) {
        for i in 0..n {
            let before = if i > 0 { x[i - 1] } else { 0.0 };
            let after = if i + 1 < n { x[i + 1] } else { 0.0 };
            y[i] = (2.0 + shift) * x[i] - before - after;
        }
    }

    /// The true residual meets the tolerance whatever the cheap matrix is off by, and with a good one the true matrix is
    /// asked only to measure it.
    #[test]
    fn the_true_residual_meets_the_tolerance() {
        let n = 300;
        let rhs: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
        for (error, few) in [(1e-8, true), (1e-3, false), (0.5, false)] {
            let products = std::cell::Cell::new(0);
            let operator = OperatorFromFn {
                len: n,
                product: |x: &[f64], y: &mut [f64]| {
                    products.set(products.get() + 1);
                    product(n, 1e-3, x, y);
                },
            };
            let cheap = OperatorFromFn { len: n, product: |x: &[f64], y: &mut [f64]| product(n, 1e-3 + error, x, y) };
            let options = CgOptions { relative_tolerance: 1e-9, absolute_tolerance: 0.0, max_iterations: 3000 };
            let mut x = vec![0.0; n];
            let report = refined_cg(
                &operator,
                &cheap,
                &Identity,
                &NoProjection,
                &Serial,
                &rhs,
                &mut x,
                &options,
                &mut CgWorkspace::new(n),
                &mut RefinementWorkspace::new(n),
            );
            assert!(report.converged(), "{error}: {report:?}");
            assert!(!few || products.get() <= 3, "{error}: {} products with the true matrix", products.get());
            let mut left = vec![0.0; n];
            product(n, 1e-3, &x, &mut left);
            left.iter_mut().zip(&rhs).for_each(|(l, r)| *l -= r);
            assert!(norm(&left) <= 1.01e-9 * norm(&rhs), "{error}: {:e}", norm(&left) / norm(&rhs));
        }
    }
}
