//! Programs with a place for every value: statements in execution order over few slots.
//!
//! A slot is free again after the last use of its value, and the slot freed last is taken first: what was written last
//! is still in the nearest cache.

use souple_program::{Op, Program, Section, Value};

/// One operation on slots; `buffer` and `index` as in [`Op`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the operands of the operation of the same name in the language")]
pub enum Step {
    Constant { to: u32, value: f64 },
    Input { to: u32, buffer: u32, index: u32 },
    Table { to: u32, table: u32 },
    Add { to: u32, a: u32, b: u32 },
    Sub { to: u32, a: u32, b: u32 },
    Mul { to: u32, a: u32, b: u32 },
    Neg { to: u32, a: u32 },
    MulAdd { to: u32, a: u32, b: u32, c: u32 },
    MulSub { to: u32, a: u32, b: u32, c: u32 },
    NegMulAdd { to: u32, a: u32, b: u32, c: u32 },
    Recip { to: u32, a: u32 },
    Sqrt { to: u32, a: u32 },
    Ln { to: u32, a: u32 },
    Exp { to: u32, a: u32 },
    Pow { to: u32, a: u32, b: u32 },
    Output { buffer: u32, index: u32, a: u32 },
}

/// A program over slots.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Sections: whether it is a loop over the points, and its steps.
    pub sections: Vec<(bool, Vec<Step>)>,
    /// Number of slots needed at once.
    pub slot_count: usize,
}

/// Gives every value of a verified program a slot.
pub fn plan(program: &Program) -> Plan {
    // A value of a straight section that a loop reads must outlive the whole loop.
    let mut last_use = vec![(0usize, 0usize); program.value_count];
    let mut made_in = vec![0usize; program.value_count];
    for (s, section) in program.sections.iter().enumerate() {
        let in_loop = matches!(section, Section::Loop(_));
        for (k, statement) in section.statements().iter().enumerate() {
            if statement.op.defines() {
                made_in[statement.value.index()] = s;
                last_use[statement.value.index()] = (s, k);
            }
            for o in statement.op.operands() {
                let until = if in_loop && made_in[o.index()] != s { usize::MAX } else { k };
                let known = &mut last_use[o.index()];
                *known = (*known).max((s, until));
            }
        }
    }
    let mut slots = Slots { of: vec![u32::MAX; program.value_count], free: Vec::new(), count: 0 };
    let mut sections = Vec::new();
    for (s, section) in program.sections.iter().enumerate() {
        let in_loop = matches!(section, Section::Loop(_));
        let mut steps = Vec::with_capacity(section.statements().len());
        let mut waiting: Vec<Value> = Vec::new();
        for (k, statement) in section.statements().iter().enumerate() {
            let operands: Vec<u32> = statement.op.operands().map(|o| slots.of[o.index()]).collect();
            let mut dead: Vec<Value> = statement.op.operands().filter(|o| last_use[o.index()] == (s, k)).collect();
            dead.dedup();
            dead.sort();
            dead.dedup();
            // Operands are read before the result is written, lane by lane, so a dying operand's slot can take it.
            for v in dead {
                slots.release(v);
            }
            waiting.extend(statement.op.operands().filter(|o| last_use[o.index()] == (s, usize::MAX)));
            let mut to = || slots.take(statement.value);
            let o = |i: usize| operands[i];
            let step = match statement.op {
                Op::Constant(value) => Step::Constant { to: to(), value },
                Op::Accumulator => Step::Constant { to: to(), value: 0.0 },
                Op::Input { buffer, index } => Step::Input { to: to(), buffer: buffer as u32, index: index as u32 },
                Op::Table(t) => Step::Table { to: to(), table: t as u32 },
                Op::Add(..) => Step::Add { to: to(), a: o(0), b: o(1) },
                Op::Sub(..) => Step::Sub { to: to(), a: o(0), b: o(1) },
                Op::Mul(..) => Step::Mul { to: to(), a: o(0), b: o(1) },
                Op::Neg(..) => Step::Neg { to: to(), a: o(0) },
                Op::MulAdd(..) => Step::MulAdd { to: to(), a: o(0), b: o(1), c: o(2) },
                Op::MulSub(..) => Step::MulSub { to: to(), a: o(0), b: o(1), c: o(2) },
                Op::NegMulAdd(..) => Step::NegMulAdd { to: to(), a: o(0), b: o(1), c: o(2) },
                Op::Recip(..) => Step::Recip { to: to(), a: o(0) },
                Op::Sqrt(..) => Step::Sqrt { to: to(), a: o(0) },
                Op::Ln(..) => Step::Ln { to: to(), a: o(0) },
                Op::Exp(..) => Step::Exp { to: to(), a: o(0) },
                Op::Pow(..) => Step::Pow { to: to(), a: o(0), b: o(1) },
                Op::Accumulate { .. } => Step::Add { to: o(0), a: o(0), b: o(1) },
                Op::AccumulateProduct { .. } => Step::MulAdd { to: o(0), a: o(1), b: o(2), c: o(0) },
                Op::AccumulateNegProduct { .. } => Step::NegMulAdd { to: o(0), a: o(1), b: o(2), c: o(0) },
                Op::Output { buffer, index, .. } => {
                    Step::Output { buffer: buffer as u32, index: index as u32, a: o(0) }
                }
            };
            // A value that nobody reads gives its slot back at once.
            if statement.op.defines() && last_use[statement.value.index()] == (s, k) {
                slots.release(statement.value);
            }
            steps.push(step);
        }
        waiting.sort();
        waiting.dedup();
        for v in waiting {
            slots.release(v);
        }
        sections.push((in_loop, steps));
    }
    Plan { sections, slot_count: slots.count as usize }
}

struct Slots {
    of: Vec<u32>,
    free: Vec<u32>,
    count: u32,
}

impl Slots {
    fn take(&mut self, value: Value) -> u32 {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count - 1
        });
        self.of[value.index()] = slot;
        slot
    }

    fn release(&mut self, value: Value) {
        let slot = std::mem::replace(&mut self.of[value.index()], u32::MAX);
        if slot != u32::MAX {
            self.free.push(slot);
        }
    }
}
