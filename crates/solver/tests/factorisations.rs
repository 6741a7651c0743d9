//! Promises of the stored matrices and their factors: block products are dense products, incomplete factors are what
//! they say, direct solves are exact to rounding or refused.

use proptest::prelude::*;
use souple_solver::{
    CgOptions, CgWorkspace, Csr, DirectError, DirectSolver, FixedUnknowns, Identity, IncompleteCholesky,
    IncompleteCholeskyError, LinearOperator, LinearStatus, NoProjection, PatternError, Preconditioner, Projector,
    Serial, Shift, SkylineLdlt, SymmetricBlocks, cg, solve_directly,
};

/// A symmetric positive definite block matrix: the coupling graph of a w × h grid with diagonals, blocks of b × b.
fn grid(b: usize, w: usize, h: usize) -> SymmetricBlocks {
    let groups: Vec<Vec<u32>> = (0..h - 1)
        .flat_map(|j| (0..w - 1).map(move |i| vec![j * w + i, j * w + i + 1, (j + 1) * w + i, (j + 1) * w + i + 1]))
        .map(|group| group.into_iter().map(|node| node as u32).collect())
        .collect();
    let mut matrix =
        SymmetricBlocks::from_groups(b, w * h, groups.iter().map(Vec::as_slice)).expect("groups name rows of the grid");
    // Each group adds G Gᵀ of pseudo-random columns: symmetric and positive semidefinite, as assembled matrices are.
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    for group in &groups {
        let g: Vec<f64> = (0..4 * b * 3).map(|_| random()).collect();
        for (i, &row) in group.iter().enumerate() {
            for (j, &column) in group.iter().enumerate() {
                let block: Vec<f64> = (0..b * b)
                    .map(|e| (0..3).map(|k| g[(i * b + e / b) * 3 + k] * g[(j * b + e % b) * 3 + k]).sum())
                    .collect();
                if row <= column {
                    matrix.add_block(row as usize, column as usize, &block);
                }
            }
        }
    }
    for row in 0..w * h {
        let identity: Vec<f64> = (0..b * b).map(|e| if e / b == e % b { 0.2 } else { 0.0 }).collect();
        matrix.add_block(row, row, &identity);
    }
    matrix
}

fn ramp(n: usize) -> Vec<f64> {
    (0..n).map(|i| (i as f64 * 0.7).sin() + 0.1).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The whole matrix as rows of numbers.
fn dense(matrix: &SymmetricBlocks) -> Vec<Vec<f64>> {
    let (b, n) = (matrix.block(), matrix.len());
    let mut dense = vec![vec![0.0; n]; n];
    for row in 0..matrix.row_count() {
        for slot in matrix.row_slots(row) {
            let column = matrix.columns()[slot] as usize;
            for i in 0..b {
                for j in 0..b {
                    let value = matrix.values()[(slot * b + i) * b + j];
                    dense[row * b + i][column * b + j] = value;
                    dense[column * b + j][row * b + i] = value;
                }
            }
        }
    }
    dense
}

/// For every block size the block product and the product of the single entries agree with the dense one, shifted or not.
#[test]
fn block_products_are_dense_products() {
    for b in 1..=7 {
        let matrix = grid(b, 5, 4);
        let n = matrix.len();
        let x = ramp(n);
        let rows = dense(&matrix);
        let expected: Vec<f64> = rows.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        let mut product = vec![f64::NAN; n];
        matrix.apply(&x, &mut product);
        assert!(largest_difference(&product, &expected) < 1e-13, "block size {b}");

        let diagonal: Vec<f64> = x.iter().map(|x| 2.0 + x).collect();
        let mut buffers = matrix.product_buffers();
        matrix.load(&x, &mut buffers);
        matrix.run_part_in_place(None, 0, &mut buffers);
        let shift = Shift { k: 0.3, m: 1.7, diagonal: &diagonal };
        matrix.finish_rows(0..matrix.row_count(), Some(shift), &x, &buffers, &mut product);
        let shifted: Vec<f64> = (0..n).map(|k| 0.3 * expected[k] + 1.7 * diagonal[k] * x[k]).collect();
        assert!(largest_difference(&product, &shifted) < 1e-13, "block size {b}");

        let csr = matrix.to_csr();
        csr.apply(&x, &mut product);
        assert!(largest_difference(&product, &expected) < 1e-13, "block size {b}");
        let mut blocks = vec![0.0; n * b];
        matrix.diagonal_blocks(&mut blocks);
        for row in 0..n {
            assert_eq!(csr.get(row, row), blocks[row * b + row % b]);
            for column in 0..n {
                assert_eq!(csr.get(row, column), rows[row][column], "block size {b}: {row}, {column}");
            }
        }
    }
}

/// A matrix of several parts gives the same bits whatever order its parts run in, and whatever ranges its rows are
/// finished in; and they are the dense product.
#[test]
fn parts_in_any_order_give_the_same_bits() {
    for (b, w, h) in [(1, 40, 300), (2, 30, 230), (3, 20, 310)] {
        let matrix = grid(b, w, h);
        let parts = matrix.parts().len();
        assert!(parts > 2, "{parts} parts of {} rows show nothing", matrix.row_count());
        let x = ramp(matrix.len());
        let mut product = vec![f64::NAN; matrix.len()];
        matrix.apply(&x, &mut product);
        let mut expected = vec![0.0; matrix.len()];
        matrix.to_csr().apply(&x, &mut expected);
        assert!(largest_difference(&product, &expected) < 1e-12, "block size {b}");

        let mut buffers = matrix.product_buffers();
        matrix.load(&x, &mut buffers);
        let (loaded, mut tasks) = matrix.tasks(&mut buffers);
        tasks.iter_mut().rev().for_each(|(part, sums)| matrix.run_part(*part, loaded, sums));
        let mut again = vec![f64::NAN; matrix.len()];
        for (first, y) in again.chunks_mut(97 * b).enumerate() {
            matrix.finish_rows(97 * first..97 * first + y.len() / b, None, &x, &buffers, y);
        }
        assert_eq!(product, again, "block size {b}");
    }
}

/// Products with values in single precision differ from the others by the rounding of the values.
#[test]
fn single_precision_rounds_values_only() {
    let matrix = grid(3, 6, 5);
    let x = ramp(matrix.len());
    let mut singles = Vec::new();
    matrix.write_single_values(&mut singles);
    let mut rounded = matrix.clone();
    rounded.values_mut().iter_mut().for_each(|value| *value = f64::from(*value as f32));
    let (mut y, mut expected) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    rounded.apply(&x, &mut expected);
    let mut buffers = matrix.product_buffers();
    matrix.load(&x, &mut buffers);
    matrix.run_part_in_place(Some(&singles), 0, &mut buffers);
    matrix.finish_rows(0..matrix.row_count(), None, &x, &buffers, &mut y);
    assert_eq!(y, expected);
}

/// Patterns that are not sorted rows of existing columns are refused by name.
#[test]
fn bad_patterns_are_refused() {
    assert_eq!(SymmetricBlocks::from_pattern(0, &[]), Err(PatternError::EmptyBlock));
    assert_eq!(SymmetricBlocks::from_pattern(3, &[vec![0], vec![0, 1]]), Err(PatternError::Unsorted { row: 1 }));
    assert_eq!(SymmetricBlocks::from_pattern(3, &[vec![0, 0]]), Err(PatternError::Unsorted { row: 0 }));
    let out_of_range = PatternError::ColumnOutOfRange { row: 0, column: 4, rows: 2 };
    assert_eq!(SymmetricBlocks::from_pattern(3, &[vec![0, 4], vec![1]]), Err(out_of_range));
    assert!(SymmetricBlocks::from_groups(3, 2, [[0u32, 5].as_slice()]).is_err());
}

/// Without fill there is nothing to drop in a tridiagonal matrix: the incomplete factor is the factor.
#[test]
fn incomplete_cholesky_of_a_tridiagonal_matrix_is_exact() {
    let n = 50;
    let rows: Vec<Vec<(usize, f64)>> = (0..n)
        .map(|i| {
            let mut row = vec![(i, 2.5 + 0.01 * i as f64)];
            if i > 0 {
                row.push((i - 1, -1.0));
            }
            if i + 1 < n {
                row.push((i + 1, -1.0));
            }
            row
        })
        .collect();
    let matrix = Csr::from_rows(&rows);
    let factor = IncompleteCholesky::new(&matrix).expect("diagonally dominant");
    assert_eq!(factor.shift(), 0.0);
    let expected = ramp(n);
    let (mut b, mut x) = (vec![0.0; n], vec![0.0; n]);
    matrix.apply(&expected, &mut b);
    factor.apply(&b, &mut x);
    assert!(largest_difference(&x, &expected) < 1e-13);
}

/// On a grid, where fill is dropped, the incomplete factor saves iterations against no preconditioner, and a refilled
/// factor equals a new one.
#[test]
fn incomplete_cholesky_saves_iterations() {
    let matrix = grid(3, 12, 12).to_csr();
    let n = matrix.row_count();
    let b = ramp(n);
    let mut factor = IncompleteCholesky::new(&matrix).expect("positive definite");
    let iterations = |preconditioner: &dyn Preconditioner| {
        let mut x = vec![0.0; n];
        let report = cg(
            &matrix,
            preconditioner,
            &NoProjection,
            &Serial,
            &b,
            &mut x,
            &CgOptions::default(),
            &mut CgWorkspace::new(n),
        );
        assert!(report.converged());
        report.iterations
    };
    let (without, with) = (iterations(&Identity), iterations(&factor));
    assert!(2 * with < without, "{with} iterations with, {without} without");

    let (mut fresh, mut refilled) = (vec![0.0; n], vec![0.0; n]);
    factor.apply(&b, &mut fresh);
    factor.update(&matrix).expect("the same matrix");
    factor.apply(&b, &mut refilled);
    assert_eq!(fresh, refilled);
}

/// A matrix without an incomplete factor gets a shift that is reported; one without a diagonal, or with a NaN, is
/// refused.
#[test]
fn incomplete_cholesky_shifts_or_refuses() {
    // Positive definite, but dropping the fill of this pattern makes a pivot negative (Kershaw's example).
    let rows = [
        vec![(0, 3.0), (1, -2.0), (3, 2.0)],
        vec![(0, -2.0), (1, 3.0), (2, -2.0)],
        vec![(1, -2.0), (2, 3.0), (3, -2.0)],
        vec![(0, 2.0), (2, -2.0), (3, 3.0)],
    ];
    let factor = IncompleteCholesky::new(&Csr::from_rows(&rows)).expect("a shift helps");
    assert!(factor.shift() > 0.0);
    let mut z = vec![0.0; 4];
    let r = [1.0, -0.3, 0.2, 0.9];
    factor.apply(&r, &mut z);
    assert!(r.iter().zip(&z).map(|(r, z)| r * z).sum::<f64>() > 0.0, "the factor must stay positive definite");

    let hollow = Csr::from_rows(&[vec![(1, 1.0)], vec![(0, 1.0), (1, 1.0)]]);
    assert_eq!(IncompleteCholesky::new(&hollow).err(), Some(IncompleteCholeskyError::NoDiagonal { row: 0 }));
    let poisoned = Csr::from_rows(&[vec![(0, f64::NAN)]]);
    assert!(matches!(IncompleteCholesky::new(&poisoned), Err(IncompleteCholeskyError::NotFactorable { row: 0, .. })));
}

/// The direct solvers that this build has, made for a matrix.
fn direct_solvers(matrix: &Csr) -> Vec<Box<dyn DirectSolver>> {
    #[allow(unused_mut, reason = "grows with the feature `direct`")]
    let mut solvers: Vec<Box<dyn DirectSolver>> = vec![Box::new(SkylineLdlt::analyse(matrix))];
    #[cfg(feature = "direct")]
    solvers.push(Box::new(souple_solver::SupernodalCholesky::analyse(matrix).expect("memory suffices")));
    solvers
}

/// Direct solves leave a residual of rounding, on a grid and on a graph of several components.
#[test]
fn direct_solves_are_exact() {
    let mut scattered = grid(2, 6, 5).to_csr();
    // Cut the grid: rows that belong to every third node keep only their own block.
    for row in 0..scattered.row_count() {
        for slot in scattered.row_start[row]..scattered.row_start[row + 1] {
            let column = scattered.columns[slot] as usize;
            if row / 2 != column / 2 && ((row / 2).is_multiple_of(3) || (column / 2).is_multiple_of(3)) {
                scattered.values[slot] = 0.0;
            }
        }
    }
    for matrix in [grid(3, 9, 7).to_csr(), scattered, Csr::from_rows(&[])] {
        let n = matrix.row_count();
        let expected = ramp(n);
        let (mut b, mut x, mut scratch) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        matrix.apply(&expected, &mut b);
        for solver in &mut direct_solvers(&matrix) {
            solver.factor(&matrix).expect("positive definite");
            let report = solve_directly(solver.as_mut(), &matrix, &b, &mut x, &mut scratch);
            assert!(report.converged() && report.iterations == 0, "{report:?}");
            assert!(largest_difference(&x, &expected) < 1e-11);
        }
    }
}

/// With the rows and columns of fixed unknowns replaced by identity, the direct solution is that of the projected
/// conjugate gradient.
#[test]
fn direct_solves_of_projected_systems() {
    let matrix = grid(3, 7, 6).to_csr();
    let n = matrix.row_count();
    let fixed = FixedUnknowns { indices: (0..21).chain([40, 77]).collect() };
    let mut b = ramp(n);
    let mut by_cg = vec![0.0; n];
    let options = CgOptions { relative_tolerance: 1e-13, ..CgOptions::default() };
    cg(&matrix, &Identity, &fixed, &Serial, &b, &mut by_cg, &options, &mut CgWorkspace::new(n));

    let mut held = matrix.clone();
    held.fix_unknowns(&fixed.indices);
    fixed.project(&mut b);
    for solver in &mut direct_solvers(&held) {
        let (mut x, mut scratch) = (vec![0.0; n], vec![0.0; n]);
        solver.factor(&held).expect("positive definite");
        let report = solve_directly(solver.as_mut(), &held, &b, &mut x, &mut scratch);
        assert!(report.converged(), "{report:?}");
        assert!(largest_difference(&x, &by_cg) < 1e-10);
        assert!(fixed.indices.iter().all(|&index| x[index] == 0.0));
    }
}

/// Singular matrices, matrices with a NaN and matrices of another pattern are refused by name.
#[test]
fn bad_matrices_are_refused() {
    // A free chain: nothing holds it.
    let free =
        Csr::from_rows(&[vec![(0, 1.0), (1, -1.0)], vec![(0, -1.0), (1, 2.0), (2, -1.0)], vec![(1, -1.0), (2, 1.0)]]);
    assert!(matches!(SkylineLdlt::analyse(&free).factor(&free), Err(DirectError::Singular { .. })));
    let other = Csr::from_rows(&[vec![(0, 1.0)], vec![(1, 1.0)]]);
    for solver in &mut direct_solvers(&free) {
        assert_eq!(solver.factor(&other), Err(DirectError::OtherPattern));
        let mut poisoned = free.clone();
        poisoned.values[3] = f64::NAN;
        let error = solver.factor(&poisoned).expect_err("a NaN");
        assert_eq!(error, DirectError::NotFinite { unknown: 1 });
        assert_eq!(error.status(), LinearStatus::NotFinite);
    }
}

/// The method that needs a positive definite matrix says so of one that is not.
#[cfg(feature = "direct")]
#[test]
fn indefinite_matrices_are_refused_by_cholesky() {
    let matrix = Csr::from_rows(&[vec![(0, 1.0), (1, 2.0)], vec![(0, 2.0), (1, 1.0)]]);
    let mut solver = souple_solver::SupernodalCholesky::analyse(&matrix).expect("memory suffices");
    assert!(matches!(solver.factor(&matrix), Err(DirectError::NotPositiveDefinite { .. })));
}

proptest! {
    /// The number of negative pivots is the number of negative eigenvalues: A = L D Lᵀ with a chosen D, any signs.
    #[test]
    fn inertia_is_counted(
        entries in proptest::collection::vec(-1.0..1.0f64, 8 * 8),
        signs in proptest::collection::vec(proptest::bool::ANY, 8),
    ) {
        let n = 8;
        let l = |i: usize, j: usize| if i == j { 1.0 } else if i > j { entries[i * n + j] } else { 0.0 };
        let rows: Vec<Vec<(usize, f64)>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| (j, (0..n).map(|k| l(i, k) * l(j, k) * if signs[k] { 1.0 } else { -1.0 }).sum()))
                    .collect()
            })
            .collect();
        let matrix = Csr::from_rows(&rows);
        let mut solver = SkylineLdlt::analyse(&matrix);
        // Without pivoting an indefinite matrix may meet a zero pivot; that is refused, not miscounted.
        if solver.factor(&matrix).is_ok() {
            prop_assert_eq!(solver.negative_pivots(), signs.iter().filter(|&&positive| !positive).count());
            let expected = ramp(n);
            let (mut b, mut x, mut scratch) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            matrix.apply(&expected, &mut b);
            let report = solve_directly(&mut solver, &matrix, &b, &mut x, &mut scratch);
            prop_assert!(report.converged(), "{report:?}");
        }
    }
}

/// The ordering of a slender grid keeps the profile near the width of its short side, whatever the numbering.
#[test]
fn slender_grids_have_small_profiles() {
    let (w, h) = (60, 3);
    let matrix = grid(1, w, h).to_csr();
    let entries = SkylineLdlt::analyse(&matrix).entry_count();
    assert!(entries <= w * h * 2 * (h + 1), "{entries} entries for {} unknowns", w * h);
}
