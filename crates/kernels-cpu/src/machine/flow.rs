//! A program as work on vectors of lanes, knowing how each input arrives.
//!
//! Two kinds of values: those that memory holds anyhow (constants, tables, laned and uniform inputs: their [`Home`] says
//! where), which cost nothing to drop from a register, and those that are computed.
//! What nobody needs is gone; loops over one point are gone too; a gathered row is one piece of work that makes all
//! its places.
//!
//! What it is not: it chooses neither order nor registers.

use souple_kernels::Input;
use souple_program::{Buffer, Op, Program, Section, Value};
use std::collections::HashMap;

/// A value, numbered through the flow.
pub(crate) type Id = u32;

/// No value.
pub(crate) const NONE: Id = u32::MAX;

/// How one input buffer arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// In lane order.
    Lanes,
    /// Rows of this many values, shared.
    Gathered(usize),
    /// The same for every item.
    Uniform,
}

impl Arrival {
    /// How this input arrives.
    pub(crate) fn of<T>(input: &Input<'_, T>) -> Arrival {
        match input {
            Input::Lanes(_) => Arrival::Lanes,
            Input::Gathered { width, .. } => Arrival::Gathered(*width),
            Input::Uniform(_) => Arrival::Uniform,
        }
    }
}

/// Where a value can be read at any time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Home {
    /// Nowhere: it is computed.
    Computed,
    /// Constant of this number.
    Constant(u32),
    /// A whole vector of lanes at this place of a stream.
    Lanes { stream: u32, place: u32 },
    /// A scalar among the uniform values.
    Uniform(u32),
    /// A scalar of the current point at this place of a stream.
    Point { stream: u32, place: u32 },
    /// A table at the current point.
    Table(u32),
}

/// What a pointer of the machine code walks over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Source {
    /// Lanes of an input.
    Input(u32),
    /// Row numbers of a gathered input.
    Rows(u32),
    /// The shared array of a gathered input; it stays where it is.
    Shared(u32),
    /// Uniform values of an input, one array per point.
    Points(u32),
    /// Lanes of an output.
    Output(u32),
}

/// A pointer and how far it walks; lengths in places, a place being what one lane vector or one scalar takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Stream {
    /// What it walks over.
    pub(crate) source: Source,
    /// Places per group.
    pub(crate) per_group: u32,
    /// Places per point, where there is an array per point and a loop walks over it.
    pub(crate) per_point: u32,
}

/// A function of the language that is called rather than emitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Ln,
    Exp,
    Pow,
}

/// What is done to vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// a + b.
    Add,
    /// a − b.
    Sub,
    /// a · b.
    Mul,
    /// a / b.
    Div,
    /// Bits of a where they differ from b's; with −0 as b it negates.
    Xor,
    /// √a.
    Sqrt,
    /// ±a·b ± c, rounded once.
    Fused { minus_product: bool, minus_addend: bool },
    /// One row of a shared array: its places into up to three values, or with `axis` one place of a longer row.
    Gather { rows: u32, shared: u32, place: u32, width: u32, axis: Option<u32> },
    /// A function of a (and b), lane by lane.
    Call(Function),
    /// Writes a at this place of an output's stream.
    Store { stream: u32, place: u32 },
}

/// A piece of work: values read and values made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Work {
    /// What is done.
    pub(crate) what: What,
    /// What it makes; more than the first only for gathers. An accumulator is made anew from its old self.
    pub(crate) to: [Id; 3],
    /// What it reads.
    pub(crate) args: [Id; 3],
}

impl Work {
    /// Values read, each once per reading.
    pub(crate) fn reads(&self) -> impl Iterator<Item = Id> + use<> {
        self.args.into_iter().filter(|a| *a != NONE)
    }

    /// Values made.
    pub(crate) fn makes(&self) -> impl Iterator<Item = Id> + use<> {
        self.to.into_iter().filter(|t| *t != NONE)
    }
}

/// Work that runs once, or once per point.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    /// How often it runs, for a loop.
    pub(crate) passes: Option<u32>,
    /// Accumulators that begin here as zero.
    pub(crate) fresh: Vec<Id>,
    /// The work.
    pub(crate) work: Vec<Work>,
}

/// A program as work on vectors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Flow {
    /// Home of each value.
    pub(crate) homes: Vec<Home>,
    /// Whether each value is an accumulator, made anew by each addition.
    pub(crate) grows: Vec<bool>,
    /// Bits of each constant.
    pub(crate) constants: Vec<u64>,
    /// Tables of the program that are read, by their new number.
    pub(crate) tables: Vec<usize>,
    /// Pointers.
    pub(crate) streams: Vec<Stream>,
    /// Uniform values that are read: buffer and place.
    pub(crate) uniforms: Vec<(usize, usize)>,
    /// The work in order.
    pub(crate) parts: Vec<Part>,
}

/// Writes a verified program as work; `None` where an input arrives in a way that only the interpreter follows (rows
/// that straddle points).
pub(crate) fn flow(program: &Program, arrivals: &[Arrival]) -> Option<Flow> {
    for (buffer, arrival) in program.inputs.iter().zip(arrivals) {
        if let Arrival::Gathered(width) = *arrival
            && (width == 0 || (buffer.per_point && program.points > 1 && !buffer.len.is_multiple_of(width)))
        {
            return None;
        }
    }
    let needed = needed(program);
    let mut b = Builder { program, arrivals, flow: Flow::default(), value: HashMap::new(), home: HashMap::new() };
    b.flow.parts.push(Part::default());
    for section in &program.sections {
        match section {
            Section::Straight(statements) => {
                b.open(None);
                statements.iter().for_each(|s| b.statement(s.value, &s.op, &needed));
            }
            Section::Loop(_) if program.points == 0 => {}
            Section::Loop(statements) => {
                b.open((program.points > 1).then_some(program.points as u32));
                statements.iter().for_each(|s| b.statement(s.value, &s.op, &needed));
            }
        }
    }
    b.flow.parts.retain(|p| !p.work.is_empty());
    Some(b.flow)
}

/// Which values an output depends on.
fn needed(program: &Program) -> Vec<bool> {
    let mut needed = vec![false; program.value_count];
    for section in program.sections.iter().rev() {
        for s in section.statements().iter().rev() {
            let wanted = match s.op {
                Op::Output { .. } => true,
                Op::Accumulate { into, .. }
                | Op::AccumulateProduct { into, .. }
                | Op::AccumulateNegProduct { into, .. } => needed[into.index()],
                _ => needed[s.value.index()],
            };
            if wanted {
                s.op.operands().for_each(|o| needed[o.index()] = true);
            }
        }
    }
    needed
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    Home(Home),
    /// Buffer, row of the shared array, place in the row.
    Row(u32, u32, u32),
}

struct Builder<'a> {
    program: &'a Program,
    arrivals: &'a [Arrival],
    flow: Flow,
    /// What a value of the program is here.
    value: HashMap<Value, Id>,
    /// What is known already, by where it comes from.
    home: HashMap<Key, Id>,
}

impl Builder<'_> {
    /// Begins a part; straight parts that follow each other are one.
    fn open(&mut self, passes: Option<u32>) {
        let last = self.flow.parts.last().expect("the first part is made before the first section");
        if last.passes.is_some() || passes.is_some() {
            self.flow.parts.push(Part { passes, ..Part::default() });
        }
        if passes.is_some() {
            // What a row of one point held is not what it holds in another loop's pass.
            let inputs = &self.program.inputs;
            self.home.retain(|k, _| !matches!(k, Key::Row(b, ..) if inputs[*b as usize].per_point));
        }
    }

    fn looped(&self) -> bool {
        self.flow.parts.last().is_some_and(|p| p.passes.is_some())
    }

    fn new_value(&mut self, home: Home) -> Id {
        self.flow.homes.push(home);
        self.flow.grows.push(false);
        self.flow.homes.len() as Id - 1
    }

    fn at_home(&mut self, home: Home) -> Id {
        if let Some(&id) = self.home.get(&Key::Home(home)) {
            return id;
        }
        let id = self.new_value(home);
        self.home.insert(Key::Home(home), id);
        id
    }

    fn constant(&mut self, value: f64) -> Id {
        let bits = value.to_bits();
        let at = self.flow.constants.iter().position(|c| *c == bits).unwrap_or_else(|| {
            self.flow.constants.push(bits);
            self.flow.constants.len() - 1
        });
        self.at_home(Home::Constant(at as u32))
    }

    fn stream(&mut self, source: Source, buffer: &Buffer, width: usize) -> u32 {
        if let Some(at) = self.flow.streams.iter().position(|s| s.source == source) {
            return at as u32;
        }
        let moves = !matches!(source, Source::Shared(_));
        let stays = matches!(source, Source::Points(_));
        let per_point = buffer.per_point && self.program.points > 1;
        let stream = Stream {
            source,
            per_group: if moves && !stays { (buffer.total(self.program.points) / width) as u32 } else { 0 },
            per_point: if moves && per_point { (buffer.len / width) as u32 } else { 0 },
        };
        self.flow.streams.push(stream);
        self.flow.streams.len() as u32 - 1
    }

    fn input(&mut self, buffer: usize, index: usize) -> Id {
        let b = &self.program.inputs[buffer];
        let number = buffer as u32;
        match self.arrivals[buffer] {
            Arrival::Lanes => {
                let stream = self.stream(Source::Input(number), b, 1);
                self.at_home(Home::Lanes { stream, place: index as u32 })
            }
            Arrival::Uniform if b.per_point && self.looped() => {
                let stream = self.stream(Source::Points(number), b, 1);
                self.at_home(Home::Point { stream, place: index as u32 })
            }
            Arrival::Uniform => {
                let at = self.flow.uniforms.iter().position(|u| *u == (buffer, index)).unwrap_or_else(|| {
                    self.flow.uniforms.push((buffer, index));
                    self.flow.uniforms.len() - 1
                });
                self.at_home(Home::Uniform(at as u32))
            }
            Arrival::Gathered(width) => self.gathered(number, index, width),
        }
    }

    /// A place of a row: the whole row is gathered where the first of its places is read, before the loop if one array
    /// serves all points.
    fn gathered(&mut self, buffer: u32, index: usize, width: usize) -> Id {
        let key = |axis: usize| Key::Row(buffer, (index / width) as u32, axis as u32);
        if let Some(&id) = self.home.get(&key(index % width)) {
            return id;
        }
        let b = &self.program.inputs[buffer as usize];
        let rows = self.stream(Source::Rows(buffer), b, width);
        let shared = self.stream(Source::Shared(buffer), b, width);
        let whole = width <= 3;
        let mut to = [NONE; 3];
        let axes = if whole { 0..width } else { index % width..index % width + 1 };
        for (slot, axis) in to.iter_mut().zip(axes) {
            *slot = self.new_value(Home::Computed);
            self.home.insert(key(axis), *slot);
        }
        let what = What::Gather {
            rows,
            shared,
            place: (index / width) as u32,
            width: width as u32,
            axis: (!whole).then_some((index % width) as u32),
        };
        let last = self.flow.parts.len() - 1;
        let part = if self.flow.parts[last].passes.is_some() && !b.per_point { self.before(last) } else { last };
        self.flow.parts[part].work.push(Work { what, to, args: [NONE; 3] });
        self.home[&key(index % width)]
    }

    /// The straight part right before a loop.
    fn before(&mut self, part: usize) -> usize {
        if part > 0 && self.flow.parts[part - 1].passes.is_none() {
            return part - 1;
        }
        self.flow.parts.insert(part, Part::default());
        part
    }

    fn push(&mut self, what: What, args: [Id; 3]) -> Id {
        let to = self.new_value(Home::Computed);
        self.push_to(what, to, args);
        to
    }

    fn push_to(&mut self, what: What, to: Id, args: [Id; 3]) {
        let part = self.flow.parts.last_mut().expect("the first part is made before the first section");
        part.work.push(Work { what, to: [to, NONE, NONE], args });
    }

    fn statement(&mut self, value: Value, op: &Op, needed: &[bool]) {
        let wanted = match op {
            Op::Output { .. } => true,
            Op::Accumulate { into, .. }
            | Op::AccumulateProduct { into, .. }
            | Op::AccumulateNegProduct { into, .. } => needed[into.index()],
            _ => needed[value.index()],
        };
        if !wanted {
            return;
        }
        let arg: Vec<Id> = op.operands().map(|o| self.value[&o]).collect();
        let fused = |minus_product, minus_addend| What::Fused { minus_product, minus_addend };
        let id = match *op {
            Op::Constant(c) => self.constant(c),
            // Zero until a loop adds to it.
            Op::Accumulator => self.constant(0.0),
            Op::Input { buffer, index } => self.input(buffer, index),
            Op::Table(t) => {
                let at = self.flow.tables.iter().position(|k| *k == t).unwrap_or_else(|| {
                    self.flow.tables.push(t);
                    self.flow.tables.len() - 1
                });
                if self.looped() {
                    self.at_home(Home::Table(at as u32))
                } else {
                    self.constant(self.program.tables[t][0])
                }
            }
            Op::Add(..) => self.push(What::Add, [arg[0], arg[1], NONE]),
            Op::Sub(..) => self.push(What::Sub, [arg[0], arg[1], NONE]),
            Op::Mul(..) => self.push(What::Mul, [arg[0], arg[1], NONE]),
            Op::Neg(_) => {
                let sign = self.constant(-0.0);
                self.push(What::Xor, [arg[0], sign, NONE])
            }
            Op::MulAdd(..) => self.push(fused(false, false), [arg[0], arg[1], arg[2]]),
            Op::MulSub(..) => self.push(fused(false, true), [arg[0], arg[1], arg[2]]),
            Op::NegMulAdd(..) => self.push(fused(true, false), [arg[0], arg[1], arg[2]]),
            Op::Recip(_) => {
                let one = self.constant(1.0);
                self.push(What::Div, [one, arg[0], NONE])
            }
            Op::Sqrt(_) => self.push(What::Sqrt, [arg[0], NONE, NONE]),
            Op::Ln(_) => self.push(What::Call(Function::Ln), [arg[0], NONE, NONE]),
            Op::Exp(_) => self.push(What::Call(Function::Exp), [arg[0], NONE, NONE]),
            Op::Pow(..) => self.push(What::Call(Function::Pow), [arg[0], arg[1], NONE]),
            Op::Accumulate { into, .. } => return self.accumulate(into, What::Add, [arg[0], arg[1], NONE]),
            Op::AccumulateProduct { into, .. } => {
                return self.accumulate(into, fused(false, false), [arg[1], arg[2], arg[0]]);
            }
            Op::AccumulateNegProduct { into, .. } => {
                return self.accumulate(into, fused(true, false), [arg[1], arg[2], arg[0]]);
            }
            Op::Output { buffer, index, .. } => {
                let b = &self.program.outputs[buffer];
                let stream = self.stream(Source::Output(buffer as u32), b, 1);
                return self.push_to(What::Store { stream, place: index as u32 }, NONE, [arg[0], NONE, NONE]);
            }
        };
        self.value.insert(value, id);
    }

    /// Adds to an accumulator: a new value outside loops, the same one inside.
    fn accumulate(&mut self, into: Value, what: What, mut args: [Id; 3]) {
        let old = self.value[&into];
        if !self.looped() {
            let new = self.push(what, args);
            self.value.insert(into, new);
            return;
        }
        let id = if self.flow.grows[old as usize] {
            old
        } else {
            let new = self.new_value(Home::Computed);
            self.flow.grows[new as usize] = true;
            self.value.insert(into, new);
            let part = self.flow.parts.last_mut().expect("a loop is open");
            part.fresh.push(new);
            new
        };
        // Only the place of the sum: an addend may be the same constant zero that the sum began as.
        args[if matches!(what, What::Add) { 0 } else { 2 }] = id;
        self.push_to(what, id, args);
    }
}
