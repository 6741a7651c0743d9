//! Numerical value of expressions, node by node in plain `f64`: slow, obvious, and what faster ways are compared with.

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
                        match function {
                            Function::Sqrt => a.sqrt(),
                            Function::Ln => a.ln(),
                            Function::Exp => a.exp(),
                            Function::Pow => a.powf(of(operands[1], q)),
                            Function::RootSum => root_sum(a, of(operands[1], q), of(operands[2], q)),
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
