//! Promises of the conjugate gradient: the right answer on what is positive definite, projections that are exact, and a
//! word on everything else instead of a wrong number.

use proptest::prelude::*;
use souple_solver::{
    BlockJacobi, CgOptions, CgWorkspace, Csr, FixedUnknowns, Identity, IncompleteCholesky, Jacobi, LinearOperator,
    LinearStatus, NoProjection, OperatorFromFn, Preconditioner, Projector, Serial, cg, small_dense,
};

fn dense_operator(n: usize, a: &[f64]) -> OperatorFromFn<impl Fn(&[f64], &mut [f64])> {
    OperatorFromFn {
        len: n,
        product: move |x: &[f64], y: &mut [f64]| {
            for i in 0..n {
                y[i] = (0..n).map(|j| a[i * n + j] * x[j]).sum();
            }
        },
    }
}

/// G Gᵀ + I from any square G.
fn positive_definite(n: usize, g: &[f64]) -> Vec<f64> {
    let mut a = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            a[i * n + j] = (0..n).map(|k| g[i * n + k] * g[j * n + k]).sum();
        }
        a[i * n + i] += 1.0;
    }
    a
}

fn dense_solve(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let (mut factor, mut x) = (a.to_vec(), b.to_vec());
    small_dense::cholesky(n, &mut factor).expect("the matrix is positive definite");
    small_dense::cholesky_solve(n, &factor, &mut x);
    x
}

fn diagonal_blocks(n: usize, b: usize, a: &[f64]) -> Vec<f64> {
    let mut blocks = Vec::new();
    for k in 0..n / b {
        for i in 0..b {
            for j in 0..b {
                blocks.push(a[(k * b + i) * n + k * b + j]);
            }
        }
    }
    blocks
}

fn full_csr(n: usize, a: &[f64]) -> Csr {
    let rows: Vec<Vec<(usize, f64)>> = (0..n).map(|i| (0..n).map(|j| (j, a[i * n + j])).collect()).collect();
    Csr::from_rows(&rows)
}

const TIGHT: CgOptions = CgOptions { relative_tolerance: 1e-12, absolute_tolerance: 0.0, max_iterations: 500 };

proptest! {
    /// On random symmetric positive definite matrices every preconditioner leads to the dense solution, from any start.
    #[test]
    fn agrees_with_a_dense_solve(
        g in proptest::collection::vec(-1.0..1.0f64, 12 * 12),
        b in proptest::collection::vec(-1.0..1.0f64, 12),
        start in proptest::collection::vec(-1.0..1.0f64, 12),
    ) {
        let n = 12;
        let a = positive_definite(n, &g);
        let expected = dense_solve(n, &a, &b);
        let diagonal: Vec<f64> = (0..n).map(|i| a[i * n + i]).collect();
        let preconditioners: [Box<dyn Preconditioner>; 4] = [
            Box::new(Identity),
            Box::new(Jacobi::new(&diagonal)),
            Box::new(BlockJacobi::new(3, &diagonal_blocks(n, 3, &a))),
            Box::new(IncompleteCholesky::new(&full_csr(n, &a)).expect("positive definite")),
        ];
        for (kind, preconditioner) in preconditioners.iter().enumerate() {
            for start in [vec![0.0; n], start.clone()] {
                let mut x = start;
                let operator = dense_operator(n, &a);
                let report =
                    cg(&operator, preconditioner.as_ref(), &NoProjection, &Serial, &b, &mut x, &TIGHT, &mut CgWorkspace::new(n));
                prop_assert!(report.converged(), "preconditioner {kind}: {report:?}");
                for (x, expected) in x.iter().zip(&expected) {
                    prop_assert!((x - expected).abs() < 1e-9, "preconditioner {kind}: {x} is not {expected}");
                }
            }
        }
    }

    /// Fixed unknowns keep the value that they came in with to the last bit, and the others satisfy their own equations
    /// with these values as data.
    #[test]
    fn fixed_unknowns_are_exact(
        g in proptest::collection::vec(-1.0..1.0f64, 9 * 9),
        b in proptest::collection::vec(-1.0..1.0f64, 9),
        known in proptest::collection::vec(-1.0..1.0f64, 3),
    ) {
        let n = 9;
        let a = positive_definite(n, &g);
        let fixed = FixedUnknowns { indices: vec![1, 4, 7] };
        let mut x = vec![0.0; n];
        for (&index, &value) in fixed.indices.iter().zip(&known) {
            x[index] = value;
        }
        let operator = dense_operator(n, &a);
        let diagonal: Vec<f64> = (0..n).map(|i| a[i * n + i]).collect();
        let report =
            cg(&operator, &Jacobi::new(&diagonal), &fixed, &Serial, &b, &mut x, &TIGHT, &mut CgWorkspace::new(n));
        prop_assert!(report.converged(), "{report:?}");
        for (&index, &value) in fixed.indices.iter().zip(&known) {
            prop_assert_eq!(x[index].to_bits(), value.to_bits());
        }
        let mut product = vec![0.0; n];
        operator.apply(&x, &mut product);
        for i in (0..n).filter(|i| !fixed.indices.contains(i)) {
            prop_assert!((product[i] - b[i]).abs() < 1e-9, "equation {i}: {} is not {}", product[i], b[i]);
        }
    }
}

/// A projection that is not along axes (a sliding plane) is satisfied to rounding at every size of the right-hand side.
#[test]
fn oblique_projections_hold() {
    struct Plane([f64; 3]);
    impl Projector for Plane {
        fn project(&self, v: &mut [f64]) {
            let along: f64 = (0..3).map(|i| self.0[i] * v[i]).sum();
            (0..3).for_each(|i| v[i] -= along * self.0[i]);
        }
    }
    let plane = Plane([0.6, 0.0, 0.8]);
    let a = [4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 9.0];
    let b = [1.0, 2.0, 3.0];
    let mut x = [0.0; 3];
    let report = cg(
        &dense_operator(3, &a),
        &Jacobi::new(&[4.0, 3.0, 9.0]),
        &plane,
        &Serial,
        &b,
        &mut x,
        &TIGHT,
        &mut CgWorkspace::new(3),
    );
    assert!(report.converged() && report.iterations <= 3, "{report:?}");
    assert!((0.6 * x[0] + 0.8 * x[2]).abs() < 1e-15, "x leaves the plane: {x:?}");
    let mut residual: Vec<f64> = (0..3).map(|i| b[i] - (0..3).map(|j| a[i * 3 + j] * x[j]).sum::<f64>()).collect();
    plane.project(&mut residual);
    assert!(residual.iter().all(|r| r.abs() < 1e-12), "{residual:?}");
}

/// Negative curvature at the first direction gives the preconditioned residual, from any start; later it gives the
/// iterate before, which has lowered the quadratic.
#[test]
fn negative_curvature_is_reported() {
    let a = [-2.0, 0.0, 0.0, 5.0];
    for start in [[0.0, 0.0], [0.3, -0.2]] {
        let mut x = start;
        let report = cg(
            &dense_operator(2, &a),
            &Jacobi::new(&[2.0, 5.0]),
            &NoProjection,
            &Serial,
            &[1.0, 0.125],
            &mut x,
            &TIGHT,
            &mut CgWorkspace::new(2),
        );
        assert!(matches!(report.status, LinearStatus::NegativeCurvature { p_a_p } if p_a_p < 0.0), "{report:?}");
        assert_eq!(report.iterations, 0);
        assert_eq!(x, [0.5, 0.025], "the preconditioned steepest descent");
    }

    // b leans on the positive direction, so that the first step is fine and the second is not.
    let b = [0.1, 1.0];
    let mut x = [0.0; 2];
    let report =
        cg(&dense_operator(2, &a), &Identity, &NoProjection, &Serial, &b, &mut x, &TIGHT, &mut CgWorkspace::new(2));
    assert!(matches!(report.status, LinearStatus::NegativeCurvature { .. }), "{report:?}");
    assert_eq!(report.iterations, 1);
    assert!(b[0] * x[0] + b[1] * x[1] > 0.0, "not a direction of descent: {x:?}");
}

/// A singular matrix with an incompatible right-hand side is not mistaken for a solved one.
#[test]
fn zero_curvature_is_reported() {
    let mut x = [0.0; 2];
    let report = cg(
        &dense_operator(2, &[0.0; 4]),
        &Identity,
        &NoProjection,
        &Serial,
        &[1.0, 0.0],
        &mut x,
        &TIGHT,
        &mut CgWorkspace::new(2),
    );
    assert_eq!(report.status, LinearStatus::NegativeCurvature { p_a_p: 0.0 });
}

/// A NaN in the matrix, in the right-hand side, or in the preconditioner is reported and never gets into x.
#[test]
fn not_a_number_is_reported() {
    struct Broken;
    impl Preconditioner for Broken {
        fn apply(&self, _r: &[f64], z: &mut [f64]) {
            z.fill(f64::NAN);
        }
    }
    let good = [2.0, 0.5, 0.5, 1.0];
    let bad = [2.0, 0.5, 0.5, f64::NAN];
    let cases: [(&[f64], &dyn Preconditioner, [f64; 2]); 4] = [
        (&bad, &Identity, [1.0, 1.0]),
        (&good, &Identity, [f64::NAN, 1.0]),
        (&good, &Identity, [f64::INFINITY, 1.0]),
        (&good, &Broken, [1.0, 1.0]),
    ];
    for (case, (a, preconditioner, b)) in cases.into_iter().enumerate() {
        for start in [[0.0, 0.0], [0.25, 0.5]] {
            let mut x = start;
            let report = cg(
                &dense_operator(2, a),
                preconditioner,
                &NoProjection,
                &Serial,
                &b,
                &mut x,
                &TIGHT,
                &mut CgWorkspace::new(2),
            );
            assert_eq!(report.status, LinearStatus::NotFinite, "case {case}");
            assert!(!report.usable());
            assert_eq!(x, start, "case {case}");
        }
    }
}

/// A preconditioner that is not positive definite is named as the culprit.
#[test]
fn indefinite_preconditioner_is_reported() {
    struct Negative;
    impl Preconditioner for Negative {
        fn apply(&self, r: &[f64], z: &mut [f64]) {
            z.iter_mut().zip(r).for_each(|(z, r)| *z = -r);
        }
    }
    let mut x = [0.0; 2];
    let report = cg(
        &dense_operator(2, &[1.0, 0.0, 0.0, 2.0]),
        &Negative,
        &NoProjection,
        &Serial,
        &[1.0, 1.0],
        &mut x,
        &TIGHT,
        &mut CgWorkspace::new(2),
    );
    assert_eq!(report.status, LinearStatus::IndefinitePreconditioner { r_z: -2.0 });
    assert!(!report.usable());
}

/// The right-hand side sets the scale: a start that is already good enough costs no iteration, and running out of
/// iterations is said.
#[test]
fn tolerances_and_limits() {
    let n = 40;
    let operator = OperatorFromFn {
        len: n,
        product: |x: &[f64], y: &mut [f64]| {
            for i in 0..x.len() {
                let left = if i > 0 { x[i - 1] } else { 0.0 };
                let right = if i + 1 < x.len() { x[i + 1] } else { 0.0 };
                y[i] = 2.0 * x[i] - left - right;
            }
        },
    };
    let b = vec![1.0; n];
    let solve = |x: &mut [f64], options: &CgOptions| {
        cg(&operator, &Identity, &NoProjection, &Serial, &b, x, options, &mut CgWorkspace::new(n))
    };
    let mut x = vec![0.0; n];
    let report = solve(&mut x, &CgOptions { max_iterations: 3, ..TIGHT });
    assert_eq!((report.status, report.iterations), (LinearStatus::MaxIterations, 3));
    let report = solve(&mut x, &TIGHT);
    assert!(report.converged() && report.iterations <= n, "{report:?}");
    let report = solve(&mut x, &CgOptions { relative_tolerance: 1e-10, ..TIGHT });
    assert_eq!((report.status, report.iterations), (LinearStatus::Converged, 0));
    let mut zero = vec![0.0; n];
    let report = solve(&mut zero, &CgOptions { absolute_tolerance: 10.0, ..TIGHT });
    assert_eq!((report.status, report.iterations), (LinearStatus::Converged, 0));
}
