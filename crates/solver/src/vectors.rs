//! Products of 3 × 3 blocks with the widest vectors that the processor has.
//!
//! This crate is compiled for every processor of its family; where multiply–add instructions are found at run time, the
//! loops below run in a version compiled for them. The choice is made once per process and never in between, so that
//! one machine always gives the same bits.
//!
//! A row of a block is read as four numbers, of which the last belongs to the next row: it meets a zero of the vector.

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
    // `Scalar` has no multiply–add of its own, and the one in software is far slower than two roundings.
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

/// `sums[i] += row i of block · x`, kept as four partial sums each, of which the last holds nothing.
#[inline(always)]
fn add_block<const FUSED: bool, T: Copy + Into<f64>>(block: &[T; 9], x: &[f64; 3], sums: &mut [[f64; 4]; 3]) {
    let x = [x[0], x[1], x[2], 0.0];
    let at = |k: usize| -> f64 { block[k].into() };
    let rows = [[at(0), at(1), at(2), 0.0], [at(3), at(4), at(5), 0.0], [at(6), at(7), at(8), 0.0]];
    for (row, sum) in rows.iter().zip(sums) {
        for lane in 0..4 {
            sum[lane] = multiply_add::<FUSED>(row[lane], x[lane], sum[lane]);
        }
    }
}

/// `y_i = k Σ_j A_ij x_j + m M_i x_i` for rows of 3 × 3 blocks, in double precision whatever the blocks are kept in.
pub(crate) struct Rows<'a, T> {
    /// First row.
    pub(crate) first: usize,
    /// First slot of each row, one more than there are rows.
    pub(crate) row_start: &'a [usize],
    /// Column of each slot of the matrix.
    pub(crate) columns: &'a [u32],
    /// Blocks of the matrix.
    pub(crate) values: &'a [T],
    /// The whole vector.
    pub(crate) x: &'a [f64],
    /// The rows' part of the result.
    pub(crate) y: &'a mut [f64],
    /// k, m and the diagonal M of the whole matrix; none: k = 1, m = 0.
    pub(crate) shift: Option<(f64, f64, &'a [f64])>,
}

impl<T: Copy + Into<f64>> Widest for Rows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Rows { first, row_start, columns, values, x, y, shift } = self;
        let (x, _) = x.as_chunks::<3>();
        let (y, _) = y.as_chunks_mut::<3>();
        let (blocks, _) = values.as_chunks::<9>();
        for (k, (y, bounds)) in y.iter_mut().zip(row_start.windows(2)).enumerate() {
            let mut sums = [[0.0; 4]; 3];
            for (block, &column) in blocks[bounds[0]..bounds[1]].iter().zip(&columns[bounds[0]..bounds[1]]) {
                add_block::<FUSED, T>(block, &x[column as usize], &mut sums);
            }
            *y = sums.map(|s| (s[0] + s[1]) + s[2]);
            if let Some((scale, mass_scale, mass)) = shift {
                let row = first + k;
                for i in 0..3 {
                    y[i] = multiply_add::<FUSED>(mass_scale * mass[3 * row + i], x[row][i], scale * y[i]);
                }
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

    /// Rows of blocks, whatever the processor has, are the sums that they stand for.
    #[test]
    fn rows_are_sums_of_products() {
        let row_start = [0, 2, 5, 6];
        let columns = [0, 2, 0, 1, 2, 1];
        let (values, x, mass) = (sample(6 * 9, 1), sample(9, 2), sample(9, 3));
        let mut y = vec![0.0; 9];
        widest(Rows {
            first: 0,
            row_start: &row_start,
            columns: &columns,
            values: &values,
            x: &x,
            y: &mut y,
            shift: Some((0.3, 1.7, &mass)),
        });
        for row in 0..3 {
            for i in 0..3 {
                let slots = row_start[row]..row_start[row + 1];
                let product = |slot: usize| -> f64 {
                    (0..3).map(|j| values[9 * slot + 3 * i + j] * x[3 * columns[slot] as usize + j]).sum()
                };
                let at = 3 * row + i;
                let expected = 0.3 * slots.map(product).sum::<f64>() + 1.7 * mass[at] * x[at];
                assert!((y[at] - expected).abs() < 1e-15, "{} for {expected}", y[at]);
            }
        }
    }
}
