//! Sparse rows of single entries, sorted by column: what factorisations read.
//!
//! Products of large block systems are better taken with [`crate::SymmetricBlocks`].

use crate::operator::LinearOperator;

/// A square sparse matrix, row by row, columns ascending in each row.
#[derive(Clone, Debug, PartialEq)]
pub struct Csr {
    /// Where each row starts in the two other arrays; one entry more than rows.
    pub row_start: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<f64>,
}

impl Csr {
    /// From rows of (column, value), which need not be sorted; repeated columns are summed in the order given.
    ///
    /// # Panics
    /// When a column index is not below the number of rows.
    pub fn from_rows(rows: &[Vec<(usize, f64)>]) -> Self {
        let mut csr = Self { row_start: vec![0], columns: Vec::new(), values: Vec::new() };
        for row in rows {
            let start = csr.columns.len();
            let mut sorted = row.clone();
            sorted.sort_by_key(|&(column, _)| column);
            for (column, value) in sorted {
                assert!(column < rows.len(), "column {column} of a matrix of {} rows", rows.len());
                if csr.columns.len() > start && csr.columns.last() == Some(&(column as u32)) {
                    *csr.values.last_mut().expect("a column was pushed together with its value") += value;
                } else {
                    csr.columns.push(column as u32);
                    csr.values.push(value);
                }
            }
            csr.row_start.push(csr.columns.len());
        }
        csr
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.row_start.len() - 1
    }

    /// The entries of a row as (column, value).
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.row_start[row]..self.row_start[row + 1];
        self.columns[range.clone()].iter().zip(&self.values[range]).map(|(&column, &value)| (column as usize, value))
    }

    /// An entry, zero where the pattern has none.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let range = self.row_start[row]..self.row_start[row + 1];
        match self.columns[range.clone()].binary_search(&(column as u32)) {
            Ok(offset) => self.values[range.start + offset],
            Err(_) => 0.0,
        }
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.row_count()).map(|i| self.get(i, i)).collect()
    }

    /// Replaces the rows and columns of the listed unknowns by those of the identity.
    ///
    /// The solution of A x = b with b zeroed there is then that of the projected system P A P x = P b.
    pub fn fix_unknowns(&mut self, fixed: &[usize]) {
        let mut is_fixed = vec![false; self.row_count()];
        for &index in fixed {
            is_fixed[index] = true;
        }
        for row in 0..self.row_count() {
            for slot in self.row_start[row]..self.row_start[row + 1] {
                let column = self.columns[slot] as usize;
                if is_fixed[row] || is_fixed[column] {
                    self.values[slot] = if row == column { 1.0 } else { 0.0 };
                }
            }
        }
    }
}

impl LinearOperator for Csr {
    fn len(&self) -> usize {
        self.row_count()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        for (row, y) in y.iter_mut().enumerate() {
            let mut sum = 0.0;
            for (column, value) in self.row(row) {
                sum += value * x[column];
            }
            *y = sum;
        }
    }
}
