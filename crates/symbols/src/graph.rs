//! The graph: nodes, hash-consing, and the normal form that makes equal expressions the same node.

use crate::Number;
use crate::root::{Equation, RootId};
use std::collections::HashMap;

/// A value of the graph. Operands always have smaller indices than the nodes that use them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Expr(pub(crate) u32);

impl Expr {
    /// Position in the graph; operands come before the nodes that use them.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// When a value is known: the binding time of a leaf is declared, that of a node is the latest of its operands'.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Time {
    /// While deriving: constants.
    Derive,
    /// Once, before the first step.
    Setup,
    /// Once per evaluation of the state.
    Step,
    /// Once per product with a direction, many times per step.
    Apply,
}

/// A function that is neither a sum nor a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// Square root.
    Sqrt,
    /// Natural logarithm.
    Ln,
    /// Exponential.
    Exp,
    /// First operand to the power of the second.
    Pow,
    /// r₁ + r₂ + r₃ for the numbers with a = r₁² + r₂² + r₃², b = r₁²r₂² + r₂²r₃² + r₃²r₁² and c = r₁r₂r₃, at most one
    /// of which is negative, the smallest: the trace of the square root of a symmetric matrix from its invariants.
    ///
    /// It is the largest root s of s⁴ − 2a s² − 8c s + a² − 4b (Hoger and Carlson 1984), and smooth
    /// wherever no two of the numbers cancel.
    RootSum,
    /// sinh(x)/x, one at zero. Its derivative is written for other x only.
    Sinhc,
    /// The `a`-th eigenvalue of a symmetric 3 × 3 matrix, in no particular order. Operands: entries 11, 22, 33, 12, 23, 31.
    ///
    /// Its derivative holds for eigenvalues that are not repeated.
    Eigenvalue(u8),
    /// Component `row` of the unit eigenvector for the `a`-th eigenvalue: (row, a). Operands as those of the eigenvalue.
    ///
    /// Its derivative holds where all eigenvalues differ.
    Eigenvector(u8, u8),
    /// `tr Σ_p c_p M^(q_p)`: see [`Graph::power_trace`]. Operands: the value written out, six entries, then each c_p and
    /// q_p.
    PowerTrace,
    /// Entry (i, j) of `Σ_p c_p M^(q_p − s)`: (i, j, s). Operands as those of the trace.
    PowerEntry(u8, u8, u8),
    /// The root of an equation: the first operand is its value, the others what it depends on; see [`Graph::root`].
    Root(RootId),
}

/// What a node is. Read it through [`Graph::node`]; build nodes only through the graph's functions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A constant.
    Constant(Number),
    /// A leaf; its name and time are in [`Graph::symbol_name`] and [`Graph::time`].
    Symbol(u32),
    /// A constant for each point: values by [`Graph::table_values`].
    Table(u32),
    /// `constant + Σ coefficient · term`; at least two summands, terms in increasing order, each once.
    Sum(Number, Box<[(Number, Expr)]>),
    /// `coefficient · Π factor^exponent`, factors in increasing order, each once, no exponent zero, and no factor is
    /// itself a product.
    Product(Number, Box<[(Expr, i32)]>),
    /// A function of other nodes.
    Function(Function, Box<[Expr]>),
    /// The sum over all points of an operand that varies over them.
    PointSum(Expr),
    /// Another node under a name ([`Graph::symbol_name`]): the same value, but sums and products do not look into it.
    Named(u32, Expr),
}

/// A summand: coefficient and node.
type Term = (Number, Expr);
/// A factor: node and exponent.
type Power = (Expr, i32);

#[derive(Clone, Copy, Debug)]
struct Facts {
    time: Time,
    varying: bool,
}

/// A shared graph of expressions.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    nodes: Vec<Node>,
    facts: Vec<Facts>,
    found: HashMap<Node, Expr>,
    symbols: Vec<String>,
    names: HashMap<Expr, Expr>,
    tables: Vec<Box<[f64]>>,
    pub(crate) equations: Vec<Equation>,
    points: usize,
}

impl Graph {
    /// An empty graph without points.
    pub fn new() -> Graph {
        Graph::default()
    }

    /// An empty graph whose tables and point sums run over `points` points.
    pub fn with_points(points: usize) -> Graph {
        Graph { points, ..Graph::default() }
    }

    /// Number of points of every [`Graph::table`] and [`Graph::point_sum`].
    pub fn points(&self) -> usize {
        self.points
    }

    /// What a node is.
    pub fn node(&self, e: Expr) -> &Node {
        &self.nodes[e.index()]
    }

    /// Number of nodes made so far.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether nothing was built yet.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Binding time of a node.
    pub fn time(&self, e: Expr) -> Time {
        self.facts[e.index()].time
    }

    /// Whether a node's value differs from point to point.
    pub fn varies(&self, e: Expr) -> bool {
        self.facts[e.index()].varying
    }

    /// The name under which a symbol was made.
    pub fn symbol_name(&self, symbol: u32) -> &str {
        &self.symbols[symbol as usize]
    }

    /// The values of a table, one per point.
    pub fn table_values(&self, table: u32) -> &[f64] {
        &self.tables[table as usize]
    }

    /// The constant value of a node, if it is one.
    pub fn constant(&self, e: Expr) -> Option<Number> {
        match self.node(e) {
            Node::Constant(c) => Some(*c),
            _ => None,
        }
    }

    /// Operands of a node, in order.
    pub fn operands(&self, e: Expr) -> Vec<Expr> {
        match self.node(e) {
            Node::Constant(_) | Node::Symbol(_) | Node::Table(_) => Vec::new(),
            Node::Sum(_, terms) => terms.iter().map(|t| t.1).collect(),
            Node::Product(_, factors) => factors.iter().map(|f| f.0).collect(),
            Node::Function(_, operands) => operands.to_vec(),
            Node::PointSum(e) | Node::Named(_, e) => vec![*e],
        }
    }

    /// Operands that a node is differentiated through: all, but of roots and of powers of matrices not the
    /// value written out.
    pub(crate) fn variables(&self, e: Expr) -> Vec<Expr> {
        let operands = self.operands(e);
        match self.node(e) {
            Node::Function(Function::PowerTrace | Function::PowerEntry(..) | Function::Root(_), _) => {
                operands[1..].to_vec()
            }
            _ => operands,
        }
    }

    fn intern(&mut self, node: Node, facts: Facts) -> Expr {
        if let Some(&e) = self.found.get(&node) {
            return e;
        }
        let e = Expr(u32::try_from(self.nodes.len()).expect("a graph has less than 2³² nodes"));
        self.nodes.push(node.clone());
        self.facts.push(facts);
        self.found.insert(node, e);
        e
    }

    fn facts_of(&self, operands: impl Iterator<Item = Expr>) -> Facts {
        operands.fold(Facts { time: Time::Derive, varying: false }, |facts, e| {
            let f = self.facts[e.index()];
            Facts { time: facts.time.max(f.time), varying: facts.varying || f.varying }
        })
    }

    /// A new leaf known from `time` on; two leaves are never the same, even with the same name.
    pub fn symbol(&mut self, name: impl Into<String>, time: Time) -> Expr {
        self.leaf(name.into(), Facts { time, varying: false })
    }

    /// A new leaf with one value per point.
    pub fn varying_symbol(&mut self, name: impl Into<String>, time: Time) -> Expr {
        self.leaf(name.into(), Facts { time, varying: true })
    }

    fn leaf(&mut self, name: String, facts: Facts) -> Expr {
        let id = u32::try_from(self.symbols.len()).expect("a graph has less than 2³² symbols");
        self.symbols.push(name);
        self.intern(Node::Symbol(id), facts)
    }

    /// A constant.
    pub fn number(&mut self, value: Number) -> Expr {
        let value = if value.is_zero() { Number::ZERO } else { value };
        self.intern(Node::Constant(value), Facts { time: Time::Derive, varying: false })
    }

    /// A constant integer.
    pub fn int(&mut self, value: i64) -> Expr {
        self.number(Number::Rational(value, 1))
    }

    /// The exact constant `n / d`.
    pub fn rational(&mut self, n: i64, d: i64) -> Expr {
        self.number(Number::rational(n, d))
    }

    /// A floating-point constant.
    pub fn real(&mut self, value: f64) -> Expr {
        self.number(Number::from_f64(value))
    }

    /// A constant per point. Equal columns, and columns that differ in sign only, are shared; a column without
    /// variation is a constant.
    ///
    /// # Panics
    /// When the number of values is not the graph's number of points.
    pub fn table(&mut self, values: &[f64]) -> Expr {
        assert_eq!(values.len(), self.points, "a table has one value per point");
        if values.iter().all(|v| v.to_bits() == values[0].to_bits()) {
            return self.real(values[0]);
        }
        let first = values.iter().copied().find(|v| *v != 0.0).unwrap_or(1.0);
        let sign = if first < 0.0 { -1.0 } else { 1.0 };
        // `+ 0.0` makes −0 and 0 the same column.
        let values: Box<[f64]> = values.iter().map(|v| sign * v + 0.0).collect();
        let known = self.tables.iter().position(|t| t.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()));
        let id = known.unwrap_or_else(|| {
            self.tables.push(values);
            self.tables.len() - 1
        });
        let id = u32::try_from(id).expect("a graph has less than 2³² tables");
        let table = self.intern(Node::Table(id), Facts { time: Time::Derive, varying: true });
        if sign < 0.0 { self.neg(table) } else { table }
    }

    /// `Σ terms`.
    pub fn sum(&mut self, terms: &[Expr]) -> Expr {
        let terms: Vec<(Number, Expr)> = terms.iter().map(|&t| (Number::ONE, t)).collect();
        self.linear(&terms)
    }

    /// `a + b`.
    pub fn add(&mut self, a: Expr, b: Expr) -> Expr {
        self.linear(&[(Number::ONE, a), (Number::ONE, b)])
    }

    /// `a − b`.
    pub fn sub(&mut self, a: Expr, b: Expr) -> Expr {
        self.linear(&[(Number::ONE, a), (Number::MINUS_ONE, b)])
    }

    /// `−a`.
    pub fn neg(&mut self, a: Expr) -> Expr {
        self.scale(Number::MINUS_ONE, a)
    }

    /// `c · a`.
    pub fn scale(&mut self, c: Number, a: Expr) -> Expr {
        self.scaled_powers(c, &[(a, 1)])
    }

    /// `a · b`.
    pub fn mul(&mut self, a: Expr, b: Expr) -> Expr {
        self.scaled_powers(Number::ONE, &[(a, 1), (b, 1)])
    }

    /// `a / b`.
    pub fn div(&mut self, a: Expr, b: Expr) -> Expr {
        self.scaled_powers(Number::ONE, &[(a, 1), (b, -1)])
    }

    /// `a` to an integer power.
    pub fn powi(&mut self, a: Expr, exponent: i32) -> Expr {
        self.scaled_powers(Number::ONE, &[(a, exponent)])
    }

    /// `Π factors`.
    pub fn product(&mut self, factors: &[Expr]) -> Expr {
        let factors: Vec<(Expr, i32)> = factors.iter().map(|&f| (f, 1)).collect();
        self.scaled_powers(Number::ONE, &factors)
    }

    /// `Σ coefficient · term`, in normal form.
    ///
    /// Like terms are merged. A nested sum is opened only where that makes terms cancel, or where it is a node plus a
    /// constant: anything else would lose the sharing of the nested sum. A factor that every term has is taken out if
    /// that saves a multiplication at the time at which the sum is computed.
    pub fn linear(&mut self, input: &[(Number, Expr)]) -> Expr {
        let (scale, e) = self.scaled_linear(input, Scale::KeepWhereFree);
        self.scale(scale, e)
    }

    /// As [`Graph::linear`], as a constant times a node, so that the caller can join the constant with others.
    pub(crate) fn linear_with_scale(&mut self, input: &[(Number, Expr)]) -> (Number, Expr) {
        self.scaled_linear(input, Scale::TakeOut)
    }

    fn scaled_linear(&mut self, input: &[(Number, Expr)], style: Scale) -> (Number, Expr) {
        let mut constant = Number::ZERO;
        let mut terms: Vec<(Number, Expr)> = Vec::with_capacity(input.len());
        for &(c, e) in input {
            self.collect_term(c, e, &mut constant, &mut terms);
        }
        merge(&mut terms);
        while let Some(at) = self.cancelling_sum(&terms) {
            let (c, e) = terms.remove(at);
            let Node::Sum(inner, nested) = self.node(e).clone() else { unreachable!("cancelling_sum finds sums") };
            constant = constant + c * inner;
            for &(k, t) in nested.iter() {
                self.collect_term(c * k, t, &mut constant, &mut terms);
            }
            merge(&mut terms);
        }
        if terms.is_empty() {
            return (Number::ONE, self.number(constant));
        }
        if constant.is_zero() {
            if let [(c, e)] = terms[..] {
                return (c, e);
            }
            if let Some((common, rest)) = self.common_factors(&terms) {
                let (scale, inner) = self.scaled_linear(&rest, style);
                let mut factors = common;
                factors.push((inner, 1));
                return (scale, self.scaled_powers(Number::ONE, &factors));
            }
        }
        self.primitive_sum(constant, terms, style)
    }

    /// Splits `e` into coefficient and node, and opens what may always be opened.
    fn collect_term(&self, c: Number, e: Expr, constant: &mut Number, terms: &mut Vec<(Number, Expr)>) {
        match self.node(e) {
            Node::Constant(k) => *constant = *constant + c * *k,
            Node::Product(k, factors) if !k.is_one() => {
                // A coefficient times one node is the node's term; times several, the product without coefficient
                // was interned when this product was made.
                let bare = if let [(f, 1)] = factors[..] {
                    f
                } else {
                    *self
                        .found
                        .get(&Node::Product(Number::ONE, factors.clone()))
                        .expect("`scaled_powers` interns the bare product first")
                };
                self.collect_term(c * *k, bare, constant, terms);
            }
            Node::Sum(inner, nested) if nested.len() == 1 => {
                *constant = *constant + c * *inner;
                terms.push((c * nested[0].0, nested[0].1));
            }
            _ => terms.push((c, e)),
        }
    }

    /// A nested sum one of whose terms vanishes when it is opened.
    fn cancelling_sum(&self, terms: &[(Number, Expr)]) -> Option<usize> {
        terms.iter().enumerate().position(|(at, &(c, e))| {
            let Node::Sum(_, nested) = self.node(e) else { return false };
            nested.iter().any(|&(k, t)| {
                terms.iter().enumerate().any(|(other, &(d, u))| {
                    if other == at {
                        return false;
                    }
                    if u == t {
                        return (c * k + d).is_zero();
                    }
                    match self.node(u) {
                        Node::Sum(_, inner) => inner.iter().any(|&(l, v)| v == t && (c * k + d * l).is_zero()),
                        _ => false,
                    }
                })
            })
        })
    }

    /// Factors that all terms share, and the terms without them.
    fn common_factors(&mut self, terms: &[Term]) -> Option<(Vec<Power>, Vec<Term>)> {
        let powers = |g: &Graph, e: Expr| -> Vec<(Expr, i32)> {
            match g.node(e) {
                Node::Product(_, factors) => factors.to_vec(),
                _ => vec![(e, 1)],
            }
        };
        let mut common = powers(self, terms[0].1);
        for &(_, e) in &terms[1..] {
            let here = powers(self, e);
            common.retain_mut(|(f, n)| match here.iter().find(|(h, _)| h == f) {
                Some(&(_, m)) if m.signum() == n.signum() => {
                    *n = n.signum() * n.abs().min(m.abs());
                    true
                }
                _ => false,
            });
            if common.is_empty() {
                return None;
            }
        }
        // A factor known earlier than a term costs that term nothing if the term has another factor known as early:
        // the two are multiplied then. Taking it out would move a multiplication to the later time.
        common.retain(|&(f, _)| {
            let costly = |&&(_, e): &&(Number, Expr)| {
                let others = powers(self, e).into_iter().filter(|o| o.0 != f);
                self.time(f) == self.time(e) || others.into_iter().all(|(o, _)| self.time(o) > self.time(f))
            };
            terms.iter().filter(costly).count() >= 2
        });
        if common.is_empty() {
            return None;
        }
        let inverse: Vec<(Expr, i32)> = common.iter().map(|&(f, n)| (f, -n)).collect();
        let rest = terms
            .iter()
            .map(|&(c, e)| {
                let mut factors = powers(self, e);
                factors.extend(&inverse);
                (c, self.scaled_powers(Number::ONE, &factors))
            })
            .collect();
        Some((common, rest))
    }

    /// Interns a sum after taking out the scale that most terms share, so that sums that differ by a factor are one
    /// node; a scale that two terms or more can multiply into a factor known earlier stays inside.
    /// The sign is kept as written unless the opposite sum exists already: then that one is used.
    fn primitive_sum(&mut self, constant: Number, mut terms: Vec<(Number, Expr)>, style: Scale) -> (Number, Expr) {
        let magnitudes: Vec<Number> = terms.iter().map(|t| t.0.abs()).collect();
        let mut scale = magnitudes[0];
        let mut best = 0;
        for &m in &magnitudes {
            let count = magnitudes.iter().filter(|&&n| n == m).count();
            // At equal counts: one, which costs nothing; else the larger, which what follows halves or divides.
            let better = !scale.is_one() && (m.is_one() || m > scale);
            if count > best || (count == best && better) {
                (scale, best) = (m, count);
            }
        }
        if style == Scale::KeepWhereFree && self.absorbs_scale(&terms) {
            scale = Number::ONE;
        }
        let inverse = scale.recip().expect("terms with coefficient zero were merged away");
        for (c, _) in &mut terms {
            *c = *c * inverse;
        }
        let constant = constant * inverse;
        let negated: Box<[(Number, Expr)]> = terms.iter().map(|&(c, e)| (-c, e)).collect();
        if let Some(&opposite) = self.found.get(&Node::Sum(-constant, negated)) {
            return (-scale, opposite);
        }
        let facts = self.facts_of(terms.iter().map(|t| t.1));
        (scale, self.intern(Node::Sum(constant, terms.into()), facts))
    }

    /// `factor · e`, multiplied into each term if `e` is a sum: for a factor that each term can join with its own.
    pub fn multiply_through(&mut self, factor: Expr, e: Expr) -> Expr {
        let (scale, sum) = match self.node(e) {
            Node::Product(c, factors) if factors.len() == 1 && factors[0].1 == 1 => (*c, factors[0].0),
            _ => (Number::ONE, e),
        };
        let Node::Sum(constant, terms) = self.node(sum).clone() else { return self.mul(factor, e) };
        let mut products: Vec<(Number, Expr)> = vec![(scale * constant, factor)];
        for &(k, t) in terms.iter() {
            products.push((scale * k, self.mul(factor, t)));
        }
        self.linear(&products)
    }

    /// Whether a constant times this sum costs nothing: all terms, but at most one, have a factor known before the sum
    /// is, which takes the constant in.
    fn absorbs_scale(&self, terms: &[(Number, Expr)]) -> bool {
        let time = terms.iter().map(|t| self.time(t.1)).max().unwrap_or(Time::Derive);
        let absorbs = |e: Expr| match self.node(e) {
            Node::Product(_, factors) => factors.iter().any(|f| self.time(f.0) < time),
            _ => self.time(e) < time,
        };
        let absorbed = terms.iter().filter(|t| absorbs(t.1)).count();
        absorbed > 0 && absorbed + 1 >= terms.len()
    }

    /// `c · Π factor^exponent`, in normal form. Products are always opened: what is shared inside them is found again
    /// when they are put in an order of evaluation.
    pub fn scaled_powers(&mut self, c: Number, input: &[(Expr, i32)]) -> Expr {
        let mut coefficient = c;
        let mut factors: Vec<(Expr, i32)> = Vec::with_capacity(input.len());
        for &(e, n) in input {
            match self.node(e) {
                // Zero to a negative power stays a factor, and becomes an infinity when evaluated.
                Node::Constant(k) if k.powi(n).is_some() => {
                    coefficient = coefficient * k.powi(n).expect("checked by the guard");
                }
                Node::Product(k, nested) if k.powi(n).is_some() => {
                    coefficient = coefficient * k.powi(n).expect("checked by the guard");
                    factors.extend(nested.iter().map(|&(f, m)| (f, m * n)));
                }
                _ => factors.push((e, n)),
            }
        }
        factors.sort_by_key(|f| f.0);
        factors.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        factors.retain(|f| f.1 != 0);
        if coefficient.is_zero() {
            return self.number(Number::ZERO);
        }
        if factors.is_empty() {
            return self.number(coefficient);
        }
        let bare = if let [(f, 1)] = factors[..] {
            f
        } else {
            let facts = self.facts_of(factors.iter().map(|f| f.0));
            self.intern(Node::Product(Number::ONE, factors.clone().into()), facts)
        };
        if coefficient.is_one() {
            return bare;
        }
        let facts = self.facts[bare.index()];
        self.intern(Node::Product(coefficient, factors.into()), facts)
    }

    /// Square root.
    pub fn sqrt(&mut self, a: Expr) -> Expr {
        self.function(Function::Sqrt, &[a])
    }

    /// Natural logarithm.
    pub fn ln(&mut self, a: Expr) -> Expr {
        self.function(Function::Ln, &[a])
    }

    /// Exponential.
    pub fn exp(&mut self, a: Expr) -> Expr {
        self.function(Function::Exp, &[a])
    }

    /// `a` to the power `exponent`; integer constants become products.
    pub fn pow(&mut self, a: Expr, exponent: Expr) -> Expr {
        match self.constant(exponent) {
            Some(Number::Rational(n, 1)) if n.abs() <= 16 => self.powi(a, n as i32),
            Some(Number::Rational(1, 2)) => self.sqrt(a),
            _ => self.function(Function::Pow, &[a, exponent]),
        }
    }

    /// A function of its operands; exact values at the usual constants are folded.
    pub fn function(&mut self, function: Function, operands: &[Expr]) -> Expr {
        let folded = match (function, self.constant(operands[0])) {
            (Function::Sqrt, Some(c)) if c.is_one() || c.is_zero() => Some(c),
            (Function::Ln, Some(c)) if c.is_one() => Some(Number::ZERO),
            (Function::Exp, Some(c)) if c.is_zero() => Some(Number::ONE),
            (Function::Pow, Some(c)) if c.is_one() => Some(Number::ONE),
            (Function::Sinhc, Some(c)) if c.is_zero() => Some(Number::ONE),
            _ => None,
        };
        if let Some(value) = folded {
            return self.number(value);
        }
        let facts = self.facts_of(operands.iter().copied());
        self.intern(Node::Function(function, operands.into()), facts)
    }

    /// `Σ over the points of e`. Factors that do not vary are taken out.
    pub fn point_sum(&mut self, e: Expr) -> Expr {
        if !self.varies(e) {
            let count = i64::try_from(self.points).expect("points are few");
            return self.scale(Number::Rational(count, 1), e);
        }
        if let Node::Product(c, factors) = self.node(e).clone() {
            let (inside, outside): (Vec<_>, Vec<_>) = factors.iter().partition(|f| self.varies(f.0));
            if !outside.is_empty() || !c.is_one() {
                let inside = self.scaled_powers(Number::ONE, &inside);
                let sum = self.point_sum(inside);
                let mut factors = outside;
                factors.push((sum, 1));
                return self.scaled_powers(c, &factors);
            }
        }
        let time = self.time(e);
        self.intern(Node::PointSum(e), Facts { time, varying: false })
    }

    /// `e` under a name: a quantity that is worth keeping together, and worth showing to a reader.
    ///
    /// Sums and products do not open it, so it is computed once and its factors do not cancel with others.
    /// Constants and leaves are returned as they are.
    pub fn named(&mut self, name: impl Into<String>, e: Expr) -> Expr {
        if matches!(self.node(e), Node::Constant(_) | Node::Symbol(_) | Node::Table(_) | Node::Named(..)) {
            return e;
        }
        if let Some(&known) = self.names.get(&e) {
            return known;
        }
        let id = u32::try_from(self.symbols.len()).expect("a graph has less than 2³² symbols");
        self.symbols.push(name.into());
        let facts = self.facts[e.index()];
        let named = self.intern(Node::Named(id, e), facts);
        self.names.insert(e, named);
        named
    }

    /// The nodes that `roots` depend on, themselves included, operands first.
    pub fn reachable(&self, roots: &[Expr]) -> Vec<Expr> {
        self.reachable_through(roots, Graph::operands)
    }

    /// The same, following those operands only that `operands` gives.
    pub(crate) fn reachable_through(&self, roots: &[Expr], operands: fn(&Graph, Expr) -> Vec<Expr>) -> Vec<Expr> {
        let mut seen = vec![false; self.len()];
        let mut stack: Vec<Expr> = roots.to_vec();
        while let Some(e) = stack.pop() {
            if !std::mem::replace(&mut seen[e.index()], true) {
                stack.extend(operands(self, e));
            }
        }
        (0..self.len()).filter(|&i| seen[i]).map(|i| Expr(i as u32)).collect()
    }

    /// Rebuilds `roots` with some nodes replaced, simplifying on the way up.
    pub fn substitute(&mut self, roots: &[Expr], replaced: &[(Expr, Expr)]) -> Vec<Expr> {
        let mut map: HashMap<Expr, Expr> = replaced.iter().copied().collect();
        for e in self.reachable(roots) {
            if map.contains_key(&e) {
                continue;
            }
            let new = match self.node(e).clone() {
                Node::Constant(_) | Node::Symbol(_) | Node::Table(_) => e,
                Node::Sum(c, terms) => {
                    let mut terms: Vec<(Number, Expr)> = terms.iter().map(|&(k, t)| (k, map[&t])).collect();
                    let constant = self.number(c);
                    terms.push((Number::ONE, constant));
                    self.linear(&terms)
                }
                Node::Product(c, factors) => {
                    let factors: Vec<(Expr, i32)> = factors.iter().map(|&(f, n)| (map[&f], n)).collect();
                    self.scaled_powers(c, &factors)
                }
                Node::Function(f, operands) => {
                    let operands: Vec<Expr> = operands.iter().map(|o| map[o]).collect();
                    if f == Function::Pow { self.pow(operands[0], operands[1]) } else { self.function(f, &operands) }
                }
                Node::PointSum(o) => self.point_sum(map[&o]),
                Node::Named(name, o) => {
                    let name = self.symbol_name(name).to_string();
                    self.named(name, map[&o])
                }
            };
            map.insert(e, new);
        }
        roots.iter().map(|r| map[r]).collect()
    }
}

/// What to do with the scale that the terms of a sum share.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Scale {
    /// Give it back apart.
    TakeOut,
    /// Leave it in the sum if its terms have factors of an earlier time that take it in.
    KeepWhereFree,
}

/// Sorts terms by node and adds the coefficients of equal ones.
fn merge(terms: &mut Vec<(Number, Expr)>) {
    terms.sort_by_key(|t| t.1);
    terms.dedup_by(|next, kept| {
        let same = next.1 == kept.1;
        if same {
            kept.0 = kept.0 + next.0;
        }
        same
    });
    terms.retain(|t| !t.0.is_zero());
}
