//! Symmetric tensors of stress and strain as lists xx, yy, zz, xy, yz, zx.

/// A symmetric tensor: xx, yy, zz, xy, yz, zx.
pub(crate) type Symmetric = [f64; 6];

/// Von Mises' equivalent stress `√(3/2 s:s)`, where s is the deviator of σ: the uniaxial stress with the same distortion.
pub(crate) fn von_mises([xx, yy, zz, xy, yz, zx]: Symmetric) -> f64 {
    // Differences first: the pressure that they share may be much larger than they are.
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
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

    /// Rows put each entry at both of its places.
    #[test]
    fn rows_are_symmetric() {
        let full = rows([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(full, [1.0, 4.0, 6.0, 4.0, 2.0, 5.0, 6.0, 5.0, 3.0]);
    }
}
