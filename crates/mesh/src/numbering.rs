//! Orders of nodes and elements that keep neighbours close in memory.
//!
//! Gathering the nodes of an element touches memory all over the mesh when neighbours have distant numbers. Reverse
//! Cuthill–McKee numbers nodes in waves from a far end of the mesh, which makes the matrix band narrow; elements sorted
//! by their lowest node then follow the same waves.
//! Reference: A. George, J. Liu, "Computer Solution of Large Sparse Positive Definite Systems", 1981, ch. 4.

use crate::mesh::{ElementId, Mesh};

/// Neighbours of each node (nodes that share an element) in compressed rows, sorted, without itself.
fn neighbours(mesh: &Mesh) -> (Vec<usize>, Vec<u32>) {
    let elements = || mesh.blocks.iter().flat_map(|b| (0..b.len()).map(move |e| b.nodes(e)));
    // Elements of each node in compressed rows: counts, then starts, then filled from the ends.
    let mut first = vec![0usize; mesh.nodes.len() + 1];
    elements().flatten().for_each(|&n| first[n as usize] += 1);
    let mut total = 0;
    first.iter_mut().for_each(|row| {
        total += *row;
        *row = total;
    });
    let mut of_node: Vec<&[u32]> = vec![&[]; total];
    for nodes in elements() {
        for &n in nodes {
            first[n as usize] -= 1;
            of_node[first[n as usize]] = nodes;
        }
    }
    let (mut start, mut list) = (vec![0], Vec::new());
    let mut last_seen = vec![u32::MAX; mesh.nodes.len()];
    for n in 0..mesh.nodes.len() {
        last_seen[n] = n as u32;
        let from = list.len();
        for &other in of_node[first[n]..first[n + 1]].iter().copied().flatten() {
            if std::mem::replace(&mut last_seen[other as usize], n as u32) != n as u32 {
                list.push(other);
            }
        }
        list[from..].sort_unstable();
        start.push(list.len());
    }
    (start, list)
}

/// A reverse Cuthill–McKee order: `order[new] = old`, a permutation of the mesh's nodes.
///
/// Every connected piece starts at a pseudo-peripheral node (George & Liu) and lists neighbours by increasing degree,
/// equal degrees by number; the whole is reversed. Nodes of no element come last.
/// A structured grid numbered along its shortest sides is as narrow as can be already, and waves that start at its
/// corner are wider: compare [`bandwidth`] before and after.
pub fn reverse_cuthill_mckee(mesh: &Mesh) -> Vec<u32> {
    let (start, list) = neighbours(mesh);
    let of = |n: u32| &list[start[n as usize]..start[n as usize + 1]];
    let degree = |n: u32| of(n).len();

    // Levels of nodes around a root; returns the visited nodes and where the last level begins.
    let mut seen = vec![u32::MAX; mesh.nodes.len()];
    let mut mark = 0;
    let mut levels = |root: u32| -> (Vec<u32>, usize, usize) {
        mark += 1;
        let (mut visited, mut begin, mut depth) = (vec![root], 0, 0);
        seen[root as usize] = mark;
        loop {
            let end = visited.len();
            for at in begin..end {
                for &next in of(visited[at]) {
                    if seen[next as usize] != mark {
                        seen[next as usize] = mark;
                        visited.push(next);
                    }
                }
            }
            if visited.len() == end {
                return (visited, begin, depth);
            }
            (begin, depth) = (end, depth + 1);
        }
    };

    let mut order: Vec<u32> = Vec::with_capacity(mesh.nodes.len());
    let mut placed = vec![false; mesh.nodes.len()];
    for seed in 0..mesh.nodes.len() as u32 {
        if placed[seed as usize] || degree(seed) == 0 {
            continue;
        }
        let mut root = seed;
        let (mut visited, mut last, mut depth) = levels(root);
        loop {
            let far = visited[last..].iter().copied().min_by_key(|&n| (degree(n), n)).unwrap_or(root);
            let (next_visited, next_last, next_depth) = levels(far);
            if next_depth <= depth {
                break;
            }
            (root, visited, last, depth) = (far, next_visited, next_last, next_depth);
        }
        let mut at = order.len();
        order.push(root);
        placed[root as usize] = true;
        let mut next: Vec<u32> = Vec::new();
        while at < order.len() {
            next.clear();
            next.extend(of(order[at]).iter().copied().filter(|&n| !placed[n as usize]));
            next.sort_by_key(|&n| (degree(n), n));
            next.iter().for_each(|&n| placed[n as usize] = true);
            order.extend_from_slice(&next);
            at += 1;
        }
    }
    order.reverse();
    order.extend((0..mesh.nodes.len() as u32).filter(|&n| !placed[n as usize]));
    order
}

/// An order that is not one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OrderError {
    /// Too long or too short.
    #[error("an order of {given} numbers for {expected} nodes; it must name each node once")]
    Length {
        /// What was given.
        given: usize,
        /// Number of nodes.
        expected: usize,
    },
    /// A number twice or out of range.
    #[error(
        "the order names node {node} at position {position} again, or the mesh has no such node; each node must appear once"
    )]
    Entry {
        /// Where in the order.
        position: usize,
        /// The number there.
        node: u32,
    },
}

/// Renumbers nodes: the new node i is the old node `order[i]`. Regions follow.
///
/// # Errors
/// The order is not a permutation of the nodes; the mesh is unchanged then.
pub fn renumber_nodes(mesh: &mut Mesh, order: &[u32]) -> Result<(), OrderError> {
    if order.len() != mesh.nodes.len() {
        return Err(OrderError::Length { given: order.len(), expected: mesh.nodes.len() });
    }
    let mut new = vec![u32::MAX; order.len()];
    for (position, &node) in order.iter().enumerate() {
        match new.get_mut(node as usize) {
            Some(place) if *place == u32::MAX => *place = position as u32,
            _ => return Err(OrderError::Entry { position, node }),
        }
    }
    mesh.nodes = order.iter().map(|&old| mesh.nodes[old as usize]).collect();
    for node in mesh.blocks.iter_mut().flat_map(|b| &mut b.connectivity) {
        *node = new[*node as usize];
    }
    for region in mesh.regions.values_mut() {
        region.nodes.iter_mut().for_each(|n| *n = new[*n as usize]);
        region.nodes.sort_unstable();
    }
    Ok(())
}

/// Sorts the elements of each block by their nodes in increasing order, and returns `order[block][new] = old`.
/// Regions follow.
pub fn sort_elements(mesh: &mut Mesh) -> Vec<Vec<u32>> {
    let mut orders: Vec<Vec<u32>> = Vec::with_capacity(mesh.blocks.len());
    for block in &mut mesh.blocks {
        let mut keyed: Vec<(Vec<u32>, u32)> = (0..block.len())
            .map(|e| {
                let mut nodes = block.nodes(e).to_vec();
                nodes.sort_unstable();
                (nodes, e as u32)
            })
            .collect();
        keyed.sort_unstable();
        let order: Vec<u32> = keyed.into_iter().map(|(_, e)| e).collect();
        block.connectivity = order.iter().flat_map(|&e| block.nodes(e as usize).to_vec()).collect();
        orders.push(order);
    }
    let mut new: Vec<Vec<u32>> = orders.iter().map(|order| vec![0; order.len()]).collect();
    for (block, order) in orders.iter().enumerate() {
        order.iter().enumerate().for_each(|(at, &old)| new[block][old as usize] = at as u32);
    }
    for region in mesh.regions.values_mut() {
        for id in &mut region.elements {
            *id = ElementId { index: new[id.block as usize][id.index as usize], ..*id };
        }
        region.elements.sort_unstable();
    }
    orders
}

/// The largest difference of two node numbers of one element: half the band of the matrix, in nodes.
pub fn bandwidth(mesh: &Mesh) -> u32 {
    let spread = |nodes: &[u32]| nodes.iter().max().zip(nodes.iter().min()).map_or(0, |(a, b)| a - b);
    mesh.blocks.iter().flat_map(|b| (0..b.len()).map(move |e| spread(b.nodes(e)))).max().unwrap_or(0)
}
