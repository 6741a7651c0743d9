//! The kernel language.
//!
//! It has: constants, reading and writing numbered places of declared buffers, arithmetic, four functions, loops over
//! the declared number of points, and accumulators that live across a loop.
//! It has not: pointers, calls, branches, recursion, strings, other loops, or any word about what is computed.
//! That is what makes a backend a printer or a small compiler.
//!
//! A program describes the work for *one* item; a kernel runs it for many, independent of each other.

/// A number computed by a statement. Each is assigned once, except accumulators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Value(pub u32);

impl Value {
    /// Position in tables by value.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A numbered array that a program reads or writes, per item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Buffer {
    /// Name in text and reports.
    pub name: String,
    /// Number of values, per point if `per_point`.
    pub len: usize,
    /// Whether there is one array per point.
    pub per_point: bool,
}

impl Buffer {
    /// Number of values for a program with this many points.
    pub fn total(&self, points: usize) -> usize {
        self.len * if self.per_point { points } else { 1 }
    }
}

/// What a statement does. `buffer` numbers the program's inputs or outputs, `index` the places in one; `into` is an
/// accumulator.
#[expect(missing_docs, reason = "the fields are named in the line above; each variant's formula uses them")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Op {
    /// A constant.
    Constant(f64),
    /// Reads place `index` of an input; inside a loop, of the current point's array if the buffer is per point.
    Input { buffer: usize, index: usize },
    /// Value of a table at the current point; only inside a loop.
    Table(usize),
    /// `a + b`.
    Add(Value, Value),
    /// `a − b`.
    Sub(Value, Value),
    /// `a · b`.
    Mul(Value, Value),
    /// `−a`.
    Neg(Value),
    /// `a · b + c`, rounded once or twice: the backend chooses.
    MulAdd(Value, Value, Value),
    /// `a · b − c`, likewise.
    MulSub(Value, Value, Value),
    /// `c − a · b`, likewise.
    NegMulAdd(Value, Value, Value),
    /// `1 / a`.
    Recip(Value),
    /// `√a`.
    Sqrt(Value),
    /// `ln a`.
    Ln(Value),
    /// `eᵃ`.
    Exp(Value),
    /// `aᵇ`.
    Pow(Value, Value),
    /// A new accumulator, zero; only outside loops.
    Accumulator,
    /// `into += a`; only inside a loop, `into` being an accumulator. Defines no value.
    Accumulate { into: Value, a: Value },
    /// `into += a · b`, likewise.
    AccumulateProduct { into: Value, a: Value, b: Value },
    /// `into −= a · b`, likewise.
    AccumulateNegProduct { into: Value, a: Value, b: Value },
    /// Writes place `index` of an output. Defines no value.
    Output { buffer: usize, index: usize, a: Value },
}

impl Op {
    /// Values that it reads.
    pub fn operands(&self) -> impl Iterator<Item = Value> + use<> {
        use Op::*;
        let three = match *self {
            Constant(_) | Input { .. } | Table(_) | Accumulator => [None, None, None],
            Neg(a) | Recip(a) | Sqrt(a) | Ln(a) | Exp(a) | Output { a, .. } => [Some(a), None, None],
            Add(a, b) | Sub(a, b) | Mul(a, b) | Pow(a, b) => [Some(a), Some(b), None],
            Accumulate { into, a } => [Some(into), Some(a), None],
            MulAdd(a, b, c) | MulSub(a, b, c) | NegMulAdd(a, b, c) => [Some(a), Some(b), Some(c)],
            AccumulateProduct { into, a, b } | AccumulateNegProduct { into, a, b } => [Some(into), Some(a), Some(b)],
        };
        three.into_iter().flatten()
    }

    /// Whether it defines a new value.
    pub fn defines(&self) -> bool {
        !matches!(
            self,
            Op::Accumulate { .. } | Op::AccumulateProduct { .. } | Op::AccumulateNegProduct { .. } | Op::Output { .. }
        )
    }
}

/// One operation, and the value that it defines, if it defines one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statement {
    /// The value defined; meaningless for operations that define none.
    pub value: Value,
    /// What is done.
    pub op: Op,
}

/// Statements that run once, or once per point.
#[derive(Clone, Debug, PartialEq)]
pub enum Section {
    /// Runs once.
    Straight(Vec<Statement>),
    /// Runs for each point in order.
    Loop(Vec<Statement>),
}

impl Section {
    /// The statements, whatever the kind of section.
    pub fn statements(&self) -> &[Statement] {
        match self {
            Section::Straight(s) | Section::Loop(s) => s,
        }
    }
}

/// A program for one item.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Name in text and reports.
    pub name: String,
    /// Number of points of loops, tables and per-point buffers.
    pub points: usize,
    /// What it reads.
    pub inputs: Vec<Buffer>,
    /// What it writes; every place is written exactly once (per point for per-point buffers).
    pub outputs: Vec<Buffer>,
    /// One constant per point, [table][point].
    pub tables: Vec<Vec<f64>>,
    /// The work, in order.
    pub sections: Vec<Section>,
    /// Values are numbered below this.
    pub value_count: usize,
}

impl Program {
    /// Number of the input buffer with this name.
    pub fn input(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|b| b.name == name)
    }

    /// Number of the output buffer with this name.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|b| b.name == name)
    }
}
