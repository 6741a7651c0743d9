//! Unknowns that follow others, u = T û, taken out of a system of equations.
//!
//! ```text
//! F̂ = Tᵀ F(T û)        K̂ = Tᵀ K T        T: identity on free rows, weights on rows that follow
//! ```
//!
//! Vectors keep their length: the entries of rows that follow are idle. [`Elimination::expand`] writes them (T),
//! [`Elimination::restrict`] moves what stands there to the masters and leaves zero (Tᵀ). A solver that treats idle
//! unknowns as prescribed ones therefore solves the smaller system, and the constraints hold to the rounding of one
//! weighted sum, however well it converged.
//!
//! Why elimination and not penalties or multipliers: K̂ stays symmetric positive definite and as well conditioned as K,
//! so that every solver and preconditioner works on it as it is, and no stiffness has to be chosen.
//!
//! Rows are blocks of as many unknowns as a node has axes; all of a row follow with the same weights.
//! Sums are taken in a fixed order on one thread: the same bits, whatever the number of threads elsewhere.

use crate::symmetric_blocks::SymmetricBlocks;
use std::cmp::Ordering;

/// Rows that follow others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Elimination {
    block: usize,
    /// The rows that follow, ascending.
    rows: Vec<u32>,
    /// Where the masters of each begin, `[row + 1]`.
    starts: Vec<usize>,
    /// Masters with their weights.
    masters: Vec<(u32, f64)>,
}

/// Where each stored block of K goes in K̂: those of a slot are `targets[starts[slot]..starts[slot + 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct CondensationMap {
    starts: Vec<u32>,
    targets: Vec<Target>,
    /// Slots of K̂ of the diagonal blocks of rows that follow.
    idle: Vec<u32>,
}

/// A slot of K̂ that a block of K is added to.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Target {
    slot: u32,
    weight: f64,
    turn: Turn,
}

/// How a block is added. K and K̂ keep their upper halves only: what goes below the diagonal goes above it transposed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    AsIs,
    Transposed,
    /// Both: a block of two different rows that ends on the diagonal, and so does its mirror image.
    Sum,
}

impl Elimination {
    /// Rows with their masters and weights, in ascending order of the rows, `block` unknowns each.
    ///
    /// # Panics
    /// When rows do not ascend, or a master is itself a row that follows: the caller puts chains into each other.
    pub fn new<'a>(block: usize, rows: impl IntoIterator<Item = (u32, &'a [(u32, f64)])>) -> Self {
        let mut elimination = Self { block, rows: Vec::new(), starts: vec![0], masters: Vec::new() };
        for (row, masters) in rows {
            elimination.rows.push(row);
            elimination.masters.extend_from_slice(masters);
            elimination.starts.push(elimination.masters.len());
        }
        assert!(elimination.rows.is_sorted_by(|a, b| a < b), "rows that follow ascend");
        let free = elimination.masters.iter().all(|m| !elimination.follows(m.0));
        assert!(free, "masters do not follow anybody");
        elimination
    }

    /// Whether no row follows another.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The rows that follow, ascending.
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Whether a row follows others.
    pub fn follows(&self, row: u32) -> bool {
        self.rows.binary_search(&row).is_ok()
    }

    /// The masters of a row with their weights: itself with one when it is free.
    fn masters_of(&self, row: u32) -> Vec<(u32, f64)> {
        match self.rows.binary_search(&row) {
            Ok(at) => self.masters[self.starts[at]..self.starts[at + 1]].to_vec(),
            Err(_) => vec![(row, 1.0)],
        }
    }

    /// x ← T x: overwrites the entries of rows that follow, `[row][entry of the block]`.
    pub fn expand(&self, x: &mut [f64]) {
        let b = self.block;
        for (at, &row) in self.rows.iter().enumerate() {
            for k in 0..b {
                let masters = &self.masters[self.starts[at]..self.starts[at + 1]];
                x[row as usize * b + k] = masters.iter().map(|&(m, w)| w * x[m as usize * b + k]).sum();
            }
        }
    }

    /// f ← Tᵀ f: adds what rows that follow carry to their masters, by weight, and leaves zero behind.
    pub fn restrict(&self, f: &mut [f64]) {
        let b = self.block;
        for (at, &row) in self.rows.iter().enumerate() {
            for k in 0..b {
                let carried = std::mem::take(&mut f[row as usize * b + k]);
                for &(m, w) in &self.masters[self.starts[at]..self.starts[at + 1]] {
                    f[m as usize * b + k] += w * carried;
                }
            }
        }
    }

    /// Gives lumped masses, one per row, to the masters, and leaves zero behind.
    ///
    /// The row sums of Tᵀ M T are Σ_s w_sa m_s, as the weights of each row sum to one: nothing is lost, and the centre of
    /// mass stays. Where a weight is negative (corners of a quadratic face) the sum could be negative as well, which no
    /// mass may be; there the positive weights share, and the total alone is kept.
    pub fn lump(&self, masses: &mut [f64]) {
        for (at, &row) in self.rows.iter().enumerate() {
            let carried = std::mem::take(&mut masses[row as usize]);
            let masters = &self.masters[self.starts[at]..self.starts[at + 1]];
            let positive: f64 = masters.iter().map(|m| m.1.max(0.0)).sum();
            for &(m, w) in masters {
                masses[m as usize] += w.max(0.0) / positive * carried;
            }
        }
    }

    /// An empty K̂ for matrices with the pattern of `full`, and where the blocks of those go.
    pub fn pattern(&self, full: &SymmetricBlocks) -> (SymmetricBlocks, CondensationMap) {
        let row_count = full.row_count() as u32;
        let masters: Vec<Vec<(u32, f64)>> = (0..row_count).map(|row| self.masters_of(row)).collect();
        let mut pattern: Vec<Vec<u32>> = (0..row_count).map(|row| vec![row]).collect();
        for (row, of_row) in masters.iter().enumerate() {
            for slot in full.row_slots(row) {
                for &(i, _) in of_row {
                    for &(j, _) in &masters[full.columns()[slot] as usize] {
                        pattern[i.min(j) as usize].push(i.max(j));
                    }
                }
            }
        }
        for columns in &mut pattern {
            columns.sort_unstable();
            columns.dedup();
        }
        let condensed = SymmetricBlocks::from_pattern(full.block(), &pattern).expect("columns are sorted and in range");
        let slot = |i: u32, j: u32| condensed.slot(i as usize, j as usize).expect("the pattern holds the pair") as u32;
        let mut map = CondensationMap { starts: vec![0], targets: Vec::new(), idle: Vec::new() };
        for (row, of_row) in masters.iter().enumerate() {
            for at in full.row_slots(row) {
                let column = full.columns()[at] as usize;
                for &(i, w) in of_row {
                    for &(j, v) in &masters[column] {
                        let turn = match i.cmp(&j) {
                            // A diagonal block gives both (i, j) and (j, i): one of them is kept.
                            Ordering::Greater if column == row => continue,
                            Ordering::Greater => Turn::Transposed,
                            Ordering::Equal if column != row => Turn::Sum,
                            Ordering::Equal | Ordering::Less => Turn::AsIs,
                        };
                        map.targets.push(Target { slot: slot(i.min(j), i.max(j)), weight: w * v, turn });
                    }
                }
                map.starts.push(u32::try_from(map.targets.len()).expect("a matrix has less than 2³² blocks"));
            }
        }
        map.idle = self.rows.iter().map(|&row| slot(row, row)).collect();
        (condensed, map)
    }
}

impl CondensationMap {
    /// K̂ ← Tᵀ K T, with identity blocks on the rows that follow.
    pub fn condense(&self, full: &SymmetricBlocks, condensed: &mut SymmetricBlocks) {
        let b = full.block();
        let size = b * b;
        condensed.clear();
        let (from, to) = (full.values(), condensed.values_mut());
        for (slot, range) in self.starts.windows(2).enumerate() {
            let block = &from[slot * size..(slot + 1) * size];
            for &Target { slot, weight, turn } in &self.targets[range[0] as usize..range[1] as usize] {
                let target = &mut to[slot as usize * size..][..size];
                for (k, t) in target.iter_mut().enumerate() {
                    let mirrored = block[k % b * b + k / b];
                    *t += weight
                        * match turn {
                            Turn::AsIs => block[k],
                            Turn::Transposed => mirrored,
                            Turn::Sum => block[k] + mirrored,
                        };
                }
            }
        }
        self.write_idle(condensed);
    }

    /// Writes identity blocks on the rows that follow: they meet nobody, and diagonal preconditioners can divide.
    pub fn write_idle(&self, condensed: &mut SymmetricBlocks) {
        let b = condensed.block();
        for &slot in &self.idle {
            for k in 0..b {
                condensed.values_mut()[slot as usize * b * b + k * (b + 1)] = 1.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::LinearOperator;

    /// Four rows of two unknowns: row 1 follows 0 and 3, row 2 follows 3 alone.
    fn sample() -> (Elimination, SymmetricBlocks) {
        let elimination = Elimination::new(2, [(1, &[(0, 0.25), (3, 0.75)][..]), (2, &[(3, 1.0)][..])]);
        let pattern: Vec<Vec<u32>> = vec![vec![0, 1], vec![1, 2], vec![2, 3], vec![3]];
        let mut full = SymmetricBlocks::from_pattern(2, &pattern).unwrap();
        for (k, value) in full.values_mut().iter_mut().enumerate() {
            *value = ((k * 37 + 11) % 17) as f64 - 5.0;
        }
        for row in 0..4 {
            let diagonal = full.row_slots(row).start * 4;
            full.values_mut()[diagonal + 2] = full.values()[diagonal + 1];
        }
        (elimination, full)
    }

    /// The condensed matrix does what expanding, multiplying and restricting do.
    #[test]
    fn condensing_is_expand_multiply_restrict() {
        let (elimination, full) = sample();
        let (mut condensed, map) = elimination.pattern(&full);
        map.condense(&full, &mut condensed);
        for unknown in [0, 1, 6, 7] {
            let mut x = vec![0.0; 8];
            x[unknown] = 1.0;
            let mut got = vec![0.0; 8];
            condensed.apply(&x, &mut got);
            elimination.expand(&mut x);
            let mut wanted = vec![0.0; 8];
            full.apply(&x, &mut wanted);
            elimination.restrict(&mut wanted);
            assert!(got.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-13), "{got:?} {wanted:?}");
        }
    }

    /// Rows that follow are alone with an identity block.
    #[test]
    fn idle_rows_are_identities() {
        let (elimination, full) = sample();
        let (mut condensed, map) = elimination.pattern(&full);
        map.condense(&full, &mut condensed);
        for &row in elimination.rows() {
            let slots = condensed.row_slots(row as usize);
            assert_eq!(condensed.columns()[slots.clone()], [row]);
            assert_eq!(condensed.values()[slots.start * 4..slots.end * 4], [1.0, 0.0, 0.0, 1.0]);
        }
    }

    /// Restricting is the transpose of expanding: f · T û = Tᵀ f · û.
    #[test]
    fn restricting_is_the_transpose() {
        let (elimination, _) = sample();
        let f: Vec<f64> = (0..8).map(|k| f64::from(k * k % 5) - 1.0).collect();
        let reduced = [1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.5];
        let (mut full, mut restricted) = (reduced, f.clone());
        elimination.expand(&mut full);
        elimination.restrict(&mut restricted);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((dot(&f, &full) - dot(&restricted, &reduced)).abs() < 1e-13);
    }

    /// Masses keep their sum, and stay positive where a weight is negative.
    #[test]
    fn masses_are_given_away_whole() {
        let elimination = Elimination::new(1, [(2, &[(0, -0.5), (1, 1.0), (3, 0.5)][..])]);
        let mut masses = [0.1, 1.0, 3.0, 1.0];
        elimination.lump(&mut masses);
        assert_eq!(masses, [0.1, 3.0, 0.0, 2.0]);
    }
}
