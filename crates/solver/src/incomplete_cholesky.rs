//! Incomplete Cholesky factorisation without fill, as a preconditioner.
//!
//! Finds a lower triangular L with the pattern of the lower triangle of A such that (L Lᵀ)_ij = A_ij wherever A has an
//! entry. Dropping fill can make a pivot negative even when A is positive definite; then A + σ diag(A) is factored
//! instead, with σ growing until it succeeds, and σ is reported.
//!
//! References: J. A. Meijerink and H. A. van der Vorst, "An iterative solution method for linear systems of which the
//! coefficient matrix is a symmetric M-matrix", 1977; T. A. Manteuffel, "An incomplete factorization technique for
//! positive definite linear systems", 1980, for the shift.

use crate::csr::Csr;
use crate::operator::{Preconditioner, positive_reciprocal};

/// First shift that is tried when the plain factorisation fails; each next one is four times larger.
const FIRST_SHIFT: f64 = 1e-3;
/// Number of shifts that are tried: the last one makes the diagonal dominate any matrix worth solving.
const SHIFT_COUNT: u32 = 12;

/// Why no factor could be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IncompleteCholeskyError {
    /// The pattern lacks a diagonal entry.
    #[error("row {row} has no diagonal entry; every row of the pattern needs one")]
    NoDiagonal {
        /// The row.
        row: usize,
    },
    /// No shift helped: an entry is not finite, or the diagonal is far from positive.
    #[error("row {row} has no positive pivot even with a diagonal shift of {shift}")]
    NotFactorable {
        /// The first row that failed with the last shift.
        row: usize,
        /// The last shift.
        shift: f64,
    },
}

/// An incomplete Cholesky factor with the pattern of a symmetric matrix.
#[derive(Clone, Debug)]
pub struct IncompleteCholesky {
    row_start: Vec<usize>,
    /// Columns of the lower triangle; the diagonal is the last of its row.
    columns: Vec<u32>,
    values: Vec<f64>,
    shift: f64,
    /// Position of each column in the row being factored, or `ABSENT`.
    position: Vec<usize>,
}

const ABSENT: usize = usize::MAX;

impl IncompleteCholesky {
    /// Factors a symmetric matrix, of which only the lower triangle is read.
    ///
    /// # Errors
    /// [`IncompleteCholeskyError`] when the pattern lacks a diagonal entry or no shift gives positive pivots.
    pub fn new(matrix: &Csr) -> Result<Self, IncompleteCholeskyError> {
        let rows = matrix.row_count();
        let mut row_start = Vec::with_capacity(rows + 1);
        let mut columns = Vec::new();
        row_start.push(0);
        for row in 0..rows {
            columns.extend(matrix.row(row).map(|(column, _)| column as u32).filter(|&column| column as usize <= row));
            if columns.last() != Some(&(row as u32)) || columns.len() == row_start[row] {
                return Err(IncompleteCholeskyError::NoDiagonal { row });
            }
            row_start.push(columns.len());
        }
        let values = vec![0.0; columns.len()];
        let mut factor = Self { row_start, columns, values, shift: 0.0, position: vec![ABSENT; rows] };
        factor.update(matrix)?;
        Ok(factor)
    }

    /// Factors a matrix of the same pattern with new values, without allocating.
    ///
    /// # Errors
    /// [`IncompleteCholeskyError::NotFactorable`]; the factor must then not be used.
    pub fn update(&mut self, matrix: &Csr) -> Result<(), IncompleteCholeskyError> {
        self.shift = 0.0;
        let mut next = FIRST_SHIFT;
        for attempt in 0..=SHIFT_COUNT {
            self.load(matrix);
            match self.factor() {
                Ok(()) => return Ok(()),
                Err(row) if attempt == SHIFT_COUNT => {
                    return Err(IncompleteCholeskyError::NotFactorable { row, shift: self.shift });
                }
                Err(_) => {
                    self.shift = next;
                    next *= 4.0;
                }
            }
        }
        unreachable!("the last attempt returns")
    }

    /// The shift σ of the matrix A + σ diag(A) that was factored; zero when A itself was.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Copies the lower triangle, with the diagonal shifted.
    fn load(&mut self, matrix: &Csr) {
        for row in 0..self.row_start.len() - 1 {
            let lower = self.row_start[row]..self.row_start[row + 1];
            let start = matrix.row_start[row];
            let count = lower.len();
            self.values[lower.clone()].copy_from_slice(&matrix.values[start..start + count]);
            let diagonal = &mut self.values[lower.end - 1];
            // A diagonal that is not positive cannot be helped by a multiple of itself.
            let scale = if *diagonal > 0.0 { *diagonal } else { 1.0 / positive_reciprocal(*diagonal) };
            *diagonal += self.shift * scale;
        }
    }

    /// Row by row: l_ik = (a_ik − Σ_{j<k} l_ij l_kj) / l_kk over the pattern, l_ii = √(a_ii − Σ l_ij²).
    fn factor(&mut self) -> Result<(), usize> {
        for row in 0..self.row_start.len() - 1 {
            let (start, diagonal) = (self.row_start[row], self.row_start[row + 1] - 1);
            for slot in start..diagonal {
                self.position[self.columns[slot] as usize] = slot;
            }
            let mut pivot = self.values[diagonal];
            for slot in start..diagonal {
                let k = self.columns[slot] as usize;
                let (k_start, k_diagonal) = (self.row_start[k], self.row_start[k + 1] - 1);
                let mut entry = self.values[slot];
                for other in k_start..k_diagonal {
                    let position = self.position[self.columns[other] as usize];
                    if position != ABSENT {
                        entry -= self.values[position] * self.values[other];
                    }
                }
                entry /= self.values[k_diagonal];
                self.values[slot] = entry;
                pivot -= entry * entry;
            }
            for slot in start..diagonal {
                self.position[self.columns[slot] as usize] = ABSENT;
            }
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(row);
            }
            self.values[diagonal] = pivot.sqrt();
        }
        Ok(())
    }
}

impl Preconditioner for IncompleteCholesky {
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        z.copy_from_slice(r);
        let rows = self.row_start.len() - 1;
        for row in 0..rows {
            let (start, diagonal) = (self.row_start[row], self.row_start[row + 1] - 1);
            let mut sum = z[row];
            for slot in start..diagonal {
                sum -= self.values[slot] * z[self.columns[slot] as usize];
            }
            z[row] = sum / self.values[diagonal];
        }
        for row in (0..rows).rev() {
            let (start, diagonal) = (self.row_start[row], self.row_start[row + 1] - 1);
            let value = z[row] / self.values[diagonal];
            z[row] = value;
            for slot in start..diagonal {
                z[self.columns[slot] as usize] -= self.values[slot] * value;
            }
        }
    }
}
