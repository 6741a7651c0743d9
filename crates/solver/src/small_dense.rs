//! Dense matrices of a few rows, row by row in a slice: the blocks of block methods.
//!
//! Not a linear algebra library: only what a preconditioner needs of a block of 2 to 6 rows.

/// Replaces the lower triangle of a symmetric matrix (n × n, row by row) by its Cholesky factor L, A = L Lᵀ.
/// The strict upper triangle is neither read nor written.
///
/// # Errors
/// The index of the first pivot that is not positive and finite; the matrix is then half overwritten.
pub fn cholesky(n: usize, a: &mut [f64]) -> Result<(), usize> {
    for j in 0..n {
        let mut pivot = a[j * n + j];
        for k in 0..j {
            pivot -= a[j * n + k] * a[j * n + k];
        }
        // Written so that a NaN fails too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(j);
        }
        let root = pivot.sqrt();
        a[j * n + j] = root;
        for i in j + 1..n {
            let mut entry = a[i * n + j];
            for k in 0..j {
                entry -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] = entry / root;
        }
    }
    Ok(())
}

/// x ← A⁻¹ x with the factor from [`cholesky`].
pub fn cholesky_solve(n: usize, factor: &[f64], x: &mut [f64]) {
    for i in 0..n {
        for k in 0..i {
            x[i] -= factor[i * n + k] * x[k];
        }
        x[i] /= factor[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= factor[k * n + i] * x[k];
        }
        x[i] /= factor[i * n + i];
    }
}
