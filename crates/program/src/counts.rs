//! What a program costs, counted from its statements.

use crate::{Op, Program, Section, Statement};

/// Operations and memory accesses of a program for one item.
///
/// One addition, subtraction, multiplication or negation counts one; a fused multiply-add counts two; a division, root
/// or function counts one and is counted apart as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Arithmetic operations in all, loops multiplied out.
    pub operations: usize,
    /// Of these, divisions, roots and functions.
    pub functions: usize,
    /// Operations of one pass through the loops.
    pub per_point: usize,
    /// Operations outside loops.
    pub once: usize,
    /// Values read from buffers, loops multiplied out.
    pub loads: usize,
    /// Values written to buffers, loops multiplied out.
    pub stores: usize,
    /// Statements, loops not multiplied out: the length of the code.
    pub statements: usize,
}

impl Counts {
    /// Counts a program.
    pub fn of(program: &Program) -> Counts {
        let mut counts = Counts::default();
        for section in &program.sections {
            let times = match section {
                Section::Straight(_) => 1,
                Section::Loop(_) => program.points,
            };
            let statements = section.statements();
            counts.statements += statements.len();
            let operations: usize = statements.iter().map(operations).sum();
            match section {
                Section::Straight(_) => counts.once += operations,
                Section::Loop(_) => counts.per_point += operations,
            }
            counts.operations += times * operations;
            for s in statements {
                match s.op {
                    Op::Input { .. } => counts.loads += times,
                    Op::Output { .. } => counts.stores += times,
                    Op::Recip(_) | Op::Sqrt(_) | Op::Ln(_) | Op::Exp(_) | Op::Pow(..) => counts.functions += times,
                    _ => {}
                }
            }
        }
        counts
    }
}

fn operations(s: &Statement) -> usize {
    use Op::*;
    match s.op {
        Constant(_) | Input { .. } | Table(_) | Accumulator | Output { .. } => 0,
        Add(..) | Sub(..) | Mul(..) | Neg(_) | Recip(_) | Sqrt(_) | Ln(_) | Exp(_) | Pow(..) | Accumulate { .. } => 1,
        MulAdd(..) | MulSub(..) | NegMulAdd(..) | AccumulateProduct { .. } | AccumulateNegProduct { .. } => 2,
    }
}
