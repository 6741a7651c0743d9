//! Two-operand nodes, hash-consed: the form between n-ary expressions and programs.
//!
//! The order of evaluation is decided here (see [`associate`](crate::associate)), the time and place of it are not yet.

use souple_symbols::{Expr, Time};
use std::collections::HashMap;

/// A node of a [`Dag`]; operands have smaller indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Ref(pub u32);

impl Ref {
    /// Position in the dag.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// What a node computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Operation {
    /// A constant, by its bits.
    Constant(u64),
    /// A leaf of the expression graph.
    Leaf(Expr),
    /// A table of the expression graph: one constant per point.
    Table(u32),
    /// `a + b`, operands ordered.
    Add(Ref, Ref),
    /// `a − b`.
    Sub(Ref, Ref),
    /// `a · b`, operands ordered.
    Mul(Ref, Ref),
    /// `−a`.
    Neg(Ref),
    /// `1 / a`.
    Recip(Ref),
    /// `√a`.
    Sqrt(Ref),
    /// `ln a`.
    Ln(Ref),
    /// `eᵃ`.
    Exp(Ref),
    /// `aᵇ`.
    Pow(Ref, Ref),
    /// Sum over the points.
    PointSum(Ref),
}

impl Operation {
    /// Operands, in order.
    pub fn operands(self) -> impl Iterator<Item = Ref> {
        use Operation::*;
        let pair = match self {
            Constant(_) | Leaf(_) | Table(_) => [None, None],
            Neg(a) | Recip(a) | Sqrt(a) | Ln(a) | Exp(a) | PointSum(a) => [Some(a), None],
            Add(a, b) | Sub(a, b) | Mul(a, b) | Pow(a, b) => [Some(a), Some(b)],
        };
        pair.into_iter().flatten()
    }

    /// Arithmetic operations that it costs.
    pub fn cost(self) -> u64 {
        use Operation::*;
        match self {
            Constant(_) | Leaf(_) | Table(_) => 0,
            Add(..) | Sub(..) | Mul(..) | Neg(_) | PointSum(_) => 1,
            // Division and roots have a tenth of the throughput of a product on the processors at hand; the
            // transcendental functions less.
            Recip(_) | Sqrt(_) => 8,
            Ln(_) | Exp(_) => 20,
            Pow(..) => 45,
        }
    }
}

/// A node with what is known of it.
#[derive(Clone, Copy, Debug)]
pub struct DagNode {
    /// What it computes.
    pub operation: Operation,
    /// Latest binding time of its leaves.
    pub time: Time,
    /// Whether it has one value per point.
    pub varying: bool,
}

/// Hash-consed nodes over the points of one expression graph.
#[derive(Clone, Debug, Default)]
pub struct Dag {
    nodes: Vec<DagNode>,
    found: HashMap<Operation, Ref>,
    /// Number of points of tables and point sums.
    pub points: usize,
    /// Table values, [table][point].
    pub tables: Vec<Vec<f64>>,
}

impl Dag {
    /// An empty dag over this many points.
    pub fn with_points(points: usize) -> Dag {
        Dag { points, ..Dag::default() }
    }

    /// Everything known of a node.
    pub fn node(&self, r: Ref) -> &DagNode {
        &self.nodes[r.index()]
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no node.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// A leaf with its declared time.
    pub fn leaf(&mut self, operation: Operation, time: Time, varying: bool) -> Ref {
        self.intern(DagNode { operation, time, varying })
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> Ref {
        self.leaf(Operation::Constant(value.to_bits()), Time::Derive, false)
    }

    /// A constant for each point; a column without variation is a constant.
    pub fn table(&mut self, values: &[f64]) -> Ref {
        if values.iter().all(|v| v.to_bits() == values[0].to_bits()) {
            return self.constant(values[0]);
        }
        let same = |t: &Vec<f64>| t.iter().zip(values).all(|(a, b)| a.to_bits() == b.to_bits());
        let id = self.tables.iter().position(same).unwrap_or_else(|| {
            self.tables.push(values.to_vec());
            self.tables.len() - 1
        });
        let id = u32::try_from(id).expect("a dag has less than 2³² tables");
        self.leaf(Operation::Table(id), Time::Derive, true)
    }

    /// Value of a node of time `Derive` at a point.
    fn folded(&self, r: Ref, point: usize) -> f64 {
        use Operation::*;
        match self.node(r).operation {
            Constant(bits) => f64::from_bits(bits),
            Table(t) => self.tables[t as usize][point],
            other => unreachable!("{other:?} of time Derive was folded when it was made"),
        }
    }

    /// A node over existing ones; folded where everything in it is known.
    pub fn add(&mut self, operation: Operation) -> Ref {
        if operation.operands().all(|o| self.node(o).time == Time::Derive) {
            use Operation::*;
            let points = if operation.operands().any(|o| self.node(o).varying) { self.points } else { 1 };
            let mut values: Vec<f64> = (0..points)
                .map(|q| {
                    let v = |r| self.folded(r, q);
                    match operation {
                        Constant(_) | Leaf(_) | Table(_) => unreachable!("leaves are made by `leaf`"),
                        Add(a, b) => v(a) + v(b),
                        Sub(a, b) => v(a) - v(b),
                        Mul(a, b) => v(a) * v(b),
                        Neg(a) => -v(a),
                        Recip(a) => 1.0 / v(a),
                        Sqrt(a) => v(a).sqrt(),
                        Ln(a) => v(a).ln(),
                        Exp(a) => v(a).exp(),
                        Pow(a, b) => v(a).powf(v(b)),
                        PointSum(a) => v(a),
                    }
                })
                .collect();
            if matches!(operation, PointSum(_)) {
                values = vec![values.iter().sum()];
            }
            return if points > 1 && values.len() > 1 { self.table(&values) } else { self.constant(values[0]) };
        }
        let operation = match operation {
            Operation::Add(a, b) if a > b => Operation::Add(b, a),
            Operation::Mul(a, b) if a > b => Operation::Mul(b, a),
            other => other,
        };
        let mut node = DagNode { operation, time: Time::Derive, varying: false };
        for o in operation.operands() {
            node.time = node.time.max(self.node(o).time);
            node.varying |= self.node(o).varying;
        }
        if matches!(operation, Operation::PointSum(_)) {
            node.varying = false;
        }
        self.intern(node)
    }

    fn intern(&mut self, node: DagNode) -> Ref {
        if let Some(&r) = self.found.get(&node.operation) {
            return r;
        }
        let r = Ref(u32::try_from(self.nodes.len()).expect("a dag has less than 2³² nodes"));
        self.nodes.push(node);
        self.found.insert(node.operation, r);
        r
    }

    /// The nodes that `roots` need, operands first, not looking behind those for which `stop` holds.
    pub fn needed(&self, roots: &[Ref], stop: impl Fn(Ref) -> bool) -> Vec<Ref> {
        let mut seen = vec![false; self.len()];
        let mut stack = roots.to_vec();
        while let Some(r) = stack.pop() {
            if !std::mem::replace(&mut seen[r.index()], true) && !stop(r) {
                stack.extend(self.node(r).operation.operands());
            }
        }
        (0..self.len() as u32).map(Ref).filter(|r| seen[r.index()]).collect()
    }
}
