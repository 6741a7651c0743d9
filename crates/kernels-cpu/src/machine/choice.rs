//! Which order the work runs in, and how many accumulators keep registers: several of both are tried, and the one that
//! takes fewest cycles on the pretended processor of [`time`](super::time) is kept.

use super::allocate::{Allocation, Allocator, accumulators, last_parts};
use super::flow::{Flow, Id, Part, Work};
use super::order::{Ordering, ordered};
use super::reuse::{Prices, Tie};
use super::target::Target;
use super::time::cycles;

/// Pieces of work above which fewer orders are tried, and above which very few are: compiling must stay quick.
const LONG: usize = 700;
const VERY_LONG: usize = 4000;

/// Prices that gave the quickest code for some program; no two of them would do for all.
const PRICES: [Prices; 4] = [
    Prices { read: 4, alive: 4, tie: Tie::Longest },
    Prices { read: 4, alive: 2, tie: Tie::First },
    Prices { read: 1, alive: 4, tie: Tie::First },
    Prices { read: 1, alive: 4, tie: Tie::Longest },
];

/// The orders that are tried on so many pieces of work.
fn orderings(pieces: usize) -> Vec<Ordering> {
    let prices = match pieces {
        _ if pieces <= LONG => &PRICES[..],
        _ if pieces <= VERY_LONG => &PRICES[..1],
        _ => &[],
    };
    let mut all = vec![Ordering::Depth];
    if pieces > LONG {
        all.push(Ordering::Given);
    }
    all.extend(prices.iter().map(|p| Ordering::Reuse(*p)));
    all
}

/// The quickest allocation that was found, by [`cycles`]: among orders first, then for the best of them among numbers of
/// accumulators that keep registers.
pub(crate) fn allocate(flow: &Flow, target: Target) -> Allocation {
    let registers = target.registers();
    let last_part = last_parts(flow);
    let added: Vec<Vec<Id>> = flow.parts.iter().map(|p| accumulators(flow, p)).collect();
    let most = added.iter().map(Vec::len).max().unwrap_or(0);
    let attempt = |ordering: Ordering, keep: usize| {
        let order = |(k, part): (usize, &Part)| {
            let kept = &added[k][..keep.min(added[k].len())];
            let free = registers.count as usize - kept.len();
            ordered(flow, part, ordering, free, kept, &|id| last_part[id as usize] > k as u32)
        };
        let parts: Vec<Vec<Work>> = flow.parts.iter().enumerate().map(order).collect();
        let found = Allocator::new(flow, registers, &last_part, keep).run(&parts);
        (cycles(target, &found.steps, found.slots), ordering, found)
    };
    let pieces = flow.parts.iter().map(|p| p.work.len()).sum();
    let mut keeps: Vec<usize> = [0, 8, 16, 24].into_iter().filter(|k| *k < most).collect();
    keeps.push(most);
    keeps.retain(|k| k + 8 <= registers.count as usize);
    let first = keeps.first().copied().unwrap_or(0);
    let quickest = |tried: Vec<(u64, Ordering, Allocation)>| {
        // Of equals the first.
        tried.into_iter().min_by_key(|t| t.0).expect("several orders are tried")
    };
    let best = quickest(orderings(pieces).into_iter().map(|o| attempt(o, first)).collect());
    if pieces > LONG {
        return best.2;
    }
    let ordering = best.1;
    let others = keeps.into_iter().skip(1).map(|keep| attempt(ordering, keep));
    quickest([best].into_iter().chain(others).collect()).2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::allocate::{Address, Operand, Step};
    use crate::machine::flow::{Arrival, flow};
    use std::fmt::Write as _;

    /// A product of matrices, Σ d[a][i] g[a][j], reads each factor from memory once or hardly more often, however its
    /// program is ordered: all nine sums grow at once.
    #[test]
    fn factors_of_a_matrix_product_are_read_once() {
        let rows = 9;
        let mut text = format!("program p\npoints 1\ninput d {0}\ninput g {0}\noutput f 9\nstraight\n", 3 * rows);
        let mut next = 0;
        for entry in 0..9 {
            let (i, j) = (entry / 3, entry % 3);
            for a in 0..rows {
                let (d, g, v) = (next, next + 1, next + 2);
                writeln!(text, "  v{d} = input d[{}]\n  v{g} = input g[{}]", 3 * a + i, 3 * a + j).unwrap();
                let sum = if a == 0 { String::new() } else { format!(" + v{}", d - 1) };
                writeln!(text, "  v{v} = v{d} * v{g}{sum}").unwrap();
                next += 3;
            }
            writeln!(text, "  output f[{entry}] = v{}", next - 1).unwrap();
        }
        text.push_str("end\n");
        let program = souple_program::parse(&text).unwrap();
        let flow = flow(&program, &[Arrival::Lanes, Arrival::Lanes]).unwrap();
        let found = allocate(&flow, Target::Avx2);
        let reads = |s: &&Step| match s {
            Step::Load { .. } => true,
            Step::Two { b: Operand::Memory(m), .. } | Step::Fused { c: Operand::Memory(m), .. } => {
                !matches!(m, Address::Slot(_))
            }
            _ => false,
        };
        let reads = found.steps.iter().filter(reads).count();
        assert!(reads <= 7 * rows, "{reads} reads of {} factors", 6 * rows);
        assert_eq!(found.slots, 0);
    }
}
