//! A short sequence of random deformations and rotations, the same everywhere.

use crate::response::{IDENTITY, Tensor, product, tensor_from_fn};

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(super) struct Random(pub(super) u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// The identity with up to `size` added to each entry: below 0.2, J stays positive.
    pub(super) fn deformation(&mut self, size: f64) -> Tensor {
        let added: [f64; 9] = std::array::from_fn(|_| self.between(-size, size));
        tensor_from_fn(|i, j| IDENTITY[i][j] + added[3 * i + j])
    }

    /// The product of one rotation about each axis.
    pub(super) fn rotation(&mut self) -> Tensor {
        (0..3).fold(IDENTITY, |rotation, axis| {
            let (sine, cosine) = self.between(-std::f64::consts::PI, std::f64::consts::PI).sin_cos();
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut turn = IDENTITY;
            (turn[a][a], turn[b][b], turn[a][b], turn[b][a]) = (cosine, cosine, -sine, sine);
            product(&turn, &rotation)
        })
    }
}
