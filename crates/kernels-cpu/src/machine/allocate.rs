//! Registers for the values of a flow.
//!
//! Belady's rule: when a register is needed, the value whose next use is furthest goes ("A study of replacement
//! algorithms for a virtual-storage computer", 1966).
//! A value that memory holds anyhow goes for nothing; a computed one is stored to a slot of the scratch block once, and
//! is free to go afterwards.
//! A value in memory is read by the arithmetic itself where that costs no more than loading it.
//!
//! A loop begins and ends with everything in memory except accumulators that keep a register throughout; how many do
//! is a choice, and so is the order of the work; both are made in [`choice`](super::choice).

use super::flow::{Flow, Function, Home, Id, NONE, Part, What, Work};

/// A place in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Address {
    /// A spilled vector.
    Slot(u32),
    /// Where a value is at home.
    Home(Home),
    /// Argument of a call, and its result.
    Call(u32),
}

/// The second operand of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operand {
    /// A register.
    Register(u8),
    /// Memory.
    Memory(Address),
}

/// Which role of a fused multiply-add its result overwrites.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// to = to · b + c.
    Factor213,
    /// to = to · c + b.
    Factor132,
    /// to = b · c + to.
    Addend231,
}

/// Spare registers of a gather, beside its three results.
pub(crate) const SPARE: usize = 4;

/// One machine instruction, or a fixed sequence of a few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// to = memory, spread over the lanes if it is a scalar.
    Load { to: u8, from: Address },
    /// to = from.
    Copy { to: u8, from: u8 },
    /// Memory = from.
    Store { at: Address, from: u8 },
    /// to = a ∘ b.
    Two { what: What, to: u8, a: u8, b: Operand },
    /// to = √a.
    Sqrt { to: u8, a: Operand },
    /// A fused multiply-add that overwrites one of its operands.
    Fused { minus_product: bool, minus_addend: bool, form: Form, to: u8, b: u8, c: Operand },
    /// to = 0.
    Zero { to: u8 },
    /// A row of a shared array.
    Gather { rows: u32, shared: u32, place: u32, width: u32, axis: Option<u32>, to: [u8; 3], spare: [u8; SPARE] },
    /// Calls a function on the call area; no vector register survives.
    Call(Function),
    /// Begins a loop of so many passes.
    Begin { passes: u32 },
    /// Ends it.
    End,
}

/// What the registers can do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Registers {
    /// How many there are.
    pub(crate) count: u8,
    /// Whether arithmetic can read a scalar and spread it over the lanes.
    pub(crate) spreads: bool,
    /// Whether constants and uniform values are kept as whole vectors.
    pub(crate) wide_constants: bool,
    /// Spare registers that a gather needs.
    pub(crate) gather_spare: usize,
}

/// Steps with registers.
#[derive(Clone, Debug)]
pub(crate) struct Allocation {
    /// The instructions.
    pub(crate) steps: Vec<Step>,
    /// Slots of the scratch block that are used.
    pub(crate) slots: u32,
}

/// The last part that reads each value; within loops, what comes from before is read to the end.
pub(crate) fn last_parts(flow: &Flow) -> Vec<u32> {
    let mut last = vec![0; flow.homes.len()];
    for (k, part) in flow.parts.iter().enumerate() {
        part.work.iter().flat_map(|w| w.reads()).for_each(|id| last[id as usize] = k as u32);
    }
    last
}

/// Accumulators that a part adds to, those added to most first.
pub(crate) fn accumulators(flow: &Flow, part: &Part) -> Vec<Id> {
    if part.passes.is_none() {
        return Vec::new();
    }
    let mut found: Vec<(u32, Id)> = Vec::new();
    let mut at = vec![usize::MAX; flow.homes.len()];
    for id in part.work.iter().flat_map(|w| w.makes()).filter(|id| flow.grows[*id as usize]) {
        if at[id as usize] == usize::MAX {
            at[id as usize] = found.len();
            found.push((0, id));
        }
        found[at[id as usize]].0 += 1;
    }
    found.sort_by_key(|f| (std::cmp::Reverse(f.0), f.1));
    found.into_iter().map(|f| f.1).collect()
}

/// Never read again.
const DEAD: u32 = u32::MAX;
/// Read again, but not in this part.
const LATER: u32 = u32::MAX - 1;
/// In no register.
const NOWHERE: u8 = u8::MAX;

pub(crate) struct Allocator<'a> {
    flow: &'a Flow,
    registers: Registers,
    last_part: &'a [u32],
    keep: usize,
    /// Value in each register.
    holds: Vec<Id>,
    /// Register of each value.
    register: Vec<u8>,
    /// Registers that keep an accumulator through the current loop.
    kept: u64,
    /// Registers that the current piece of work needs as they are.
    locked: u64,
    /// Position of the next use of each value in the current part.
    next: Vec<u32>,
    /// Spill slot of each value.
    slot: Vec<u32>,
    /// Whether the slot holds the current value.
    stored: Vec<bool>,
    free_slots: Vec<u32>,
    /// Slots of values that the current instruction reads last: free for the next one.
    leaving: Vec<u32>,
    slots: u32,
    steps: Vec<Step>,
    at: u32,
}

impl<'a> Allocator<'a> {
    pub(crate) fn new(flow: &'a Flow, registers: Registers, last_part: &'a [u32], keep: usize) -> Allocator<'a> {
        let values = flow.homes.len();
        Allocator {
            flow,
            registers,
            last_part,
            keep,
            holds: vec![NONE; registers.count as usize],
            register: vec![NOWHERE; values],
            kept: 0,
            locked: 0,
            next: vec![DEAD; values],
            slot: vec![NONE; values],
            stored: vec![false; values],
            free_slots: Vec::new(),
            leaving: Vec::new(),
            slots: 0,
            steps: Vec::new(),
            at: 0,
        }
    }

    pub(crate) fn run(mut self, parts: &[Vec<Work>]) -> Allocation {
        for (k, work) in parts.iter().enumerate() {
            let passes = self.flow.parts[k].passes;
            if let Some(passes) = passes {
                self.begin(k, passes);
            }
            self.part(k as u32, work, passes.is_some());
            if passes.is_some() {
                self.end();
            }
        }
        Allocation { steps: self.steps, slots: self.slots }
    }

    fn outlives(&self, id: Id, part: u32) -> bool {
        self.last_part[id as usize] > part
    }

    /// Work of a part: next uses are counted backwards, then registers are given forwards.
    fn part(&mut self, part: u32, work: &[Work], looped: bool) {
        let made_here: Vec<Id> =
            work.iter().flat_map(|w| w.makes()).filter(|id| !self.flow.grows[*id as usize]).collect();
        // In a loop everything from outside is read again by the next pass.
        for id in 0..self.flow.homes.len() as u32 {
            let computed = self.flow.homes[id as usize] == Home::Computed;
            let again = computed && (self.outlives(id, part) || looped);
            self.next[id as usize] = if again { LATER } else { DEAD };
        }
        for id in made_here {
            self.next[id as usize] = if self.outlives(id, part) { LATER } else { DEAD };
        }
        let mut after = vec![[DEAD; 3]; work.len()];
        let mut made = vec![[DEAD; 3]; work.len()];
        for (k, w) in work.iter().enumerate().rev() {
            for (slot, &id) in made[k].iter_mut().zip(&w.to).filter(|(_, id)| **id != NONE) {
                *slot = self.next[id as usize];
            }
            for (slot, &id) in after[k].iter_mut().zip(&w.args).filter(|(_, id)| **id != NONE) {
                *slot = self.next[id as usize];
            }
            for id in w.reads() {
                self.next[id as usize] = k as u32;
            }
        }
        // What neither this part nor a later one reads.
        for id in 0..self.flow.homes.len() as u32 {
            if self.next[id as usize] == DEAD && (self.is_in(id) || self.slot[id as usize] != NONE) {
                self.forget(id);
            }
        }
        for (k, w) in work.iter().enumerate() {
            self.at = k as u32;
            self.locked = 0;
            self.free_slots.append(&mut self.leaving);
            for (&id, &next) in w.args.iter().zip(&after[k]).filter(|(id, _)| **id != NONE) {
                self.next[id as usize] = next;
            }
            self.piece(w, &made[k]);
        }
    }

    /// Before a loop: what lives on goes to memory, except accumulators that keep a register.
    fn begin(&mut self, part: usize, passes: u32) {
        let flow = self.flow;
        self.at = 0;
        self.locked = 0;
        let all = accumulators(flow, &flow.parts[part]);
        let kept: Vec<Id> = all.iter().copied().take(self.keep).collect();
        let mut is_fresh = vec![false; flow.homes.len()];
        flow.parts[part].fresh.iter().for_each(|id| is_fresh[*id as usize] = true);
        for r in 0..self.holds.len() {
            let id = self.holds[r];
            if id == NONE || kept.contains(&id) {
                continue;
            }
            let computed = flow.homes[id as usize] == Home::Computed;
            if computed && self.last_part[id as usize] >= part as u32 {
                self.store(id);
            }
            self.leave(id);
        }
        for &id in &all {
            let fresh = is_fresh[id as usize];
            let keeps = kept.contains(&id);
            if self.register[id as usize] == NOWHERE && (keeps || fresh) {
                let r = self
                    .holds
                    .iter()
                    .position(|h| *h == NONE)
                    .expect("fewer accumulators keep registers than there are");
                if fresh {
                    self.steps.push(Step::Zero { to: r as u8 });
                } else {
                    let from = self.address(id);
                    self.steps.push(Step::Load { to: r as u8, from });
                }
                self.put(id, r as u8);
                self.stored[id as usize] = !fresh;
            }
            if keeps {
                self.kept |= 1 << self.register[id as usize];
                self.stored[id as usize] = false;
            } else if self.register[id as usize] != NOWHERE {
                self.store(id);
                self.leave(id);
            }
        }
        self.steps.push(Step::Begin { passes });
    }

    /// After a pass: accumulators without a register go back to memory, the rest is forgotten.
    fn end(&mut self) {
        for r in 0..self.holds.len() {
            let id = self.holds[r];
            if id == NONE || self.kept >> r & 1 == 1 {
                continue;
            }
            if self.flow.grows[id as usize] {
                self.store(id);
            }
            self.leave(id);
        }
        self.steps.push(Step::End);
        self.kept = 0;
    }

    fn put(&mut self, id: Id, r: u8) {
        self.holds[r as usize] = id;
        self.register[id as usize] = r;
    }

    /// Takes a value out of its register; where else it is does not change.
    fn leave(&mut self, id: Id) {
        let r = std::mem::replace(&mut self.register[id as usize], NOWHERE);
        if r != NOWHERE {
            self.holds[r as usize] = NONE;
        }
    }

    /// Nobody reads it any more.
    fn forget(&mut self, id: Id) {
        self.leave(id);
        let slot = std::mem::replace(&mut self.slot[id as usize], NONE);
        if slot != NONE {
            self.leaving.push(slot);
        }
        self.stored[id as usize] = false;
    }

    fn clean(&self, id: Id) -> bool {
        self.flow.homes[id as usize] != Home::Computed || self.stored[id as usize]
    }

    /// Writes a value to its slot unless memory has it already.
    fn store(&mut self, id: Id) {
        if self.clean(id) {
            return;
        }
        if self.slot[id as usize] == NONE {
            self.slot[id as usize] = self.free_slots.pop().unwrap_or_else(|| {
                self.slots += 1;
                self.slots - 1
            });
        }
        self.stored[id as usize] = true;
        self.steps.push(Step::Store { at: Address::Slot(self.slot[id as usize]), from: self.register[id as usize] });
    }

    fn address(&self, id: Id) -> Address {
        match self.flow.homes[id as usize] {
            Home::Computed => {
                debug_assert!(self.stored[id as usize], "value {id} is neither in a register nor in memory");
                Address::Slot(self.slot[id as usize])
            }
            home => Address::Home(home),
        }
    }

    /// How far away the next use of what a register holds is, and whether it can go without a store.
    fn distance(&self, r: usize) -> (u64, bool) {
        let id = self.holds[r];
        match self.next[id as usize] {
            LATER | DEAD => (1 << 32, true),
            next => (u64::from(next.saturating_sub(self.at)), self.clean(id)),
        }
    }

    fn blocked(&self, r: usize) -> bool {
        (self.kept | self.locked) >> r & 1 == 1
    }

    /// The register whose value is missed least, and how far its next use is.
    fn victim(&self) -> (usize, u64, bool) {
        let mut best = (usize::MAX, 0, false, 0);
        for r in (0..self.holds.len()).filter(|r| !self.blocked(*r)) {
            let (distance, clean) = self.distance(r);
            // What must be stored first has to be twice as far.
            let key = if clean { 2 * distance } else { distance };
            if best.0 == usize::MAX || key > best.3 {
                best = (r, distance, clean, key);
            }
        }
        assert!(best.0 != usize::MAX, "a piece of work locks fewer registers than there are");
        (best.0, best.1, best.2)
    }

    /// A free register, made so if need be.
    fn take(&mut self) -> u8 {
        if let Some(r) = (0..self.holds.len()).find(|r| self.holds[*r] == NONE && !self.blocked(*r)) {
            return r as u8;
        }
        let (r, ..) = self.victim();
        let id = self.holds[r];
        if self.next[id as usize] != DEAD {
            self.store(id);
        }
        self.leave(id);
        r as u8
    }

    fn lock(&mut self, r: u8) {
        self.locked |= 1 << r;
    }

    /// The register of a value, loaded if need be, and locked.
    fn in_register(&mut self, id: Id) -> u8 {
        if self.register[id as usize] == NOWHERE {
            let r = self.take();
            let from = self.address(id);
            self.steps.push(Step::Load { to: r, from });
            self.put(id, r);
        }
        let r = self.register[id as usize];
        self.lock(r);
        r
    }

    fn is_in(&self, id: Id) -> bool {
        self.register[id as usize] != NOWHERE
    }

    /// Whether arithmetic can read a value from where it is in memory.
    fn folds(&self, id: Id) -> bool {
        match self.flow.homes[id as usize] {
            Home::Computed | Home::Lanes { .. } => true,
            Home::Constant(_) | Home::Uniform(_) => self.registers.spreads || self.registers.wide_constants,
            Home::Point { .. } | Home::Table(_) => self.registers.spreads,
        }
    }

    /// Whether a value that is in memory is worth a register of its own: it is read again before whatever would have to
    /// go, and that can go for nothing.
    fn worth(&self, id: Id) -> bool {
        let next = self.next[id as usize];
        if next == DEAD || next == LATER {
            return false;
        }
        if (0..self.holds.len()).any(|r| self.holds[r] == NONE && !self.blocked(r)) {
            return true;
        }
        if (0..self.holds.len()).all(|r| self.blocked(r)) {
            return false;
        }
        let (_, distance, clean) = self.victim();
        clean && distance > u64::from(next - self.at)
    }

    /// A value as the operand that may be memory.
    fn operand(&mut self, id: Id) -> Operand {
        if self.is_in(id) || !self.folds(id) || self.worth(id) {
            return Operand::Register(self.in_register(id));
        }
        Operand::Memory(self.address(id))
    }

    /// Gives up what is not read again, so that its register can take the result.
    fn bury(&mut self, w: &Work) {
        for id in w.reads() {
            if self.next[id as usize] == DEAD && !(self.flow.grows[id as usize] && w.to[0] == id) {
                if self.is_in(id) {
                    self.locked &= !(1 << self.register[id as usize]);
                }
                self.forget(id);
            }
        }
    }

    /// Where the result goes: the register that an accumulator keeps, or any.
    fn result(&mut self, w: &Work) -> u8 {
        let id = w.to[0];
        if self.flow.grows[id as usize] && self.is_in(id) {
            return self.register[id as usize];
        }
        self.take()
    }

    fn define(&mut self, id: Id, r: u8, next: u32) {
        if self.register[id as usize] != r {
            self.leave(id);
            self.put(id, r);
        }
        self.stored[id as usize] = false;
        self.next[id as usize] = next;
        if next == DEAD {
            self.forget(id);
        }
    }

    fn piece(&mut self, w: &Work, made: &[u32; 3]) {
        let [a, b, _] = w.args;
        // Loading one operand must not push out another.
        for id in w.reads() {
            if self.is_in(id) {
                self.lock(self.register[id as usize]);
            }
        }
        match w.what {
            What::Add | What::Mul | What::Sub | What::Div | What::Xor => {
                let commutes = matches!(w.what, What::Add | What::Mul | What::Xor);
                // The operand that stays in memory is the second one.
                let swap = commutes && a != b && self.second_is_better_first(a, b);
                let (a, b) = if swap { (b, a) } else { (a, b) };
                let first = self.in_register(a);
                let second = self.operand(b);
                self.bury(w);
                let to = self.result(w);
                self.steps.push(Step::Two { what: w.what, to, a: first, b: second });
                self.define(w.to[0], to, made[0]);
            }
            What::Sqrt => {
                let a = self.operand(a);
                self.bury(w);
                let to = self.result(w);
                self.steps.push(Step::Sqrt { to, a });
                self.define(w.to[0], to, made[0]);
            }
            What::Fused { minus_product, minus_addend } => self.fused(w, minus_product, minus_addend, made[0]),
            What::Store { stream, place } => {
                let from = self.in_register(a);
                self.steps.push(Step::Store { at: Address::Home(Home::Lanes { stream, place }), from });
                self.bury(w);
            }
            What::Gather { rows, shared, place, width, axis } => {
                let mut to = [0; 3];
                let mut spare = [0; SPARE];
                for slot in to.iter_mut().chain(&mut spare[..self.registers.gather_spare]) {
                    *slot = self.take();
                    self.lock(*slot);
                }
                self.steps.push(Step::Gather { rows, shared, place, width, axis, to, spare });
                for (k, id) in w.makes().enumerate() {
                    self.define(id, to[k], made[k]);
                }
            }
            What::Call(function) => self.call(w, function, made[0]),
        }
    }

    /// Whether a commutative operation should swap its operands: the second is in a register and the first is not, or
    /// the first is the one to be read from memory.
    fn second_is_better_first(&self, a: Id, b: Id) -> bool {
        match (self.is_in(a), self.is_in(b)) {
            (true, _) => false,
            (false, true) => true,
            (false, false) => match (self.folds(a), self.folds(b)) {
                (true, false) => true,
                (false, true) | (false, false) => false,
                // What is read again soonest deserves the register.
                (true, true) => self.next[b as usize] < self.next[a as usize],
            },
        }
    }

    fn fused(&mut self, w: &Work, minus_product: bool, minus_addend: bool, made: u32) {
        let [mut a, mut b, c] = w.args;
        // A value that is read twice cannot be memory in one place and be overwritten in the other.
        for id in [a, b, c] {
            if [a, b, c].iter().filter(|o| **o == id).count() > 1 {
                self.in_register(id);
            }
        }
        let dies = |s: &Self, id: Id| {
            s.is_in(id)
                && s.kept >> s.register[id as usize] & 1 == 0
                && (s.next[id as usize] == DEAD || (s.flow.grows[id as usize] && w.to[0] == id))
        };
        let kept_sum = self.flow.grows[c as usize]
            && w.to[0] == c
            && self.is_in(c)
            && self.kept >> self.register[c as usize] & 1 == 1;
        // All but one operand must be in registers; the one that stays in memory is the one read again latest.
        loop {
            let outside: Vec<Id> = [a, b, c].into_iter().filter(|id| !self.is_in(*id)).collect();
            let overwritable = kept_sum || [a, b, c].iter().any(|id| dies(self, *id));
            let load = match outside.len() {
                0 => break,
                1 if overwritable => {
                    let id = outside[0];
                    if !self.folds(id) || self.worth(id) {
                        id
                    } else {
                        break;
                    }
                }
                // Loading it gives a register that may be overwritten, for the price of a copy.
                1 => outside[0],
                _ => outside
                    .iter()
                    .copied()
                    .min_by_key(|id| (self.folds(*id), self.next[*id as usize]))
                    .expect("there are several"),
            };
            self.in_register(load);
        }
        let memory = [a, b, c].into_iter().find(|id| !self.is_in(*id));
        // The operand whose register takes the result: the sum itself, one that dies, one that memory has anyway.
        let spare = |s: &Self, id: Id| {
            let r = s.register[id as usize];
            s.is_in(id) && s.clean(id) && s.kept >> r & 1 == 0 && matches!(s.next[id as usize], DEAD | LATER)
        };
        let candidates = [c, a, b];
        let to = if kept_sum {
            Some(c)
        } else {
            candidates
                .into_iter()
                .find(|id| self.is_in(*id) && dies(self, *id))
                .or_else(|| candidates.into_iter().find(|id| spare(self, *id)))
                .or_else(|| self.overwritable_at_no_loss(&candidates))
        };
        let (role, register) = match to {
            Some(id) => (id, self.register[id as usize]),
            None => {
                // Nothing may be overwritten: copy the addend, or a factor if the addend is memory.
                let id = if memory == Some(c) { a } else { c };
                let from = self.register[id as usize];
                let r = self.take();
                self.lock(r);
                self.steps.push(Step::Copy { to: r, from });
                (id, r)
            }
        };
        let (form, first, second) = if role == c {
            if memory == Some(a) {
                std::mem::swap(&mut a, &mut b);
            }
            (Form::Addend231, a, b)
        } else {
            if role == b {
                std::mem::swap(&mut a, &mut b);
            }
            if memory == Some(b) { (Form::Factor132, c, b) } else { (Form::Factor213, b, c) }
        };
        let place = |s: &Self, id: Id| -> Operand {
            if s.is_in(id) { Operand::Register(s.register[id as usize]) } else { Operand::Memory(s.address(id)) }
        };
        let Operand::Register(b_register) = place(self, first) else {
            unreachable!("only the last operand of a fused multiply-add is memory")
        };
        let second = place(self, second);
        self.steps.push(Step::Fused { minus_product, minus_addend, form, to: register, b: b_register, c: second });
        self.bury(w);
        // Whatever was in the register is gone; if it lives on, memory has it.
        let old = self.holds[register as usize];
        if old != NONE && old != w.to[0] {
            self.leave(old);
        }
        self.define(w.to[0], register, made);
    }

    /// An operand that memory has and whose next use is further than that of anything that a copy would push out.
    fn overwritable_at_no_loss(&self, candidates: &[Id; 3]) -> Option<Id> {
        if (0..self.holds.len()).any(|r| self.holds[r] == NONE && !self.blocked(r)) {
            return None;
        }
        let best = candidates
            .iter()
            .copied()
            .filter(|id| self.is_in(*id) && self.clean(*id) && self.kept >> self.register[*id as usize] & 1 == 0)
            .max_by_key(|id| self.next[*id as usize])?;
        if (0..self.holds.len()).all(|r| self.blocked(r)) {
            return Some(best);
        }
        let (_, distance, clean) = self.victim();
        (!clean || distance <= u64::from(self.next[best as usize].saturating_sub(self.at))).then_some(best)
    }

    /// A call: no register survives it.
    fn call(&mut self, w: &Work, function: Function, made: u32) {
        for (k, id) in w.reads().enumerate() {
            let from = self.in_register(id);
            self.steps.push(Step::Store { at: Address::Call(k as u32), from });
        }
        self.bury(w);
        let mut back = Vec::new();
        for r in 0..self.holds.len() {
            let id = self.holds[r];
            if id == NONE {
                continue;
            }
            if self.kept >> r & 1 == 1 {
                self.stored[id as usize] = false;
                back.push((id, r as u8));
            }
            if self.next[id as usize] != DEAD || self.kept >> r & 1 == 1 {
                self.store(id);
            }
            if self.kept >> r & 1 == 0 {
                self.leave(id);
            }
        }
        self.steps.push(Step::Call(function));
        for (id, r) in back {
            let from = self.address(id);
            self.steps.push(Step::Load { to: r, from });
            self.stored[id as usize] = false;
        }
        self.locked = 0;
        let to = self.take();
        self.steps.push(Step::Load { to, from: Address::Call(0) });
        self.define(w.to[0], to, made);
    }
}
