//! Two groups side by side: simulations with the same parameters, ratios of their times and differences of their results.
//!
//! ```text
//! match     by bar, by device where either group has several, and by every parameter that both have
//! time      B / A
//! result    |B − A| / max(|A|, |B|)
//! ```
//!
//! What is on one side only, what is there several times under one key, what ended differently and what was measured on one
//! side only is said, and takes no part in the figures.

use crate::report::data::{Group, Simulation};
use crate::report::quantities::{Derived, Kind, Quantity, derive};
use crate::report::scene::value;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// What two groups have in common, and where they differ.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The two sides, A and B.
    pub sides: [Side; 2],
    /// Parameters by which simulations are matched.
    pub matched_by: Vec<String>,
    /// Numbers of simulations that match, and came to their end on both sides.
    pub pairs: Vec<Pair>,
    /// Simulations that match and did not both come to their end: numbers and statuses.
    pub ended_differently: Vec<Ending>,
    /// Quantities that are measured on both sides.
    pub quantities: Vec<Compared>,
}

/// One of the two groups.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Side {
    /// Its name.
    pub group: String,
    /// Its simulations.
    pub simulations: usize,
    /// Its machines: processor and name.
    pub machines: Vec<String>,
    /// SHA-256 of the programs.
    pub programs: Vec<String>,
    /// Parameters that the other side does not have.
    pub only_parameters: Vec<String>,
    /// Numbers of simulations without a counterpart.
    pub unmatched: Vec<usize>,
    /// Numbers of simulations that several others look the same as.
    pub ambiguous: Vec<usize>,
    /// Quantities that the other side does not have.
    pub only_quantities: Vec<String>,
}

/// Two simulations with the same parameters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pair {
    /// Number in A.
    pub a: usize,
    /// Number in B.
    pub b: usize,
}

/// A pair of which at least one did not come to its end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Ending {
    /// The pair.
    pub pair: Pair,
    /// Status in A.
    pub a: String,
    /// Status in B.
    pub b: String,
}

/// A quantity of all pairs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Its name.
    pub name: String,
    /// Whether times are compared, by their ratios, or results, by their relative differences.
    pub kind: Kind,
    /// Pair by pair: value in A, value in B, ratio or difference; none where a value is missing or there is no ratio.
    pub values: Vec<(Option<f64>, Option<f64>, Option<f64>)>,
    /// Least, middle and largest of these; none where there are none.
    pub range: Option<[f64; 3]>,
}

/// Compares two groups.
pub fn compare(a: &Group, b: &Group) -> Comparison {
    let names = |g: &Group| -> BTreeSet<String> { g.parameters.iter().map(|p| p.name.clone()).collect() };
    let (of_a, of_b) = (names(a), names(b));
    let shared: Vec<String> = of_a.intersection(&of_b).cloned().collect();
    let devices = |g: &Group| g.simulations.iter().map(|s| s.device.clone()).collect::<BTreeSet<_>>().len();
    let by_device = devices(a) > 1 || devices(b) > 1;
    let by_bar = !a.bars.is_empty() && !b.bars.is_empty();
    let key = |g: &Group, s: &Simulation| -> Vec<String> {
        let parameter = |name: &String| {
            let at = g.parameters.iter().position(|p| p.name == *name)?;
            // 1 and 1.0 are one value.
            let value = value(s.values[at].as_deref()?);
            Some(value.number().map_or_else(|| value.to_string(), |x| format!("{x:?}")))
        };
        let mut key: Vec<String> = shared.iter().map(|name| parameter(name).unwrap_or_default()).collect();
        key.extend(s.bar.filter(|_| by_bar).map(|bar| g.bars[bar].name.clone()));
        key.extend(by_device.then(|| s.device.clone()));
        key
    };
    let places = |g: &Group| -> BTreeMap<Vec<String>, Vec<usize>> {
        let mut all: BTreeMap<Vec<String>, Vec<usize>> = BTreeMap::new();
        for (at, s) in g.simulations.iter().enumerate() {
            all.entry(key(g, s)).or_default().push(at);
        }
        all
    };
    let (in_a, in_b) = (places(a), places(b));
    let (mut unmatched, mut ambiguous) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    let mut matched: Vec<(usize, usize)> = Vec::new();
    for key in in_a.keys().chain(in_b.keys().filter(|k| !in_a.contains_key(*k))) {
        let of = |all: &BTreeMap<Vec<String>, Vec<usize>>| all.get(key).cloned().unwrap_or_default();
        match (of(&in_a).as_slice(), of(&in_b).as_slice()) {
            (&[a], &[b]) => matched.push((a, b)),
            (left, []) => unmatched[0].extend(left),
            ([], right) => unmatched[1].extend(right),
            (left, right) => {
                ambiguous[0].extend(left);
                ambiguous[1].extend(right);
            }
        }
    }
    matched.sort_unstable();
    let status =
        |g: &Group, at: usize| g.simulations[at].done.as_ref().map_or("to do".to_owned(), |d| d.status.clone());
    let succeeded = |g: &Group, at: usize| g.simulations[at].done.as_ref().is_some_and(|d| d.succeeded());
    let pair = |&(x, y): &(usize, usize)| Pair { a: a.simulations[x].number, b: b.simulations[y].number };
    let (good, bad): (Vec<_>, Vec<_>) = matched.into_iter().partition(|&(x, y)| succeeded(a, x) && succeeded(b, y));
    let (all_a, all_b) = (derive(a), derive(b));
    let [unmatched_a, unmatched_b] = unmatched;
    let [ambiguous_a, ambiguous_b] = ambiguous;
    Comparison {
        sides: [
            side(a, &of_b, &all_a, &all_b, unmatched_a, ambiguous_a),
            side(b, &of_a, &all_b, &all_a, unmatched_b, ambiguous_b),
        ],
        pairs: good.iter().map(pair).collect(),
        ended_differently: bad.iter().map(|p| Ending { pair: pair(p), a: status(a, p.0), b: status(b, p.1) }).collect(),
        quantities: quantities(&all_a, &all_b, &good),
        matched_by: {
            let further = [by_bar.then_some("bar"), by_device.then_some("device")];
            shared.into_iter().chain(further.into_iter().flatten().map(str::to_owned)).collect()
        },
    }
}

fn side(
    group: &Group,
    other: &BTreeSet<String>,
    own: &Derived,
    others: &Derived,
    unmatched: Vec<usize>,
    ambiguous: Vec<usize>,
) -> Side {
    let numbers = |mut at: Vec<usize>| {
        at.sort_unstable();
        at.into_iter().map(|at| group.simulations[at].number).collect()
    };
    let programs: BTreeSet<String> =
        group.simulations.iter().filter_map(|s| s.done.as_ref().map(|d| d.program.clone())).collect();
    let missing = |q: &&Quantity| !others.quantities.iter().any(|o| o.name == q.name);
    Side {
        group: group.name.clone(),
        simulations: group.simulations.len(),
        machines: group.machines.iter().map(|m| format!("{} ({})", m.processor, m.host)).collect(),
        programs: programs.into_iter().collect(),
        only_parameters: group.parameters.iter().map(|p| p.name.clone()).filter(|n| !other.contains(n)).collect(),
        unmatched: numbers(unmatched),
        ambiguous: numbers(ambiguous),
        only_quantities: own.quantities.iter().filter(missing).map(|q| q.name.clone()).collect(),
    }
}

fn quantities(a: &Derived, b: &Derived, pairs: &[(usize, usize)]) -> Vec<Compared> {
    let compared = |left: &Quantity| {
        let right = b.quantities.iter().find(|q| q.name == left.name)?;
        let values: Vec<_> = pairs
            .iter()
            .map(|&(x, y)| {
                let (x, y) = (left.values[x], right.values[y]);
                (x, y, x.zip(y).and_then(|(x, y)| figure(left.kind, x, y)))
            })
            .collect();
        let mut figures: Vec<f64> = values.iter().filter_map(|v| v.2).collect();
        figures.sort_by(f64::total_cmp);
        let range = figures.first().zip(figures.last()).map(|(&low, &high)| [low, middle(&figures), high]);
        Some(Compared { name: left.name.clone(), kind: left.kind, values, range })
    };
    a.quantities.iter().filter_map(compared).collect()
}

/// The ratio of two times, or the relative difference of two results.
fn figure(kind: Kind, a: f64, b: f64) -> Option<f64> {
    match kind {
        Kind::Time => (a > 0.0).then(|| b / a),
        _ if a == b => Some(0.0),
        _ => Some((b - a).abs() / a.abs().max(b.abs())),
    }
}

/// The median of sorted numbers, at least one.
fn middle(sorted: &[f64]) -> f64 {
    let half = sorted.len() / 2;
    if sorted.len() % 2 == 1 { sorted[half] } else { 0.5 * (sorted[half - 1] + sorted[half]) }
}
