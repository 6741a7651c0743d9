//! Orders the unknowns of a symmetric sparse matrix so that its entries lie near the diagonal.
//!
//! Reverse Cuthill–McKee: number breadth-first from an end of the graph, neighbours of small degree first, and reverse.
//! Good for slender bodies, where the bandwidth becomes that of a cross-section; for compact ones of many unknowns an
//! ordering by nested dissection fills less.
//!
//! References: E. Cuthill and J. McKee, "Reducing the bandwidth of sparse symmetric matrices", 1969; A. George and J.
//! W. H. Liu, "An implementation of a pseudoperipheral node finder", 1979.

use crate::csr::Csr;

/// The order in which to eliminate: `order[new] = old`. The pattern must be symmetric.
pub fn reverse_cuthill_mckee(matrix: &Csr) -> Vec<u32> {
    let n = matrix.row_count();
    let neighbours = |row: u32| &matrix.columns[matrix.row_start[row as usize]..matrix.row_start[row as usize + 1]];
    let degree = |row: u32| neighbours(row).len();

    let mut order: Vec<u32> = Vec::with_capacity(n);
    let mut search = Search { seen: vec![0; n], round: 0, queue: Vec::new() };
    let mut numbered = vec![false; n];
    for seed in 0..n as u32 {
        if numbered[seed as usize] {
            continue;
        }
        // Walk to an end of this component: the farthest row from the farthest row, while that gets farther.
        let (mut start, mut depth) = (seed, 0);
        loop {
            let (end, reached) = search.farthest(start, &neighbours);
            if reached <= depth {
                break;
            }
            (start, depth) = (end, reached);
        }

        let first = order.len();
        order.push(start);
        numbered[start as usize] = true;
        let mut next = first;
        while next < order.len() {
            let row = order[next];
            next += 1;
            let added = order.len();
            for &column in neighbours(row) {
                if !numbered[column as usize] {
                    numbered[column as usize] = true;
                    order.push(column);
                }
            }
            order[added..].sort_by_key(|&column| (degree(column), column));
        }
    }
    order.reverse();
    order
}

struct Search {
    /// Round in which a row was last seen.
    seen: Vec<u32>,
    round: u32,
    queue: Vec<u32>,
}

impl Search {
    /// A row of small degree in the last level of a breadth-first search, and the number of that level.
    fn farthest<'a>(&mut self, start: u32, neighbours: &impl Fn(u32) -> &'a [u32]) -> (u32, usize) {
        self.round += 1;
        self.queue.clear();
        self.queue.push(start);
        self.seen[start as usize] = self.round;
        let (mut level_start, mut depth) = (0, 0);
        loop {
            let level_end = self.queue.len();
            for k in level_start..level_end {
                for &column in neighbours(self.queue[k]) {
                    if self.seen[column as usize] != self.round {
                        self.seen[column as usize] = self.round;
                        self.queue.push(column);
                    }
                }
            }
            if self.queue.len() == level_end {
                break;
            }
            (level_start, depth) = (level_end, depth + 1);
        }
        let last = &self.queue[level_start..];
        let end = last.iter().copied().min_by_key(|&row| (neighbours(row).len(), row));
        (end.unwrap_or(start), depth)
    }
}
