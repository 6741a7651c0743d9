//! The walk over a program that all languages share: which statement comes when, where each place lies in memory.

use super::{Access, Binding, Layout, Loops, PrintError, Printed};
use souple_program::{Buffer, Counts, Op, Program, Section, Statement, Value};
use std::collections::{HashMap, HashSet};

/// What differs between languages. Every function gives text; addresses are texts of whole numbers.
pub trait Dialect {
    /// What stands before the body: comments, bindings, the name of the function.
    fn head(&self, program: &Program, layout: &Layout, bindings: &[Binding], provenance: &[String]) -> String;
    /// What stands after the body; `functions` names those that were called.
    fn tail(&self, functions: &[Function]) -> String;
    /// Statement that names a number.
    fn define(&self, name: &str, value: &str) -> String;
    /// Statement that names an unsigned whole number.
    fn define_address(&self, name: &str, value: &str) -> String;
    /// Statement that makes a number that changes, zero.
    fn accumulator(&self, name: &str) -> String;
    /// First line of a loop over `points` points with the counter `q`.
    fn begin_loop(&self, points: usize) -> String;
    /// A number of single precision.
    fn constant(&self, value: f32) -> String;
    /// Entry of an array of a binding.
    fn load(&self, binding: Binding, address: &str) -> String;
    /// Statement that writes an entry of an output.
    fn store(&self, output: usize, address: &str, value: &str) -> String;
    /// `a · b + c`, rounded once where the device can.
    fn multiply_add(&self, a: &str, b: &str, c: &str) -> String;
    /// A function of one or two numbers.
    fn call(&self, function: Function, arguments: &[&str]) -> String;
}

/// Functions that a language has, or that its tail defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Function {
    /// √a.
    Sqrt,
    /// ln a.
    Ln,
    /// eᵃ.
    Exp,
    /// aᵇ.
    Pow,
}

/// Prints a verified program.
///
/// `provenance` are lines that say where the program comes from; they become comments.
///
/// # Errors
/// When the layout describes another number of inputs, or a constant does not fit single precision.
pub fn print(
    program: &Program,
    layout: &Layout,
    dialect: &dyn Dialect,
    provenance: &[String],
) -> Result<Printed, PrintError> {
    if layout.inputs.len() != program.inputs.len() {
        let (expected, found) = (program.inputs.len(), layout.inputs.len());
        return Err(PrintError::Layout { program: program.name.clone(), expected, found });
    }
    let bindings = layout.bindings(program);
    let mut walk = Walk {
        program,
        layout,
        dialect,
        functions: Vec::new(),
        rows: HashMap::new(),
        text: dialect.head(program, layout, &bindings, provenance),
        indent: 1,
        longest: 0,
    };
    walk.bases();
    for section in &program.sections {
        walk.section(section)?;
    }
    walk.functions.sort();
    let Walk { mut text, functions, longest, .. } = walk;
    text.push_str(&dialect.tail(&functions));
    Ok(Printed { source: text, bindings, longest, counts: Counts::of(program) })
}

struct Walk<'a> {
    program: &'a Program,
    layout: &'a Layout,
    dialect: &'a dyn Dialect,
    functions: Vec<Function>,
    /// Names of the first places of rows that are known everywhere, by table and row place.
    /// All inputs of a table have rows of one length.
    rows: HashMap<(usize, usize), String>,
    text: String,
    indent: usize,
    longest: usize,
}

/// Where a statement stands.
#[derive(Clone, Copy)]
enum At<'a> {
    /// Outside loops.
    Once,
    /// In a loop with the counter `q`.
    Looped,
    /// In a loop that is written out, at this point; the names of its values end like this.
    Point(usize, &'a HashSet<Value>),
}

impl Walk<'_> {
    fn line(&mut self, line: &str) {
        self.text.extend(std::iter::repeat_n("    ", self.indent));
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// Addresses of place zero of every buffer in lane order.
    fn bases(&mut self) {
        let (program, lanes) = (self.program, self.layout.lanes);
        let mut lines = Vec::new();
        for table in 0..self.layout.tables() {
            let rows = self.layout.rows_per_item(program, table);
            lines.push(self.dialect.define_address(&format!("rows{table}_0"), &base(rows, lanes)));
        }
        for (k, b) in program.inputs.iter().enumerate().filter(|(k, _)| self.layout.inputs[*k] == Access::Lanes) {
            lines.push(self.dialect.define_address(&format!("in{k}_0"), &base(b.total(program.points), lanes)));
        }
        for (k, b) in program.outputs.iter().enumerate() {
            lines.push(self.dialect.define_address(&format!("out{k}_0"), &base(b.total(program.points), lanes)));
        }
        lines.iter().for_each(|l| self.line(l));
    }

    fn section(&mut self, section: &Section) -> Result<(), PrintError> {
        let statements = section.statements();
        match section {
            Section::Straight(_) => {
                self.longest = self.longest.max(statements.len());
                statements.iter().try_for_each(|s| self.statement(s, At::Once))
            }
            Section::Loop(_) if self.layout.loops == Loops::Unrolled => {
                self.longest = self.longest.max(statements.len() * self.program.points);
                let own: HashSet<Value> = statements.iter().filter(|s| s.op.defines()).map(|s| s.value).collect();
                for point in 0..self.program.points {
                    statements.iter().try_for_each(|s| self.statement(s, At::Point(point, &own)))?;
                }
                Ok(())
            }
            Section::Loop(_) => {
                self.longest = self.longest.max(statements.len());
                let begin = self.dialect.begin_loop(self.program.points);
                self.line(&begin);
                self.indent += 1;
                let done = statements.iter().try_for_each(|s| self.statement(s, At::Looped));
                self.indent -= 1;
                self.line("}");
                done
            }
        }
    }

    fn statement(&mut self, s: &Statement, at: At<'_>) -> Result<(), PrintError> {
        let name = |v: Value| match at {
            At::Point(q, own) if own.contains(&v) => format!("v{}_{q}", v.0),
            _ => format!("v{}", v.0),
        };
        let d = self.dialect;
        let fma = |a: &str, b: &str, c: &str| d.multiply_add(a, b, c);
        let value = match s.op {
            Op::Constant(c) => self.constant(c)?,
            Op::Input { buffer, index } => self.input(buffer, index, at),
            Op::Table(t) => match at {
                At::Point(q, _) => self.constant(self.program.tables[t][q])?,
                _ => {
                    let first = self.layout.tables_offset(self.program) + t * self.program.points;
                    d.load(Binding::Uniforms, &format!("{first}u + q"))
                }
            },
            Op::Add(a, b) => format!("{} + {}", name(a), name(b)),
            Op::Sub(a, b) => format!("{} - {}", name(a), name(b)),
            Op::Mul(a, b) => format!("{} * {}", name(a), name(b)),
            Op::Neg(a) => format!("-{}", name(a)),
            Op::MulAdd(a, b, c) => fma(&name(a), &name(b), &name(c)),
            Op::MulSub(a, b, c) => fma(&name(a), &name(b), &format!("-{}", name(c))),
            Op::NegMulAdd(a, b, c) => fma(&format!("-{}", name(a)), &name(b), &name(c)),
            Op::Recip(a) => format!("{} / {}", d.constant(1.0), name(a)),
            Op::Sqrt(a) => self.call(Function::Sqrt, &[&name(a)]),
            Op::Ln(a) => self.call(Function::Ln, &[&name(a)]),
            Op::Exp(a) => self.call(Function::Exp, &[&name(a)]),
            Op::Pow(a, b) => self.call(Function::Pow, &[&name(a), &name(b)]),
            Op::Accumulator => {
                let line = d.accumulator(&name(s.value));
                self.line(&line);
                return Ok(());
            }
            Op::Accumulate { into, a } => {
                self.line(&format!("{0} = {0} + {1};", name(into), name(a)));
                return Ok(());
            }
            Op::AccumulateProduct { into, a, b } => {
                let sum = fma(&name(a), &name(b), &name(into));
                self.line(&format!("{} = {sum};", name(into)));
                return Ok(());
            }
            Op::AccumulateNegProduct { into, a, b } => {
                let sum = fma(&format!("-{}", name(a)), &name(b), &name(into));
                self.line(&format!("{} = {sum};", name(into)));
                return Ok(());
            }
            Op::Output { buffer, index, a } => {
                let address =
                    place(&format!("out{buffer}_0"), &self.program.outputs[buffer], index, self.layout.lanes, at);
                let line = d.store(buffer, &address, &name(a));
                self.line(&line);
                return Ok(());
            }
        };
        let line = d.define(&name(s.value), &value);
        self.line(&line);
        Ok(())
    }

    fn constant(&self, value: f64) -> Result<String, PrintError> {
        let single = value as f32;
        if !single.is_finite() {
            return Err(PrintError::Constant { program: self.program.name.clone(), value });
        }
        // Languages may treat the smallest numbers as zero in any case; the bound of a comparison covers it.
        Ok(self.dialect.constant(if single.is_subnormal() { 0.0 } else { single }))
    }

    fn call(&mut self, function: Function, arguments: &[&str]) -> String {
        if !self.functions.contains(&function) {
            self.functions.push(function);
        }
        self.dialect.call(function, arguments)
    }

    /// Place `index` of an input.
    fn input(&mut self, buffer: usize, index: usize, at: At<'_>) -> String {
        let b = &self.program.inputs[buffer];
        match self.layout.inputs[buffer] {
            Access::Lanes => {
                let address = place(&format!("in{buffer}_0"), b, index, self.layout.lanes, at);
                self.dialect.load(Binding::Input(buffer), &address)
            }
            Access::Uniform => {
                let first = self.layout.uniform_offset(self.program, buffer) + index;
                let address = match at {
                    At::Looped if b.per_point => format!("{first}u + q * {}u", b.len),
                    At::Point(q, _) if b.per_point => format!("{}u", first + q * b.len),
                    _ => format!("{first}u"),
                };
                self.dialect.load(Binding::Uniforms, &address)
            }
            Access::Gathered { width, table } => self.gathered(buffer, index, width, table, at),
        }
    }

    fn gathered(&mut self, buffer: usize, index: usize, width: usize, table: usize, at: At<'_>) -> String {
        let (b, lanes) = (&self.program.inputs[buffer], self.layout.lanes);
        if let (true, At::Looped) = (b.per_point, at) {
            // Which row and which axis depend on the point: both are computed where they are needed.
            let row = format!("rows{table}_0 + (q * {}u + {index}u) / {width}u * {lanes}u", b.len);
            let row = self.dialect.load(Binding::Rows(table), &row);
            let address = format!("{row} * {width}u + (q * {}u + {index}u) % {width}u", b.len);
            return self.dialect.load(Binding::Input(buffer), &address);
        }
        let flat = match at {
            At::Point(q, _) if b.per_point => q * b.len + index,
            _ => index,
        };
        let row = flat / width;
        let known = self.rows.get(&(table, row)).cloned();
        let first = known.unwrap_or_else(|| {
            let load = self.dialect.load(Binding::Rows(table), &format!("rows{table}_0 + {}u", row * lanes));
            let first = format!("{load} * {width}u");
            // A name made inside a loop ends with the loop.
            if matches!(at, At::Looped) {
                return first;
            }
            let name = format!("r{table}_{row}");
            let line = self.dialect.define_address(&name, &first);
            self.line(&line);
            self.rows.insert((table, row), name.clone());
            name
        });
        self.dialect.load(Binding::Input(buffer), &format!("{first} + {}u", flat % width))
    }
}

/// Address of place zero of a buffer in lane order with this many places.
fn base(places: usize, lanes: usize) -> String {
    format!("group * {}u + lane", places * lanes)
}

/// Address of a place of a buffer in lane order.
fn place(base: &str, buffer: &Buffer, index: usize, lanes: usize, at: At<'_>) -> String {
    match at {
        At::Looped if buffer.per_point => format!("{base} + q * {}u + {}u", buffer.len * lanes, index * lanes),
        At::Point(q, _) if buffer.per_point => format!("{base} + {}u", (q * buffer.len + index) * lanes),
        _ => format!("{base} + {}u", index * lanes),
    }
}
