//! Programs as text, and back.
//!
//! ```text
//! program force
//! points 8
//! input x 24
//! input setup_point_values 23 per point
//! output force 24
//! table 0.5 -0.5 0.5 -0.5 0.5 -0.5 0.5 -0.5
//! straight
//!   v0 = input x[0]
//!   v1 = accumulator
//! loop
//!   v2 = input setup_point_values[3]
//!   v3 = table 0
//!   v4 = v2 * v3 + v0
//!   v1 += v4 * v2
//! straight
//!   output force[0] = v1
//! end
//! ```
//!
//! Constants are printed with as many digits as it takes to read the same bits back.

use crate::{Buffer, Op, Program, Section, Statement, Value};
use std::fmt::Write as _;
use thiserror::Error;

/// What is wrong with a text, and in which line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {what}")]
pub struct ParseError {
    /// Line number, from 1.
    pub line: usize,
    /// What was expected, and what was found.
    pub what: String,
}

/// The text of a program.
pub fn print(p: &Program) -> String {
    let mut out = format!("program {}\npoints {}\n", p.name, p.points);
    let buffer = |out: &mut String, kind: &str, b: &Buffer| {
        let per_point = if b.per_point { " per point" } else { "" };
        writeln!(out, "{kind} {} {}{per_point}", b.name, b.len).expect("writing to a string cannot fail");
    };
    p.inputs.iter().for_each(|b| buffer(&mut out, "input", b));
    p.outputs.iter().for_each(|b| buffer(&mut out, "output", b));
    for table in &p.tables {
        let values: Vec<String> = table.iter().map(|v| format!("{v:?}")).collect();
        writeln!(out, "table {}", values.join(" ")).expect("writing to a string cannot fail");
    }
    for section in &p.sections {
        out.push_str(match section {
            Section::Straight(_) => "straight\n",
            Section::Loop(_) => "loop\n",
        });
        for s in section.statements() {
            writeln!(out, "  {}", statement(p, s)).expect("writing to a string cannot fail");
        }
    }
    out.push_str("end\n");
    out
}

fn statement(p: &Program, s: &Statement) -> String {
    let v = |v: Value| format!("v{}", v.0);
    let right = match s.op {
        Op::Constant(c) => format!("{c:?}"),
        Op::Input { buffer, index } => format!("input {}[{index}]", p.inputs[buffer].name),
        Op::Table(t) => format!("table {t}"),
        Op::Add(a, b) => format!("{} + {}", v(a), v(b)),
        Op::Sub(a, b) => format!("{} - {}", v(a), v(b)),
        Op::Mul(a, b) => format!("{} * {}", v(a), v(b)),
        Op::Neg(a) => format!("- {}", v(a)),
        Op::MulAdd(a, b, c) => format!("{} * {} + {}", v(a), v(b), v(c)),
        Op::MulSub(a, b, c) => format!("{} * {} - {}", v(a), v(b), v(c)),
        Op::NegMulAdd(a, b, c) => format!("{} - {} * {}", v(c), v(a), v(b)),
        Op::Recip(a) => format!("recip {}", v(a)),
        Op::Sqrt(a) => format!("sqrt {}", v(a)),
        Op::Ln(a) => format!("ln {}", v(a)),
        Op::Exp(a) => format!("exp {}", v(a)),
        Op::Pow(a, b) => format!("pow {} {}", v(a), v(b)),
        Op::Accumulator => "accumulator".into(),
        Op::Accumulate { into, a } => return format!("{} += {}", v(into), v(a)),
        Op::AccumulateProduct { into, a, b } => return format!("{} += {} * {}", v(into), v(a), v(b)),
        Op::AccumulateNegProduct { into, a, b } => return format!("{} -= {} * {}", v(into), v(a), v(b)),
        Op::Output { buffer, index, a } => return format!("output {}[{index}] = {}", p.outputs[buffer].name, v(a)),
    };
    format!("{} = {right}", v(s.value))
}

/// Reads a program's text. The result is well formed but not verified.
///
/// # Errors
/// The first line that cannot be read, with what was expected.
pub fn parse(text: &str) -> Result<Program, ParseError> {
    let mut program = Program {
        name: String::new(),
        points: 1,
        inputs: Vec::new(),
        outputs: Vec::new(),
        tables: Vec::new(),
        sections: Vec::new(),
        value_count: 0,
    };
    let mut ended = false;
    for (at, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.is_empty() || words[0].starts_with('#') {
            continue;
        }
        if ended {
            return Err(ParseError { line: at + 1, what: "text after `end`".into() });
        }
        ended = read_line(&mut program, &words).map_err(|what| ParseError { line: at + 1, what })?;
    }
    if !ended {
        return Err(ParseError { line: text.lines().count() + 1, what: "expected `end`".into() });
    }
    let defined = program.sections.iter().flat_map(|s| s.statements()).filter(|s| s.op.defines());
    program.value_count = defined.map(|s| s.value.index() + 1).max().unwrap_or(0);
    Ok(program)
}

/// Reads one line into the program; true at the end.
fn read_line(p: &mut Program, words: &[&str]) -> Result<bool, String> {
    match words {
        ["program", name] => p.name = (*name).into(),
        ["points", n] => p.points = number(n)?,
        ["input", name, n, rest @ ..] if p.sections.is_empty() => p.inputs.push(buffer(name, n, rest)?),
        ["output", name, n, rest @ ..] if p.sections.is_empty() => p.outputs.push(buffer(name, n, rest)?),
        ["table", values @ ..] if p.sections.is_empty() => {
            p.tables.push(values.iter().map(|v| real(v)).collect::<Result<_, _>>()?);
        }
        ["straight"] => p.sections.push(Section::Straight(Vec::new())),
        ["loop"] => p.sections.push(Section::Loop(Vec::new())),
        ["end"] => return Ok(true),
        _ => {
            let s = read_statement(p, words)?;
            let section = p.sections.last_mut().ok_or("expected `straight` or `loop` before the first statement")?;
            let (Section::Straight(statements) | Section::Loop(statements)) = section;
            statements.push(s);
        }
    }
    Ok(false)
}

fn read_statement(p: &Program, words: &[&str]) -> Result<Statement, String> {
    let none = Value(u32::MAX);
    let effect = |op| Ok(Statement { value: none, op });
    match *words {
        ["output", at, "=", a] => {
            let (buffer, index) = place(at, &p.outputs)?;
            effect(Op::Output { buffer, index, a: value(a)? })
        }
        [into, "+=", a] => effect(Op::Accumulate { into: value(into)?, a: value(a)? }),
        [into, "+=", a, "*", b] => effect(Op::AccumulateProduct { into: value(into)?, a: value(a)?, b: value(b)? }),
        [into, "-=", a, "*", b] => effect(Op::AccumulateNegProduct { into: value(into)?, a: value(a)?, b: value(b)? }),
        [v, "=", ref right @ ..] => {
            let op = match *right {
                ["accumulator"] => Op::Accumulator,
                ["input", at] => {
                    let (buffer, index) = place(at, &p.inputs)?;
                    Op::Input { buffer, index }
                }
                ["table", t] => Op::Table(number(t)?),
                ["-", a] => Op::Neg(value(a)?),
                ["recip", a] => Op::Recip(value(a)?),
                ["sqrt", a] => Op::Sqrt(value(a)?),
                ["ln", a] => Op::Ln(value(a)?),
                ["exp", a] => Op::Exp(value(a)?),
                ["pow", a, b] => Op::Pow(value(a)?, value(b)?),
                [a, "+", b] => Op::Add(value(a)?, value(b)?),
                [a, "-", b] => Op::Sub(value(a)?, value(b)?),
                [a, "*", b] => Op::Mul(value(a)?, value(b)?),
                [a, "*", b, "+", c] => Op::MulAdd(value(a)?, value(b)?, value(c)?),
                [a, "*", b, "-", c] => Op::MulSub(value(a)?, value(b)?, value(c)?),
                [c, "-", a, "*", b] => Op::NegMulAdd(value(a)?, value(b)?, value(c)?),
                [constant] => Op::Constant(real(constant)?),
                _ => return Err(format!("`{}` is not an operation", right.join(" "))),
            };
            Ok(Statement { value: value(v)?, op })
        }
        _ => Err(format!("`{}` is not a statement", words.join(" "))),
    }
}

fn buffer(name: &str, len: &str, rest: &[&str]) -> Result<Buffer, String> {
    let per_point = match rest {
        [] => false,
        ["per", "point"] => true,
        _ => return Err(format!("expected `per point` or nothing after the length, found `{}`", rest.join(" "))),
    };
    Ok(Buffer { name: name.into(), len: number(len)?, per_point })
}

fn number(word: &str) -> Result<usize, String> {
    word.parse().map_err(|_| format!("expected a whole number, found `{word}`"))
}

fn real(word: &str) -> Result<f64, String> {
    word.parse().map_err(|_| format!("expected a number, found `{word}`"))
}

fn value(word: &str) -> Result<Value, String> {
    let digits = word.strip_prefix('v').ok_or_else(|| format!("expected a value like `v3`, found `{word}`"))?;
    digits.parse().map(Value).map_err(|_| format!("expected a value like `v3`, found `{word}`"))
}

fn place(word: &str, buffers: &[Buffer]) -> Result<(usize, usize), String> {
    let parts = word.strip_suffix(']').and_then(|w| w.split_once('['));
    let (name, index) = parts.ok_or_else(|| format!("expected a place like `name[3]`, found `{word}`"))?;
    let buffer = buffers.iter().position(|b| b.name == name).ok_or_else(|| format!("there is no buffer `{name}`"))?;
    Ok((buffer, number(index)?))
}
