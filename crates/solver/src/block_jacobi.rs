//! Block Jacobi: the inverse of the diagonal blocks of a matrix.
//!
//! With A = (A_ij) in b × b blocks, z_i = A_ii⁻¹ r_i.
//! A diagonal block that is not positive definite (a compressed region can make one) would spoil the conjugate
//! gradient, so it is replaced by its diagonal, made positive; how many were is kept for the report.

use crate::operator::{Preconditioner, positive_reciprocal};
use crate::small_dense::{cholesky, cholesky_solve};
use crate::vectors::{Diagonal, widest};

/// Inverses of the diagonal blocks of a matrix.
#[derive(Clone, Debug)]
pub struct BlockJacobi {
    block: usize,
    /// [block][row][column]
    inverse: Vec<f64>,
    fallbacks: usize,
    factor: Vec<f64>,
    column: Vec<f64>,
}

impl BlockJacobi {
    /// From the diagonal blocks, \[block\]\[row\]\[column\], each `block` × `block` and symmetric.
    ///
    /// # Panics
    /// When `block` is zero or `blocks` is not a whole number of blocks.
    pub fn new(block: usize, blocks: &[f64]) -> Self {
        assert!(block > 0 && blocks.len().is_multiple_of(block * block), "whole blocks of {block} × {block}");
        let mut jacobi = Self {
            block,
            inverse: vec![0.0; blocks.len()],
            fallbacks: 0,
            factor: vec![0.0; block * block],
            column: vec![0.0; block],
        };
        jacobi.update(blocks);
        jacobi
    }

    /// Takes new diagonal blocks, as many as before, without allocating.
    pub fn update(&mut self, blocks: &[f64]) {
        assert_eq!(blocks.len(), self.inverse.len(), "the number of blocks stays");
        let b = self.block;
        self.fallbacks = 0;
        for (inverse, block) in self.inverse.chunks_exact_mut(b * b).zip(blocks.chunks_exact(b * b)) {
            if let (Ok(inverse), Ok(block)) = (<&mut [f64; 9]>::try_from(&mut *inverse), block.try_into())
                && let Some(found) = inverse_of_three(block)
            {
                *inverse = found;
                continue;
            }
            self.factor.copy_from_slice(block);
            if cholesky(b, &mut self.factor).is_ok() {
                for j in 0..b {
                    self.column.fill(0.0);
                    self.column[j] = 1.0;
                    cholesky_solve(b, &self.factor, &mut self.column);
                    for i in 0..b {
                        inverse[i * b + j] = self.column[i];
                    }
                }
                // Rounding leaves the inverse symmetric only to the last bits; the method needs it exactly so.
                for i in 0..b {
                    for j in 0..i {
                        inverse[j * b + i] = inverse[i * b + j];
                    }
                }
            } else {
                self.fallbacks += 1;
                inverse.fill(0.0);
                for i in 0..b {
                    inverse[i * b + i] = positive_reciprocal(block[i * b + i]);
                }
            }
        }
    }

    /// Number of blocks that were not positive definite and were replaced by their diagonal.
    pub fn fallbacks(&self) -> usize {
        self.fallbacks
    }

    /// Rows of a block.
    pub fn block(&self) -> usize {
        self.block
    }
}

/// The inverse of a symmetric positive definite 3 × 3 block, Σ_k m_ki m_kj / d_k with A = L D Lᵀ and m = L⁻¹; none where a
/// pivot is not positive and finite. The lower triangle is read.
fn inverse_of_three(a: &[f64; 9]) -> Option<[f64; 9]> {
    let d0 = a[0];
    let r0 = d0.recip();
    let (l10, l20) = (a[3] * r0, a[6] * r0);
    let d1 = a[4] - l10 * a[3];
    let r1 = d1.recip();
    let below = a[7] - l20 * a[3];
    let l21 = below * r1;
    let d2 = a[8] - l20 * a[6] - l21 * below;
    let r2 = d2.recip();
    // Written so that a NaN fails too.
    if ![d0, d1, d2].iter().all(|&d| d > 0.0 && d.is_finite()) {
        return None;
    }
    let m20 = l10 * l21 - l20;
    let (x00, x10, x20) = (r0 + l10 * l10 * r1 + m20 * m20 * r2, -l10 * r1 - m20 * l21 * r2, m20 * r2);
    let (x11, x21) = (r1 + l21 * l21 * r2, -l21 * r2);
    Some([x00, x10, x20, x10, x11, x21, x20, x21, r2])
}

impl Preconditioner for BlockJacobi {
    fn apply_part(&self, first: usize, r: &[f64], z: &mut [f64]) -> bool {
        if self.block != 3 || !first.is_multiple_of(3) {
            return false;
        }
        let blocks = &self.inverse[3 * first..3 * (first + r.len())];
        widest(Diagonal { blocks, r, z });
        true
    }

    fn apply(&self, r: &[f64], z: &mut [f64]) {
        match self.block {
            3 => widest(Diagonal { blocks: &self.inverse, r, z }),
            b => {
                for ((z, r), inverse) in
                    z.chunks_exact_mut(b).zip(r.chunks_exact(b)).zip(self.inverse.chunks_exact(b * b))
                {
                    for i in 0..b {
                        z[i] = (0..b).map(|j| inverse[i * b + j] * r[j]).sum();
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Applying the preconditioner to a block-diagonal product gives the vector back, for every block size.
    #[test]
    fn inverts_its_blocks() {
        for b in 1..=6 {
            // A = I + v vᵀ with v = (1, 2, …, b), twice, the second one scaled.
            let mut blocks = Vec::new();
            for scale in [1.0, 7.0] {
                for i in 0..b {
                    for j in 0..b {
                        let identity = if i == j { 1.0 } else { 0.0 };
                        blocks.push(scale * (identity + ((i + 1) * (j + 1)) as f64));
                    }
                }
            }
            let x: Vec<f64> = (0..2 * b).map(|i| 1.0 - 0.3 * i as f64).collect();
            let mut r = vec![0.0; 2 * b];
            for k in 0..2 {
                for i in 0..b {
                    r[k * b + i] = (0..b).map(|j| blocks[(k * b + i) * b + j] * x[k * b + j]).sum();
                }
            }
            let jacobi = BlockJacobi::new(b, &blocks);
            let mut z = vec![0.0; 2 * b];
            jacobi.apply(&r, &mut z);
            assert_eq!(jacobi.fallbacks(), 0);
            for (z, x) in z.iter().zip(&x) {
                assert!((z - x).abs() < 1e-12, "block size {b}: {z} is not {x}");
            }
        }
    }

    /// A block that is not positive definite, or not finite, is replaced by its positive diagonal and counted.
    #[test]
    fn falls_back_to_the_diagonal() {
        let blocks = [2.0, 3.0, 3.0, 4.0, f64::NAN, 0.0, 0.0, 5.0];
        let jacobi = BlockJacobi::new(2, &blocks);
        let mut z = [0.0; 4];
        jacobi.apply(&[1.0; 4], &mut z);
        assert_eq!(jacobi.fallbacks(), 2);
        assert_eq!(z, [0.5, 0.25, 1.0, 0.2]);

        let indefinite = [2.0, 3.0, 0.0, 3.0, 4.0, 0.0, 0.0, 0.0, 8.0];
        let unknown = [2.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, f64::NAN];
        let jacobi = BlockJacobi::new(3, &[indefinite, unknown].concat());
        let mut z = [0.0; 6];
        jacobi.apply(&[1.0; 6], &mut z);
        assert_eq!(jacobi.fallbacks(), 2);
        assert_eq!(z, [0.5, 0.25, 0.125, 0.5, 0.25, 1.0]);
    }
}
