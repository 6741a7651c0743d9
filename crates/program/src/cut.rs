//! Which values cross the border between two binding times: a minimum cut.
//!
//! Everything known at the earlier time can either be *carried* (stored, then read) or *computed again* from other
//! carried values.
//! Carrying costs a price per value, computing again costs its operations; both are multiplied by the number of points
//! for values that vary.
//!
//! Each early value v that a later one might need becomes two vertices, A ("needed later") and B ("computed later"):
//!
//! ```text
//! source ──∞──▶ A(v)              for v used directly by a later value
//! A(v) ──carry(v)──▶ B(v)         cut: v is carried
//! B(v) ──compute(v)──▶ sink       cut: v is computed again (∞ for a leaf)
//! B(v) ──∞──▶ A(u)                for each operand u of v
//! ```
//!
//! A minimum cut is the cheapest consistent choice, whatever the order in which terms were written.

use crate::{Dag, Operation, Ref};
use souple_symbols::Time;
use std::collections::{HashSet, VecDeque};

/// What a device pays, in units of one arithmetic operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Storing a value once and reading it in each later program.
    pub carry: u64,
}

impl Default for Costs {
    /// A processor core that does some tens of operations in the time of fetching a value from memory, and a few in
    /// the time of fetching it from its nearest cache.
    fn default() -> Costs {
        Costs { carry: 6 }
    }
}

/// The values of time at most `border` that programs computing `roots` read as carried values.
///
/// `free` are values that are stored anyway and cost nothing to carry.
pub fn carried(dag: &Dag, roots: &[Ref], border: Time, free: &HashSet<Ref>, costs: Costs) -> Vec<Ref> {
    let early = |r: Ref| dag.node(r).time <= border;
    let known = |r: Ref| dag.node(r).time == Time::Derive;
    let needed = dag.needed(roots, |_| false);
    let candidates: Vec<Ref> = needed.iter().copied().filter(|&r| early(r) && !known(r)).collect();
    let mut position = vec![usize::MAX; dag.len()];
    for (k, r) in candidates.iter().enumerate() {
        position[r.index()] = k;
    }
    let (source, sink) = (2 * candidates.len(), 2 * candidates.len() + 1);
    let mut network = Network::new(sink + 1);
    let mut direct: HashSet<Ref> = roots.iter().copied().filter(|&r| early(r)).collect();
    for &r in needed.iter().filter(|&&r| !early(r)) {
        direct.extend(dag.node(r).operation.operands().filter(|&o| early(o)));
    }
    for (k, &r) in candidates.iter().enumerate() {
        let node = dag.node(r);
        let (a, b) = (2 * k, 2 * k + 1);
        let points = dag.points.max(1) as u64;
        let times = if node.varying { points } else { 1 };
        let carry = if free.contains(&r) { 0 } else { costs.carry * times };
        let compute = match node.operation {
            Operation::Leaf(_) => INFINITE,
            Operation::PointSum(_) => points,
            operation => operation.cost() * times,
        };
        if direct.contains(&r) {
            network.edge(source, a, INFINITE);
        }
        network.edge(a, b, carry);
        network.edge(b, sink, compute);
        for o in node.operation.operands().filter(|&o| !known(o)) {
            network.edge(b, 2 * position[o.index()], INFINITE);
        }
    }
    let side = network.source_side(source, sink);
    candidates.iter().enumerate().filter(|&(k, _)| side[2 * k] && !side[2 * k + 1]).map(|(_, &r)| r).collect()
}

const INFINITE: u64 = 1 << 48;

/// Maximum flow by Dinic's algorithm.
struct Network {
    heads: Vec<Vec<usize>>,
    to: Vec<usize>,
    left: Vec<u64>,
}

impl Network {
    fn new(vertices: usize) -> Network {
        Network { heads: vec![Vec::new(); vertices], to: Vec::new(), left: Vec::new() }
    }

    fn edge(&mut self, from: usize, to: usize, capacity: u64) {
        self.heads[from].push(self.to.len());
        self.to.push(to);
        self.left.push(capacity);
        self.heads[to].push(self.to.len());
        self.to.push(from);
        self.left.push(0);
    }

    fn levels(&self, source: usize) -> Vec<u32> {
        let mut level = vec![u32::MAX; self.heads.len()];
        level[source] = 0;
        let mut queue = VecDeque::from([source]);
        while let Some(v) = queue.pop_front() {
            for &e in &self.heads[v] {
                let w = self.to[e];
                if self.left[e] > 0 && level[w] == u32::MAX {
                    level[w] = level[v] + 1;
                    queue.push_back(w);
                }
            }
        }
        level
    }

    /// Vertices on the source's side of the minimum cut that is nearest to the source.
    fn source_side(&mut self, source: usize, sink: usize) -> Vec<bool> {
        loop {
            let level = self.levels(source);
            if level[sink] == u32::MAX {
                return level.iter().map(|&l| l != u32::MAX).collect();
            }
            let mut next = vec![0; self.heads.len()];
            while self.augment(source, sink, &level, &mut next) {}
        }
    }

    /// Sends flow along one path of increasing level, if there is one left.
    fn augment(&mut self, source: usize, sink: usize, level: &[u32], next: &mut [usize]) -> bool {
        let mut path: Vec<usize> = Vec::new();
        let mut v = source;
        while v != sink {
            let edge = self.heads[v].get(next[v]).copied();
            match edge {
                Some(e) if self.left[e] > 0 && level[self.to[e]] == level[v].wrapping_add(1) => {
                    path.push(e);
                    v = self.to[e];
                }
                Some(_) => next[v] += 1,
                None => {
                    // A dead end: step back and do not come here again.
                    let Some(e) = path.pop() else { return false };
                    v = self.to[e ^ 1];
                    next[v] += 1;
                }
            }
        }
        let flow = path.iter().map(|&e| self.left[e]).min().expect("source and sink differ");
        for e in path {
            self.left[e] -= flow;
            self.left[e ^ 1] += flow;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::associate;
    use souple_symbols::Graph;

    /// a, b → p = a·b → four products used later: one value is carried, not two and not four.
    #[test]
    fn the_waist_is_carried() {
        let mut g = Graph::new();
        let a = g.symbol("a", Time::Setup);
        let b = g.symbol("b", Time::Setup);
        let u = g.symbol("u", Time::Step);
        let ab = g.add(a, b);
        let p = g.exp(ab);
        let uses: Vec<_> = (2..6)
            .map(|k| {
                let c = g.int(k);
                let s = g.add(p, c);
                let s = g.ln(s);
                g.mul(s, u)
            })
            .collect();
        let (dag, roots) = associate(&g, &uses);
        let costs = |carry| Costs { carry };
        let early = |carry| carried(&dag, &roots, Time::Setup, &HashSet::new(), costs(carry));
        // Logarithms are dear: carried at a moderate price, computed again from the waist at a high one.
        assert_eq!(early(2).len(), 4);
        let waist = early(200);
        assert_eq!(waist.len(), 1);
        assert!(matches!(dag.node(waist[0]).operation, Operation::Exp(_)));
    }

    /// What is free to carry is carried in place of anything dearer.
    #[test]
    fn free_values_are_used() {
        let mut g = Graph::new();
        let a = g.symbol("a", Time::Setup);
        let u = g.symbol("u", Time::Step);
        let e = g.exp(a);
        let root = g.mul(e, u);
        let (dag, roots) = associate(&g, &[root, a]);
        let leaf = roots[1];
        let free = HashSet::from([leaf]);
        let chosen = carried(&dag, &roots[..1], Time::Setup, &free, Costs { carry: 1000 });
        assert_eq!(chosen, [leaf]);
    }
}
