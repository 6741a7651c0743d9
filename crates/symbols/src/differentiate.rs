//! Derivatives, backwards and forwards. This is the only place in Souple where a differentiation rule is written.
//!
//! Backwards (reverse accumulation): the adjoint of a node is the sum over its users of *adjoint of the user × partial
//! derivative of the user by the node*. One sweep gives the derivatives by all leaves, at a small multiple of the cost
//! of the expression itself, whatever their number.
//!
//! A point sum needs one rule more: a node that does not vary over the points, used by one that does, collects its
//! contributions over all points, so they are wrapped in a point sum.

use crate::{Expr, Function, Graph, Node, Number};
use std::collections::HashMap;

/// Contributions to the adjoint of one node.
#[derive(Default)]
struct Adjoint {
    once: Vec<(Number, Expr)>,
    per_point: Vec<(Number, Expr)>,
}

impl Graph {
    /// Derivatives of `root` by each of `by` (symbols or any nodes), in their order.
    ///
    /// A node of `by` is treated as an independent variable: what it is made of is not looked into.
    pub fn gradient(&mut self, root: Expr, by: &[Expr]) -> Vec<Expr> {
        let order = self.reachable_through(&[root], Graph::variables);
        let mut depends: HashMap<Expr, bool> = HashMap::new();
        for &e in &order {
            let d = by.contains(&e) || self.variables(e).iter().any(|o| depends[o]);
            depends.insert(e, d);
        }
        let mut adjoints: HashMap<Expr, Adjoint> = HashMap::new();
        let one = self.int(1);
        adjoints.entry(root).or_default().once.push((Number::ONE, one));
        let mut found: HashMap<Expr, Expr> = HashMap::new();
        for &e in order.iter().rev() {
            if !depends[&e] {
                continue;
            }
            let Some(adjoint) = adjoints.remove(&e) else { continue };
            // The constant in front is kept apart, where it can meet the constants of the partial derivatives.
            let (scale, adjoint) = self.total(adjoint);
            if by.contains(&e) {
                found.insert(e, self.scale(scale, adjoint));
                continue;
            }
            for (operand, partial) in self.partials(e, &|o| depends[&o]) {
                if !depends[&operand] {
                    continue;
                }
                let contribution = self.mul(adjoint, partial);
                let entry = adjoints.entry(operand).or_default();
                let collects = self.varies(e) && !self.varies(operand);
                if collects { &mut entry.per_point } else { &mut entry.once }.push((scale, contribution));
            }
        }
        let zero = self.int(0);
        by.iter().map(|e| found.get(e).copied().unwrap_or(zero)).collect()
    }

    fn total(&mut self, adjoint: Adjoint) -> (Number, Expr) {
        let mut terms = adjoint.once;
        if !adjoint.per_point.is_empty() {
            let (scale, inside) = self.linear_with_scale(&adjoint.per_point);
            let sum = self.point_sum(inside);
            terms.push((scale, sum));
        }
        self.linear_with_scale(&terms)
    }

    /// Derivatives of `roots` along a direction: each pair is a variable and the direction's component for it.
    pub fn directional(&mut self, roots: &[Expr], direction: &[(Expr, Expr)]) -> Vec<Expr> {
        // Constants are kept apart from the nodes that they multiply, so that they meet and cancel.
        let mut tangent: HashMap<Expr, (Number, Expr)> =
            direction.iter().map(|&(variable, along)| (variable, (Number::ONE, along))).collect();
        let zero = self.int(0);
        for e in self.reachable_through(roots, Graph::variables) {
            if tangent.contains_key(&e) {
                continue;
            }
            let moving = self.variables(e).iter().any(|o| tangent[o].1 != zero);
            if !moving {
                tangent.insert(e, (Number::ONE, zero));
                continue;
            }
            let value = match self.node(e).clone() {
                Node::Sum(_, terms) => {
                    let terms: Vec<(Number, Expr)> =
                        terms.iter().map(|&(k, t)| (k * tangent[&t].0, tangent[&t].1)).collect();
                    self.linear_with_scale(&terms)
                }
                Node::PointSum(o) => {
                    let (scale, inside) = tangent[&o];
                    (scale, self.point_sum(inside))
                }
                Node::Named(_, o) => tangent[&o],
                Node::Function(Function::PowerEntry(..) | Function::PowerTrace, operands) => {
                    // All entries of the matrix at once: the change of the matrix is turned into its eigenvectors once.
                    let matrix = &operands[1..7];
                    let along: Vec<Expr> = matrix.iter().map(|m| self.scale(tangent[m].0, tangent[m].1)).collect();
                    let along: [Expr; 6] = along.try_into().expect("a symmetric matrix has six entries");
                    let mut terms = Vec::new();
                    if along.iter().any(|&c| c != zero) {
                        terms.push((Number::ONE, self.power_along(e, &along)));
                    }
                    for (o, partial) in self.power_term_partials(e, &|o| tangent[&o].1 != zero) {
                        terms.push((tangent[&o].0, self.mul(partial, tangent[&o].1)));
                    }
                    self.linear_with_scale(&terms)
                }
                _ => {
                    let partials = self.partials(e, &|o| tangent[&o].1 != zero);
                    let moving = partials.into_iter().filter(|(o, _)| tangent[o].1 != zero);
                    let terms: Vec<(Number, Expr)> =
                        moving.map(|(o, partial)| (tangent[&o].0, self.mul(partial, tangent[&o].1))).collect();
                    self.linear_with_scale(&terms)
                }
            };
            tangent.insert(e, value);
        }
        roots.iter().map(|r| self.scale(tangent[r].0, tangent[r].1)).collect()
    }

    /// Derivative of `root` by one variable.
    pub fn derivative(&mut self, root: Expr, by: Expr) -> Expr {
        let one = self.int(1);
        self.directional(&[root], &[(by, one)])[0]
    }

    /// Each operand of a node with the partial derivative by it; where one is dear, those that are not `wanted` may be
    /// left out.
    fn partials(&mut self, e: Expr, wanted: &dyn Fn(Expr) -> bool) -> Vec<(Expr, Expr)> {
        match self.node(e).clone() {
            Node::Constant(_) | Node::Symbol(_) | Node::Table(_) => Vec::new(),
            Node::Sum(_, terms) => terms.iter().map(|&(k, t)| (t, self.number(k))).collect(),
            Node::Product(c, factors) => factors
                .iter()
                .map(|&(f, n)| {
                    let mut rest = factors.to_vec();
                    rest.push((f, -1));
                    (f, self.scaled_powers(c * Number::Rational(n.into(), 1), &rest))
                })
                .collect(),
            Node::PointSum(o) | Node::Named(_, o) => vec![(o, self.int(1))],
            Node::Function(function, operands) => {
                let a = operands[0];
                match function {
                    Function::Sqrt => vec![(a, self.scaled_powers(Number::rational(1, 2), &[(e, -1)]))],
                    Function::Ln => vec![(a, self.powi(a, -1))],
                    Function::Exp => vec![(a, e)],
                    Function::RootSum => {
                        // By the implicit function theorem on s⁴ − 2a s² − 8c s + a² − 4b = 0:
                        // (s³ − a s − 2c) ds = ½(s² − a) da + db + 2s dc.
                        let (b, c) = (operands[1], operands[2]);
                        let (cube, square) = (self.powi(e, 3), self.powi(e, 2));
                        let linear = self.mul(a, e);
                        let two = Number::Rational(2, 1);
                        let slope = self.linear(&[(Number::ONE, cube), (Number::MINUS_ONE, linear), (-two, c)]);
                        let rest = self.sub(square, a);
                        vec![
                            (a, self.scaled_powers(Number::rational(1, 2), &[(rest, 1), (slope, -1)])),
                            (b, self.powi(slope, -1)),
                            (c, self.scaled_powers(two, &[(e, 1), (slope, -1)])),
                        ]
                    }
                    Function::Sinhc => {
                        // (cosh x − s)/x with cosh² = 1 + (x s)².
                        let sinh_squared = self.scaled_powers(Number::ONE, &[(a, 2), (e, 2)]);
                        let one = self.int(1);
                        let cosh_squared = self.add(sinh_squared, one);
                        let cosh = self.sqrt(cosh_squared);
                        let excess = self.sub(cosh, e);
                        vec![(a, self.div(excess, a))]
                    }
                    Function::Eigenvalue(_)
                    | Function::Eigenvector(..)
                    | Function::PowerTrace
                    | Function::PowerEntry(..) => self.spectral_partials(e, wanted),
                    Function::Root(root) => self.root_partials(e, root, &operands[1..]),
                    Function::Pow => {
                        // d(a^b) = b a^b / a da + a^b ln a db; written with the power itself so that it is shared.
                        let b = operands[1];
                        let by_base = self.scaled_powers(Number::ONE, &[(b, 1), (e, 1), (a, -1)]);
                        if self.constant(b).is_some() {
                            return vec![(a, by_base)];
                        }
                        let log = self.ln(a);
                        vec![(a, by_base), (b, self.mul(e, log))]
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Graph, Time};
    use proptest::prelude::*;

    /// Equal mixed derivatives taken backwards then forwards agree with central differences of the expression.
    #[test]
    fn derivatives_agree_with_differences() {
        let mut g = Graph::new();
        let x = g.symbol("x", Time::Step);
        let y = g.symbol("y", Time::Step);
        let xy = g.mul(x, y);
        let s = g.add(xy, x);
        let (root, ln, exp) = (g.sqrt(s), g.ln(y), g.exp(xy));
        let third = g.rational(1, 3);
        let p = g.pow(s, third);
        let cubed = g.powi(y, -3);
        let quotient = g.mul(x, cubed);
        let f = g.sum(&[root, ln, exp, p, quotient]);
        let grad = g.gradient(f, &[x, y]);
        let forward = [g.derivative(f, x), g.derivative(f, y)];
        let at = |g: &Graph, e, vx: f64, vy: f64| g.evaluate(&[e], &[(x, vx), (y, vy)])[0];
        let (vx, vy, h) = (0.7, 1.3, 1e-6);
        let dx = (at(&g, f, vx + h, vy) - at(&g, f, vx - h, vy)) / (2.0 * h);
        let dy = (at(&g, f, vx, vy + h) - at(&g, f, vx, vy - h)) / (2.0 * h);
        for (k, d) in [dx, dy].into_iter().enumerate() {
            assert!((at(&g, grad[k], vx, vy) - d).abs() < 1e-8, "backwards {k}");
            assert!((at(&g, forward[k], vx, vy) - d).abs() < 1e-8, "forwards {k}");
        }
    }

    /// The gradient of a point sum by something that does not vary collects the contributions of every point, including
    /// those that do not depend on the point.
    #[test]
    fn point_sums_collect() {
        let mut g = Graph::with_points(3);
        let t = g.table(&[1.0, 2.0, 4.0]);
        let x = g.symbol("x", Time::Step);
        let body = g.mul(x, t);
        let shifted = g.add(body, x);
        let squared = g.powi(shifted, 2);
        let total = g.point_sum(squared);
        // Σ (x (t + 1))² = (4 + 9 + 25) x².
        let d = g.gradient(total, &[x])[0];
        assert_eq!(g.evaluate(&[total, d], &[(x, 0.5)]), vec![38.0 / 4.0, 38.0]);
        let along = g.derivative(total, x);
        assert_eq!(g.evaluate(&[along], &[(x, 0.5)]), vec![38.0]);
    }

    /// The sum of roots and its first and second derivatives against the roots themselves.
    #[test]
    fn root_sums_follow_their_roots() {
        let mut g = Graph::new();
        let r: Vec<_> = (0..3).map(|k| g.symbol(format!("r{k}"), Time::Step)).collect();
        let squares: Vec<_> = r.iter().map(|&x| g.powi(x, 2)).collect();
        let a = g.sum(&squares);
        let pairs: Vec<_> = (0..3).map(|k| g.mul(squares[k], squares[(k + 1) % 3])).collect();
        let b = g.sum(&pairs);
        let c = g.product(&r);
        let s = g.function(crate::Function::RootSum, &[a, b, c]);
        let gradient = g.gradient(s, &r);
        let second: Vec<_> = gradient.iter().map(|&d| g.derivative(d, r[0])).collect();
        for values in [[1.0, 1.0, 1.0], [2.0, 0.5, 1.1], [9.0, 0.2, 0.1], [1.3, 1.3, -0.4]] {
            let at: Vec<_> = r.iter().copied().zip(values).collect();
            let sum: f64 = values.iter().sum();
            assert!((g.evaluate(&[s], &at)[0] - sum).abs() < 1e-13 * sum, "{values:?}");
            // The sum is linear in the roots: its gradient is one, its second derivatives vanish.
            assert!(g.evaluate(&gradient, &at).iter().all(|d| (d - 1.0).abs() < 1e-10), "{values:?}");
            assert!(g.evaluate(&second, &at).iter().all(|d| d.abs() < 1e-8), "{values:?}");
        }
    }

    proptest! {
        /// A gradient costs at most a small multiple of its expression, whatever the number of variables.
        #[test]
        fn gradients_are_cheap(n in 2usize..40) {
            let mut g = Graph::new();
            let x: Vec<_> = (0..n).map(|i| g.symbol(format!("x{i}"), Time::Step)).collect();
            let mut product = x[0];
            for pair in x.windows(2) {
                let s = g.add(pair[0], pair[1]);
                let q = g.powi(s, 2);
                product = g.sum(&[product, q]);
            }
            let before = g.len();
            let _ = g.gradient(product, &x);
            prop_assert!(g.len() - before <= 8 * before, "{} nodes became {}", before, g.len());
        }
    }
}
