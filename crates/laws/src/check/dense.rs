//! Small dense linear algebra: what six strains and five unknown stretches need.

/// Eigenvalues of a symmetric matrix in increasing order, by cyclic Jacobi rotations.
pub(super) fn eigenvalues<const N: usize>(matrix: &[[f64; N]; N]) -> [f64; N] {
    let mut a = *matrix;
    for _ in 0..60 {
        let outside: f64 = (0..N).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| a[i][j] * a[i][j]).sum();
        let diagonal: f64 = (0..N).map(|i| a[i][i] * a[i][i]).sum();
        if outside <= 1e-30 * diagonal {
            break;
        }
        for p in 0..N {
            for q in p + 1..N {
                if a[p][q] != 0.0 {
                    rotate(&mut a, p, q);
                }
            }
        }
    }
    let mut values: [f64; N] = std::array::from_fn(|i| a[i][i]);
    values.sort_by(f64::total_cmp);
    values
}

/// `Rᵀ A R` with the rotation of axes p and q that makes A_pq zero.
fn rotate<const N: usize>(a: &mut [[f64; N]; N], p: usize, q: usize) {
    let half = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = 1.0f64.copysign(half) / (half.abs() + (half * half + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    for k in 0..N {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
    }
}

/// `x` of `A x = b`, by elimination with row pivots; `None` for a singular matrix.
pub(super) fn solved<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    for column in 0..N {
        let pivot = (column..N).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs()))?;
        if a[pivot][column] == 0.0 || !a[pivot][column].is_finite() {
            return None;
        }
        a.swap(column, pivot);
        b.swap(column, pivot);
        for row in column + 1..N {
            let factor = a[row][column] / a[column][column];
            for k in column..N {
                a[row][k] -= factor * a[column][k];
            }
            b[row] -= factor * b[column];
        }
    }
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|k| a[row][k] * b[k]).sum();
        b[row] = (b[row] - known) / a[row][row];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix built from known eigenvalues gives them back, and a system its solution.
    #[test]
    fn small_systems_are_solved() {
        // I − 2 v vᵀ / v·v is a reflection; reflecting a diagonal keeps its eigenvalues.
        let (v, values) = ([1.0, -2.0, 0.5, 3.0], [-1.0, 2.0, 2.0, 1e3]);
        let size: f64 = v.iter().map(|x| x * x).sum();
        let h = |i: usize, j: usize| f64::from(u8::from(i == j)) - 2.0 * v[i] * v[j] / size;
        let a: [[f64; 4]; 4] =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..4).map(|k| h(i, k) * values[k] * h(k, j)).sum()));
        for (found, expected) in eigenvalues(&a).into_iter().zip(values) {
            assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
        }
        let x = [1.0, -1.0, 2.0, 0.25];
        let b = std::array::from_fn(|i| (0..4).map(|j| a[i][j] * x[j]).sum());
        for (found, expected) in solved(a, b).unwrap().into_iter().zip(x) {
            assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
        }
        assert_eq!(solved([[1.0, 2.0], [2.0, 4.0]], [1.0, 1.0]), None);
    }
}
