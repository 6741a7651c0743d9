//! Results are the same to the last bit for any number of threads.
//!
//! Out of scope: different backends, which may fuse a multiplication and an addition or not.

use souple_kernels::Interpreter;
use souple_kernels::conformance::Random;
use souple_operators::{BlockSpec, Elements, Masses, Tangent, Threads};
use souple_program::Costs;
use souple_solver::LinearOperator as _;
use std::sync::Arc;

/// Cells along each edge of the block of cells.
const CELLS: usize = 7;

/// A grid of cells, each filled at random by a hexahedron, two prisms, or five tetrahedra; the law of each block
/// alternates. Faces of neighbours need not match: forces of all elements are summed at the nodes either way.
fn model(threads: usize) -> (Elements, Masses) {
    let mut random = Random::new(31);
    let side = CELLS + 1;
    let node = |i: usize, j: usize, k: usize| (i + side * (j + side * k)) as u32;
    let mut nodes = Vec::new();
    for k in 0..side {
        for j in 0..side {
            for i in 0..side {
                nodes.push([i, j, k].map(|c| c as f64 + random.between(-0.1, 0.1)));
            }
        }
    }
    let mut blocks: [(&str, Vec<u32>); 4] =
        [("hex8", Vec::new()), ("prism6", Vec::new()), ("pyramid5", Vec::new()), ("tet4", Vec::new())];
    for cell in 0..CELLS * CELLS * CELLS {
        let (i, j, k) = (cell % CELLS, cell / CELLS % CELLS, cell / CELLS / CELLS);
        let c: Vec<u32> = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
            .map(|(a, b, d)| node(i + a, j + b, k + d))
            .to_vec();
        let parts: (usize, &[&[usize]]) = match random.below(4) {
            0 => (0, &[&[0, 1, 2, 3, 4, 5, 6, 7]]),
            1 => (1, &[&[0, 1, 2, 4, 5, 6], &[0, 2, 3, 4, 6, 7]]),
            2 => (2, &[&[0, 1, 2, 3, 6], &[0, 4, 5, 1, 6], &[0, 3, 7, 4, 6]]),
            _ => (3, &[&[0, 1, 2, 5], &[0, 2, 3, 7], &[0, 5, 7, 4], &[2, 7, 5, 6], &[0, 2, 7, 5]]),
        };
        for part in parts.1 {
            blocks[parts.0].1.extend(part.iter().map(|&a| c[a]));
        }
    }
    let laws = ["stvk", "hooke"].map(|id| souple_laws::by_id(id).unwrap());
    let specs = blocks.into_iter().enumerate().map(|(k, (id, connectivity))| {
        let element = souple_elements::by_id(id).unwrap();
        let count = (connectivity.len() / element.node_count()) as u32;
        BlockSpec {
            element,
            law: laws[k % 2],
            rule: element.default_rule(),
            parameters: vec![1e5, 0.3],
            density: 1000.0,
            viscosity: (k % 2 == 0).then_some([3.0, 5.0]),
            section: 1.0,
            connectivity,
            ids: (0..count).collect(),
        }
    });
    let threads = Arc::new(Threads::new(threads).unwrap());
    Elements::new(3, &nodes, specs.collect(), &Interpreter::default(), threads, Costs::default()).unwrap()
}

/// Bits of everything that a model computes at one state.
fn bits(threads: usize) -> Vec<(&'static str, Vec<u64>)> {
    let (mut elements, masses) = model(threads);
    let mut random = Random::new(32);
    let mut vector = |size: f64| -> Vec<f64> { (0..elements.len()).map(|_| random.between(-size, size)).collect() };
    let (u, v) = (vector(0.05), vector(1.0));
    let mut force = vec![0.0; u.len()];
    elements.add_force(&u, &mut force);
    elements.linearise(&u);
    let mut product = vec![0.0; u.len()];
    elements.add_tangent(-0.3, &v, &mut product);
    let (mut matrix, map) = elements.pattern();
    elements.assemble(&u, &map, &mut matrix);
    elements.linearise_damping(&u);
    let mut damping = vec![0.0; u.len()];
    elements.add_damping(0.7, &v, &mut damping);
    let energy = elements.energy(&u);
    let crushed: Vec<f64> = elements.crushed(&u, 0.95).iter().map(|c| c.1).collect();
    assert!(!crushed.is_empty(), "some elements are compressed");
    elements.set_tangent(Tangent::Projected, &Interpreter::default(), Costs::default()).unwrap();
    elements.linearise(&u);
    let mut projected = vec![0.0; u.len()];
    elements.add_tangent(-0.3, &v, &mut projected);
    [
        ("masses", masses.lumped),
        ("force", force),
        ("tangent product", product),
        ("matrix", matrix.values().to_vec()),
        ("damping", damping),
        ("projected product", projected),
        ("energy", vec![energy]),
        ("crushed", crushed),
    ]
    .map(|(name, values)| (name, values.iter().map(|v| v.to_bits()).collect()))
    .to_vec()
}

/// Energy, forces, tangent products and matrices of a mixed model have the same bits with 1, 2, 3 and 4 threads.
#[test]
fn the_number_of_threads_changes_no_bit() {
    let one = bits(1);
    for threads in 2..=4 {
        for ((name, want), (_, got)) in one.iter().zip(bits(threads)) {
            assert!(*want == got, "{name} with {threads} threads");
        }
    }
}

/// Assembled matrices of a mixed model agree with matrix-free products, over several blocks that share nodes.
#[test]
fn assembled_and_matrix_free_products_agree_on_a_mixed_model() {
    let (mut elements, _) = model(2);
    let mut random = Random::new(33);
    let mut vector = |size: f64| -> Vec<f64> { (0..elements.len()).map(|_| random.between(-size, size)).collect() };
    let (u, v) = (vector(0.05), vector(1.0));
    elements.linearise(&u);
    let mut product = vec![0.0; u.len()];
    elements.add_tangent(-1.0, &v, &mut product);
    let (mut matrix, map) = elements.pattern();
    elements.assemble(&u, &map, &mut matrix);
    let mut kv = vec![0.0; v.len()];
    matrix.apply(&v, &mut kv);
    let scale = crate::sample::largest(&kv);
    crate::sample::assert_close("mixed model", &product, &kv, 1e-12, scale);
}
