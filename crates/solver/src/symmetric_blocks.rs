//! Symmetric sparse matrices of small dense blocks: b unknowns per row and per column of the pattern, upper half only.
//!
//! ```text
//! y_i = A_ii x_i + Σ_{j>i} A_ij x_j + Σ_{j<i} A_jiᵀ x_j      A_ij : b × b, kept row by row, [slot][row][column]
//! ```
//!
//! A product waits for the matrix to be read; of a symmetric one half is enough, and every block that is read serves
//! two rows ([`crate::symmetric_products`]).
//! The pattern is fixed when the matrix is made; filling it is adding to slots, whose indices can be asked for once
//! ([`SymmetricBlocks::slot`]) and kept.

use crate::csr::Csr;
use crate::symmetric_products::{Part, parts};
use std::ops::Range;

/// A symmetric sparse matrix of b × b blocks with a fixed pattern, of which the blocks on and above the diagonal are kept.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricBlocks {
    block: usize,
    row_start: Vec<usize>,
    columns: Vec<u32>,
    /// Blocks, and one number beyond the last that nobody counts: rows of three are read as four.
    values: Vec<f64>,
    parts: Vec<Part>,
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
    /// A row does not begin with its diagonal block, or its columns are not in ascending order, or one is repeated.
    #[error("the columns of row {row} must begin with {row} and ascend without repeats")]
    Unsorted {
        /// Row of the pattern.
        row: usize,
    },
}

impl SymmetricBlocks {
    /// A matrix of zeros with the given pattern: for each row, its columns from the diagonal on, ascending.
    ///
    /// # Errors
    /// [`PatternError`] when a column is out of range, or a row is not sorted or does not begin with its diagonal.
    pub fn from_pattern(block: usize, rows: &[Vec<u32>]) -> Result<Self, PatternError> {
        if block == 0 {
            return Err(PatternError::EmptyBlock);
        }
        let mut row_start = Vec::with_capacity(rows.len() + 1);
        let mut columns = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        row_start.push(0);
        for (row, row_columns) in rows.iter().enumerate() {
            if row_columns.first() != Some(&(row as u32)) || !row_columns.is_sorted_by(|a, b| a < b) {
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
        let values = vec![0.0; columns.len() * block * block + 1];
        let parts = parts(block, &row_start, &columns);
        Ok(Self { block, row_start, columns, values, parts })
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
                columns.extend(group.iter().filter(|&&column| column > row));
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

    /// Number of unknowns: rows of numbers.
    pub fn len(&self) -> usize {
        self.row_count() * self.block
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.row_count() == 0
    }

    /// Number of stored blocks.
    pub fn slot_count(&self) -> usize {
        self.columns.len()
    }

    /// First slot of each row, and the number of slots: the diagonal block comes first.
    pub fn row_starts(&self) -> &[usize] {
        &self.row_start
    }

    /// The slots of a row: indices into [`Self::columns`] and blocks of [`Self::values`]. The first is the diagonal one.
    pub fn row_slots(&self, row: usize) -> Range<usize> {
        self.row_start[row]..self.row_start[row + 1]
    }

    /// Column of each slot.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// All values, [slot][row in block][column in block].
    pub fn values(&self) -> &[f64] {
        &self.values[..self.values.len() - 1]
    }

    /// All values, for filling.
    pub fn values_mut(&mut self) -> &mut [f64] {
        let len = self.values.len() - 1;
        &mut self.values[..len]
    }

    /// The values with one more number behind the last.
    pub(crate) fn padded_values(&self) -> &[f64] {
        &self.values
    }

    /// Ranges of rows that a product takes as one task.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Index of the block at a row and a column on or above the diagonal, or none if the pattern does not have it.
    pub fn slot(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.row_slots(row);
        self.columns[range.clone()].binary_search(&(column as u32)).ok().map(|offset| range.start + offset)
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds a block (row by row) at a row and a column on or above the diagonal. On the diagonal it must be symmetric.
    ///
    /// # Panics
    /// When the pattern does not have that block.
    pub fn add_block(&mut self, row: usize, column: usize, block: &[f64]) {
        let slot = self.slot(row, column).expect("blocks are added inside the pattern, on or above the diagonal");
        let size = self.block * self.block;
        for (value, add) in self.values[slot * size..(slot + 1) * size].iter_mut().zip(block) {
            *value += add;
        }
    }

    /// Copies the values in single precision, for [`Self::run_part_of_singles`](Self::run_part_of_singles). Values beyond
    /// its range become infinite, and whoever multiplies notices.
    pub fn write_single_values(&self, out: &mut Vec<f32>) {
        out.clear();
        out.extend(self.values.iter().map(|&value| value as f32));
    }

    /// Copies the diagonal blocks, [row][row in block][column in block].
    pub fn diagonal_blocks(&self, out: &mut [f64]) {
        let size = self.block * self.block;
        for (&slot, out) in self.row_start.iter().zip(out.chunks_exact_mut(size)) {
            out.copy_from_slice(&self.values[slot * size..(slot + 1) * size]);
        }
    }

    /// The whole matrix, both halves, in single entries; every entry of a stored block is kept, zero or not.
    pub fn to_csr(&self) -> Csr {
        let (b, rows) = (self.block, self.row_count());
        let starts = self.whole_rows();
        let mut columns = vec![0; starts[rows] * b * b];
        let mut row_start = Vec::with_capacity(rows * b + 1);
        row_start.push(0);
        for row in 0..rows {
            let width = (starts[row + 1] - starts[row]) * b;
            row_start.extend((1..=b).map(|i| starts[row] * b * b + i * width));
        }
        self.each_block_of_rows(&starts, |at, width, column, _, _| {
            for i in 0..b {
                for j in 0..b {
                    columns[at + i * width + j] = (column * b + j) as u32;
                }
            }
        });
        let mut csr = Csr { row_start, values: vec![0.0; columns.len()], columns };
        self.write_csr_values(&mut csr.values);
        csr
    }

    /// Writes the values in the order of [`Self::to_csr`], for refilling a matrix made by it.
    pub fn write_csr_values(&self, out: &mut [f64]) {
        let b = self.block;
        self.each_block_of_rows(&self.whole_rows(), |at, width, _, slot, transposed| {
            let block = &self.values[slot * b * b..][..b * b];
            for i in 0..b {
                for j in 0..b {
                    out[at + i * width + j] = if transposed { block[j * b + i] } else { block[i * b + j] };
                }
            }
        });
    }

    /// First block of each row of the whole matrix, and their number.
    fn whole_rows(&self) -> Vec<usize> {
        let mut starts = vec![0; self.row_count() + 1];
        for row in 0..self.row_count() {
            for &column in &self.columns[self.row_slots(row)] {
                starts[column as usize + 1] += 1;
            }
            starts[row + 1] += self.row_slots(row).len() - 1;
        }
        for row in 0..self.row_count() {
            starts[row + 1] += starts[row];
        }
        starts
    }

    /// Gives every block of the whole matrix: index of its first number among those of [`Self::to_csr`], numbers in one
    /// of its rows, column, slot, and whether it is the transpose of what stands there.
    fn each_block_of_rows(&self, starts: &[usize], mut give: impl FnMut(usize, usize, usize, usize, bool)) {
        let b = self.block;
        // Rows are visited in ascending order, and so are the columns that each row gets.
        let mut next = vec![0; self.row_count()];
        let mut place = |row: usize, column: usize, slot: usize, transposed: bool| {
            let width = (starts[row + 1] - starts[row]) * b;
            give(starts[row] * b * b + next[row] * b, width, column, slot, transposed);
            next[row] += 1;
        };
        for row in 0..self.row_count() {
            for slot in self.row_slots(row) {
                let column = self.columns[slot] as usize;
                place(row, column, slot, false);
                if column > row {
                    place(column, row, slot, true);
                }
            }
        }
    }
}
