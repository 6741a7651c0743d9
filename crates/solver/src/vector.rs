//! Vector operations whose sums do not depend on how many threads take part.
//!
//! A floating-point sum depends on the order of its terms.
//! Here the order is part of the definition: a vector is cut into blocks of [`SUM_BLOCK`] entries, each block is summed
//! on eight lanes, and the block sums are combined as a binary tree:
//!
//! ```text
//! blocks   s0   s1   s2   s3   s4
//!            \  /      \  /     |
//!             +         +       |      PairwiseSum
//!               \     /         |
//!                  +            |
//!                     \      /
//!                         +
//! ```
//!
//! Whoever computes the block sums (one thread or many) then feeds them in order to [`PairwiseSum`] and gets the same
//! bits. The rounding error grows with log n instead of n as a bonus.

use crate::vectors::{Advance, Axpy, Dot, widest};
use std::ops::Range;

/// Number of entries in one block of a sum. Part of the definition of every result: changing it changes bits.
///
/// A multiple of 8 lanes, and of 2, 3 and 6 unknowns per node: a part of a vector is a whole number of nodes.
pub const SUM_BLOCK: usize = 1536;

/// The vector work of a Krylov method. All slices of one call have the same length.
pub trait VectorOps {
    /// x · y
    fn dot(&self, x: &[f64], y: &[f64]) -> f64;

    /// y ← y + a x
    fn axpy(&self, a: f64, x: &[f64], y: &mut [f64]);

    /// x ← x + a p, then p ← z + b p: the end of a conjugate gradient iteration in one pass.
    fn advance(&self, a: f64, b: f64, z: &[f64], p: &mut [f64], x: &mut [f64]);
}

/// Vector operations on the calling thread: the definition that other implementations must reproduce.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl VectorOps for Serial {
    fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        assert_eq!(x.len(), y.len(), "both vectors of a dot product have the same length");
        let mut sum = PairwiseSum::new();
        for (x, y) in x.chunks(SUM_BLOCK).zip(y.chunks(SUM_BLOCK)) {
            sum.push(block_dot(x, y));
        }
        sum.total()
    }

    fn axpy(&self, a: f64, x: &[f64], y: &mut [f64]) {
        widest(Axpy { a, x, y });
    }

    fn advance(&self, a: f64, b: f64, z: &[f64], p: &mut [f64], x: &mut [f64]) {
        widest(Advance { a, b, z, p, x });
    }
}

/// Euclidean norm, summed in the fixed order.
pub fn norm(x: &[f64]) -> f64 {
    Serial.dot(x, x).sqrt()
}

/// The entries of block number `block` of a vector of length `len`.
pub fn block_range(block: usize, len: usize) -> Range<usize> {
    block * SUM_BLOCK..((block + 1) * SUM_BLOCK).min(len)
}

/// x · y of one block, at most [`SUM_BLOCK`] entries long.
pub fn block_dot(x: &[f64], y: &[f64]) -> f64 {
    widest(Dot { x, y })
}

/// Combines block sums, given in order, as a binary tree, in constant memory.
///
/// Works like a binary counter: level `k` holds the sum of 2ᵏ consecutive blocks, and a carry adds two of them.
#[derive(Clone, Debug)]
pub struct PairwiseSum {
    levels: [f64; 64],
    count: u64,
}

impl PairwiseSum {
    /// An empty sum.
    pub fn new() -> Self {
        Self { levels: [0.0; 64], count: 0 }
    }

    /// Adds the next block sum.
    pub fn push(&mut self, value: f64) {
        let carries = self.count.trailing_ones() as usize;
        let mut value = value;
        for level in 0..carries {
            value += self.levels[level];
        }
        self.levels[carries] = value;
        self.count += 1;
    }

    /// The sum of what was pushed.
    pub fn total(&self) -> f64 {
        let mut total = 0.0;
        let mut rest = self.count;
        while rest != 0 {
            total += self.levels[rest.trailing_zeros() as usize];
            rest &= rest - 1;
        }
        total
    }
}

impl Default for PairwiseSum {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    fn sample(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..n)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect()
    }

    /// Block sums computed on any number of threads combine to the bits of the serial sum.
    #[test]
    fn threads_do_not_change_bits() {
        let n = 10 * SUM_BLOCK + 137;
        let (x, y) = (sample(n, 1), sample(n, 2));
        let serial = Serial.dot(&x, &y);
        for threads in 1..=5 {
            let blocks = n.div_ceil(SUM_BLOCK);
            let mut partial = vec![0.0; blocks];
            let share = blocks.div_ceil(threads);
            thread::scope(|scope| {
                for (part, sums) in partial.chunks_mut(share).enumerate() {
                    let (x, y) = (&x, &y);
                    scope.spawn(move || {
                        for (k, sum) in sums.iter_mut().enumerate() {
                            let range = block_range(part * share + k, n);
                            *sum = block_dot(&x[range.clone()], &y[range]);
                        }
                    });
                }
            });
            let mut sum = PairwiseSum::new();
            partial.iter().for_each(|&s| sum.push(s));
            assert_eq!(sum.total().to_bits(), serial.to_bits(), "{threads} threads");
        }
    }

    /// The blocked sum equals the sum of exactly representable integers, for lengths around every boundary.
    #[test]
    fn sums_of_integers_are_exact() {
        for n in [0, 1, 7, 8, 9, SUM_BLOCK - 1, SUM_BLOCK, SUM_BLOCK + 1, 5 * SUM_BLOCK + 3] {
            let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
            let expected = if n == 0 { 0 } else { n * (n - 1) / 2 };
            assert_eq!(Serial.dot(&x, &vec![1.0; n]), expected as f64, "length {n}");
        }
    }

    /// The fused operations give the bits of their parts.
    #[test]
    fn fused_equals_separate() {
        let n = 2 * SUM_BLOCK + 11;
        let z = sample(n, 4);
        let (mut p, mut target) = (sample(n, 6), sample(n, 7));
        let (old_p, mut expected_target) = (p.clone(), target.clone());
        Serial.advance(0.3, 0.9, &z, &mut p, &mut target);
        Serial.axpy(0.3, &old_p, &mut expected_target);
        assert_eq!(target, expected_target);
        assert!((0..n).all(|i| p[i] == z[i] + 0.9 * old_p[i]));
    }
}
