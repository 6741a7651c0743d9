//! The mean ratio of an element's corner: how far it is from the ideal one, whatever its size and direction.

use crate::geometry::{cross, dot, triple};

/// The ideal edge vectors at a corner, reduced to what the mean ratio needs of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct IdealCorner {
    determinant: f64,
    /// Inverse of the Gram matrix WᵀW of the vectors; unused entries are 0.
    inverse_gram: [[f64; 3]; 3],
}

impl IdealCorner {
    /// From the edge vectors W of the ideal shape, one to three of them.
    pub(super) fn new(ideal: &[[f64; 3]]) -> IdealCorner {
        // Rows of the dual basis: dᵢ · wⱼ = δᵢⱼ; the inverse Gram matrix holds their products.
        let (determinant, dual): (f64, Vec<[f64; 3]>) = match ideal {
            [a, b] => {
                let n = cross(*a, *b);
                (n[2], [cross(*b, n), cross(n, *a)].map(|c| c.map(|x| x / dot(n, n))).to_vec())
            }
            [a, b, c] => {
                let v = triple(*a, *b, *c);
                (v, [cross(*b, *c), cross(*c, *a), cross(*a, *b)].map(|c| c.map(|x| x / v)).to_vec())
            }
            _ => (1.0, Vec::new()),
        };
        let mut inverse_gram = [[0.0; 3]; 3];
        for (i, p) in dual.iter().enumerate() {
            for (j, q) in dual.iter().enumerate() {
                inverse_gram[i][j] = dot(*p, *q);
            }
        }
        IdealCorner { determinant, inverse_gram }
    }

    /// q = d (det T)^(2/d) / ‖T‖², T = A W⁻¹, with the edge vectors at a corner as columns of A and their
    /// determinant; 0 when that is not positive. An edge has the ideal shape whatever its length.
    pub(super) fn mean_ratio(&self, vectors: &[[f64; 3]], determinant: f64) -> f64 {
        if determinant <= 0.0 {
            return 0.0;
        }
        // ‖T‖² = tr(AᵀA (WᵀW)⁻¹): needs the two Gram matrices only, which also covers surfaces in space.
        let mut square = 0.0;
        for (i, a) in vectors.iter().enumerate() {
            for (j, b) in vectors.iter().enumerate() {
                square += dot(*a, *b) * self.inverse_gram[j][i];
            }
        }
        let ratio = determinant / self.determinant;
        match vectors.len() {
            1 => 1.0,
            2 => 2.0 * ratio / square,
            _ => 3.0 * ratio.cbrt().powi(2) / square,
        }
    }
}
