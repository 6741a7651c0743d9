//! Orders in which the work of a part may run.
//!
//! Fewer values alive at once need fewer registers, and which order keeps them few differs from program to program;
//! so there are several, and whoever allocates registers takes the one that moves the least data.
//! All are deterministic.

use super::flow::{Flow, Id, NONE, Part, Work};
use super::reuse::{Prices, reuse};

/// A way to order work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ordering {
    /// As the program has it.
    Given,
    /// From each effect down to what it needs, the side that needs more first (Sethi and Ullman, "The generation of
    /// optimal code for arithmetic expressions", 1970, as a heuristic on a graph).
    Depth,
    /// What reads least from memory next; see [`reuse`](super::reuse).
    Reuse(Prices),
}

/// What each piece of work waits for.
pub(crate) struct Waits {
    /// Pieces before each piece.
    pub(crate) before: Vec<Vec<u32>>,
    /// Pieces after each piece.
    pub(crate) after: Vec<Vec<u32>>,
}

/// What waits for what among pieces that read and make values numbered below `values`.
pub(crate) fn waits(work: &[Work], values: usize) -> Waits {
    let mut maker = vec![NONE; values];
    let mut w = Waits { before: vec![Vec::new(); work.len()], after: vec![Vec::new(); work.len()] };
    for (k, piece) in work.iter().enumerate() {
        for id in piece.reads() {
            let m = maker[id as usize];
            if m != NONE && !w.before[k].contains(&m) {
                w.before[k].push(m);
                w.after[m as usize].push(k as u32);
            }
        }
        for id in piece.makes() {
            maker[id as usize] = k as u32;
        }
    }
    w
}

/// The work of a part in another order, for so many registers beside those of `kept`; `outlives` says which values are read after the part.
pub(crate) fn ordered(
    flow: &Flow,
    part: &Part,
    ordering: Ordering,
    registers: usize,
    kept: &[Id],
    outlives: &dyn Fn(Id) -> bool,
) -> Vec<Work> {
    let work = &part.work;
    let values = flow.homes.len();
    let order = match ordering {
        Ordering::Given => return work.clone(),
        Ordering::Depth => depth(work, &waits(work, values)),
        Ordering::Reuse(prices) => reuse(flow, part, registers, kept, prices, outlives),
    };
    order.into_iter().map(|k| work[k as usize]).collect()
}

fn depth(work: &[Work], w: &Waits) -> Vec<u32> {
    // Registers that a tree would need.
    let mut need = vec![1u32; work.len()];
    for k in 0..work.len() {
        let mut below: Vec<u32> = w.before[k].iter().map(|b| need[*b as usize]).collect();
        below.sort_unstable_by(|a, b| b.cmp(a));
        need[k] = below.iter().enumerate().map(|(i, n)| n + i as u32).max().unwrap_or(1);
    }
    let mut done = vec![false; work.len()];
    let mut order = Vec::with_capacity(work.len());
    let mut stack: Vec<(u32, bool)> = Vec::new();
    for root in (0..work.len()).filter(|k| w.after[*k].is_empty()) {
        stack.push((root as u32, false));
        while let Some((k, ready)) = stack.pop() {
            if done[k as usize] {
                continue;
            }
            if ready {
                done[k as usize] = true;
                order.push(k);
                continue;
            }
            stack.push((k, true));
            let mut below: Vec<u32> = w.before[k as usize].iter().copied().filter(|b| !done[*b as usize]).collect();
            // The neediest is pushed last and so runs first.
            below.sort_by_key(|b| (need[*b as usize], std::cmp::Reverse(*b)));
            stack.extend(below.into_iter().map(|b| (b, false)));
        }
    }
    order
}

/// Values that a piece reads, each once.
pub(crate) fn distinct(piece: &Work) -> impl Iterator<Item = Id> + use<> {
    let a = piece.args;
    (0..3).filter(move |&k| a[k] != NONE && !a[..k].contains(&a[k])).map(move |k| a[k])
}
