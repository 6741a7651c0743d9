//! The three questions that an iterative solver asks: multiply, precondition, project.
//!
//! All three are object safe and take `&self`; an implementation that needs scratch memory hides it (a `RefCell` or a
//! `Mutex`), so that one operator can serve several solvers.
//! Two preconditioners so small that they need no file of their own are here: [`Identity`] and [`Jacobi`].

use crate::vector::{PairwiseSum, SUM_BLOCK, Serial, VectorOps, block_dot};

/// A square matrix, known by its products.
pub trait LinearOperator {
    /// Number of rows and columns.
    fn len(&self) -> usize;

    /// Whether the operator acts on no unknown at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// y ← A x
    fn apply(&self, x: &[f64], y: &mut [f64]);

    /// q ← P A p, and returns p · q, summed as [`VectorOps::dot`](crate::vector::VectorOps::dot) sums.
    ///
    /// An operator whose rows are independent does it in one pass over memory ([`product_in_parts`]).
    fn apply_and_dot(&self, projector: &dyn Projector, p: &[f64], q: &mut [f64]) -> f64 {
        self.apply(p, q);
        projector.project(q);
        Serial.dot(p, q)
    }
}

/// [`LinearOperator::apply_and_dot`] from a product `rows(first, q)` that writes the entries from `first` on: each part
/// is projected and summed while it is in the nearest cache. Parts have [`SUM_BLOCK`] entries.
pub fn product_in_parts(
    projector: &dyn Projector,
    p: &[f64],
    q: &mut [f64],
    mut rows: impl FnMut(usize, &mut [f64]),
) -> f64 {
    let mut sum = PairwiseSum::new();
    let mut in_parts = true;
    for (part, (p, q)) in p.chunks(SUM_BLOCK).zip(q.chunks_mut(SUM_BLOCK)).enumerate() {
        rows(part * SUM_BLOCK, q);
        in_parts = in_parts && projector.project_part(part * SUM_BLOCK, q);
        sum.push(block_dot(p, q));
    }
    if in_parts {
        return sum.total();
    }
    projector.project(q);
    Serial.dot(p, q)
}

/// A symmetric positive definite approximation of the inverse of a matrix.
pub trait Preconditioner {
    /// z ← M⁻¹ r
    fn apply(&self, r: &[f64], z: &mut [f64]);

    /// The same for the entries from `first` on, given those of r alone; whether it could. `false`, as of a
    /// preconditioner that couples all unknowns, leaves z untouched, and is the answer for every part.
    fn apply_part(&self, _first: usize, _r: &[f64], _z: &mut [f64]) -> bool {
        false
    }
}

/// An orthogonal projection P = Pᵀ = P² onto the free directions: what eliminates constraints exactly.
pub trait Projector {
    /// v ← P v
    fn project(&self, v: &mut [f64]);

    /// The same for the entries from `first` on, given those of v alone; whether it could. `false`, as of a projection
    /// that couples all unknowns, leaves v untouched, and is the answer for every part.
    fn project_part(&self, _first: usize, _v: &mut [f64]) -> bool {
        false
    }
}

/// Every direction is free.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProjection;

impl Projector for NoProjection {
    fn project(&self, _v: &mut [f64]) {}

    fn project_part(&self, _first: usize, _v: &mut [f64]) -> bool {
        true
    }
}

/// Projection that zeroes listed unknowns.
#[derive(Clone, Debug, Default)]
pub struct FixedUnknowns {
    /// Indices of the unknowns that are not free.
    pub indices: Vec<usize>,
}

impl Projector for FixedUnknowns {
    fn project(&self, v: &mut [f64]) {
        for &index in &self.indices {
            v[index] = 0.0;
        }
    }

    fn project_part(&self, first: usize, v: &mut [f64]) -> bool {
        let sorted = self.indices.is_sorted();
        let from = if sorted { self.indices.partition_point(|&index| index < first) } else { 0 };
        for &index in &self.indices[from..] {
            match index.checked_sub(first).and_then(|offset| v.get_mut(offset)) {
                Some(value) => *value = 0.0,
                None if sorted => break,
                None => {}
            }
        }
        true
    }
}

/// An operator made of a length and a closure `(x, y)` that writes y ← A x.
pub struct OperatorFromFn<F> {
    /// Number of unknowns.
    pub len: usize,
    /// The product.
    pub product: F,
}

impl<F: Fn(&[f64], &mut [f64])> LinearOperator for OperatorFromFn<F> {
    fn len(&self) -> usize {
        self.len
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        (self.product)(x, y);
    }
}

/// A diagonal matrix, for instance a lumped mass.
#[derive(Clone, Debug, Default)]
pub struct DiagonalOperator {
    /// The entries.
    pub diagonal: Vec<f64>,
}

impl LinearOperator for DiagonalOperator {
    fn len(&self) -> usize {
        self.diagonal.len()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        for ((y, x), d) in y.iter_mut().zip(x).zip(&self.diagonal) {
            *y = d * x;
        }
    }
}

/// No preconditioning.
#[derive(Clone, Copy, Debug, Default)]
pub struct Identity;

impl Preconditioner for Identity {
    fn apply_part(&self, _first: usize, r: &[f64], z: &mut [f64]) -> bool {
        z.copy_from_slice(r);
        true
    }

    fn apply(&self, r: &[f64], z: &mut [f64]) {
        z.copy_from_slice(r);
    }
}

/// The inverse of the diagonal.
#[derive(Clone, Debug, Default)]
pub struct Jacobi {
    inverse: Vec<f64>,
    repaired: usize,
}

impl Jacobi {
    /// From the diagonal of the matrix.
    pub fn new(diagonal: &[f64]) -> Self {
        let mut jacobi = Self { inverse: vec![0.0; diagonal.len()], repaired: 0 };
        jacobi.update(diagonal);
        jacobi
    }

    /// Takes a new diagonal of the same length, without allocating.
    pub fn update(&mut self, diagonal: &[f64]) {
        assert_eq!(diagonal.len(), self.inverse.len(), "a diagonal keeps its length");
        self.repaired = 0;
        for (inverse, &d) in self.inverse.iter_mut().zip(diagonal) {
            *inverse = positive_reciprocal(d);
            self.repaired += usize::from(!is_positive(d));
        }
    }

    /// Number of diagonal entries that were not positive and were replaced (by their magnitude, or by one).
    pub fn repaired(&self) -> usize {
        self.repaired
    }
}

impl Preconditioner for Jacobi {
    fn apply_part(&self, first: usize, r: &[f64], z: &mut [f64]) -> bool {
        for ((z, r), inverse) in z.iter_mut().zip(r).zip(&self.inverse[first..]) {
            *z = inverse * r;
        }
        true
    }

    fn apply(&self, r: &[f64], z: &mut [f64]) {
        for ((z, r), inverse) in z.iter_mut().zip(r).zip(&self.inverse) {
            *z = inverse * r;
        }
    }
}

fn is_positive(d: f64) -> bool {
    d.is_finite() && d > 0.0
}

/// 1/|d|, or 1 where that is not a finite positive number: a preconditioner must stay positive definite.
pub(crate) fn positive_reciprocal(d: f64) -> f64 {
    let inverse = 1.0 / d.abs();
    if inverse.is_finite() && inverse > 0.0 { inverse } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jacobi stays positive whatever the diagonal holds, and counts what it had to replace.
    #[test]
    fn jacobi_repairs_bad_entries() {
        let jacobi = Jacobi::new(&[2.0, -4.0, 0.0, f64::NAN, f64::INFINITY]);
        let mut z = [0.0; 5];
        jacobi.apply(&[1.0; 5], &mut z);
        assert_eq!(z, [0.5, 0.25, 1.0, 1.0, 1.0]);
        assert_eq!(jacobi.repaired(), 4);
    }
}
