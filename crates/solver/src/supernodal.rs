//! Sparse Cholesky on supernodes, by the `faer` library: for large positive definite systems.
//!
//! Only compiled with the cargo feature `direct`.
//! Everything runs on the calling thread, so results do not depend on the machine's number of cores.

use crate::csr::Csr;
use crate::direct::{DirectError, DirectSolver};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{MatMut, Side};

/// L Lᵀ of a positive definite matrix in a fill-reducing order.
#[derive(Clone, Debug)]
pub struct SupernodalCholesky {
    row_start: Vec<usize>,
    columns: Vec<usize>,
    symbolic: SymbolicLlt<usize>,
    numeric: Option<Llt<usize, f64>>,
}

impl SupernodalCholesky {
    /// Orders the unknowns of a symmetric pattern. Values are not read.
    ///
    /// # Errors
    /// [`DirectError::Library`] when memory runs out.
    pub fn analyse(matrix: &Csr) -> Result<Self, DirectError> {
        let n = matrix.row_count();
        let row_start = matrix.row_start.clone();
        let columns: Vec<usize> = matrix.columns.iter().map(|&column| column as usize).collect();
        // Rows of a symmetric matrix are its columns.
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &row_start, None, &columns);
        let symbolic =
            SymbolicLlt::try_new(pattern, Side::Lower).map_err(|error| DirectError::Library(format!("{error:?}")))?;
        Ok(Self { row_start, columns, symbolic, numeric: None })
    }
}

impl DirectSolver for SupernodalCholesky {
    fn factor(&mut self, matrix: &Csr) -> Result<(), DirectError> {
        if matrix.row_start != self.row_start || matrix.values.len() != self.columns.len() {
            return Err(DirectError::OtherPattern);
        }
        if let Some(slot) = matrix.values.iter().position(|value| !value.is_finite()) {
            let unknown = self.row_start.partition_point(|&start| start <= slot) - 1;
            return Err(DirectError::NotFinite { unknown });
        }
        let n = matrix.row_count();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.row_start, None, &self.columns);
        let values = SparseColMatRef::new(pattern, &matrix.values);
        self.numeric = None;
        match Llt::try_new_with_symbolic(self.symbolic.clone(), values, Side::Lower) {
            Ok(numeric) => {
                self.numeric = Some(numeric);
                Ok(())
            }
            Err(LltError::Numeric(faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index })) => {
                Err(DirectError::NotPositiveDefinite { unknown: index })
            }
            Err(LltError::Generic(error)) => Err(DirectError::Library(format!("{error:?}"))),
        }
    }

    fn solve(&mut self, x: &mut [f64]) {
        let numeric = self.numeric.as_ref().expect("solving comes after a successful factorisation");
        let n = x.len();
        numeric.solve_in_place(MatMut::from_column_major_slice_mut(x, n, 1));
    }
}
