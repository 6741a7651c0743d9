//! Products with half a matrix, part by part, with the same bits for any number of threads.
//!
//! A block above the diagonal adds to two rows, its own and that of its column. Rows are cut into parts, which depend on
//! the pattern alone; each part adds into sums of its own, those of its rows and of the rows below that it reaches:
//!
//! ```text
//! part 0   ████████▒▒            █ its rows   ▒ rows of later parts that it adds to
//! part 1           ██████▒▒▒
//! part 2                 ███████
//! y = k (█ + ▒ of earlier parts, in their order) + m M x
//! ```
//!
//! So parts run in any order ([`SymmetricBlocks::run_part`]), and what they left is put together afterwards
//! ([`SymmetricBlocks::finish_rows`]); rows of a part are complete once it and all earlier parts are done.

use crate::operator::LinearOperator;
use crate::symmetric_blocks::SymmetricBlocks;
use crate::vector::SUM_BLOCK;
use crate::vectors::{Stored, Upper, upper};
use std::ops::Range;

/// Unknowns of a part at least: enough to be worth a thread, and few enough for their sums to stay in the nearest caches.
const PART: usize = SUM_BLOCK;

/// Rows that a product takes as one task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// First row.
    pub first: usize,
    /// Row after the last.
    pub end: usize,
    /// Row after the last that blocks of these rows add to.
    pub reach: usize,
    /// First part that may add to these rows.
    giver: usize,
}

/// Cuts rows into parts. A part grows until it reaches fewer rows beyond it than it has.
pub(crate) fn parts(block: usize, row_start: &[usize], columns: &[u32]) -> Vec<Part> {
    let rows = row_start.len() - 1;
    let step = (SUM_BLOCK / block).max(1);
    let mut parts: Vec<Part> = Vec::new();
    let (mut first, mut reach) = (0, 0);
    for end in (step..rows).step_by(step).chain([rows]) {
        let last_columns = (end.saturating_sub(step).max(first)..end).filter(|&r| row_start[r] < row_start[r + 1]);
        reach = last_columns.map(|r| columns[row_start[r + 1] - 1] as usize + 1).fold(reach.max(end), usize::max);
        let enough = (end - first) * block >= PART && reach - end <= end - first;
        if end == rows || enough {
            let giver = parts.iter().position(|p| p.reach > first).unwrap_or(parts.len());
            parts.push(Part { first, end, reach, giver });
            first = end;
            reach = end;
        }
    }
    parts
}

/// What products with one matrix need beside it, sized once: the vector and the sums, with rows of three kept as four
/// numbers of which the last counts nothing.
#[derive(Clone, Debug, Default)]
pub struct ProductBuffers {
    x: Vec<f64>,
    sums: Vec<f64>,
    /// Where the sums of each part begin.
    starts: Vec<usize>,
}

/// Numbers that a row has in the buffers.
fn width(block: usize) -> usize {
    if block == 3 { 4 } else { block }
}

/// How y follows from A x: y = k A x + m M x with a diagonal M of one number per unknown. The matrix of an implicit step
/// is never made.
#[derive(Clone, Copy, Debug)]
pub struct Shift<'a> {
    /// Factor of the matrix.
    pub k: f64,
    /// Factor of the diagonal.
    pub m: f64,
    /// The diagonal M.
    pub diagonal: &'a [f64],
}

impl SymmetricBlocks {
    /// Memory for products.
    pub fn product_buffers(&self) -> ProductBuffers {
        let width = width(self.block());
        let mut starts = vec![0];
        for part in self.parts() {
            starts.push(starts[starts.len() - 1] + (part.reach - part.first) * width);
        }
        let sums = vec![0.0; starts[starts.len() - 1]];
        ProductBuffers { x: vec![0.0; self.row_count() * width], sums, starts }
    }

    /// Takes the vector of the next product.
    pub fn load(&self, x: &[f64], buffers: &mut ProductBuffers) {
        if self.block() != 3 {
            buffers.x.copy_from_slice(x);
            return;
        }
        let (x, _) = x.as_chunks::<3>();
        let (wide, _) = buffers.x.as_chunks_mut::<4>();
        for (wide, x) in wide.iter_mut().zip(x) {
            *wide = [x[0], x[1], x[2], 0.0];
        }
    }

    /// All parts as tasks: their numbers with their sums, and the loaded vector that they share.
    pub fn tasks<'b>(&self, buffers: &'b mut ProductBuffers) -> (&'b [f64], Vec<(usize, &'b mut [f64])>) {
        let mut left = &mut buffers.sums[..];
        let mut tasks = Vec::with_capacity(self.parts().len());
        for (part, bounds) in buffers.starts.windows(2).enumerate() {
            let (sums, rest) = left.split_at_mut(bounds[1] - bounds[0]);
            tasks.push((part, sums));
            left = rest;
        }
        (&buffers.x, tasks)
    }

    /// The sums of one part, from the vector and the place that [`Self::tasks`] gave for it.
    pub fn run_part(&self, part: usize, x: &[f64], sums: &mut [f64]) {
        match self.block() {
            3 => self.run_part_of_three(self.padded_values(), part, x, sums),
            1 => self.run_part_of::<1>(part, x, sums),
            2 => self.run_part_of::<2>(part, x, sums),
            _ => self.run_part_of_any(part, x, sums),
        }
    }

    /// The same with a copy of the values in single precision, made by [`Self::write_single_values`]: half the memory is
    /// read, and sums are as precise as ever.
    ///
    /// # Panics
    /// When blocks are not 3 × 3, or `values` are not those of such a copy.
    pub fn run_part_of_singles(&self, values: &[f32], part: usize, x: &[f64], sums: &mut [f64]) {
        assert_eq!(self.block(), 3, "single precision is for blocks of three");
        self.run_part_of_three(values, part, x, sums);
    }

    /// Makes one part's sums in place; the parts before it need not be done.
    pub fn run_part_in_place(&self, singles: Option<&[f32]>, part: usize, buffers: &mut ProductBuffers) {
        let sums = &mut buffers.sums[buffers.starts[part]..buffers.starts[part + 1]];
        match singles {
            Some(values) => self.run_part_of_singles(values, part, &buffers.x, sums),
            None => self.run_part(part, &buffers.x, sums),
        }
    }

    /// y ← rows of A x, or of the shifted matrix, where `y` has the entries of those rows only; `x` is the whole vector
    /// that was loaded. All parts up to the last of these rows must be done.
    pub fn finish_rows(
        &self,
        rows: Range<usize>,
        shift: Option<Shift<'_>>,
        x: &[f64],
        buffers: &ProductBuffers,
        y: &mut [f64],
    ) {
        let b = self.block();
        let mut at = rows.start;
        while at < rows.end {
            let part = self.parts().partition_point(|p| p.end <= at);
            let end = rows.end.min(self.parts()[part].end);
            let y = &mut y[(at - rows.start) * b..(end - rows.start) * b];
            if b == 3 {
                self.gather::<3, 4>(part, at..end, buffers, y);
            } else {
                self.gather_any(part, at..end, buffers, y);
            }
            if let Some(Shift { k, m, diagonal }) = shift {
                let entries = at * b..end * b;
                for ((y, x), d) in y.iter_mut().zip(&x[entries.clone()]).zip(&diagonal[entries]) {
                    *y = k * *y + m * d * x;
                }
            }
            at = end;
        }
    }

    /// Parts before `part` that add to its rows from `first` on, with where in the buffer the sums of row `first` are, and
    /// how many rows they reach from there.
    fn givers<'b>(
        &'b self,
        part: usize,
        first: usize,
        buffers: &'b ProductBuffers,
    ) -> impl Iterator<Item = (usize, usize)> + 'b {
        let width = width(self.block());
        let givers =
            self.parts()[self.parts()[part].giver..part].iter().zip(&buffers.starts[self.parts()[part].giver..]);
        givers
            .filter(move |(p, _)| p.reach > first)
            .map(move |(p, start)| (start + (first - p.first) * width, p.reach - first))
    }

    fn gather<const B: usize, const W: usize>(
        &self,
        part: usize,
        rows: Range<usize>,
        buffers: &ProductBuffers,
        y: &mut [f64],
    ) {
        let (y, _) = y.as_chunks_mut::<B>();
        let own = buffers.starts[part] + (rows.start - self.parts()[part].first) * W;
        let (sums, _) = buffers.sums[own..].as_chunks::<W>();
        for (y, sum) in y.iter_mut().zip(sums) {
            y.copy_from_slice(&sum[..B]);
        }
        for (from, reached) in self.givers(part, rows.start, buffers) {
            let (sums, _) = buffers.sums[from..from + reached * W].as_chunks::<W>();
            for (y, sum) in y.iter_mut().zip(sums) {
                for i in 0..B {
                    y[i] += sum[i];
                }
            }
        }
    }

    fn gather_any(&self, part: usize, rows: Range<usize>, buffers: &ProductBuffers, y: &mut [f64]) {
        let b = self.block();
        let own = buffers.starts[part] + (rows.start - self.parts()[part].first) * b;
        y.copy_from_slice(&buffers.sums[own..own + y.len()]);
        for (from, reached) in self.givers(part, rows.start, buffers) {
            for (y, sum) in y.iter_mut().zip(&buffers.sums[from..from + reached * b]) {
                *y += sum;
            }
        }
    }

    fn run_part_of_three<T: Stored>(&self, values: &[T], part: usize, x: &[f64], sums: &mut [f64]) {
        let Part { first, end, .. } = self.parts()[part];
        upper(Upper {
            first,
            row_start: &self.row_starts()[first..=end],
            columns: self.columns(),
            values,
            x: x.as_chunks().0,
            sums: sums.as_chunks_mut().0,
        });
    }

    /// The product for a block size known to the compiler, which then keeps the row's sums in registers.
    fn run_part_of<const B: usize>(&self, part: usize, x: &[f64], sums: &mut [f64]) {
        let Part { first, end, .. } = self.parts()[part];
        let (x, _) = x.as_chunks::<B>();
        sums.fill(0.0);
        let (sums, _) = sums.as_chunks_mut::<B>();
        let (rows, _) = self.values().as_chunks::<B>();
        let (blocks, _) = rows.as_chunks::<B>();
        for row in first..end {
            let slots = self.row_slots(row);
            let own = x[row];
            let mut sum = product(&blocks[slots.start], &own);
            for (block, &column) in blocks[slots.clone()].iter().zip(&self.columns()[slots]).skip(1) {
                let column = column as usize;
                let right = product(block, &x[column]);
                let target = &mut sums[column - first];
                for i in 0..B {
                    sum[i] += right[i];
                    for j in 0..B {
                        target[j] += block[i][j] * own[i];
                    }
                }
            }
            for i in 0..B {
                sums[row - first][i] += sum[i];
            }
        }
    }

    fn run_part_of_any(&self, part: usize, x: &[f64], sums: &mut [f64]) {
        let b = self.block();
        let Part { first, end, .. } = self.parts()[part];
        sums.fill(0.0);
        for row in first..end {
            for slot in self.row_slots(row) {
                let block = &self.values()[slot * b * b..(slot + 1) * b * b];
                let column = self.columns()[slot] as usize;
                for i in 0..b {
                    for j in 0..b {
                        sums[(row - first) * b + i] += block[i * b + j] * x[column * b + j];
                        if column > row {
                            sums[(column - first) * b + j] += block[i * b + j] * x[row * b + i];
                        }
                    }
                }
            }
        }
    }
}

fn product<const B: usize>(block: &[[f64; B]; B], x: &[f64; B]) -> [f64; B] {
    block.map(|row| {
        let mut sum = row[0] * x[0];
        for j in 1..B {
            sum += row[j] * x[j];
        }
        sum
    })
}

impl LinearOperator for SymmetricBlocks {
    fn len(&self) -> usize {
        self.row_count() * self.block()
    }

    /// Allocates its buffers: whoever multiplies often keeps [`ProductBuffers`].
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        let mut buffers = self.product_buffers();
        self.load(x, &mut buffers);
        for part in 0..self.parts().len() {
            self.run_part_in_place(None, part, &mut buffers);
        }
        self.finish_rows(0..self.row_count(), None, x, &buffers, y);
    }
}
