//! Numerical value of expressions, node by node in plain `f64`: slow, obvious, and what faster ways are compared with.

use crate::spectral::PLACE;
use crate::{Expr, Function, Graph, Node};
use std::collections::HashMap;

impl Graph {
    /// Values of `roots`, given the values of the symbols.
    ///
    /// # Panics
    /// When a symbol has no value or a root varies over the points (use [`Graph::evaluate_at_points`]).
    pub fn evaluate(&self, roots: &[Expr], symbols: &[(Expr, f64)]) -> Vec<f64> {
        let symbols: Vec<(Expr, Vec<f64>)> = symbols.iter().map(|&(e, v)| (e, vec![v])).collect();
        self.evaluate_at_points(roots, &symbols)
            .into_iter()
            .map(|values| {
                assert_eq!(values.len(), 1, "a varying root has one value per point");
                values[0]
            })
            .collect()
    }

    /// Values of `roots`, one per point for those that vary and one for the others; symbols likewise.
    ///
    /// # Panics
    /// When a symbol that is needed has no value.
    pub fn evaluate_at_points(&self, roots: &[Expr], symbols: &[(Expr, Vec<f64>)]) -> Vec<Vec<f64>> {
        let mut values: HashMap<Expr, Vec<f64>> = symbols.iter().cloned().collect();
        for e in self.reachable(roots) {
            if values.contains_key(&e) {
                continue;
            }
            let count = if self.varies(e) { self.points() } else { 1 };
            let of = |o: Expr, q: usize| -> f64 {
                let v = &values[&o];
                if v.len() == 1 { v[0] } else { v[q] }
            };
            let at = |q: usize| -> f64 {
                match self.node(e) {
                    Node::Constant(c) => c.to_f64(),
                    Node::Symbol(s) => panic!("no value was given for `{}`", self.symbol_name(*s)),
                    Node::Table(t) => self.table_values(*t)[q],
                    Node::Sum(c, terms) => terms.iter().fold(c.to_f64(), |s, &(k, t)| s + k.to_f64() * of(t, q)),
                    Node::Product(c, factors) => factors.iter().fold(c.to_f64(), |p, &(f, n)| p * of(f, q).powi(n)),
                    Node::Function(function, operands) => {
                        let a = of(operands[0], q);
                        let entries = |q| std::array::from_fn(|k| of(operands[k], q));
                        match function {
                            Function::Sqrt => a.sqrt(),
                            Function::Ln => a.ln(),
                            Function::Exp => a.exp(),
                            Function::Pow => a.powf(of(operands[1], q)),
                            Function::RootSum => root_sum(a, of(operands[1], q), of(operands[2], q)),
                            Function::Sinhc => sinhc(a),
                            Function::Eigenvalue(which) => eigen(entries(q)).0[*which as usize],
                            Function::Eigenvector(row, which) => eigen(entries(q)).1[*row as usize][*which as usize],
                            // The first operand is the value, written out.
                            Function::PowerTrace | Function::PowerEntry(..) => a,
                            Function::Root(_) => a,
                        }
                    }
                    Node::Named(_, o) => of(*o, q),
                    Node::PointSum(o) => {
                        let v = &values[o];
                        if v.len() == 1 { v[0] * self.points() as f64 } else { v.iter().sum() }
                    }
                }
            };
            let value = (0..count).map(at).collect();
            values.insert(e, value);
        }
        roots.iter().map(|r| values[r].clone()).collect()
    }
}

/// Newton's method on s⁴ − 2a s² − 8c s + a² − 4b from above its largest root: √(3a), by the Cauchy–Schwarz inequality.
/// All roots are real, so the iterates fall monotonically.
fn root_sum(a: f64, b: f64, c: f64) -> f64 {
    let mut s = (3.0 * a).sqrt();
    for _ in 0..60 {
        let value = ((s * s - 2.0 * a) * s - 8.0 * c) * s + a * a - 4.0 * b;
        let slope = 4.0 * ((s * s - a) * s - 2.0 * c);
        let next = s - value / slope;
        // Falling stops at rounding; a NaN stops at once.
        if next < s {
            s = next;
        } else {
            return next.min(s);
        }
    }
    s
}

/// sinh(x)/x; by its series near zero.
fn sinhc(x: f64) -> f64 {
    if x.abs() > 0.1 {
        return x.sinh() / x;
    }
    let square = x * x;
    1.0 + square / 6.0 * (1.0 + square / 20.0 * (1.0 + square / 42.0 * (1.0 + square / 72.0)))
}

/// Eigenvalues and eigenvectors, [row][which], of a symmetric matrix by Jacobi's rotations, each by at most 45°, until
/// what is off the diagonal no longer counts.
fn eigen(entries: [f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut m: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| entries[PLACE[i][j]]));
    let mut n = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let size = entries.iter().fold(0.0, |s: f64, x| s.max(x.abs()));
    for _ in 0..20 {
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            let off = m[p][q];
            if off == 0.0 {
                continue;
            }
            let half = 0.5 * (m[p][p] - m[q][q]);
            let tangent = off / (half + half.hypot(off).copysign(half));
            let cosine = 1.0 / tangent.hypot(1.0);
            let sine = tangent * cosine;
            m[p][p] += tangent * off;
            m[q][q] -= tangent * off;
            (m[p][q], m[q][p]) = (0.0, 0.0);
            (m[p][r], m[q][r]) = (cosine * m[p][r] + sine * m[q][r], cosine * m[q][r] - sine * m[p][r]);
            (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
            for row in &mut n {
                (row[p], row[q]) = (cosine * row[p] + sine * row[q], cosine * row[q] - sine * row[p]);
            }
        }
        // A NaN ends it too.
        let off = m[0][1].abs() + m[1][2].abs() + m[0][2].abs();
        if off.is_nan() || off <= 1e-22 * size {
            break;
        }
    }
    ([m[0][0], m[1][1], m[2][2]], n)
}
