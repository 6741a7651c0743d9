//! Parameters, deformations and rotations for the tests.

use souple_laws::response::{Tensor, determinant, product, tensor_from_fn};
use souple_laws::{Bound, Law, Parameter, Response};

/// SplitMix64: a short sequence of numbers that is the same everywhere.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Between `low` and `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A deformation gradient with entries up to `size` from the identity.
    pub(crate) fn deformation(&mut self, size: f64) -> Tensor {
        let values: Vec<f64> = (0..9).map(|_| self.between(-size, size)).collect();
        tensor_from_fn(|i, j| values[3 * i + j] + if i == j { 1.0 } else { 0.0 })
    }

    /// A rotation: the product of one about each axis.
    pub(crate) fn rotation(&mut self) -> Tensor {
        let mut rotation = tensor_from_fn(|i, j| if i == j { 1.0 } else { 0.0 });
        for axis in 0..3 {
            let (sine, cosine) = self.between(-3.2, 3.2).sin_cos();
            let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
            let turn = tensor_from_fn(|i, j| match (i, j) {
                _ if i == axis || j == axis => f64::from(u8::from(i == j)),
                _ if i == j => cosine,
                _ if (i, j) == (a, b) => -sine,
                _ => sine,
            });
            rotation = product(&turn, &rotation);
        }
        assert!((determinant(&rotation) - 1.0).abs() < 1e-14);
        rotation
    }
}

/// Parameters well inside their ranges, in the law's order.
pub(crate) fn parameters(law: &Law, random: &mut Random) -> Vec<f64> {
    let limit = |b: Bound| match b {
        Bound::None | Bound::NonZero => None,
        Bound::Open(v) | Bound::Closed(v) => Some(v),
    };
    let mut inside = |p: &Parameter| match (limit(p.minimum), limit(p.maximum)) {
        (Some(low), Some(high)) => low + random.between(0.5, 0.9) * (high - low),
        (Some(low), None) => low + random.between(0.5, 2.0),
        (None, Some(high)) => high - random.between(0.5, 2.0),
        (None, None) => random.between(0.3, 0.9),
    };
    law.parameters.iter().map(&mut inside).collect()
}

/// Every law with each of a few sets of parameters.
pub(crate) fn responses() -> impl Iterator<Item = (&'static Law, Vec<f64>, Response)> {
    souple_laws::all().iter().enumerate().flat_map(|(k, &law)| {
        (0..3).map(move |set| {
            let parameters = parameters(law, &mut Random(100 * k as u64 + set));
            let response = Response::new(law, &parameters).unwrap();
            (law, parameters, response)
        })
    })
}

/// Largest absolute entry.
pub(crate) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |m, v| m.max(v.abs()))
}
