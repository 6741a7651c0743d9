//! Products of 3 × 3 blocks, and sums and updates of vectors, with the widest vectors that the processor has.
//!
//! This crate is compiled for every processor of its family; where multiply–add instructions are found at run time, the
//! loops below run in a version compiled for them. The choice is made once per process and never in between, so that
//! one machine always gives the same bits.
//!
//! A row of a block is read as four numbers, of which the last belongs to the next row: it meets a zero of the vector, or
//! ends in a sum that nobody reads.

use pulp::Arch;

/// Runs `work` compiled for the instructions of this processor, with whether it has multiply–add.
#[inline]
pub(crate) fn widest<R>(work: impl Widest<Output = R>) -> R {
    struct Fused<W>(W);
    impl<W: Widest> pulp::WithSimd for Fused<W> {
        type Output = W::Output;
        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _simd: S) -> W::Output {
            self.0.run::<true>()
        }
    }
    // Pages and `Scalar` have no multiply–add of their own, and the one in software is far slower than two roundings.
    if cfg!(target_arch = "wasm32") {
        return work.run::<false>();
    }
    match Arch::new() {
        Arch::Scalar => work.run::<false>(),
        #[allow(unreachable_patterns, reason = "some targets know no other kind")]
        arch => arch.dispatch(Fused(work)),
    }
}

/// Work that is compiled once per kind of processor; its functions are inlined always.
pub(crate) trait Widest {
    /// What it gives.
    type Output;
    /// Does it, with multiply–add or without.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// `a b + c`.
#[inline(always)]
fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// What a matrix is kept in.
pub(crate) trait Stored: Copy + Into<f64> {
    /// Four of them as vectors of four.
    #[cfg(target_arch = "x86_64")]
    fn four(simd: pulp::x86::V3, values: [Self; 4]) -> pulp::f64x4;
}

impl Stored for f64 {
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn four(_simd: pulp::x86::V3, values: [f64; 4]) -> pulp::f64x4 {
        pulp::cast(values)
    }
}

impl Stored for f32 {
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    fn four(simd: pulp::x86::V3, values: [f32; 4]) -> pulp::f64x4 {
        simd.convert_f32x4_to_f64x4(pulp::cast(values))
    }
}

/// Sums of a part of the upper half of a symmetric matrix of 3 × 3 blocks, in double precision whatever the blocks are
/// kept in:
///
/// ```text
/// sums_i = Σ_{j ≥ i} A_ij x_j      sums_j += A_ijᵀ x_i  for j > i
/// ```
pub(crate) struct Upper<'a, T> {
    /// First row.
    pub(crate) first: usize,
    /// First slot of each row, one more than there are rows; the first slot of a row is its diagonal.
    pub(crate) row_start: &'a [usize],
    /// Column of each slot of the matrix.
    pub(crate) columns: &'a [u32],
    /// Blocks of the matrix, and one more number.
    pub(crate) values: &'a [T],
    /// The whole vector, each row followed by a zero.
    pub(crate) x: &'a [[f64; 4]],
    /// The sums from the first row on; the last number of each means nothing.
    pub(crate) sums: &'a mut [[f64; 4]],
}

/// Runs a part with the widest vectors that help: a row of a block is three numbers, read as four.
pub(crate) fn upper<T: Stored>(work: Upper<'_, T>) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        simd.vectorize(Wide { simd, work });
        return;
    }
    work.narrow();
}

impl<T: Stored> Upper<'_, T> {
    /// The same in plain numbers.
    fn narrow(self) {
        let Upper { first, row_start, columns, values, x, sums } = self;
        sums.fill([0.0; 4]);
        let (blocks, _) = values.as_chunks::<9>();
        for (k, slots) in row_start.windows(2).enumerate() {
            let own = x[first + k];
            let mut sum = [0.0; 3];
            for (block, &column) in blocks[slots[0]..slots[1]].iter().zip(&columns[slots[0]..slots[1]]) {
                let (column, block) = (column as usize, block.map(Into::into));
                for i in 0..3 {
                    for j in 0..3 {
                        sum[i] += block[3 * i + j] * x[column][j];
                    }
                }
                if column > first + k {
                    for i in 0..3 {
                        for j in 0..3 {
                            sums[column - first][j] += block[3 * i + j] * own[i];
                        }
                    }
                }
            }
            for i in 0..3 {
                sums[k][i] += sum[i];
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
struct Wide<'a, T> {
    simd: pulp::x86::V3,
    work: Upper<'a, T>,
}

#[cfg(target_arch = "x86_64")]
impl<T: Stored> pulp::NullaryFnOnce for Wide<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Wide { simd, work: Upper { first, row_start, columns, values, x, sums } } = self;
        let rows_of = |block: &[T]| -> [pulp::f64x4; 3] {
            std::array::from_fn(|r| {
                T::four(simd, *block[3 * r..].first_chunk().expect("a block is followed by another number"))
            })
        };
        sums.fill([0.0; 4]);
        for (k, slots) in row_start.windows(2).enumerate() {
            let own = x[first + k];
            let spread = [simd.splat_f64x4(own[0]), simd.splat_f64x4(own[1]), simd.splat_f64x4(own[2])];
            // Four partial sums per row of the block, of which the last holds nothing.
            let diagonal = rows_of(&values[9 * slots[0]..9 * slots[0] + 10]);
            let mut sum = diagonal.map(|row| simd.mul_f64x4(row, pulp::cast(own)));
            let blocks = values[9 * slots[0] + 9..9 * slots[1] + 1].windows(10).step_by(9);
            for (block, &column) in blocks.zip(&columns[slots[0] + 1..slots[1]]) {
                let column = column as usize;
                let right = pulp::cast(x[column]);
                let target = &mut sums[column - first];
                let mut below: pulp::f64x4 = pulp::cast(*target);
                for ((row, sum), own) in rows_of(block).into_iter().zip(&mut sum).zip(spread) {
                    *sum = simd.mul_add_f64x4(row, right, *sum);
                    below = simd.mul_add_f64x4(row, own, below);
                }
                *target = pulp::cast(below);
            }
            for (target, sum) in sums[k].iter_mut().zip(sum) {
                *target += sum.0 + sum.1 + sum.2;
            }
        }
    }
}

/// `z_i = B_i r_i` for symmetric 3 × 3 blocks.
pub(crate) struct Diagonal<'a> {
    /// The blocks B_i.
    pub(crate) blocks: &'a [f64],
    /// The vector.
    pub(crate) r: &'a [f64],
    /// The result.
    pub(crate) z: &'a mut [f64],
}

impl Widest for Diagonal<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let (z, _) = self.z.as_chunks_mut::<3>();
        let (r, _) = self.r.as_chunks::<3>();
        let (blocks, _) = self.blocks.as_chunks::<9>();
        for ((z, r), block) in z.iter_mut().zip(r).zip(blocks) {
            // Columns of a symmetric block are its rows: no sum across lanes.
            let mut sum = [0.0; 4];
            for j in 0..3 {
                let row = [block[3 * j], block[3 * j + 1], block[3 * j + 2], 0.0];
                for lane in 0..4 {
                    sum[lane] = multiply_add::<FUSED>(row[lane], r[j], sum[lane]);
                }
            }
            *z = [sum[0], sum[1], sum[2]];
        }
    }
}

/// Partial sums kept side by side in a dot product.
const LANES: usize = 8;

/// x · y on eight partial sums: products and sums are rounded apart, so that every processor gives the same bits.
pub(crate) struct Dot<'a> {
    /// One vector.
    pub(crate) x: &'a [f64],
    /// The other.
    pub(crate) y: &'a [f64],
}

impl Widest for Dot<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let mut lanes = [0.0; LANES];
        let (x_wide, x_rest) = self.x.as_chunks::<LANES>();
        let (y_wide, y_rest) = self.y.as_chunks::<LANES>();
        for (x, y) in x_wide.iter().zip(y_wide) {
            for lane in 0..LANES {
                lanes[lane] += x[lane] * y[lane];
            }
        }
        for (lane, (x, y)) in x_rest.iter().zip(y_rest).enumerate() {
            lanes[lane] += x * y;
        }
        ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
    }
}

/// y ← y + a x.
pub(crate) struct Axpy<'a> {
    /// Factor.
    pub(crate) a: f64,
    /// What is added.
    pub(crate) x: &'a [f64],
    /// What it is added to.
    pub(crate) y: &'a mut [f64],
}

impl Widest for Axpy<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for (y, x) in self.y.iter_mut().zip(self.x) {
            *y += self.a * x;
        }
    }
}

/// x ← x + a p, then p ← z + b p.
pub(crate) struct Advance<'a> {
    /// Length of the step.
    pub(crate) a: f64,
    /// Share of the old direction.
    pub(crate) b: f64,
    /// Preconditioned residual.
    pub(crate) z: &'a [f64],
    /// Direction.
    pub(crate) p: &'a mut [f64],
    /// Solution.
    pub(crate) x: &'a mut [f64],
}

impl Widest for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for ((p, x), z) in self.p.iter_mut().zip(self.x).zip(self.z) {
            *x += self.a * *p;
            *p = z + self.b * *p;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..n)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
            })
            .collect()
    }

    /// Sums of a part, with vectors and without and in both precisions, are those of the whole symmetric matrix.
    #[test]
    fn sums_of_a_part_are_those_of_the_symmetric_matrix() {
        // Rows 1 to 3 of five.
        let (first, row_start) = (1, [1, 4, 6, 7]);
        let columns = [0, 1, 2, 4, 2, 3, 3, 4];
        let singles: Vec<f32> = sample(8 * 9 + 1, 1).iter().map(|&v| v as f32).collect();
        let values: Vec<f64> = singles.iter().map(|&v| f64::from(v)).collect();
        let x: Vec<[f64; 4]> = sample(15, 2).chunks(3).map(|x| [x[0], x[1], x[2], 0.0]).collect();
        let mut expected = [[0.0; 3]; 4];
        for row in 1..4 {
            for slot in row_start[row - first]..row_start[row] {
                let column = columns[slot] as usize;
                for i in 0..3 {
                    for j in 0..3 {
                        let value = values[9 * slot + 3 * i + j];
                        expected[row - first][i] += value * x[column][j];
                        if column > row {
                            expected[column - first][j] += value * x[row][i];
                        }
                    }
                }
            }
        }
        let same = |sums: &[[f64; 4]]| {
            for (got, want) in sums.iter().zip(&expected) {
                assert!((0..3).all(|i| (got[i] - want[i]).abs() < 1e-15), "{got:?} for {want:?}");
            }
        };
        let stale = vec![[7.0; 4]; 4];
        let mut sums = [stale.clone(), stale.clone(), stale.clone(), stale];
        let [wide, narrow, wide_singles, narrow_singles] = &mut sums;
        let columns = &columns;
        upper(Upper { first, row_start: &row_start, columns, values: &values, x: &x, sums: wide });
        Upper { first, row_start: &row_start, columns, values: &values, x: &x, sums: narrow }.narrow();
        upper(Upper { first, row_start: &row_start, columns, values: &singles, x: &x, sums: wide_singles });
        Upper { first, row_start: &row_start, columns, values: &singles, x: &x, sums: narrow_singles }.narrow();
        sums.iter().for_each(|s| same(s));
    }
}
