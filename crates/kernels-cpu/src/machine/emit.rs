//! Steps as bytes of machine code.
//!
//! ```text
//! entry(frame)                     System V: the frame's address in rdi, nothing returned
//!   save rbx rbp r12–r15, load the pointers of the streams
//!   for each group
//!     for each half                only where a register holds fewer numbers than a group has lanes
//!       steps; loops over points count r11 down
//!       every pointer on by half a place
//!     every pointer on by a group
//!   restore, return
//! ```
//!
//! | register | holds |
//! |---|---|
//! | rdi | the frame: counters, pointers, call area, uniform values, slots |
//! | rsi | the pool: constants, then tables, [point][table] |
//! | rax rcx rdx r8 | row numbers of a gather; rax also a pointer that has no register |
//! | r11 | passes left of a loop |
//! | rbx rbp r12–r15 r9 r10 | pointers of streams, those used most; the others stay in the frame |
//!
//! All jumps go backwards: every count is at least one.

use super::allocate::{Address, Allocation, Operand, Step};
use super::flow::{Flow, Function, Home, Source, Stream, What};
use super::gather;
use super::target::Target;
use iced_x86::{Code, Encoder, Instruction, MemoryOperand, Register};
use souple_kernels::LANES;
use std::collections::HashSet;

/// Where things are in the frame, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Arguments and results of calls.
    pub(crate) call: u32,
    /// Uniform values.
    pub(crate) uniforms: u32,
    /// Spilled vectors.
    pub(crate) slots: u32,
    /// Bytes in all.
    pub(crate) size: u32,
}

impl Layout {
    /// Groups left to run.
    pub(crate) const GROUPS: u32 = 0;
    /// Halves of the group left to run.
    pub(crate) const HALVES: u32 = 8;
    /// Address of the pool.
    pub(crate) const POOL: u32 = 16;
    /// Addresses of the functions: ln, exp, pow.
    pub(crate) const FUNCTIONS: u32 = 24;
    /// Pointers of the streams.
    pub(crate) const STREAMS: u32 = 48;
    /// Bytes of one argument of a call.
    pub(crate) const ARGUMENT: u32 = 64;

    fn new(target: Target, flow: &Flow, slots: u32) -> Layout {
        let round = |bytes: u32| bytes.next_multiple_of(64);
        let call = round(Layout::STREAMS + 8 * flow.streams.len() as u32);
        let uniforms = call + 2 * Layout::ARGUMENT;
        let slots_at = round(uniforms + target.constant() * flow.uniforms.len() as u32);
        Layout { call, uniforms, slots: slots_at, size: slots_at + target.vector() * slots }
    }
}

/// Offset of a function's address in the frame.
pub(crate) fn function_at(function: Function) -> u32 {
    Layout::FUNCTIONS
        + match function {
            Function::Ln => 0,
            Function::Exp => 8,
            Function::Pow => 16,
        }
}

/// Machine code and what it expects around it.
#[derive(Clone, Debug)]
pub(crate) struct Assembly {
    /// The code.
    pub(crate) code: Vec<u8>,
    /// Constants and tables, to lie at a multiple of 64 bytes.
    pub(crate) pool: Vec<u8>,
    /// The frame.
    pub(crate) layout: Layout,
}

/// Pointers that have registers, by priority.
const POINTERS: [Register; 8] = [
    Register::RBX,
    Register::RBP,
    Register::R12,
    Register::R13,
    Register::R14,
    Register::R15,
    Register::R9,
    Register::R10,
];

/// Bytes by which lanes are asked for ahead of their use, at least. Of 1, 2, 4 and 8 KiB this was the best for streams
/// from memory; for data in a cache none costs more than what one run differs from the next.
const AHEAD: i64 = 1024;

const FRAME: Register = Register::RDI;
const POOL: Register = Register::RSI;
const SAVED: [Register; 6] = [Register::RBX, Register::RBP, Register::R12, Register::R13, Register::R14, Register::R15];
/// What a call may change and this code needs afterwards; five, so that the stack stays aligned.
const ACROSS: [Register; 5] = [FRAME, POOL, Register::R9, Register::R10, Register::R11];

/// Encodes an allocation; `None` where there are more gathered inputs than registers for their arrays.
pub(crate) fn emit(target: Target, flow: &Flow, allocation: &Allocation, tables: &[Vec<f64>]) -> Option<Assembly> {
    let (pool, tables_at) = pool(target, flow, tables);
    let mut free = POINTERS.to_vec();
    let table = (!flow.tables.is_empty()).then(|| free.remove(0));
    let pointers = pointers(flow, allocation, &free)?;
    let mut e = Emitter {
        target,
        flow,
        layout: Layout::new(target, flow, allocation.slots),
        pointers,
        table,
        tables_at,
        asked: HashSet::new(),
        looped: false,
        begin: 0,
        passes: 0,
        encoder: Encoder::new(64),
        length: 0,
    };
    e.whole(allocation);
    Some(Assembly { code: e.encoder.take_buffer(), pool, layout: e.layout })
}

/// Bits of a number as the target has it.
fn number(target: Target, value: f64) -> Vec<u8> {
    match target {
        Target::Avx2Single => (value as f32).to_le_bytes().to_vec(),
        Target::Avx2 | Target::Avx512 => value.to_le_bytes().to_vec(),
    }
}

fn pool(target: Target, flow: &Flow, tables: &[Vec<f64>]) -> (Vec<u8>, u32) {
    let mut pool = Vec::new();
    let copies = target.constant() / target.number();
    for bits in &flow.constants {
        (0..copies).for_each(|_| pool.extend(number(target, f64::from_bits(*bits))));
    }
    let tables_at = pool.len() as u32;
    let points = tables.first().map_or(0, Vec::len);
    for point in 0..points {
        flow.tables.iter().for_each(|t| pool.extend(number(target, tables[*t][point])));
    }
    (pool, tables_at)
}

/// A register for each stream, `None` for those that stay in the frame.
fn pointers(flow: &Flow, allocation: &Allocation, free: &[Register]) -> Option<Vec<Option<Register>>> {
    let mut uses = vec![0u64; flow.streams.len()];
    let mut weight = 1;
    for step in &allocation.steps {
        let mut count = |address: &Address| {
            if let Address::Home(Home::Lanes { stream, .. } | Home::Point { stream, .. }) = address {
                uses[*stream as usize] += weight;
            }
        };
        match step {
            Step::Load { from, .. } => count(from),
            Step::Store { at, .. } => count(at),
            Step::Two { b: Operand::Memory(m), .. }
            | Step::Sqrt { a: Operand::Memory(m), .. }
            | Step::Fused { c: Operand::Memory(m), .. } => count(m),
            Step::Gather { rows, .. } => uses[*rows as usize] += weight,
            Step::Begin { passes } => weight = u64::from(*passes),
            Step::End => weight = 1,
            _ => {}
        }
    }
    let shared = |k: usize| matches!(flow.streams[k].source, Source::Shared(_));
    let mut by_use: Vec<usize> = (0..flow.streams.len()).collect();
    // Shared arrays must have one: a gather has no register to load theirs into.
    by_use.sort_by_key(|k| (!shared(*k), std::cmp::Reverse(uses[*k]), *k));
    let mut pointers = vec![None; flow.streams.len()];
    for (&stream, &register) in by_use.iter().zip(free) {
        pointers[stream] = Some(register);
    }
    (0..pointers.len()).all(|k| pointers[k].is_some() || !shared(k)).then_some(pointers)
}

/// Memory at a base.
pub(crate) fn memory(base: Register, offset: i64) -> MemoryOperand {
    MemoryOperand::with_base_displ_size(base, offset, u32::from(offset != 0))
}

pub(crate) struct Emitter<'a> {
    pub(crate) target: Target,
    flow: &'a Flow,
    layout: Layout,
    pointers: Vec<Option<Register>>,
    table: Option<Register>,
    tables_at: u32,
    /// Places of lanes that are asked for ahead of their use.
    asked: HashSet<(u32, u32)>,
    /// Whether a loop is open.
    looped: bool,
    /// Where the current loop begins.
    begin: u64,
    passes: u32,
    encoder: Encoder,
    /// Bytes encoded so far.
    length: u64,
}

impl Emitter<'_> {
    fn here(&self) -> u64 {
        self.length
    }

    /// Appends an instruction.
    pub(crate) fn push(&mut self, instruction: Result<Instruction, iced_x86::IcedError>) {
        let instruction = instruction.expect("operands fit the instruction");
        let at = self.here();
        let length = self.encoder.encode(&instruction, at).expect("the instruction can be encoded");
        self.length += length as u64;
    }

    fn whole(&mut self, allocation: &Allocation) {
        for register in SAVED {
            self.push(Instruction::with1(Code::Push_r64, register));
        }
        self.push(Instruction::with2(Code::Mov_r64_rm64, POOL, memory(FRAME, Layout::POOL.into())));
        for stream in 0..self.pointers.len() {
            if let Some(register) = self.pointers[stream] {
                let from = memory(FRAME, self.stream_at(stream));
                self.push(Instruction::with2(Code::Mov_r64_rm64, register, from));
            }
        }
        let halves = self.target.halves();
        let each_group = self.here();
        if halves > 1 {
            let at = memory(FRAME, Layout::HALVES.into());
            self.push(Instruction::with2(Code::Mov_rm64_imm32, at, halves as i32));
        }
        let each_half = self.here();
        for step in &allocation.steps {
            self.step(step);
        }
        if halves > 1 {
            self.advance(|e, stream| e.half(stream));
            self.count_down(memory(FRAME, Layout::HALVES.into()), each_half);
        }
        self.advance(|e, stream| {
            let within = if halves > 1 { i64::from(halves) * e.half(stream) } else { 0 };
            i64::from(e.flow.streams[stream].per_group) * e.place(stream) - within
        });
        self.count_down(memory(FRAME, Layout::GROUPS.into()), each_group);
        self.push(Ok(Instruction::with(Code::VEX_Vzeroupper)));
        for register in SAVED.into_iter().rev() {
            self.push(Instruction::with1(Code::Pop_r64, register));
        }
        self.push(Ok(Instruction::with(Code::Retnq)));
    }

    fn stream_at(&self, stream: usize) -> i64 {
        i64::from(Layout::STREAMS) + 8 * stream as i64
    }

    /// Bytes of a place of a stream.
    fn place(&self, stream: usize) -> i64 {
        i64::from(match self.flow.streams[stream].source {
            Source::Input(_) | Source::Output(_) => LANES as u32 * self.target.number(),
            Source::Rows(_) => LANES as u32 * 4,
            Source::Points(_) | Source::Shared(_) => self.target.number(),
        })
    }

    /// Bytes from the first half of a place to the second.
    fn half(&self, stream: usize) -> i64 {
        match self.flow.streams[stream].source {
            Source::Input(_) | Source::Output(_) | Source::Rows(_) => {
                self.place(stream) / i64::from(self.target.halves())
            }
            Source::Points(_) | Source::Shared(_) => 0,
        }
    }

    /// Moves pointers on by so many bytes each.
    fn advance(&mut self, by: impl Fn(&Self, usize) -> i64) {
        for stream in 0..self.pointers.len() {
            let bytes = by(self, stream);
            if bytes == 0 {
                continue;
            }
            let bytes = i32::try_from(bytes).expect("a group takes less than 2 GiB");
            let at = memory(FRAME, self.stream_at(stream));
            self.push(match self.pointers[stream] {
                Some(register) => Instruction::with2(Code::Add_rm64_imm32, register, bytes),
                None => Instruction::with2(Code::Add_rm64_imm32, at, bytes),
            });
        }
    }

    fn count_down(&mut self, counter: MemoryOperand, to: u64) {
        self.push(Instruction::with1(Code::Dec_rm64, counter));
        self.push(Instruction::with_branch(Code::Jne_rel32_64, to));
    }

    fn step(&mut self, step: &Step) {
        let t = self.target;
        let r = |number: u8| t.register(number);
        match *step {
            Step::Load { to, from } => {
                self.ask_ahead(from);
                let (at, scalar) = self.address(from);
                self.push(Instruction::with2(if scalar { t.spread() } else { t.load() }, r(to), at));
            }
            Step::Copy { to, from } => self.push(Instruction::with2(t.copy(), r(to), r(from))),
            Step::Store { at, from } => {
                self.ask_ahead(at);
                let (at, _) = self.address(at);
                self.push(Instruction::with2(t.store(), at, r(from)));
            }
            Step::Two { what, to, a, b } => match b {
                Operand::Register(b) => self.push(Instruction::with3(t.two(what), r(to), r(a), r(b))),
                Operand::Memory(b) => {
                    let at = self.operand(b);
                    self.push(Instruction::with3(t.two(what), r(to), r(a), at));
                }
            },
            Step::Sqrt { to, a } => match a {
                Operand::Register(a) => self.push(Instruction::with2(t.sqrt(), r(to), r(a))),
                Operand::Memory(a) => {
                    let at = self.operand(a);
                    self.push(Instruction::with2(t.sqrt(), r(to), at));
                }
            },
            Step::Fused { minus_product, minus_addend, form, to, b, c } => {
                let code = t.fused(minus_product, minus_addend, form);
                match c {
                    Operand::Register(c) => self.push(Instruction::with3(code, r(to), r(b), r(c))),
                    Operand::Memory(c) => {
                        let at = self.operand(c);
                        self.push(Instruction::with3(code, r(to), r(b), at));
                    }
                }
            }
            Step::Zero { to } => self.push(Instruction::with3(t.two(What::Xor), r(to), r(to), r(to))),
            Step::Gather { rows, shared, place, width, axis, to, spare } => {
                let rows = (self.pointers[rows as usize], memory(FRAME, self.stream_at(rows as usize)));
                let shared = self.pointers[shared as usize].expect("shared arrays have registers");
                gather::gather(self, rows, shared, place, width, axis, to, spare);
            }
            Step::Call(function) => {
                self.push(Ok(Instruction::with(Code::VEX_Vzeroupper)));
                ACROSS.into_iter().for_each(|register| self.push(Instruction::with1(Code::Push_r64, register)));
                self.push(Instruction::with2(Code::Mov_r64_rm64, Register::RAX, FRAME));
                let argument = self.layout.call as i32;
                self.push(Instruction::with2(Code::Add_rm64_imm32, FRAME, argument));
                let function = memory(Register::RAX, function_at(function).into());
                self.push(Instruction::with1(Code::Call_rm64, function));
                ACROSS.into_iter().rev().for_each(|register| self.push(Instruction::with1(Code::Pop_r64, register)));
            }
            Step::Begin { passes } => {
                self.push(Instruction::with2(Code::Mov_r32_imm32, Register::R11D, passes));
                if let Some(table) = self.table {
                    let tables = memory(POOL, self.tables_at.into());
                    self.push(Instruction::with2(Code::Lea_r64_m, table, tables));
                }
                self.looped = true;
                self.passes = passes;
                self.begin = self.here();
            }
            Step::End => {
                self.advance(|e, stream| i64::from(e.flow.streams[stream].per_point) * e.place(stream));
                if let Some(table) = self.table {
                    let bytes = t.number() as i32 * self.flow.tables.len() as i32;
                    self.push(Instruction::with2(Code::Add_rm64_imm32, table, bytes));
                }
                self.push(Instruction::with1(Code::Dec_rm64, Register::R11));
                self.push(Instruction::with_branch(Code::Jne_rel32_64, self.begin));
                self.looped = false;
                let passes = i64::from(self.passes);
                self.advance(|e, stream| -passes * i64::from(e.flow.streams[stream].per_point) * e.place(stream));
            }
        }
    }

    /// An address as the last operand of arithmetic.
    fn operand(&mut self, address: Address) -> MemoryOperand {
        self.ask_ahead(address);
        let (mut at, scalar) = self.address(address);
        at.is_broadcast = scalar;
        at
    }

    /// An address, and whether a scalar is there.
    fn address(&mut self, address: Address) -> (MemoryOperand, bool) {
        let t = self.target;
        let narrow = t.constant() == t.number();
        match address {
            Address::Slot(k) => (memory(FRAME, (self.layout.slots + k * t.vector()).into()), false),
            Address::Call(k) => (memory(FRAME, (self.layout.call + k * Layout::ARGUMENT).into()), false),
            Address::Home(Home::Constant(k)) => (memory(POOL, (k * t.constant()).into()), narrow),
            Address::Home(Home::Uniform(k)) => {
                (memory(FRAME, (self.layout.uniforms + k * t.constant()).into()), narrow)
            }
            Address::Home(Home::Table(k)) => {
                let table = self.table.expect("a program that reads tables has a pointer to them");
                (memory(table, (k * t.number()).into()), true)
            }
            Address::Home(Home::Lanes { stream, place }) => (self.in_stream(stream, place), false),
            Address::Home(Home::Point { stream, place }) => (self.in_stream(stream, place), true),
            Address::Home(Home::Computed) => unreachable!("what is computed is in a slot"),
        }
    }

    /// Asks the memory for a place of lanes of a later group or point, where this place is read or written first: the
    /// processor's own guesses end with every page. What is asked for beyond the end of a buffer is never touched.
    fn ask_ahead(&mut self, address: Address) {
        let Address::Home(Home::Lanes { stream, place }) = address else { return };
        let Some(base) = self.pointers[stream as usize] else { return };
        let Stream { per_group, per_point, .. } = self.flow.streams[stream as usize];
        // What every pass reads again is asked for by none.
        if self.looped && per_point == 0 || !self.asked.insert((stream, place)) {
            return;
        }
        let step = i64::from(if per_point > 0 { per_point } else { per_group }) * self.place(stream as usize);
        let ahead = (AHEAD + step - 1) / step * step;
        let offset = i64::from(place) * self.place(stream as usize) + ahead;
        self.push(Instruction::with1(Code::Prefetcht0_m8, memory(base, offset)));
    }

    fn in_stream(&mut self, stream: u32, place: u32) -> MemoryOperand {
        let offset = i64::from(place) * self.place(stream as usize);
        match self.pointers[stream as usize] {
            Some(register) => memory(register, offset),
            None => {
                let from = memory(FRAME, self.stream_at(stream as usize));
                self.push(Instruction::with2(Code::Mov_r64_rm64, Register::RAX, from));
                memory(Register::RAX, offset)
            }
        }
    }
}
