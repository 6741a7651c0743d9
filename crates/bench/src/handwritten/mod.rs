//! Kernels written by hand with explicit vectors: what the generated ones are compared with.
//!
//! They are what a specialist writes for Saint Venant–Kirchhoff's law, knowing everything about it: gradients of the
//! shape functions prepared once, relative to the first node so that one gradient fewer is read; the second
//! Piola–Kirchhoff stress times the negative weight, so that forces need no further factor; for products the deformation
//! gradient and that stress kept from the linearisation. They are no oracle and serve no simulation: tests hold them to
//! the derived programs.
//!
//! With w the negative weight of a point, gₐ = ∂Nₐ/∂X:
//!
//! ```text
//! F = 1 + Σ (uₐ − u₀) ⊗ gₐ      C = Fᵀ F      wS = w λ/2 (tr C − 3) 1 + w μ (C − 1)
//! fₐ += F wS gₐ                  f₀ = −Σ fₐ
//! dF = Σ (vₐ − v₀) ⊗ gₐ         A = Fᵀ dF     w dS = w λ tr A 1 + w μ (A + Aᵀ)
//! dfₐ += (dF wS + F w dS) gₐ     df₀ = −Σ dfₐ
//! ```

mod hex8;
mod point;
mod tet4;

pub use hex8::Hex8;
pub use tet4::Tet4;

use crate::batch::Batch;
use crate::vectors::Vectors;
use std::ops::Range;

/// A set of kernels for one element.
pub trait Handwritten {
    /// Writes forces f of these groups, [group][node, axis][lane].
    fn force(&self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]);

    /// Keeps what products need of these groups, and writes forces.
    fn linearise(&mut self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]);

    /// Writes products (∂f/∂u) v of these groups at the state linearised last.
    fn tangent_apply(&self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]);

    /// Numbers per element that a set-up keeps, and that a linearisation keeps.
    fn carried(&self) -> [usize; 2];
}

/// Sets up the kernels for a batch, where there are some: tetrahedra with one point and hexahedra with 2 × 2 × 2 points,
/// both with Saint Venant–Kirchhoff's law.
pub fn handwritten(batch: &Batch) -> Option<Box<dyn Handwritten>> {
    let association = batch.derived.association;
    match (association.element.id, association.law.id, association.rule.points.len()) {
        ("tet4", "stvk", 1) => Some(Box::new(Tet4::new(batch))),
        ("hex8", "stvk", 8) => Some(Box::new(Hex8::new(batch))),
        _ => None,
    }
}

/// Half of Lamé's λ, and μ, in Pa, from Young's modulus and Poisson's ratio.
fn half_lambda_and_mu(parameters: &[f64]) -> [f64; 2] {
    let (young, poisson) = (parameters[0], parameters[1]);
    [0.5 * young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 * young / (1.0 + poisson)]
}

/// Inverse and determinant of a matrix, [row][column].
fn inverse(m: &[[f64; 3]; 3]) -> ([[f64; 3]; 3], f64) {
    let cofactor = |i: usize, j: usize| {
        let [a, b] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    let inverse = std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant));
    (inverse, determinant)
}
