//! Sparse rows of small dense blocks: b unknowns per row and per column of the pattern.
//!
//! ```text
//! y_i = Σ_j A_ij x_j      A_ij : b × b, kept row by row, [slot][row][column]
//! ```
//!
//! The pattern is fixed when the matrix is made; filling it is adding to slots, whose indices can be asked for once
//! ([`BlockCsr::slot`]) and kept.
//! Rows are independent, so a caller with threads gives each its own range ([`BlockCsr::multiply_rows`]) and gets the
//! same bits.

use crate::csr::Csr;
use crate::operator::LinearOperator;
use crate::vectors::{Rows, widest};
use std::ops::Range;

/// A square sparse matrix of b × b blocks with a fixed pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockCsr {
    block: usize,
    row_start: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

/// Why a pattern was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// The block size is zero.
    #[error("a block has at least one row")]
    EmptyBlock,
    /// A column index is not below the number of rows.
    #[error("row {row} names column {column}, but the matrix has {rows} rows and columns")]
    ColumnOutOfRange {
        /// Row of the pattern.
        row: usize,
        /// The column it names.
        column: usize,
        /// Number of rows.
        rows: usize,
    },
    /// Columns of a row are not in ascending order, or one is repeated.
    #[error("the columns of row {row} must ascend without repeats")]
    Unsorted {
        /// Row of the pattern.
        row: usize,
    },
}

impl BlockCsr {
    /// A matrix of zeros with the given pattern: for each row, its columns in ascending order.
    ///
    /// # Errors
    /// [`PatternError`] when a column is out of range or a row is not sorted.
    pub fn from_pattern(block: usize, rows: &[Vec<u32>]) -> Result<Self, PatternError> {
        if block == 0 {
            return Err(PatternError::EmptyBlock);
        }
        let mut row_start = Vec::with_capacity(rows.len() + 1);
        let mut columns = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        row_start.push(0);
        for (row, row_columns) in rows.iter().enumerate() {
            if !row_columns.is_sorted_by(|a, b| a < b) {
                return Err(PatternError::Unsorted { row });
            }
            if let Some(&last) = row_columns.last()
                && last as usize >= rows.len()
            {
                return Err(PatternError::ColumnOutOfRange { row, column: last as usize, rows: rows.len() });
            }
            columns.extend_from_slice(row_columns);
            row_start.push(columns.len());
        }
        let values = vec![0.0; columns.len() * block * block];
        Ok(Self { block, row_start, columns, values })
    }

    /// A matrix of zeros in which all rows of a group couple with each other, for every group; the diagonal is always
    /// part of the pattern.
    ///
    /// # Errors
    /// [`PatternError`] when a group names a row that does not exist.
    pub fn from_groups<'a>(
        block: usize,
        row_count: usize,
        groups: impl IntoIterator<Item = &'a [u32]>,
    ) -> Result<Self, PatternError> {
        let mut rows: Vec<Vec<u32>> = (0..row_count).map(|row| vec![row as u32]).collect();
        // A row meets the same neighbours again and again: sort it each time it has doubled since it was last sorted.
        let mut sorted_len = vec![1; row_count];
        for group in groups {
            for &row in group {
                let index = row as usize;
                let Some(columns) = rows.get_mut(index) else {
                    return Err(PatternError::ColumnOutOfRange { row: index, column: index, rows: row_count });
                };
                columns.extend_from_slice(group);
                if columns.len() > 2 * sorted_len[index] + 64 {
                    columns.sort_unstable();
                    columns.dedup();
                    sorted_len[index] = columns.len();
                }
            }
        }
        for columns in &mut rows {
            columns.sort_unstable();
            columns.dedup();
        }
        Self::from_pattern(block, &rows)
    }

    /// Rows of a block.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Number of rows of blocks.
    pub fn row_count(&self) -> usize {
        self.row_start.len() - 1
    }

    /// Number of stored blocks.
    pub fn slot_count(&self) -> usize {
        self.columns.len()
    }

    /// The slots of a row: indices into [`Self::columns`] and blocks of [`Self::values`].
    pub fn row_slots(&self, row: usize) -> Range<usize> {
        self.row_start[row]..self.row_start[row + 1]
    }

    /// Column of each slot.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// All values, [slot][row in block][column in block].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All values, for filling.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Index of the block at a row and a column, or none if the pattern does not have it.
    pub fn slot(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.row_slots(row);
        self.columns[range.clone()].binary_search(&(column as u32)).ok().map(|offset| range.start + offset)
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds a block (row by row) to a slot.
    pub fn add_to_slot(&mut self, slot: usize, block: &[f64]) {
        let size = self.block * self.block;
        for (value, add) in self.values[slot * size..(slot + 1) * size].iter_mut().zip(block) {
            *value += add;
        }
    }

    /// Adds a block (row by row) at a row and a column.
    ///
    /// # Panics
    /// When the pattern does not have that block.
    pub fn add_block(&mut self, row: usize, column: usize, block: &[f64]) {
        let slot = self.slot(row, column).expect("blocks are added inside the pattern");
        self.add_to_slot(slot, block);
    }

    /// y ← rows of A x, where `y` holds the entries of those rows only.
    pub fn multiply_rows(&self, rows: Range<usize>, x: &[f64], y: &mut [f64]) {
        match self.block {
            1 => self.multiply_rows_of::<1>(rows, x, y),
            2 => self.multiply_rows_of::<2>(rows, x, y),
            3 => self.multiply_rows_of_three(&self.values, rows, None, x, y),
            6 => self.multiply_rows_of::<6>(rows, x, y),
            _ => self.multiply_rows_of_any(rows, x, y),
        }
    }

    /// y ← rows of (k A + m M) x with a diagonal M of one entry per unknown, where `y` holds the entries of those rows
    /// only: the matrix of an implicit step without making it.
    ///
    /// # Panics
    /// When `diagonal` is shorter than the matrix has rows.
    pub fn multiply_rows_shifted(
        &self,
        rows: Range<usize>,
        [k, m]: [f64; 2],
        diagonal: &[f64],
        x: &[f64],
        y: &mut [f64],
    ) {
        if self.block == 3 {
            self.multiply_rows_of_three(&self.values, rows, Some((k, m, diagonal)), x, y);
            return;
        }
        let entries = rows.start * self.block..rows.end * self.block;
        self.multiply_rows(rows, x, y);
        for ((y, x), d) in y.iter_mut().zip(&x[entries.clone()]).zip(&diagonal[entries]) {
            *y = k * *y + m * d * x;
        }
    }

    /// As [`Self::multiply_rows_shifted`] with a copy of the values in single precision, made by
    /// [`Self::write_single_values`]: half the memory is read, and sums are as precise as ever.
    ///
    /// # Panics
    /// When blocks are not 3 × 3, or `values` or `diagonal` are shorter than the matrix.
    pub fn multiply_rows_of_singles(
        &self,
        values: &[f32],
        rows: Range<usize>,
        [k, m]: [f64; 2],
        diagonal: &[f64],
        x: &[f64],
        y: &mut [f64],
    ) {
        assert_eq!(self.block, 3, "single precision is for blocks of three");
        self.multiply_rows_of_three(values, rows, Some((k, m, diagonal)), x, y);
    }

    /// Copies the values in single precision. Values beyond its range become infinite, and whoever multiplies notices.
    pub fn write_single_values(&self, out: &mut Vec<f32>) {
        out.clear();
        out.extend(self.values.iter().map(|&value| value as f32));
    }

    fn multiply_rows_of_three<T: Copy + Into<f64>>(
        &self,
        values: &[T],
        rows: Range<usize>,
        shift: Option<(f64, f64, &[f64])>,
        x: &[f64],
        y: &mut [f64],
    ) {
        let y = &mut y[..3 * rows.len()];
        let row_start = &self.row_start[rows.start..=rows.end];
        widest(Rows { first: rows.start, row_start, columns: &self.columns, values, x, y, shift });
    }

    /// The product for a block size known to the compiler, which then keeps the row's sums in registers.
    fn multiply_rows_of<const B: usize>(&self, rows: Range<usize>, x: &[f64], y: &mut [f64]) {
        let (x, _) = x.as_chunks::<B>();
        let (y, _) = y.as_chunks_mut::<B>();
        let (values, _) = self.values.as_chunks::<B>();
        let (blocks, _) = values.as_chunks::<B>();
        for (row, y) in rows.zip(y) {
            let slots = self.row_slots(row);
            let mut sum = [0.0; B];
            for (block, &column) in blocks[slots.clone()].iter().zip(&self.columns[slots]) {
                let x = &x[column as usize];
                // The product first, then one addition to the sum: the chain of additions that must wait for each
                // other is B times shorter.
                for i in 0..B {
                    let mut product = block[i][0] * x[0];
                    for j in 1..B {
                        product += block[i][j] * x[j];
                    }
                    sum[i] += product;
                }
            }
            *y = sum;
        }
    }

    fn multiply_rows_of_any(&self, rows: Range<usize>, x: &[f64], y: &mut [f64]) {
        let b = self.block;
        for (row, y) in rows.zip(y.chunks_exact_mut(b)) {
            y.fill(0.0);
            for slot in self.row_slots(row) {
                let block = &self.values[slot * b * b..(slot + 1) * b * b];
                let x = &x[self.columns[slot] as usize * b..][..b];
                for i in 0..b {
                    for j in 0..b {
                        y[i] += block[i * b + j] * x[j];
                    }
                }
            }
        }
    }

    /// Copies the diagonal blocks, [row][row in block][column in block]; zero where the pattern has none.
    pub fn diagonal_blocks(&self, out: &mut [f64]) {
        let size = self.block * self.block;
        for (row, out) in out.chunks_exact_mut(size).enumerate() {
            match self.slot(row, row) {
                Some(slot) => out.copy_from_slice(&self.values[slot * size..(slot + 1) * size]),
                None => out.fill(0.0),
            }
        }
    }

    /// max |A − Aᵀ| / max |A|: zero for a symmetric matrix. A block without its transpose counts as one against zeros.
    pub fn asymmetry(&self) -> f64 {
        let b = self.block;
        let (mut largest, mut difference) = (0.0f64, 0.0f64);
        for row in 0..self.row_count() {
            for slot in self.row_slots(row) {
                let transposed = self.slot(self.columns[slot] as usize, row);
                for i in 0..b {
                    for j in 0..b {
                        let value = self.values[(slot * b + i) * b + j];
                        let mirror = transposed.map_or(0.0, |slot| self.values[(slot * b + j) * b + i]);
                        largest = largest.max(value.abs());
                        difference = difference.max((value - mirror).abs());
                    }
                }
            }
        }
        if largest > 0.0 { difference / largest } else { 0.0 }
    }

    /// The same matrix in single entries; every entry of a stored block is kept, zero or not.
    pub fn to_csr(&self) -> Csr {
        let b = self.block;
        let mut csr = Csr {
            row_start: Vec::with_capacity(self.row_count() * b + 1),
            columns: Vec::with_capacity(self.values.len()),
            values: vec![0.0; self.values.len()],
        };
        csr.row_start.push(0);
        for row in 0..self.row_count() {
            for _ in 0..b {
                for slot in self.row_slots(row) {
                    let first = self.columns[slot] * b as u32;
                    csr.columns.extend(first..first + b as u32);
                }
                csr.row_start.push(csr.columns.len());
            }
        }
        self.write_csr_values(&mut csr.values);
        csr
    }

    /// Writes the values in the order of [`Self::to_csr`], for refilling a matrix made by it.
    pub fn write_csr_values(&self, out: &mut [f64]) {
        let b = self.block;
        let mut next = 0;
        for row in 0..self.row_count() {
            for i in 0..b {
                for slot in self.row_slots(row) {
                    out[next..next + b].copy_from_slice(&self.values[(slot * b + i) * b..][..b]);
                    next += b;
                }
            }
        }
    }
}

impl LinearOperator for BlockCsr {
    fn len(&self) -> usize {
        self.row_count() * self.block
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.multiply_rows(0..self.row_count(), x, y);
    }
}
