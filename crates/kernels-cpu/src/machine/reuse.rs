//! An order that reads from registers what registers hold.
//!
//! A list schedule with a pretended register file: the next piece is the one that has to read least from memory, given
//! what the pieces before it read and made.
//! So a product of small matrices runs along the index that lets all entries grow at once, and reads each factor once:
//!
//! ```text
//! for a: for i, j: f[i][j] += d[a][i] · g[a][j]      not      for i, j: for a: …
//! ```
//!
//! What it is not: an allocation. Which values really keep registers is decided afterwards, by Belady's rule, which
//! knows the order.

use super::flow::{Flow, Home, Id, Part, What};
use super::order::{Waits, distinct, waits};

/// What pieces of work cost in choosing between them; the cheapest ready one runs next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Prices {
    /// Reading an operand from memory.
    pub(crate) read: i32,
    /// Each value by which more values are alive afterwards, when registers are short.
    pub(crate) alive: i32,
    /// What decides between equals.
    pub(crate) tie: Tie,
}

/// What decides where several pieces are as good as each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tie {
    /// The program's order.
    First,
    /// The longest chain of work that waits.
    Longest,
}

/// Registers that are pretended to be taken by what instructions need on the side.
const SIDE: usize = 1;
/// Registers are short when no more than this many are free.
const SPARE: usize = 3;

struct Reuse<'a> {
    flow: &'a Flow,
    part: &'a Part,
    /// Pieces that read each value.
    readers: Vec<Vec<u32>>,
    /// Readings of each value that are still to come.
    left: Vec<u32>,
    /// Values that are gone after their last reader here.
    ends_here: Vec<bool>,
    /// When each value was last used, if it is in the pretended registers.
    used: Vec<u32>,
    /// Values in the pretended registers.
    held: Vec<Id>,
    /// Operands of each piece that are in memory.
    reads: Vec<i32>,
    /// By how many more values are alive after each piece.
    grows: Vec<i32>,
}

/// In no pretended register.
const OUT: u32 = u32::MAX;
/// In a register throughout.
const KEPT: u32 = u32::MAX - 1;

/// The order for so many registers.
pub(crate) fn reuse(
    flow: &Flow,
    part: &Part,
    registers: usize,
    kept: &[Id],
    prices: Prices,
    outlives: &dyn Fn(Id) -> bool,
) -> Vec<u32> {
    let work = &part.work;
    let w = waits(work, flow.homes.len());
    let rank = ranks(&w, prices.tie);
    let mut s = Reuse::new(flow, part, kept, outlives);
    let room = registers.saturating_sub(SIDE).max(4);
    let mut missing: Vec<u32> = w.before.iter().map(|b| b.len() as u32).collect();
    let mut ready: Vec<u32> = (0..work.len() as u32).filter(|k| missing[*k as usize] == 0).collect();
    let mut order = Vec::with_capacity(work.len());
    while !ready.is_empty() {
        let alive = s.held.iter().filter(|id| flow.homes[**id as usize] == Home::Computed).count();
        let short = alive + SPARE >= room;
        let price = |k: u32| {
            let k = k as usize;
            let alive = if short { prices.alive * s.grows[k] } else { s.grows[k] };
            (prices.read * s.reads[k] + alive, rank[k])
        };
        let best = (0..ready.len()).min_by_key(|at| price(ready[*at])).expect("some piece is ready");
        let k = ready.swap_remove(best);
        order.push(k);
        s.run(k, order.len() as u32, room);
        for &next in &w.after[k as usize] {
            missing[next as usize] -= 1;
            if missing[next as usize] == 0 {
                ready.push(next);
            }
        }
    }
    order
}

/// What decides between pieces of one price; the lowest runs first.
fn ranks(w: &Waits, tie: Tie) -> Vec<u32> {
    let count = w.after.len();
    match tie {
        Tie::First => (0..count as u32).collect(),
        Tie::Longest => {
            let mut height = vec![0u32; count];
            for k in (0..count).rev() {
                height[k] = 1 + w.after[k].iter().map(|n| height[*n as usize]).max().unwrap_or(0);
            }
            height
                .iter()
                .enumerate()
                .map(|(k, h)| (u32::MAX >> 12).saturating_sub(*h) << 12 | k as u32 & 0xfff)
                .collect()
        }
    }
}

impl<'a> Reuse<'a> {
    fn new(flow: &'a Flow, part: &'a Part, kept: &[Id], outlives: &dyn Fn(Id) -> bool) -> Reuse<'a> {
        let values = flow.homes.len();
        let work = &part.work;
        let mut readers = vec![Vec::new(); values];
        let mut ends_here = vec![false; values];
        for (k, piece) in work.iter().enumerate() {
            distinct(piece).for_each(|id| readers[id as usize].push(k as u32));
            piece.makes().for_each(|id| ends_here[id as usize] = !outlives(id) && !flow.grows[id as usize]);
        }
        let mut s = Reuse {
            flow,
            part,
            left: readers.iter().map(|r| r.len() as u32).collect(),
            readers,
            ends_here,
            used: vec![OUT; values],
            held: Vec::new(),
            reads: work.iter().map(|p| distinct(p).count() as i32).collect(),
            grows: work.iter().map(|p| p.makes().filter(|id| !p.args.contains(id)).count() as i32).collect(),
        };
        for (k, piece) in work.iter().enumerate() {
            // A store frees its register for others at once.
            s.grows[k] -= i32::from(matches!(piece.what, What::Store { .. }));
        }
        for id in 0..values as Id {
            s.last_reader(id);
        }
        // Accumulators that keep a register are never read from memory, and are not the order's business.
        for &id in kept {
            s.used[id as usize] = KEPT;
            s.readers[id as usize].iter().for_each(|k| s.reads[*k as usize] -= 1);
        }
        s
    }

    /// Where one reader of a value is left, that one ends it.
    fn last_reader(&mut self, id: Id) {
        if self.left[id as usize] == 1 && self.ends_here[id as usize] {
            for &k in &self.readers[id as usize] {
                self.grows[k as usize] -= 1;
            }
        }
    }

    fn hold(&mut self, id: Id, now: u32) {
        if self.used[id as usize] == KEPT {
            return;
        }
        if self.used[id as usize] == OUT {
            self.held.push(id);
            self.readers[id as usize].iter().for_each(|k| self.reads[*k as usize] -= 1);
        }
        self.used[id as usize] = now;
    }

    fn drop(&mut self, at: usize) {
        let id = self.held.swap_remove(at);
        self.used[id as usize] = OUT;
        self.readers[id as usize].iter().for_each(|k| self.reads[*k as usize] += 1);
    }

    fn run(&mut self, k: u32, now: u32, room: usize) {
        let piece = self.part.work[k as usize];
        for id in distinct(&piece) {
            self.left[id as usize] -= 1;
            self.last_reader(id);
            self.hold(id, now);
        }
        piece.makes().for_each(|id| self.hold(id, now));
        let over = |s: &Self, id: Id| {
            let id = id as usize;
            s.left[id] == 0 && (s.ends_here[id] || s.flow.grows[id] || s.flow.homes[id] != Home::Computed)
        };
        let mut at = 0;
        while at < self.held.len() {
            if over(self, self.held[at]) { self.drop(at) } else { at += 1 }
        }
        while self.held.len() > room {
            // What memory has anyway goes before what would have to be written.
            let oldest = |at: &usize| {
                let id = self.held[*at];
                let computed = self.flow.homes[id as usize] == Home::Computed && self.left[id as usize] > 0;
                (u32::from(computed) * 24 + self.used[id as usize], id)
            };
            let out = (0..self.held.len()).min_by_key(oldest).expect("more are held than there is room for");
            self.drop(out);
        }
    }
}
