//! What the processor can do at most, measured in the same process as everything else.
//!
//! *Arithmetic*: fused multiply-adds on registers alone, enough chains side by side to hide their latency.
//! *Bandwidth*: the triad `a ← b + s c` on arrays, counted as 24 bytes per entry as usual (what the processor reads in
//! order to write is not counted), once with arrays that stay in the second-level cache and once with arrays that come
//! from memory.
//!
//! A kernel that does `o` operations on `b` bytes needs at least `max(o / arithmetic, b / bandwidth)`; the larger of
//! the two binds it.

use crate::stopwatch::{Effort, Spread, race};
use crate::vectors::Vectors;
use pulp::{Simd, WithSimd};
use serde::Serialize;

/// Peaks of one thread.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Operations per nanosecond, a fused multiply-add being two.
    pub operations_per_ns: Spread,
    /// Bytes per nanosecond from the second-level cache.
    pub cache_bytes_per_ns: Spread,
    /// Bytes per nanosecond from memory.
    pub memory_bytes_per_ns: Spread,
}

/// Which limit binds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// Arithmetic.
    Arithmetic,
    /// Bandwidth of the memory or cache that the data comes from.
    Bandwidth,
}

/// Entries of each of the triad's arrays that stay in the second-level cache: 192 KiB in all.
const CACHED: usize = 8 * 1024;

/// Entries of each of those that do not fit into any cache: 96 MiB in all.
const STREAMED: usize = 4 * 1024 * 1024;

/// Iterations of the loop of multiply-adds per call.
const ITERATIONS: usize = 4096;

/// Multiply-adds per iteration: a processor does two at once, each takes four or five cycles.
const CHAINS: usize = 12;

/// Measures the peaks of one thread with these vectors.
pub fn measure(vectors: Vectors, effort: Effort) -> Peak {
    let mut checksum = 0.0;
    let arithmetic = race(effort, &mut [&mut || checksum += vectors.run(MultiplyAdds { seed: 1e-3 })]);
    // The result is looked at, or the loop would be removed.
    std::hint::black_box(checksum);
    let operations = vectors.run(Lanes) * ITERATIONS * CHAINS * 2;
    let rates = |work: f64, times: &[f64]| Spread::of(&times.iter().map(|t| 1e-9 * work / t).collect::<Vec<_>>());
    let triad = |entries: usize, per_call: usize| {
        let (b, c) = (vec![1.0; entries], vec![2.0; entries]);
        // Not zeros: the system gives their pages when they are first touched.
        let mut a = vec![1.0; entries];
        let mut at = 0;
        let times = race(
            effort,
            &mut [&mut || {
                let part = at..at + per_call;
                vectors.run(Triad { a: &mut a[part.clone()], b: &b[part.clone()], c: &c[part], s: 3.0 });
                at = (at + per_call) % entries;
            }],
        );
        std::hint::black_box(a);
        rates((24 * per_call) as f64, &times[0])
    };
    Peak {
        operations_per_ns: rates(operations as f64, &arithmetic[0]),
        cache_bytes_per_ns: triad(CACHED, CACHED),
        memory_bytes_per_ns: triad(STREAMED, CACHED),
    }
}

/// The least time in ns that this work needs, and why.
pub fn least_ns(operations: f64, bytes: f64, operations_per_ns: f64, bytes_per_ns: f64) -> (f64, Bound) {
    let (arithmetic, bandwidth) = (operations / operations_per_ns, bytes / bytes_per_ns);
    if arithmetic >= bandwidth { (arithmetic, Bound::Arithmetic) } else { (bandwidth, Bound::Bandwidth) }
}

/// Number of doubles per vector.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

/// `x ← x a + b` on [`CHAINS`] registers, [`ITERATIONS`] times; their sum.
struct MultiplyAdds {
    seed: f64,
}

impl WithSimd for MultiplyAdds {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (a, b) = (simd.splat_f64s(0.999), simd.splat_f64s(self.seed));
        let mut x: [S::f64s; CHAINS] = std::array::from_fn(|k| simd.splat_f64s(self.seed * k as f64));
        for _ in 0..ITERATIONS {
            for x in &mut x {
                *x = simd.mul_add_f64s(*x, a, b);
            }
        }
        let sum = x.into_iter().fold(simd.splat_f64s(0.0), |sum, x| simd.add_f64s(sum, x));
        simd.reduce_sum_f64s(sum)
    }
}

/// `a ← b + s c`.
struct Triad<'a> {
    a: &'a mut [f64],
    b: &'a [f64],
    c: &'a [f64],
    s: f64,
}

impl WithSimd for Triad<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let s = simd.splat_f64s(self.s);
        let (a, (b, c)) = (S::as_mut_simd_f64s(self.a).0, (S::as_simd_f64s(self.b).0, S::as_simd_f64s(self.c).0));
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            *a = simd.mul_add_f64s(s, *c, *b);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The larger of the two least times binds.
    #[test]
    fn the_larger_limit_binds() {
        assert_eq!(least_ns(100.0, 10.0, 10.0, 10.0), (10.0, Bound::Arithmetic));
        assert_eq!(least_ns(10.0, 400.0, 10.0, 20.0), (20.0, Bound::Bandwidth));
    }

    /// The triad computes what it says, and the chains stay finite, so that no slow path for other numbers is measured.
    #[test]
    fn loops_compute_what_they_say() {
        for vectors in Vectors::available() {
            let (mut a, b, c) = (vec![0.0; 64], vec![1.0; 64], vec![2.0; 64]);
            vectors.run(Triad { a: &mut a, b: &b, c: &c, s: 3.0 });
            assert!(a.iter().all(|a| *a == 7.0), "{vectors:?}");
            let sum = vectors.run(MultiplyAdds { seed: 1e-3 });
            assert!(sum.is_finite() && sum > 1.0, "{vectors:?}: {sum}");
        }
    }
}
