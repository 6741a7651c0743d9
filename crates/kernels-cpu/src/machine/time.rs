//! How long steps take, on a pretended processor: what orders and allocations are judged by.
//!
//! Instructions enter in order, a few per cycle, into a window of limited length; each begins when its operands are
//! there and a unit is free, and leaves the window in order.
//!
//! ```text
//! begin = max(enter, operands, unit)      end = begin + latency      enter ≥ leave of the one `WINDOW` before
//! ```
//!
//! The numbers are those of current processors with vectors of 256 bits, rounded; for wider vectors the proportions
//! are the same.
//! What it is not: a prediction. It knows no caches; it only has to tell which of two orders waits less.

use super::allocate::{Address, Operand, Step};
use super::flow::What;
use super::target::Target;

/// Instructions that enter per cycle.
const WIDTH: u32 = 6;
/// Instructions between the oldest that has not left and the newest that has entered.
const WINDOW: usize = 224;
/// Vector instructions that have entered and wait for operands or a unit.
const WAITING: usize = 96;

/// Units: how many instructions of a kind begin per cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unit {
    Multiply,
    Add,
    Shuffle,
    Load,
    Store,
}

const UNITS: usize = 5;
const PER_CYCLE: [u8; UNITS] = [2, 2, 2, 2, 1];

/// From begin to result, in cycles.
mod latency {
    pub(super) const LOAD: u32 = 7;
    pub(super) const FORWARD: u32 = 8;
    pub(super) const MULTIPLY: u32 = 4;
    pub(super) const ADD: u32 = 3;
    pub(super) const SHUFFLE: u32 = 3;
    pub(super) const LOGIC: u32 = 1;
    pub(super) const DIVIDE: u32 = 14;
    pub(super) const ROOT: u32 = 20;
}

/// Cycles in which a unit that divides takes nothing else.
const DIVIDE_EVERY: u32 = 7;
/// Cycles that a called function takes per lane.
const CALL_PER_LANE: u32 = 40;

/// Cycles that the steps take for one pass of a group, or half of one.
pub(crate) fn cycles(target: Target, steps: &[Step], slots: u32) -> u64 {
    let mut clock = Clock::new(target, slots);
    let mut at = 0;
    let mut extra = 0u64;
    while at < steps.len() {
        let Step::Begin { passes } = steps[at] else {
            clock.step(&steps[at]);
            at += 1;
            continue;
        };
        let end = at + steps[at..].iter().position(|s| *s == Step::End).expect("every loop has an end");
        // The first pass fills the window; what the next ones take is what all others take.
        let mut ends = [0; 3];
        let run = passes.min(3);
        for end_of_pass in ends.iter_mut().take(run as usize) {
            steps[at + 1..end].iter().for_each(|s| clock.step(s));
            *end_of_pass = clock.left;
        }
        if passes > run {
            extra += u64::from(passes - run) * u64::from(ends[2] - ends[0]) / 2;
        }
        at = end + 1;
    }
    u64::from(clock.left) + extra
}

struct Clock {
    lanes: u32,
    /// When each register's value is there.
    registers: [u32; 32],
    /// When each slot's value can be read.
    slots: Vec<u32>,
    /// How much of each unit is taken, [cycle][unit], for cycles from `first` on.
    taken: Vec<[u8; UNITS]>,
    /// When divisions can begin again.
    divider: u32,
    /// When the instruction before left, and the last ones in a ring.
    left: u32,
    leaves: [u32; WINDOW],
    /// When those that wait begin, in a ring in order of entering.
    begins: std::collections::BinaryHeap<std::cmp::Reverse<u32>>,
    entered: usize,
    enter: u32,
    entered_now: u32,
}

impl Clock {
    fn new(target: Target, slots: u32) -> Clock {
        Clock {
            lanes: target.lanes(),
            registers: [0; 32],
            slots: vec![0; slots as usize],
            taken: Vec::new(),
            divider: 0,
            left: 0,
            leaves: [0; WINDOW],
            begins: std::collections::BinaryHeap::with_capacity(WAITING + 1),
            entered: 0,
            enter: 0,
            entered_now: 0,
        }
    }

    /// The first cycle from `from` on in which the unit is free; it is taken.
    fn unit(&mut self, unit: Unit, from: u32) -> u32 {
        let mut at = from as usize;
        loop {
            if at >= self.taken.len() {
                self.taken.resize(at + 64, [0; UNITS]);
            }
            let taken = &mut self.taken[at][unit as usize];
            if *taken < PER_CYCLE[unit as usize] {
                *taken += 1;
                return at as u32;
            }
            at += 1;
        }
    }

    /// An instruction enters.
    fn enters(&mut self) -> u32 {
        let mut at = self.enter.max(self.leaves[self.entered % WINDOW]);
        if self.begins.len() >= WAITING {
            let std::cmp::Reverse(earliest) = self.begins.pop().expect("as many wait as can");
            at = at.max(earliest);
        }
        if at > self.enter {
            self.enter = at;
            self.entered_now = 0;
        } else if self.entered_now == WIDTH {
            self.enter += 1;
            self.entered_now = 0;
        }
        self.entered_now += 1;
        self.enter
    }

    fn leaves(&mut self, end: u32) {
        self.left = self.left.max(end);
        self.leaves[self.entered % WINDOW] = self.left;
        self.entered += 1;
    }

    /// When what memory has is there, for an instruction that entered at `enter`.
    fn load(&mut self, from: Address, enter: u32) -> u32 {
        let begin = self.unit(Unit::Load, enter);
        let there = match from {
            Address::Slot(k) => self.slots[k as usize],
            Address::Home(_) | Address::Call(_) => 0,
        };
        (begin + latency::LOAD).max(there)
    }

    fn operand(&mut self, operand: Operand, enter: u32) -> u32 {
        match operand {
            Operand::Register(r) => self.registers[r as usize],
            Operand::Memory(from) => self.load(from, enter),
        }
    }

    /// Arithmetic whose operands are there at `operands`: when its result is.
    fn arithmetic(&mut self, unit: Unit, latency: u32, enter: u32, operands: u32) -> u32 {
        let begin = self.unit(unit, enter.max(operands));
        self.begins.push(std::cmp::Reverse(begin));
        begin + latency
    }

    fn step(&mut self, step: &Step) {
        match *step {
            Step::Load { to, from } => {
                let enter = self.enters();
                let end = self.load(from, enter);
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Copy { to, from } => {
                let enter = self.enters();
                let end = self.registers[from as usize].max(enter);
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Zero { to } => {
                let end = self.enters();
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Store { at, from } => {
                let enter = self.enters();
                let begin = self.unit(Unit::Store, enter.max(self.registers[from as usize]));
                if let Address::Slot(k) = at {
                    self.slots[k as usize] = begin + latency::FORWARD;
                }
                self.leaves(begin + 1);
            }
            Step::Two { what, to, a, b } => {
                let enter = self.enters();
                let operands = self.registers[a as usize].max(self.operand(b, enter));
                let (unit, latency) = match what {
                    What::Mul => (Unit::Multiply, latency::MULTIPLY),
                    What::Xor => (Unit::Shuffle, latency::LOGIC),
                    What::Div => (Unit::Add, latency::DIVIDE),
                    _ => (Unit::Add, latency::ADD),
                };
                let operands = if matches!(what, What::Div) { self.divide(operands.max(enter)) } else { operands };
                let end = self.arithmetic(unit, latency, enter, operands);
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Sqrt { to, a } => {
                let enter = self.enters();
                let operands = self.operand(a, enter);
                let operands = self.divide(operands.max(enter));
                let end = self.arithmetic(Unit::Add, latency::ROOT, enter, operands);
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Fused { to, b, c, .. } => {
                let enter = self.enters();
                let operands = self.registers[to as usize].max(self.registers[b as usize]).max(self.operand(c, enter));
                let end = self.arithmetic(Unit::Multiply, latency::MULTIPLY, enter, operands);
                self.registers[to as usize] = end;
                self.leaves(end);
            }
            Step::Gather { width, axis, to, .. } => self.gather(width, axis, to),
            Step::Call(_) => {
                self.enter = self.left + CALL_PER_LANE * self.lanes;
                self.leaves(self.enter);
            }
            Step::Begin { .. } | Step::End => {}
        }
    }

    /// A division begins when the one before lets it.
    fn divide(&mut self, from: u32) -> u32 {
        let begin = from.max(self.divider);
        self.divider = begin + DIVIDE_EVERY;
        begin
    }

    /// Row numbers, rows and what sorts them, for each lane.
    fn gather(&mut self, width: u32, axis: Option<u32>, to: [u8; 3]) {
        let places = if axis.is_some() { 1 } else { width };
        let mut end = 0;
        for _ in 0..self.lanes {
            let enter = self.enters();
            let number = self.unit(Unit::Load, enter) + latency::LOAD;
            self.leaves(number);
            for _ in 0..places.div_ceil(2) {
                let enter = self.enters();
                let row = self.unit(Unit::Load, number.max(enter)) + latency::LOAD;
                end = end.max(self.arithmetic(Unit::Shuffle, latency::SHUFFLE, enter, row));
                self.leaves(end);
            }
        }
        for register in to.into_iter().take(places as usize) {
            let enter = self.enters();
            let there = self.arithmetic(Unit::Shuffle, latency::SHUFFLE, enter, end);
            self.registers[register as usize] = there;
            self.leaves(there);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::allocate::Form;
    use super::*;

    fn fused(to: u8, b: u8) -> Step {
        Step::Fused {
            minus_product: false,
            minus_addend: false,
            form: Form::Addend231,
            to,
            b,
            c: Operand::Register(15),
        }
    }

    fn time(steps: &[Step]) -> u64 {
        cycles(Target::Avx2, steps, 1)
    }

    /// Work that waits for itself takes its latency each time, work that waits for nothing keeps both units busy.
    #[test]
    fn chains_wait_and_independent_work_does_not() {
        let chain: Vec<Step> = (0..100).map(|_| fused(0, 1)).collect();
        let apart: Vec<Step> = (0..100).map(|k| fused(k % 10, 14)).collect();
        assert_eq!(time(&chain), 400);
        assert!((50..60).contains(&time(&apart)), "{}", time(&apart));
    }

    /// A loop costs as many passes as it makes, whether they are all run or the later ones are taken to be like the
    /// first.
    #[test]
    fn passes_cost_what_they_cost_written_out() {
        let body: Vec<Step> = (0..40).map(|k| fused(k % 10, 14)).collect();
        let rolled = |passes: u32| {
            let mut steps = vec![Step::Begin { passes }];
            steps.extend(&body);
            steps.push(Step::End);
            time(&steps)
        };
        let written: Vec<Step> = (0..50).flat_map(|_| body.clone()).collect();
        assert!(rolled(50).abs_diff(time(&written)) <= 50, "{} for {}", rolled(50), time(&written));
        assert!(rolled(2) < rolled(3));
    }

    /// What is read back from a slot waits until it is there.
    #[test]
    fn spilled_values_come_back_later() {
        let spill = [Step::Store { at: Address::Slot(0), from: 0 }, Step::Load { to: 0, from: Address::Slot(0) }];
        let kept: Vec<Step> = (0..20).map(|_| fused(0, 1)).collect();
        let spilled: Vec<Step> = kept.iter().flat_map(|s| [vec![*s], spill.to_vec()].concat()).collect();
        assert!(time(&spilled) >= time(&kept) + 20 * u64::from(latency::FORWARD));
    }
}
