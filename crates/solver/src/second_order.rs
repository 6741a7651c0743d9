//! What a system that moves must offer to be integrated: M ü = F(t, u, u̇), with some of u prescribed.
//!
//! ```text
//! u, v     displacement and velocity, one entry per unknown
//! F        all forces: internal, external, damping
//! K, D     −∂F/∂u and −∂F/∂v at the state given to the last `linearise`
//! P        orthogonal projection onto the free directions (Pᵀ = P = P²)
//! ```
//!
//! Constraints are exact: the part (I − P) u is a given function of time, set by [`SecondOrder::prescribe`], and the
//! integrators solve for P ü only.

use crate::cg::LinearReport;
use crate::failure::Failure;

/// A second-order system of ordinary differential equations with prescribed unknowns.
///
/// Methods take `&mut self` so that an implementation can keep its scratch memory as plain fields.
/// Within one step the integrators call `force` and `linearise` in any order and number.
pub trait SecondOrder {
    /// Number of unknowns.
    fn len(&self) -> usize;

    /// Whether nothing moves.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// out ← F(t, u, v)
    ///
    /// # Errors
    /// A [`Failure`] when the state lies outside the domain of the system.
    fn force(&mut self, t: f64, u: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Failure>;

    /// y ← M x
    fn mass_apply(&mut self, x: &[f64], y: &mut [f64]);

    /// Solves P M P x = P rhs for x in the range of P; a division where M is diagonal and P zeroes unknowns.
    fn mass_solve(&mut self, rhs: &[f64], x: &mut [f64]) -> LinearReport;

    /// Prepares the products and the solve below at a state.
    ///
    /// # Errors
    /// A [`Failure`] when the derivatives cannot be evaluated there.
    fn linearise(&mut self, t: f64, u: &[f64], v: &[f64]) -> Result<(), Failure>;

    /// y ← K x, K = −∂F/∂u at the linearised state.
    fn stiffness_apply(&mut self, x: &[f64], y: &mut [f64]);

    /// y ← D x, D = −∂F/∂v at the linearised state.
    fn damping_apply(&mut self, x: &[f64], y: &mut [f64]);

    /// Solves P (a M + b D + c K) P x = P rhs, starting from the x passed in, which lies in the range of P.
    fn solve(&mut self, combination: Combination, rhs: &[f64], x: &mut [f64]) -> LinearReport;

    /// v ← P v
    fn project(&self, v: &mut [f64]);

    /// Overwrites the prescribed part of u and v, (I − P) u and (I − P) v, by its value at time t.
    fn prescribe(&self, t: f64, u: &mut [f64], v: &mut [f64]);

    /// Word on a state that a step or a Newton iteration arrived at, before it replaces the old one.
    ///
    /// # Errors
    /// A [`Failure`] when the state must not be kept: a line search then shortens its step, a step fails with it.
    fn admissible(&mut self, _t: f64, _u: &[f64], _v: &[f64]) -> Result<(), Failure> {
        Ok(())
    }
}

/// The matrix a M + b D + c K of an implicit step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combination {
    /// a, without unit.
    pub mass: f64,
    /// b, in seconds.
    pub damping: f64,
    /// c, in square seconds.
    pub stiffness: f64,
}
