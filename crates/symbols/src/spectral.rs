//! Powers of symmetric 3 × 3 matrices, M^q = Σ_a λ_a^q n_a n_aᵀ, that can be differentiated at equal eigenvalues too.
//!
//! Eigenvalues and eigenvectors have no derivative where two eigenvalues meet; the power has all of them there.
//! So its nodes are *written* with eigenvalues and eigenvectors, and *differentiated* by rules of their own
//! (Bhatia, Matrix Analysis (1997), theorem V.3.3), in which only quotients of differences of powers occur:
//!
//! ```text
//! ∂ tr(M^q)/∂M = q M^(q−1)
//! d(M^q) = N (Θ ∘ (Nᵀ dM N)) Nᵀ,   Θ_ab = (λ_a^q − λ_b^q)/(λ_a − λ_b),   Θ_aa = q λ_a^(q−1)
//! ```
//!
//! With u = ln λ, d = (u_a − u_b)/2 and S(x) = sinh(x)/x the quotient has neither a difference nor a pole:
//!
//! ```text
//! Θ_ab = q (λ_a λ_b)^((q−1)/2) S(q d)/S(d)
//! ```
//!
//! Any orthonormal eigenvectors serve, whatever a repeated eigenvalue leaves open, because the sums do not depend on
//! the choice.
//! All powers of one matrix share its eigenvectors, and a power is a weighted sum Σ_p c_p M^(q_p), so that a derivative
//! turns back from the eigenvectors once, however many terms there are.
//!
//! A matrix is given by six expressions in the order 11, 22, 33, 12, 23, 31.

use crate::{Expr, Function, Graph, Number};

/// Where the entry (i, j) of a symmetric matrix stands among the six, [i][j].
pub(crate) const PLACE: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// Row and column of each of the six, and how often it stands in the matrix.
const ENTRIES: [(usize, usize, i64); 6] = [(0, 0, 1), (1, 1, 1), (2, 2, 1), (0, 1, 2), (1, 2, 2), (2, 0, 2)];

/// The operands of a power: its value, six entries, then pairs of weight and exponent.
struct Power {
    matrix: [Expr; 6],
    /// (c_p, q_p).
    terms: Vec<(Expr, Expr)>,
}

impl Power {
    fn of(operands: &[Expr]) -> Power {
        let matrix = operands[1..7].try_into().expect("a power has a value, then six entries");
        Power { matrix, terms: operands[7..].chunks_exact(2).map(|pair| (pair[0], pair[1])).collect() }
    }
}

impl Graph {
    /// `tr Σ_p c_p M^(q_p)` of a symmetric matrix with positive eigenvalues; `terms` are (c_p, q_p).
    ///
    /// It can be differentiated twice by anything, wherever eigenvalues meet; a third time only where they differ.
    pub fn power_trace(&mut self, matrix: &[Expr; 6], terms: &[(Expr, Expr)]) -> Expr {
        let weights: Vec<Expr> = (0..3).map(|a| self.weight(matrix, terms, 0, a)).collect();
        let value = self.sum(&weights);
        self.power(Function::PowerTrace, value, matrix, terms)
    }

    /// Entry (i, j) of `Σ_p c_p M^(q_p)`, as [`Graph::power_trace`].
    pub fn power_entry(&mut self, at: (usize, usize), matrix: &[Expr; 6], terms: &[(Expr, Expr)]) -> Expr {
        self.shifted_entry(at, 0, matrix, terms)
    }

    /// Entry (i, j) of `Σ_p c_p M^(q_p − shift)`. Whole shifts are kept apart from the exponents, so that a power and its
    /// derivatives share λ^q.
    fn shifted_entry(&mut self, at: (usize, usize), shift: u8, matrix: &[Expr; 6], terms: &[(Expr, Expr)]) -> Expr {
        let (i, j) = (at.0.min(at.1), at.0.max(at.1));
        let parts: Vec<Expr> = (0..3)
            .map(|a| {
                let weight = self.weight(matrix, terms, shift, a);
                let (x, y) = (self.eigenvector(matrix, i, a), self.eigenvector(matrix, j, a));
                self.product(&[weight, x, y])
            })
            .collect();
        let value = self.sum(&parts);
        self.power(Function::PowerEntry(i as u8, j as u8, shift), value, matrix, terms)
    }

    fn power(&mut self, function: Function, value: Expr, matrix: &[Expr; 6], terms: &[(Expr, Expr)]) -> Expr {
        let mut operands = vec![value];
        operands.extend(matrix);
        operands.extend(terms.iter().flat_map(|&(c, q)| [c, q]));
        self.function(function, &operands)
    }

    fn eigenvalue(&mut self, matrix: &[Expr; 6], a: usize) -> Expr {
        self.function(Function::Eigenvalue(a as u8), matrix)
    }

    fn eigenvector(&mut self, matrix: &[Expr; 6], row: usize, a: usize) -> Expr {
        self.function(Function::Eigenvector(row as u8, a as u8), matrix)
    }

    fn log_eigenvalue(&mut self, matrix: &[Expr; 6], a: usize) -> Expr {
        let value = self.eigenvalue(matrix, a);
        self.ln(value)
    }

    /// `λ_a^(q/2)`: all other powers are made of it.
    fn half_power(&mut self, matrix: &[Expr; 6], q: Expr, a: usize) -> Expr {
        let log = self.log_eigenvalue(matrix, a);
        let exponent = self.scaled_powers(Number::rational(1, 2), &[(q, 1), (log, 1)]);
        self.exp(exponent)
    }

    /// `Σ_p c_p λ_a^(q_p − shift)`.
    fn weight(&mut self, matrix: &[Expr; 6], terms: &[(Expr, Expr)], shift: u8, a: usize) -> Expr {
        let value = self.eigenvalue(matrix, a);
        let parts: Vec<Expr> = terms
            .iter()
            .map(|&(c, q)| {
                let half = self.half_power(matrix, q, a);
                self.scaled_powers(Number::ONE, &[(c, 1), (half, 2)])
            })
            .collect();
        let sum = self.sum(&parts);
        self.scaled_powers(Number::ONE, &[(sum, 1), (value, -i32::from(shift))])
    }

    fn shifted(&mut self, q: Expr, shift: u8) -> Expr {
        let shift = self.int(-i64::from(shift));
        self.add(q, shift)
    }

    /// `Σ_p c_p Θ_ab` of the exponents q_p − shift.
    fn slope(&mut self, matrix: &[Expr; 6], terms: &[(Expr, Expr)], shift: u8, a: usize, b: usize) -> Expr {
        let (a, b) = (a.min(b), a.max(b));
        let parts: Vec<Expr> = terms
            .iter()
            .map(|&(c, q)| {
                let exponent = self.shifted(q, shift);
                let (x, y) = (self.half_power(matrix, q, a), self.half_power(matrix, q, b));
                let mut factors = vec![(c, 1), (exponent, 1), (x, 1), (y, 1)];
                if a != b {
                    let distance = self.half_distance(matrix, a, b);
                    let scaled = self.mul(exponent, distance);
                    factors.push((self.function(Function::Sinhc, &[scaled]), 1));
                }
                self.scaled_powers(Number::ONE, &factors)
            })
            .collect();
        let sum = self.sum(&parts);
        // (λ_a λ_b)^(−(shift + 1)/2): a root for even shifts only.
        let (x, y) = (self.eigenvalue(matrix, a), self.eigenvalue(matrix, b));
        let power = -i32::from(shift) - 1;
        let mut factors = vec![(sum, 1)];
        if a == b {
            factors.push((x, power));
        } else {
            if power % 2 == 0 {
                factors.extend([(x, power / 2), (y, power / 2)]);
            } else {
                let product = self.mul(x, y);
                factors.push((self.sqrt(product), power));
            }
            let distance = self.half_distance(matrix, a, b);
            factors.push((self.function(Function::Sinhc, &[distance]), -1));
        }
        self.scaled_powers(Number::ONE, &factors)
    }

    /// `(ln λ_a − ln λ_b)/2`.
    fn half_distance(&mut self, matrix: &[Expr; 6], a: usize, b: usize) -> Expr {
        let (x, y) = (self.log_eigenvalue(matrix, a), self.log_eigenvalue(matrix, b));
        let half = Number::rational(1, 2);
        self.linear(&[(half, x), (-half, y)])
    }

    /// `d(Σ_p c_p M^(q_p − shift))_ij` for a change of the matrix, six entries; weights and exponents stay.
    pub(crate) fn power_along(&mut self, e: Expr, along: &[Expr; 6]) -> Expr {
        let (function, operands) = self.function_parts(e);
        let Power { matrix, terms } = Power::of(&operands);
        let Function::PowerEntry(i, j, shift) = function else {
            let mut parts = Vec::with_capacity(6);
            for (k, &change) in along.iter().enumerate() {
                let slope = self.trace_slope(&matrix, &terms, k);
                parts.push(self.mul(slope, change));
            }
            return self.sum(&parts);
        };
        // Nᵀ dM, then Θ ∘ (Nᵀ dM N), then both turned back.
        let vector: Vec<Vec<Expr>> =
            (0..3).map(|row| (0..3).map(|a| self.eigenvector(&matrix, row, a)).collect()).collect();
        let dot = |g: &mut Graph, x: [Expr; 3], y: [Expr; 3]| {
            let parts: Vec<Expr> = x.into_iter().zip(y).map(|(x, y)| g.mul(x, y)).collect();
            g.sum(&parts)
        };
        let column = |a: usize| [vector[0][a], vector[1][a], vector[2][a]];
        let mut turned = [[along[0]; 3]; 3];
        for a in 0..3 {
            let left: [Expr; 3] =
                std::array::from_fn(|l| dot(self, column(a), std::array::from_fn(|k| along[PLACE[k][l]])));
            for b in 0..=a {
                let slope = self.slope(&matrix, &terms, shift, a, b);
                let entry = dot(self, left, column(b));
                let entry = self.mul(slope, entry);
                (turned[a][b], turned[b][a]) = (entry, entry);
            }
        }
        let row = |i: u8| [vector[i as usize][0], vector[i as usize][1], vector[i as usize][2]];
        let half: [Expr; 3] = std::array::from_fn(|b| dot(self, row(i), std::array::from_fn(|a| turned[a][b])));
        dot(self, half, row(j))
    }

    /// `∂ tr(Σ_p c_p M^(q_p))/∂M` by the `k`-th of the six entries.
    fn trace_slope(&mut self, matrix: &[Expr; 6], terms: &[(Expr, Expr)], k: usize) -> Expr {
        let (i, j, times) = ENTRIES[k];
        let terms: Vec<(Expr, Expr)> = terms.iter().map(|&(c, q)| (self.mul(c, q), q)).collect();
        let entry = self.shifted_entry((i, j), 1, matrix, &terms);
        self.scale(Number::Rational(times, 1), entry)
    }

    fn function_parts(&self, e: Expr) -> (Function, Vec<Expr>) {
        match self.node(e) {
            crate::Node::Function(function, operands) => (*function, operands.to_vec()),
            other => unreachable!("{other:?} is no function: callers match on functions first"),
        }
    }

    /// Operands that a spectral function varies with, each with the partial derivative by it; only those that are
    /// `wanted` are written.
    pub(crate) fn spectral_partials(&mut self, e: Expr, wanted: &dyn Fn(Expr) -> bool) -> Vec<(Expr, Expr)> {
        let (function, operands) = self.function_parts(e);
        match function {
            Function::Eigenvalue(a) => {
                let matrix: [Expr; 6] = operands[..].try_into().expect("an eigenvalue has six operands");
                let mut partials = Vec::new();
                for (k, (i, j, times)) in ENTRIES.into_iter().enumerate().filter(|&(k, _)| wanted(matrix[k])) {
                    let (x, y) = (self.eigenvector(&matrix, i, a.into()), self.eigenvector(&matrix, j, a.into()));
                    partials.push((matrix[k], self.scaled_powers(Number::Rational(times, 1), &[(x, 1), (y, 1)])));
                }
                partials
            }
            Function::Eigenvector(row, a) => {
                let matrix: [Expr; 6] = operands[..].try_into().expect("an eigenvector has six operands");
                let mut partials = Vec::new();
                for k in (0..6).filter(|&k| wanted(matrix[k])) {
                    partials.push((matrix[k], self.eigenvector_slope(&matrix, row.into(), a.into(), k)));
                }
                partials
            }
            Function::PowerTrace | Function::PowerEntry(..) => {
                let matrix = Power::of(&operands).matrix;
                let (zero, one) = (self.int(0), self.int(1));
                let mut partials = self.power_term_partials(e, wanted);
                for k in (0..6).filter(|&k| wanted(matrix[k])) {
                    let along: [Expr; 6] = std::array::from_fn(|l| if l == k { one } else { zero });
                    partials.push((matrix[k], self.power_along(e, &along)));
                }
                partials
            }
            other => unreachable!("{other:?} is no spectral function: the caller matches on them"),
        }
    }

    /// The weights and exponents of a power, each with the partial derivative by it, where `wanted`.
    pub(crate) fn power_term_partials(&mut self, e: Expr, wanted: &dyn Fn(Expr) -> bool) -> Vec<(Expr, Expr)> {
        let (function, operands) = self.function_parts(e);
        let Power { matrix, terms } = Power::of(&operands);
        let one = self.int(1);
        let mut partials = Vec::new();
        for &(c, q) in &terms {
            if wanted(c) {
                let single = [(one, q)];
                let by_weight = match function {
                    Function::PowerEntry(i, j, shift) => {
                        self.shifted_entry((i.into(), j.into()), shift, &matrix, &single)
                    }
                    _ => self.power_trace(&matrix, &single),
                };
                partials.push((c, by_weight));
            }
            if wanted(q) {
                partials.push((q, self.slope_by_exponent(function, &matrix, c, q)));
            }
        }
        partials
    }

    /// `∂(n_a)_row/∂M_k = Σ_{b≠a} (n_b)_row (n_b · ∂M n_a)/(λ_a − λ_b)`: for different eigenvalues only.
    fn eigenvector_slope(&mut self, matrix: &[Expr; 6], row: usize, a: usize, k: usize) -> Expr {
        let (i, j, times) = ENTRIES[k];
        let own = self.eigenvalue(matrix, a);
        let mut parts = Vec::new();
        for b in (0..3).filter(|&b| b != a) {
            let other = self.eigenvalue(matrix, b);
            let gap = self.sub(own, other);
            let along = self.eigenvector(matrix, row, b);
            for (x, y) in [(i, j), (j, i)].into_iter().take(times as usize) {
                let (x, y) = (self.eigenvector(matrix, x, b), self.eigenvector(matrix, y, a));
                parts.push(self.scaled_powers(Number::ONE, &[(along, 1), (x, 1), (y, 1), (gap, -1)]));
            }
        }
        self.sum(&parts)
    }

    /// Derivative by the exponent of one term: its weights times ln λ.
    fn slope_by_exponent(&mut self, function: Function, matrix: &[Expr; 6], c: Expr, q: Expr) -> Expr {
        let parts: Vec<Expr> = (0..3)
            .map(|a| {
                let log = self.log_eigenvalue(matrix, a);
                let (shift, around) = match function {
                    Function::PowerEntry(i, j, shift) => {
                        let (x, y) = (self.eigenvector(matrix, i.into(), a), self.eigenvector(matrix, j.into(), a));
                        (shift, vec![x, y])
                    }
                    _ => (0, Vec::new()),
                };
                let weight = self.weight(matrix, &[(c, q)], shift, a);
                let mut factors = vec![weight, log];
                factors.extend(around);
                self.product(&factors)
            })
            .collect();
        self.sum(&parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Time;

    struct Case {
        g: Graph,
        matrix: [Expr; 6],
        c: Expr,
        q: Expr,
        terms: Vec<(Expr, Expr)>,
    }

    fn case() -> Case {
        let mut g = Graph::new();
        let matrix: [Expr; 6] = std::array::from_fn(|k| g.symbol(format!("m{k}"), Time::Step));
        let (c, q) = (g.symbol("c", Time::Step), g.symbol("q", Time::Step));
        let (two, third) = (g.int(2), g.rational(-1, 3));
        Case { g, matrix, c, q, terms: vec![(c, q), (two, third)] }
    }

    const AT: [[f64; 6]; 3] =
        [[1.3, 0.8, 1.1, 0.2, -0.15, 0.3], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0], [2.0, 2.0, 0.7, 0.0, 0.0, 0.0]];
    const WEIGHT: f64 = 0.7;
    const EXPONENT: f64 = 1.6;

    impl Case {
        fn variables(&self) -> Vec<Expr> {
            self.matrix.iter().copied().chain([self.c, self.q]).collect()
        }

        fn values(&self, m: [f64; 6]) -> Vec<(Expr, f64)> {
            self.variables().into_iter().zip(m.into_iter().chain([WEIGHT, EXPONENT])).collect()
        }

        /// Largest difference of `derivatives` by each variable from central differences of `e`.
        fn error(&self, e: Expr, derivatives: &[Expr], m: [f64; 6]) -> f64 {
            let values = self.values(m);
            let found = self.g.evaluate(derivatives, &values);
            let slope = |k: usize| {
                let at = |h: f64| {
                    let mut moved = values.clone();
                    moved[k].1 += h;
                    self.g.evaluate(&[e], &moved)[0]
                };
                (at(1e-5) - at(-1e-5)) / 2e-5
            };
            found.iter().enumerate().map(|(k, d)| (d - slope(k)).abs()).fold(0.0, f64::max)
        }
    }

    /// First and second derivatives of a trace by entries, weights and exponents, backwards and forwards, agree with
    /// differences: where eigenvalues differ, where two are equal, and at the identity.
    #[test]
    fn powers_are_differentiated_where_eigenvalues_meet() {
        let mut case = case();
        let variables = case.variables();
        let (matrix, terms) = (case.matrix, case.terms.clone());
        let trace = case.g.power_trace(&matrix, &terms);
        let slopes = case.g.gradient(trace, &variables);
        for (k, &slope) in slopes.iter().enumerate() {
            assert_eq!(case.g.derivative(trace, variables[k]), slope, "{k}: both ways are one");
        }
        for m in AT {
            assert!(case.error(trace, &slopes, m) < 1e-8, "{m:?}");
            for &slope in &slopes[..6] {
                let forwards: Vec<Expr> = variables.iter().map(|&v| case.g.derivative(slope, v)).collect();
                assert!(case.error(slope, &forwards, m) < 1e-8, "{m:?}: forwards");
                let backwards = case.g.gradient(slope, &variables);
                assert!(case.error(slope, &backwards, m) < 1e-8, "{m:?}: backwards");
            }
        }
    }

    /// Where eigenvalues differ, they, their vectors and thus powers have derivatives of any order.
    #[test]
    fn eigenvalues_and_vectors_are_differentiated_where_they_differ() {
        let mut case = case();
        let variables = case.variables();
        let matrix = case.matrix;
        let mut expressions = Vec::new();
        for a in 0..3 {
            expressions.push(case.g.eigenvalue(&matrix, a));
            expressions.extend((0..3).map(|row| case.g.eigenvector(&matrix, row, a)).collect::<Vec<_>>());
        }
        let terms = case.terms.clone();
        let entry = case.g.power_entry((0, 2), &matrix, &terms);
        let second = case.g.derivative(entry, matrix[3]);
        expressions.push(second);
        for e in expressions {
            let gradient = case.g.gradient(e, &variables);
            assert!(case.error(e, &gradient, AT[0]) < 1e-7);
        }
    }

    /// A whole power is the product.
    #[test]
    fn whole_powers_are_products() {
        let mut case = case();
        let (two, one) = (case.g.int(2), case.g.int(1));
        let matrix = case.matrix;
        for m in AT {
            let full = |i: usize, j: usize| m[PLACE[i][j]];
            for (i, j) in [(0, 0), (0, 1), (2, 1), (2, 2)] {
                let entry = case.g.power_entry((i, j), &matrix, &[(one, two)]);
                let expected: f64 = (0..3).map(|k| full(i, k) * full(k, j)).sum();
                let found = case.g.evaluate(&[entry], &case.values(m))[0];
                assert!((found - expected).abs() < 1e-14, "{m:?} {i}{j}: {found} instead of {expected}");
            }
        }
    }
}
