//! Sharing and grouping do not depend on the order in which terms and factors were written.

use souple_kernels::conformance::Random;
use souple_program::{Dag, associate};
use souple_symbols::{Expr, Graph, Time};

/// What is written in a random order.
#[derive(Clone, Copy, PartialEq)]
enum Permuted {
    /// The operands of each sum and product.
    Operands,
    /// These, and the sums and products themselves.
    Nodes,
}

/// Sums of products of sums that share parts, written in an order that `order` decides.
fn expressions(permuted: Permuted, order: &mut Random) -> (Graph, Vec<Expr>) {
    let mut shape = Random::new(5);
    let mut g = Graph::new();
    let times = [Time::Setup, Time::Step, Time::Apply];
    let mut level: Vec<Expr> = (0..9).map(|k| g.symbol(format!("x_{k}"), times[k % 3])).collect();
    for depth in 0..4 {
        let picks: Vec<Vec<usize>> =
            (0..9).map(|_| (0..2 + shape.below(4)).map(|_| shape.below(level.len())).collect()).collect();
        let nodes = match permuted {
            Permuted::Operands => (0..picks.len()).collect(),
            Permuted::Nodes => shuffled(picks.len(), order),
        };
        let mut next = vec![None; picks.len()];
        for at in nodes {
            let items: Vec<Expr> = shuffled(picks[at].len(), order).iter().map(|&k| level[picks[at][k]]).collect();
            next[at] = Some(if depth % 2 == 0 { g.product(&items) } else { g.sum(&items) });
        }
        level = next.into_iter().map(|e| e.expect("every place is filled")).collect();
    }
    (g, level)
}

fn shuffled(n: usize, random: &mut Random) -> Vec<usize> {
    let mut list: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        list.swap(k, random.below(k + 1));
    }
    list
}

fn cost(dag: &Dag) -> u64 {
    (0..dag.len() as u32).map(|k| dag.node(souple_program::Ref(k)).operation.cost()).sum()
}

fn size(permuted: Permuted, seed: u64) -> (usize, u64) {
    let (g, roots) = expressions(permuted, &mut Random::new(seed));
    let (dag, _) = associate(&g, &roots);
    (dag.len(), cost(&dag))
}

/// Permuted terms and factors give a dag of the same size and cost.
#[test]
fn permuted_terms_give_the_same_size() {
    let first = size(Permuted::Operands, 100);
    assert!(first.0 > 40, "the expressions are not trivial: {first:?}");
    for seed in 101..140 {
        assert_eq!(size(Permuted::Operands, seed), first, "order {seed}");
    }
}

/// The order in which whole sub-expressions were first written breaks ties between pairs that are shared equally
/// often, and nothing else: the cost moves by a twentieth at most.
#[test]
fn order_of_writing_hardly_matters() {
    let costs: Vec<u64> = (100..140).map(|seed| size(Permuted::Nodes, seed).1).collect();
    let (least, most) = (costs.iter().min().unwrap(), costs.iter().max().unwrap());
    assert!(20 * (most - least) <= *most, "costs from {least} to {most}");
}

/// A pair that occurs in several products is multiplied once, wherever it stands in them.
#[test]
fn common_pairs_are_computed_once() {
    let mut g = Graph::new();
    let [a, b, c, d] = ["a", "b", "c", "d"].map(|n| g.symbol(n, Time::Step));
    let roots = [g.product(&[a, c, b]), g.product(&[b, d, a]), g.product(&[a, b])];
    let (dag, refs) = associate(&g, &roots);
    // Four leaves, a·b, and one more product for each of the first two roots.
    assert_eq!((dag.len(), cost(&dag)), (7, 3));
    assert_ne!(refs[0], refs[2]);
}

/// Operands of one time stand together: what the set-up knows of a product is one node of that time.
#[test]
fn operands_of_one_time_are_grouped() {
    let mut g = Graph::new();
    let [a, b] = ["a", "b"].map(|n| g.symbol(n, Time::Setup));
    let [u, v] = ["u", "v"].map(|n| g.symbol(n, Time::Step));
    let terms = [u, a, v, b];
    for root in [g.product(&terms), g.sum(&terms)] {
        let (dag, _) = associate(&g, &[root]);
        let early = (0..dag.len() as u32).filter(|&k| dag.node(souple_program::Ref(k)).time == Time::Setup);
        assert_eq!(early.count(), 3, "two leaves and their product or sum");
    }
}
