//! Direct solvers: factor a sparse symmetric matrix once, then solve to rounding.
//!
//! Two implementations:
//!
//! | type | factor | for |
//! |---|---|---|
//! | [`SkylineLdlt`] | L D Lᵀ inside the profile of the matrix | small and slender systems; indefinite ones |
//! | `SupernodalCholesky` (cargo feature `direct`) | L Lᵀ on supernodes, by the `faer` library | large systems |
//!
//! Why the feature is off by default: `faer` takes minutes to compile and most runs use conjugate gradients.
//!
//! A projected system P A P x = P b, P zeroing fixed unknowns, is solved by replacing their rows and columns with those
//! of the identity ([`Csr::fix_unknowns`]) and their right-hand side with zero.

use crate::cg::{LinearReport, LinearStatus};
use crate::csr::Csr;
use crate::operator::LinearOperator;
use crate::ordering::reverse_cuthill_mckee;
use crate::vector::norm;

/// Something that factors a symmetric matrix and solves with the factors.
pub trait DirectSolver {
    /// Factors a matrix of the pattern that the solver was made for.
    ///
    /// # Errors
    /// [`DirectError`]; the solver must then not be asked to solve.
    fn factor(&mut self, matrix: &Csr) -> Result<(), DirectError>;

    /// Replaces the right-hand side in x by the solution.
    fn solve(&mut self, x: &mut [f64]);
}

/// Why a matrix could not be factored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DirectError {
    /// The matrix is singular to rounding.
    #[error("the matrix is singular: nothing holds unknown {unknown} (is a part free to move as a rigid body?)")]
    Singular {
        /// The unknown whose pivot vanished.
        unknown: usize,
    },
    /// The method needs a positive definite matrix and this one is not.
    #[error("the matrix is not positive definite: unknown {unknown} has a negative pivot")]
    NotPositiveDefinite {
        /// The unknown whose pivot is negative, in the order of elimination where the library does not say which.
        unknown: usize,
    },
    /// An entry is infinite or not a number.
    #[error("the matrix has an entry that is not finite in the row of unknown {unknown}")]
    NotFinite {
        /// The row.
        unknown: usize,
    },
    /// The matrix does not have the pattern that the solver was made for.
    #[error("the matrix has another pattern than the one that was analysed")]
    OtherPattern,
    /// The library gave up (out of memory, index overflow).
    #[error("the factorisation failed: {0}")]
    Library(String),
}

impl DirectError {
    /// The same in the words of linear reports.
    pub fn status(&self) -> LinearStatus {
        match *self {
            Self::Singular { unknown } | Self::NotPositiveDefinite { unknown } => LinearStatus::Singular { unknown },
            _ => LinearStatus::NotFinite,
        }
    }
}

/// Solves A x = b with the factors of A, refines while rounding left an error, and reports the true residual.
///
/// `residual` is scratch of the same length.
pub fn solve_directly(
    solver: &mut dyn DirectSolver,
    matrix: &dyn LinearOperator,
    rhs: &[f64],
    x: &mut [f64],
    residual: &mut [f64],
) -> LinearReport {
    const GOOD: f64 = 1e-10;
    const REFINEMENTS: usize = 3;
    let initial_residual = norm(rhs);
    let mut report = LinearReport::direct(initial_residual);
    x.copy_from_slice(rhs);
    solver.solve(x);
    for refinement in 0..=REFINEMENTS {
        matrix.apply(x, residual);
        for (r, b) in residual.iter_mut().zip(rhs) {
            *r = b - *r;
        }
        report.residual = norm(residual);
        report.iterations = refinement;
        if !report.residual.is_finite() {
            report.status = LinearStatus::NotFinite;
            return report;
        }
        if report.residual <= GOOD * initial_residual {
            return report;
        }
        if refinement < REFINEMENTS {
            solver.solve(residual);
            for (x, dx) in x.iter_mut().zip(&*residual) {
                *x += dx;
            }
        }
    }
    report.status = LinearStatus::MaxIterations;
    report
}

/// L D Lᵀ inside the profile of a symmetric matrix, in reverse Cuthill–McKee order.
///
/// ```text
/// row i of L:   0 … 0 | l_i,first … l_i,i−1 | 1        stored: the middle part, contiguous
/// g_j = a_ij − Σ_k g_k l_jk,   l_ij = g_j / d_j,   d_i = a_ii − Σ_j g_j l_ij
/// ```
///
/// Fill stays inside the profile, so every inner product runs over contiguous memory.
/// Works for indefinite matrices too, without pivoting: [`Self::negative_pivots`] then counts the negative eigenvalues
/// (Sylvester's law of inertia), and [`solve_directly`] repairs what growth of rounding may spoil.
///
/// Reference: A. Jennings, "A compact storage scheme for the solution of symmetric linear simultaneous equations", 1966.
#[derive(Clone, Debug)]
pub struct SkylineLdlt {
    /// order[new] = old, and its inverse.
    order: Vec<u32>,
    place: Vec<u32>,
    /// First stored column of each row, in new numbers.
    first: Vec<usize>,
    /// Where the stored part of each row starts in `values`.
    start: Vec<usize>,
    values: Vec<f64>,
    pivots: Vec<f64>,
    entry_count: usize,
    pattern_len: usize,
    scratch: Vec<f64>,
}

/// A pivot smaller than this share of the terms that it is the difference of is rounding.
const PIVOT_ROUNDING: f64 = 1e-13;

/// Rows that are factored together.
const GROUP: usize = 8;

impl SkylineLdlt {
    /// Orders the unknowns of a symmetric pattern and finds its profile. Values are not read.
    pub fn analyse(matrix: &Csr) -> Self {
        let n = matrix.row_count();
        let order = reverse_cuthill_mckee(matrix);
        let mut place = vec![0u32; n];
        for (new, &old) in order.iter().enumerate() {
            place[old as usize] = new as u32;
        }
        let mut first = Vec::with_capacity(n);
        let mut start = Vec::with_capacity(n + 1);
        start.push(0);
        for (new, &old) in order.iter().enumerate() {
            let lowest = matrix.row(old as usize).map(|(column, _)| place[column] as usize).min().unwrap_or(new);
            first.push(lowest.min(new));
            start.push(start[new] + new - first[new]);
        }
        Self {
            order,
            place,
            first,
            entry_count: start[n],
            start,
            values: Vec::new(),
            pivots: vec![0.0; n],
            pattern_len: matrix.columns.len(),
            scratch: vec![0.0; n],
        }
    }

    /// Entries that the factor will hold; 8 bytes each. To decide whether factoring is worth it.
    pub fn entry_count(&self) -> usize {
        self.entry_count
    }

    /// Number of negative pivots of the last factorisation: that of negative eigenvalues of the matrix.
    pub fn negative_pivots(&self) -> usize {
        self.pivots.iter().filter(|&&pivot| pivot < 0.0).count()
    }
}

impl SkylineLdlt {
    /// Copies the lower part of a row of the matrix; its diagonal goes to the pivots.
    fn load_row(&mut self, matrix: &Csr, i: usize) -> Result<(), DirectError> {
        let first = self.first[i];
        let row = &mut self.values[self.start[i]..self.start[i + 1]];
        self.pivots[i] = 0.0;
        for (column, value) in matrix.row(self.order[i] as usize) {
            let j = self.place[column] as usize;
            if j < first {
                return Err(DirectError::OtherPattern);
            } else if j < i {
                row[j - first] = value;
            } else if j == i {
                self.pivots[i] = value;
            }
        }
        Ok(())
    }

    /// g_j ← a_ij − Σ_k g_k l_jk, once all g_k before it are there. Nothing to do left of the profile.
    fn eliminate(&mut self, i: usize, j: usize) {
        let first = self.first[i];
        if j < first {
            return;
        }
        let low = first.max(self.first[j]);
        let (above, rest) = self.values.split_at_mut(self.start[i]);
        let l = &above[self.start[j] + low - self.first[j]..self.start[j] + j - self.first[j]];
        rest[j - first] -= contiguous_dot(&rest[low - first..j - first], l);
    }

    /// l_ij = g_j / d_j and the pivot of the row.
    fn finish_row(&mut self, i: usize) -> Result<(), DirectError> {
        let unknown = self.order[i] as usize;
        let diagonal = self.pivots[i];
        let (mut pivot, mut terms) = (diagonal, diagonal.abs());
        let row = &mut self.values[self.start[i]..self.start[i + 1]];
        for (g, d) in row.iter_mut().zip(&self.pivots[self.first[i]..i]) {
            let l = *g / d;
            pivot -= *g * l;
            terms += (*g * l).abs();
            *g = l;
        }
        if !terms.is_finite() {
            return Err(DirectError::NotFinite { unknown });
        }
        if pivot.abs() <= PIVOT_ROUNDING * terms {
            return Err(DirectError::Singular { unknown });
        }
        self.pivots[i] = pivot;
        Ok(())
    }
}

impl DirectSolver for SkylineLdlt {
    fn factor(&mut self, matrix: &Csr) -> Result<(), DirectError> {
        let n = self.order.len();
        if matrix.row_count() != n || matrix.columns.len() != self.pattern_len {
            return Err(DirectError::OtherPattern);
        }
        self.values.clear();
        self.values.resize(self.entry_count, 0.0);
        for begin in (0..n).step_by(GROUP) {
            let end = (begin + GROUP).min(n);
            for i in begin..end {
                self.load_row(matrix, i)?;
            }
            // A row above serves the whole group while it is in the cache nearest to the processor.
            let lowest = self.first[begin..end].iter().copied().min().unwrap_or(begin);
            for j in lowest..begin {
                for i in begin..end {
                    self.eliminate(i, j);
                }
            }
            for i in begin..end {
                for j in begin..i {
                    self.eliminate(i, j);
                }
                self.finish_row(i)?;
            }
        }
        Ok(())
    }

    fn solve(&mut self, x: &mut [f64]) {
        let n = self.order.len();
        let y = &mut self.scratch;
        for (y, &old) in y.iter_mut().zip(&self.order) {
            *y = x[old as usize];
        }
        for i in 0..n {
            y[i] -= contiguous_dot(&self.values[self.start[i]..self.start[i + 1]], &y[self.first[i]..i]);
        }
        for (y, pivot) in y.iter_mut().zip(&self.pivots) {
            *y /= pivot;
        }
        for i in (0..n).rev() {
            let value = y[i];
            let row = &self.values[self.start[i]..self.start[i + 1]];
            for (y, l) in y[self.first[i]..i].iter_mut().zip(row) {
                *y -= l * value;
            }
        }
        for (&y, &old) in y.iter().zip(&self.order) {
            x[old as usize] = y;
        }
    }
}

/// A dot product on eight lanes. Not [`crate::vector::block_dot`], whose length is bounded: rows are longer.
fn contiguous_dot(x: &[f64], y: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (x_wide, x_rest) = x.as_chunks::<8>();
    let (y_wide, y_rest) = y.as_chunks::<8>();
    for (x, y) in x_wide.iter().zip(y_wide) {
        for lane in 0..8 {
            lanes[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(x, y)| x * y).sum();
    lanes.iter().sum::<f64>() + rest
}
