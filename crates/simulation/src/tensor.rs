//! Symmetric tensors of stress and strain as lists xx, yy, zz, xy, yz, zx.

/// A symmetric tensor: xx, yy, zz, xy, yz, zx.
pub(crate) type Symmetric = [f64; 6];

/// Von Mises' equivalent stress `√(3/2 s:s)`, where s is the deviator of σ: the uniaxial stress with the same distortion.
pub(crate) fn von_mises([xx, yy, zz, xy, yz, zx]: Symmetric) -> f64 {
    // Differences first: the pressure that they share may be much larger than they are.
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// Principal stretches λ = √(1 + 2e) of a Green–Lagrange strain with eigenvalues e, the largest first.
///
/// NaN for a tensor that is no strain of anything: e < −½.
pub(crate) fn principal_stretches(strain: Symmetric) -> [f64; 3] {
    // Of the strain and not of C = I + 2E, so that small strains keep their digits.
    let mut stretches = eigenvalues(strain).map(|e| (1.0 + 2.0 * e).sqrt());
    stretches.sort_by(|a, b| b.total_cmp(a));
    stretches
}

/// Eigenvalues by Jacobi's rotations, each of which makes one entry off the diagonal vanish.
fn eigenvalues([xx, yy, zz, xy, yz, zx]: Symmetric) -> [f64; 3] {
    let mut m = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    // The order of convergence is quadratic: four sweeps are enough for any matrix, six are certain.
    for _ in 0..6 {
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let off = m[p][q];
            if off == 0.0 {
                continue;
            }
            let half = 0.5 * (m[p][p] - m[q][q]);
            let tangent = off / (half + half.hypot(off).copysign(half));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = tangent * cosine;
            m[p][p] += tangent * off;
            m[q][q] -= tangent * off;
            (m[p][q], m[q][p]) = (0.0, 0.0);
            (m[p][r], m[q][r]) = (cosine * m[p][r] + sine * m[q][r], cosine * m[q][r] - sine * m[p][r]);
            (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
        }
    }
    [m[0][0], m[1][1], m[2][2]]
}

/// All nine entries, row by row: what files of results take.
pub(crate) fn rows([xx, yy, zz, xy, yz, zx]: Symmetric) -> [f64; 9] {
    [xx, xy, zx, xy, yy, yz, zx, yz, zz]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pure shear τ gives √3 τ in every plane, uniaxial stress itself, and pressure neither adds nor hides anything.
    #[test]
    fn von_mises_has_its_closed_forms() {
        let shear = 2.5;
        for entry in 3..6 {
            let mut tensor = [0.0; 6];
            tensor[entry] = shear;
            assert!((von_mises(tensor) - 3.0_f64.sqrt() * shear).abs() < 1e-15);
        }
        for entry in 0..3 {
            let mut tensor = [-1e3; 6];
            tensor[3..].fill(0.0);
            assert_eq!(von_mises(tensor), 0.0);
            tensor[entry] -= 4.0;
            assert!((von_mises(tensor) - 4.0).abs() < 1e-12);
        }
    }

    /// Stretches of any size come back from the strain that they make, turned or not, equal or not, the largest first.
    #[test]
    fn stretches_come_back_from_strains() {
        let rotation = |angle: f64, p: usize, q: usize| {
            let mut r = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            (r[p][p], r[q][q], r[p][q], r[q][p]) = (angle.cos(), angle.cos(), -angle.sin(), angle.sin());
            r
        };
        let product = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
        };
        for stretches in [[1.0; 3], [1.5, 1.5, 0.8], [9.0, 1.0, 0.1], [1.0 + 1e-9, 1.0, 1.0 - 2e-9]] {
            for angle in [0.0, 0.7, std::f64::consts::FRAC_PI_4] {
                let n = product(rotation(angle, 0, 1), rotation(1.3 * angle, 1, 2));
                let entry = |i: usize, j: usize| -> f64 {
                    (0..3).map(|k| n[i][k] * 0.5 * (stretches[k] - 1.0) * (stretches[k] + 1.0) * n[j][k]).sum()
                };
                let strain = [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(1, 2), entry(2, 0)];
                for (found, expected) in principal_stretches(strain).into_iter().zip(stretches) {
                    // The rounding of the largest entry of the strain, over the stretch that it is divided by.
                    let tolerance = 1e-15 * (2.0 + 0.5 * stretches[0] * stretches[0] / expected);
                    assert!((found - expected).abs() <= tolerance, "{stretches:?} {angle}: {found}");
                }
            }
        }
        assert!(principal_stretches([-0.6, 0.0, 0.0, 0.0, 0.0, 0.0]).iter().any(|x| x.is_nan()));
    }

    /// Rows put each entry at both of its places.
    #[test]
    fn rows_are_symmetric() {
        let full = rows([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(full, [1.0, 4.0, 6.0, 4.0, 2.0, 5.0, 6.0, 5.0, 3.0]);
    }
}
