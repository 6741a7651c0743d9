//! The nearest positive semi-definite matrix, in the Frobenius norm: eigenvalues below zero become zero.
//!
//! ```text
//! A = Q Λ Qᵀ,   A⁺ = Q max(Λ, 0) Qᵀ
//! ```
//!
//! For the moduli at one quadrature point: 9 × 9, 4 × 4 or 1 × 1. Cyclic Jacobi rotations, which find small eigenvalues of
//! such matrices to full relative precision and always in the same order of operations (Golub and Van Loan, "Matrix
//! Computations", §8.5). A matrix whose Cholesky factor exists is left as it is, to the bit.

/// Rows of the largest matrix: d² for d = 3.
pub(crate) const LARGEST: usize = 9;

/// Sweeps at most; four or five reach rounding.
const SWEEPS: usize = 30;

/// Replaces a symmetric matrix, given by the rows of its lower triangle, by the nearest positive semi-definite one.
///
/// A matrix with an infinite or undefined entry is left as it is: whoever uses it notices.
///
/// # Panics
/// When `lower` is not the lower triangle of `size` rows, or there are more than [`LARGEST`].
pub(crate) fn make_positive(lower: &mut [f64], size: usize) {
    assert!(size <= LARGEST && lower.len() == size * (size + 1) / 2, "the lower triangle of a small matrix");
    if lower.iter().any(|a| !a.is_finite()) || is_positive(lower, size) {
        return;
    }
    let mut a = [[0.0; LARGEST]; LARGEST];
    let mut q = [[0.0; LARGEST]; LARGEST];
    for i in 0..size {
        q[i][i] = 1.0;
        for j in 0..size {
            a[i][j] = lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)];
        }
    }
    let scale: f64 = a.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    for _ in 0..SWEEPS {
        let off: f64 = (0..size).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j] * a[i][j]).sum();
        if off.sqrt() <= f64::EPSILON * 1e-2 * scale {
            break;
        }
        for i in 0..size {
            for j in i + 1..size {
                rotate(&mut a, &mut q, size, i, j);
            }
        }
    }
    for i in 0..size {
        for j in 0..=i {
            lower[i * (i + 1) / 2 + j] = (0..size).map(|k| a[k][k].max(0.0) * q[i][k] * q[j][k]).sum();
        }
    }
}

/// Whether all pivots of the Cholesky factorisation are positive.
fn is_positive(lower: &[f64], size: usize) -> bool {
    let mut factor = [[0.0; LARGEST]; LARGEST];
    for i in 0..size {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = lower[i * (i + 1) / 2 + j] - sum;
            if i == j {
                if rest <= 0.0 {
                    return false;
                }
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    true
}

/// One rotation that makes a_ij zero: A ← RᵀAR, Q ← QR.
fn rotate(a: &mut [[f64; LARGEST]; LARGEST], q: &mut [[f64; LARGEST]; LARGEST], size: usize, i: usize, j: usize) {
    if a[i][j] == 0.0 {
        return;
    }
    let theta = (a[j][j] - a[i][i]) / (2.0 * a[i][j]);
    // The smaller of the two angles; a θ too large to square gives t ≈ 1/2θ all the same.
    let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
    let c = 1.0 / t.hypot(1.0);
    let s = t * c;
    for k in 0..size {
        let (x, y) = (a[k][i], a[k][j]);
        (a[k][i], a[k][j]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..size {
        let (x, y) = (a[i][k], a[j][k]);
        (a[i][k], a[j][k]) = (c * x - s * y, s * x + c * y);
    }
    for row in q.iter_mut().take(size) {
        let (x, y) = (row[i], row[j]);
        (row[i], row[j]) = (c * x - s * y, s * x + c * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(lower: &[f64], i: usize, j: usize) -> f64 {
        lower[i.max(j) * (i.max(j) + 1) / 2 + i.min(j)]
    }

    proptest! {
        /// The result has no negative curvature, and what was changed has no positive curvature in it: together with
        /// their orthogonality that is what makes the result the nearest positive matrix.
        #[test]
        fn splits_a_matrix_into_its_positive_and_negative_parts(
            size in prop::sample::select(vec![1usize, 4, 9]),
            entries in prop::collection::vec(-1.0..1.0f64, 45),
            x in prop::collection::vec(-1.0..1.0f64, 9),
        ) {
            let given = &entries[..size * (size + 1) / 2];
            let mut result = given.to_vec();
            make_positive(&mut result, size);
            let curvature = |m: &[f64]| -> f64 {
                (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).map(|(i, j)| x[i] * at(m, i, j) * x[j]).sum()
            };
            let change: Vec<f64> = result.iter().zip(given).map(|(r, g)| r - g).collect();
            prop_assert!(curvature(&result) >= -1e-12);
            prop_assert!(curvature(&change) >= -1e-12);
            for i in 0..size {
                for j in 0..size {
                    let product: f64 = (0..size).map(|k| at(&result, i, k) * at(&change, k, j)).sum();
                    prop_assert!(product.abs() < 1e-12, "{product:e} at {i}, {j}");
                }
            }
        }
    }

    /// A positive matrix comes back with the same bits.
    #[test]
    fn leaves_positive_matrices_alone() {
        let mut lower = vec![2.0, 0.3, 1.0, -0.1, 0.2, 0.7, 0.0, 0.0, 0.1, 3.0];
        let given = lower.clone();
        make_positive(&mut lower, 4);
        assert_eq!(lower, given);
    }
}
