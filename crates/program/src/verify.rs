//! What every program must satisfy, so that no backend ever needs to check or to panic.
//!
//! * Values are defined before they are read, once each, and are numbered below the declared count.
//! * A value defined in a loop is not read after it; accumulators are made outside loops and added to inside them, and
//!   not read in a loop that adds to them.
//! * Buffers, places and tables exist; a table has one value per point; tables and per-point buffers are touched in
//!   loops only (a per-point buffer of a program with one point may be touched anywhere).
//! * Every place of every output is written exactly once; whole buffers outside loops, per-point buffers in a loop.

use crate::{Op, Program, Section, Statement};
use std::collections::HashSet;
use thiserror::Error;

/// What is wrong with a program, and where.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("program `{program}`, section {section}, statement {statement}: {what}")]
pub struct VerifyError {
    /// Name of the program.
    pub program: String,
    /// Section, from 0.
    pub section: usize,
    /// Statement in the section, from 0.
    pub statement: usize,
    /// What is wrong.
    pub what: String,
}

#[derive(Clone, Copy, PartialEq)]
enum Known {
    No,
    Accumulator,
    /// Defined in a straight section.
    Everywhere,
    /// Defined in the loop that is this section.
    InLoop(usize),
}

/// Checks a program.
///
/// # Errors
/// The first violation of the rules above.
pub fn verify(program: &Program) -> Result<(), VerifyError> {
    let mut known = vec![Known::No; program.value_count];
    let mut written: Vec<Vec<bool>> = program.outputs.iter().map(|b| vec![false; b.len]).collect();
    for (at, table) in program.tables.iter().enumerate() {
        if table.len() != program.points {
            let what = format!("table {at} has {} values for {} points", table.len(), program.points);
            return Err(VerifyError { program: program.name.clone(), section: 0, statement: 0, what });
        }
    }
    for (section_at, section) in program.sections.iter().enumerate() {
        let in_loop = matches!(section, Section::Loop(_));
        let growing: HashSet<u32> = section.statements().iter().filter_map(|s| accumulated(&s.op)).collect();
        for (statement_at, s) in section.statements().iter().enumerate() {
            check(program, s, section_at, in_loop, &growing, &mut known, &mut written).map_err(|what| VerifyError {
                program: program.name.clone(),
                section: section_at,
                statement: statement_at,
                what,
            })?;
        }
    }
    for (buffer, places) in program.outputs.iter().zip(&written) {
        if let Some(index) = places.iter().position(|w| !w) {
            let section = program.sections.len();
            let what = format!("output {}[{index}] is never written", buffer.name);
            return Err(VerifyError { program: program.name.clone(), section, statement: 0, what });
        }
    }
    Ok(())
}

fn check(
    program: &Program,
    s: &Statement,
    section: usize,
    in_loop: bool,
    growing: &HashSet<u32>,
    known: &mut [Known],
    written: &mut [Vec<bool>],
) -> Result<(), String> {
    for o in s.op.operands() {
        match known.get(o.index()) {
            None => return Err(format!("v{} is not below the count of {} values", o.0, known.len())),
            Some(Known::No) => return Err(format!("v{} is read before it is defined", o.0)),
            Some(Known::InLoop(l)) if *l != section => {
                return Err(format!("v{} belongs to the loop of section {l}", o.0));
            }
            Some(Known::Accumulator) if growing.contains(&o.0) && accumulated(&s.op) != Some(o.0) => {
                return Err(format!("accumulator v{} is read in the loop that adds to it", o.0));
            }
            Some(_) => {}
        }
    }
    match s.op {
        Op::Input { buffer, index } => {
            let b = program.inputs.get(buffer).ok_or_else(|| format!("there is no input {buffer}"))?;
            place(b, index, in_loop, program.points)?;
        }
        Op::Table(t) if t >= program.tables.len() => return Err(format!("there is no table {t}")),
        Op::Table(_) if !in_loop => return Err("a table is read outside a loop".into()),
        Op::Accumulator if in_loop => return Err("an accumulator is made inside a loop".into()),
        Op::Accumulate { into, .. } | Op::AccumulateProduct { into, .. } | Op::AccumulateNegProduct { into, .. } => {
            if !in_loop {
                return Err("accumulation outside a loop".into());
            }
            if known[into.index()] != Known::Accumulator {
                return Err(format!("v{} is not an accumulator", into.0));
            }
            if s.op.operands().skip(1).any(|o| o == into) {
                return Err(format!("accumulator v{} is read in the loop that adds to it", into.0));
            }
        }
        Op::Output { buffer, index, .. } => {
            let b = program.outputs.get(buffer).ok_or_else(|| format!("there is no output {buffer}"))?;
            place(b, index, in_loop, program.points)?;
            if !b.per_point && in_loop {
                return Err(format!("{}[{index}] is written once per point", b.name));
            }
            if std::mem::replace(&mut written[buffer][index], true) {
                return Err(format!("{}[{index}] is written twice", b.name));
            }
        }
        _ => {}
    }
    if s.op.defines() {
        let slot = known
            .get_mut(s.value.index())
            .ok_or_else(|| format!("v{} is not below the declared count of values", s.value.0))?;
        if *slot != Known::No {
            return Err(format!("v{} is defined twice", s.value.0));
        }
        *slot = match s.op {
            Op::Accumulator => Known::Accumulator,
            _ if in_loop => Known::InLoop(section),
            _ => Known::Everywhere,
        };
    }
    Ok(())
}

/// The accumulator that an operation adds to.
fn accumulated(op: &Op) -> Option<u32> {
    match op {
        Op::Accumulate { into, .. } | Op::AccumulateProduct { into, .. } | Op::AccumulateNegProduct { into, .. } => {
            Some(into.0)
        }
        _ => None,
    }
}

fn place(buffer: &crate::Buffer, index: usize, in_loop: bool, points: usize) -> Result<(), String> {
    if index >= buffer.len {
        return Err(format!("{}[{index}] is beyond its {} places", buffer.name, buffer.len));
    }
    if buffer.per_point && !in_loop && points != 1 {
        return Err(format!("{} is per point and is touched outside a loop", buffer.name));
    }
    Ok(())
}
