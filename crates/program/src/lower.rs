//! From dag nodes to a program: sections and loops, order of statements, fused multiply-adds, accumulators.
//!
//! Values that do not vary are computed once; values that vary are computed in a loop over the points, as late as the
//! accumulators and outputs that need them allow.
//! A node that needs the result of a point sum comes after that sum's loop; a varying node that is needed in two loops
//! is computed in both.
//!
//! Order inside a section: depth first from what must be produced, so that few values are alive at a time.

use crate::{Buffer, Dag, Op, Operation, Program, Ref, Section, Statement, Value};
use std::collections::HashMap;

/// Where a node's value is read instead of being computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Number of the input buffer.
    pub buffer: usize,
    /// Place in it.
    pub index: usize,
}

/// Where a node's value is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// Number of the output buffer.
    pub buffer: usize,
    /// Place in it.
    pub index: usize,
}

/// Makes the program that reads `sources` and writes `targets`.
///
/// # Panics
/// When a leaf is needed that no source gives: the caller's list of sources is complete or it is a bug.
pub fn lower(
    dag: &Dag,
    name: &str,
    inputs: Vec<Buffer>,
    sources: &[(Ref, Source)],
    outputs: Vec<Buffer>,
    targets: &[(Ref, Target)],
) -> Program {
    let sources: HashMap<Ref, Source> = sources.iter().copied().collect();
    let roots: Vec<Ref> = targets.iter().map(|t| t.0).collect();
    let needed = dag.needed(&roots, |r| sources.contains_key(&r));
    let mut lowering = Lowering {
        dag,
        sources: &sources,
        level: vec![0; dag.len()],
        uses: vec![0; dag.len()],
        values: HashMap::new(),
        looped: HashMap::new(),
        accumulators: HashMap::new(),
        tables: Vec::new(),
        table_numbers: HashMap::new(),
        next: 0,
    };
    for &r in &needed {
        if sources.contains_key(&r) {
            continue;
        }
        let operation = dag.node(r).operation;
        let mut level = 0;
        for o in operation.operands() {
            level = level.max(lowering.level[o.index()]);
            lowering.uses[o.index()] += 1;
        }
        lowering.level[r.index()] = level + usize::from(matches!(operation, Operation::PointSum(_)));
    }
    for r in &roots {
        lowering.uses[r.index()] += 1;
    }
    let last = needed.iter().map(|r| lowering.level[r.index()]).max().unwrap_or(0);
    let mut sections = Vec::new();
    for level in 0..=last {
        let sums: Vec<Ref> = needed
            .iter()
            .copied()
            .filter(|&r| {
                !sources.contains_key(&r)
                    && matches!(dag.node(r).operation, Operation::PointSum(_))
                    && lowering.level[r.index()] == level + 1
            })
            .collect();
        let point_targets: Vec<(Ref, Target)> = targets
            .iter()
            .copied()
            .filter(|(r, t)| outputs[t.buffer].per_point && lowering.level[r.index()] == level)
            .collect();
        let mut straight = Vec::new();
        let mut body = Vec::new();
        // What the loop reads from outside it comes first.
        for &sum in &sums {
            let mut statements = Vec::new();
            let accumulator = lowering.define(Op::Accumulator, &mut statements);
            straight.extend(statements);
            lowering.accumulators.insert(sum, accumulator);
        }
        lowering.looped.clear();
        for &sum in &sums {
            let Operation::PointSum(inner) = dag.node(sum).operation else { unreachable!("filtered above") };
            let into = lowering.accumulators[&sum];
            lowering.accumulate(into, inner, false, &mut straight, &mut body);
        }
        for (r, t) in point_targets {
            let a = lowering.value(r, true, &mut straight, &mut body);
            body.push(effect(Op::Output { buffer: t.buffer, index: t.index, a }));
        }
        if level == last {
            // Outputs of non-varying values wait for the end of the last loop: split the section in two if needed.
            if !body.is_empty() {
                push(&mut sections, Section::Straight(std::mem::take(&mut straight)));
                push(&mut sections, Section::Loop(std::mem::take(&mut body)));
            }
            for (sum, value) in std::mem::take(&mut lowering.accumulators) {
                lowering.values.insert(sum, value);
            }
            for (r, t) in targets.iter().filter(|(_, t)| !outputs[t.buffer].per_point) {
                let a = lowering.value(*r, false, &mut straight, &mut body);
                straight.push(effect(Op::Output { buffer: t.buffer, index: t.index, a }));
            }
        }
        push(&mut sections, Section::Straight(straight));
        push(&mut sections, Section::Loop(body));
        for (sum, value) in std::mem::take(&mut lowering.accumulators) {
            lowering.values.insert(sum, value);
        }
    }
    let program = Program {
        name: name.into(),
        points: dag.points.max(1),
        inputs,
        outputs,
        tables: lowering.tables,
        sections,
        value_count: lowering.next as usize,
    };
    debug_assert_eq!(crate::verify(&program), Ok(()));
    program
}

fn push(sections: &mut Vec<Section>, section: Section) {
    if !section.statements().is_empty() {
        sections.push(section);
    }
}

fn effect(op: Op) -> Statement {
    Statement { value: Value(u32::MAX), op }
}

struct Lowering<'a> {
    dag: &'a Dag,
    sources: &'a HashMap<Ref, Source>,
    level: Vec<usize>,
    uses: Vec<usize>,
    /// Values known everywhere.
    values: HashMap<Ref, Value>,
    /// Values known in the current loop.
    looped: HashMap<Ref, Value>,
    accumulators: HashMap<Ref, Value>,
    tables: Vec<Vec<f64>>,
    table_numbers: HashMap<u32, usize>,
    next: u32,
}

/// A term of a sum.
#[derive(Clone, Copy, Debug)]
struct Term {
    value: Ref,
    minus: bool,
}

impl Lowering<'_> {
    fn define(&mut self, op: Op, into: &mut Vec<Statement>) -> Value {
        let value = Value(self.next);
        self.next += 1;
        into.push(Statement { value, op });
        value
    }

    /// A product that only its one user reads: it can be part of a fused multiply-add.
    fn fusible(&self, r: Ref, in_loop: bool) -> Option<(Ref, Ref)> {
        let node = self.dag.node(r);
        // A product that is known outside the loop is not worth computing inside it.
        if self.uses[r.index()] != 1 || self.sources.contains_key(&r) || (in_loop && !node.varying) {
            return None;
        }
        match node.operation {
            Operation::Mul(a, b) => Some((a, b)),
            _ => None,
        }
    }

    /// A sum or difference that only its one user reads: its terms can be added one by one instead.
    fn joins(&self, r: Ref, in_loop: bool) -> Option<(Ref, Ref, bool)> {
        let node = self.dag.node(r);
        if self.uses[r.index()] != 1 || self.sources.contains_key(&r) || (in_loop && !node.varying) {
            return None;
        }
        match node.operation {
            Operation::Add(a, b) => Some((a, b, false)),
            Operation::Sub(a, b) => Some((a, b, true)),
            _ => None,
        }
    }

    /// The terms of a sum of sums, where adding them one by one takes fewer operations than adding the sums: a fused
    /// multiply–add takes in one product, so a sum of two products inside another sum leaves one out.
    ///
    /// ```text
    /// a − (b c + d e):   p = b c, q = d e + p, a − q      becomes      p = a − b c, p − d e
    /// ```
    fn chain(&self, r: Ref, in_loop: bool) -> Option<Vec<Term>> {
        let mut terms = Vec::new();
        let taken_in = self.terms(r, in_loop, false, &mut terms);
        let products = terms.iter().filter(|t| self.fusible(t.value, in_loop).is_some()).count();
        // Where nothing but products is added, the first of them has nothing to be added to.
        let left = usize::from(products == terms.len());
        (products > taken_in + left).then_some(terms)
    }

    /// Appends the terms of a sum; the number of products that additions would take in as they stand.
    fn terms(&self, r: Ref, in_loop: bool, minus: bool, terms: &mut Vec<Term>) -> usize {
        let (a, b, difference) = match self.dag.node(r).operation {
            Operation::Add(a, b) => (a, b, false),
            Operation::Sub(a, b) => (a, b, true),
            _ => unreachable!("only sums and differences have terms"),
        };
        let mut taken_in = usize::from([a, b].iter().any(|o| self.fusible(*o, in_loop).is_some()));
        for (value, minus) in [(a, minus), (b, minus ^ difference)] {
            match self.joins(value, in_loop) {
                Some(_) => taken_in += self.terms(value, in_loop, minus, terms),
                None => terms.push(Term { value, minus }),
            }
        }
        taken_in
    }

    /// Adds up terms, of which the first is positive.
    fn add_up(
        &mut self,
        terms: &[Term],
        in_loop: bool,
        straight: &mut Vec<Statement>,
        body: &mut Vec<Statement>,
    ) -> Op {
        // It begins with what is no product, so that every product finds something to be added to.
        let plain = |s: &Self, t: &Term| s.fusible(t.value, in_loop).is_none();
        let first = terms.iter().position(|t| !t.minus && plain(self, t)).unwrap_or(0);
        let start = terms[first].value;
        let mut subtracted = None;
        let mut op = match self.fusible(start, in_loop) {
            None => None,
            Some((x, y)) => {
                subtracted = terms.iter().position(|t| t.minus && plain(self, t));
                let x = self.value(x, in_loop, straight, body);
                let y = self.value(y, in_loop, straight, body);
                Some(match subtracted {
                    Some(at) => Op::MulSub(x, y, self.value(terms[at].value, in_loop, straight, body)),
                    None => Op::Mul(x, y),
                })
            }
        };
        for (at, term) in terms.iter().enumerate() {
            if at == first || Some(at) == subtracted {
                continue;
            }
            let sum = match op.take() {
                None => self.value(start, in_loop, straight, body),
                Some(op) => self.define(op, if in_loop { &mut *body } else { &mut *straight }),
            };
            op = Some(match self.fusible(term.value, in_loop) {
                Some((x, y)) => {
                    let x = self.value(x, in_loop, straight, body);
                    let y = self.value(y, in_loop, straight, body);
                    if term.minus { Op::NegMulAdd(x, y, sum) } else { Op::MulAdd(x, y, sum) }
                }
                None => {
                    let a = self.value(term.value, in_loop, straight, body);
                    if term.minus { Op::Sub(sum, a) } else { Op::Add(sum, a) }
                }
            });
        }
        op.expect("a sum has two terms at least")
    }

    /// A sum or difference of two values.
    fn pair(
        &mut self,
        operation: Operation,
        in_loop: bool,
        straight: &mut Vec<Statement>,
        body: &mut Vec<Statement>,
    ) -> Op {
        let here = in_loop;
        let mut get = |s: &mut Self, o: Ref| s.value(o, here, straight, body);
        match operation {
            Operation::Add(a, b) => match (self.fusible(a, here), self.fusible(b, here)) {
                // The second operand is the later one: what is summed so far stays the addend.
                (_, Some((x, y))) => {
                    let c = get(self, a);
                    Op::MulAdd(get(self, x), get(self, y), c)
                }
                (Some((x, y)), None) => {
                    let c = get(self, b);
                    Op::MulAdd(get(self, x), get(self, y), c)
                }
                (None, None) => Op::Add(get(self, a), get(self, b)),
            },
            Operation::Sub(a, b) => match (self.fusible(a, here), self.fusible(b, here)) {
                (_, Some((x, y))) => {
                    let c = get(self, a);
                    Op::NegMulAdd(get(self, x), get(self, y), c)
                }
                (Some((x, y)), None) => {
                    let c = get(self, b);
                    Op::MulSub(get(self, x), get(self, y), c)
                }
                (None, None) => Op::Sub(get(self, a), get(self, b)),
            },
            _ => unreachable!("only sums and differences are pairs"),
        }
    }

    /// `into ± r`, following a sum that only this accumulation reads down to its terms.
    fn accumulate(
        &mut self,
        into: Value,
        r: Ref,
        minus: bool,
        straight: &mut Vec<Statement>,
        body: &mut Vec<Statement>,
    ) {
        let node = *self.dag.node(r);
        let single = self.uses[r.index()] == 1 && node.varying && !self.sources.contains_key(&r);
        match node.operation {
            Operation::Add(a, b) if single => {
                self.accumulate(into, a, minus, straight, body);
                self.accumulate(into, b, minus, straight, body);
            }
            // The first operand of a difference sets the sign; starting with it keeps the order of the sum.
            Operation::Sub(a, b) if single => {
                self.accumulate(into, a, minus, straight, body);
                self.accumulate(into, b, !minus, straight, body);
            }
            Operation::Mul(a, b) if single => {
                let a = self.value(a, true, straight, body);
                let b = self.value(b, true, straight, body);
                body.push(effect(if minus {
                    Op::AccumulateNegProduct { into, a, b }
                } else {
                    Op::AccumulateProduct { into, a, b }
                }));
            }
            _ if minus => {
                let a = self.value(r, true, straight, body);
                let one = self.constant(1.0, straight);
                body.push(effect(Op::AccumulateNegProduct { into, a, b: one }));
            }
            _ => {
                let a = self.value(r, true, straight, body);
                body.push(effect(Op::Accumulate { into, a }));
            }
        }
    }

    fn constant(&mut self, value: f64, straight: &mut Vec<Statement>) -> Value {
        self.define(Op::Constant(value), straight)
    }

    /// The value of a node, computed in the loop if it varies (and we are in one), outside it otherwise.
    fn value(&mut self, r: Ref, in_loop: bool, straight: &mut Vec<Statement>, body: &mut Vec<Statement>) -> Value {
        if let Some(&v) = self.values.get(&r).or_else(|| self.looped.get(&r)) {
            return v;
        }
        let node = *self.dag.node(r);
        debug_assert!(in_loop || !node.varying, "a varying value is asked for outside a loop");
        let here = in_loop && node.varying;
        let op = if let Some(&Source { buffer, index }) = self.sources.get(&r) {
            Op::Input { buffer, index }
        } else {
            let mut get = |s: &mut Self, o: Ref| s.value(o, here, straight, body);
            match node.operation {
                Operation::Constant(bits) => Op::Constant(f64::from_bits(bits)),
                Operation::Leaf(e) => panic!("no source gives the leaf {e:?}"),
                Operation::Table(t) => {
                    let next = self.tables.len();
                    let number = *self.table_numbers.entry(t).or_insert(next);
                    if number == next {
                        self.tables.push(self.dag.tables[t as usize].clone());
                    }
                    Op::Table(number)
                }
                Operation::Add(..) | Operation::Sub(..) => match self.chain(r, here) {
                    Some(terms) => self.add_up(&terms, here, straight, body),
                    None => self.pair(node.operation, here, straight, body),
                },
                Operation::Mul(a, b) => Op::Mul(get(self, a), get(self, b)),
                Operation::Neg(a) => Op::Neg(get(self, a)),
                Operation::Recip(a) => Op::Recip(get(self, a)),
                Operation::Sqrt(a) => Op::Sqrt(get(self, a)),
                Operation::Ln(a) => Op::Ln(get(self, a)),
                Operation::Exp(a) => Op::Exp(get(self, a)),
                Operation::Pow(a, b) => Op::Pow(get(self, a), get(self, b)),
                Operation::PointSum(_) => panic!("a point sum is read before its loop"),
            }
        };
        if here {
            let v = self.define(op, body);
            self.looped.insert(r, v);
            v
        } else {
            let v = self.define(op, straight);
            self.values.insert(r, v);
            v
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{BufferRequest, Costs, Counts, Op, OutputRequest, Program, stage};
    use souple_symbols::{Expr, Graph, Time};

    /// The program of one value from eight inputs.
    fn program(value: impl FnOnce(&mut Graph, &[Expr]) -> Expr) -> Program {
        let mut g = Graph::new();
        let leaves: Vec<Expr> = (0..8).map(|k| g.symbol(format!("x{k}"), Time::Step)).collect();
        let values = vec![value(&mut g, &leaves)];
        let input = BufferRequest { name: "x".into(), leaves };
        let output = OutputRequest { program: "p".into(), time: Time::Step, name: "y".into(), values, cached: true };
        stage(&g, &[input], &[output], Costs::default()).program("p").unwrap().clone()
    }

    fn arithmetic(p: &Program) -> usize {
        let statements = p.sections.iter().flat_map(|s| s.statements());
        statements.filter(|s| !matches!(s.op, Op::Input { .. } | Op::Output { .. } | Op::Constant(_))).count()
    }

    /// Products in sums inside a sum are each taken in by a multiply–add: four products take four operations however
    /// they are bracketed, and none more where something else is added to them.
    #[test]
    fn every_product_of_a_sum_of_sums_is_fused() {
        let product = |g: &mut Graph, x: &[Expr], k: usize| g.mul(x[2 * k], x[2 * k + 1]);
        let sums = |g: &mut Graph, x: &[Expr]| {
            let p: Vec<Expr> = (0..4).map(|k| product(g, x, k)).collect();
            let (a, b) = (g.add(p[0], p[1]), g.add(p[2], p[3]));
            let (a, b) = (g.named("a", a), g.named("b", b));
            g.sub(a, b)
        };
        let p = program(sums);
        assert_eq!((arithmetic(&p), Counts::of(&p).operations), (4, 7), "{}", crate::print(&p));
        let p = program(|g, x| {
            let (c, d) = (product(g, x, 1), product(g, x, 2));
            let inner = g.add(c, d);
            let inner = g.named("inner", inner);
            g.sub(x[0], inner)
        });
        assert_eq!(arithmetic(&p), 2, "{}", crate::print(&p));
    }
}
