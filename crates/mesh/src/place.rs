//! Completing elements that are known by their corners: mid-side, face and inner nodes.
//!
//! A node that is not a corner is known by what carries it and where it lies on that: the sorted global corners of its
//! side, each with its weight. Two elements that share the side find the same key whatever their families and local
//! orders, so nodes merge without comparing positions. New nodes are numbered by sorted key (edges, then faces, then
//! interiors), which is a function of the corners alone.
//! Positions are Σ wᵢ xᵢ: sides are straight.

use crate::mesh::{Block, ElementId, Mesh};
use crate::reference::{Support, supports};
use souple_elements::Element;

/// Elements known by their corners only.
#[derive(Clone, Debug)]
pub(crate) struct CornerBlock {
    pub element: &'static Element,
    /// Global nodes, `[element, corner]`.
    pub corners: Vec<u32>,
}

/// More corners than any family has would be a bug of the registry.
const MAX_CORNERS: usize = 8;

/// Carrier of a node: number of corners first, so that edges sort before faces and those before interiors.
type Key = (u8, [u32; MAX_CORNERS], [i32; MAX_CORNERS]);

fn key(support: &Support, corners: &[u32]) -> Key {
    // Weights are multiples of small fractions (1/2, 1/3, …): 2⁻²⁰ tells them apart and absorbs rounding.
    const STEPS: f64 = (1 << 20) as f64;
    let count = support.corners.len();
    let mut at = [(u32::MAX, 0); MAX_CORNERS];
    for (place, (&c, w)) in at.iter_mut().zip(support.corners.iter().zip(&support.weights)) {
        *place = (corners[c as usize], (w * STEPS).round() as i32);
    }
    at[..count].sort_unstable();
    (count as u8, at.map(|(corner, _)| corner), at.map(|(_, weight)| weight))
}

/// One node to be made: who asks for it, sorted by what carries it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Request {
    /// Number of carrying corners.
    carriers: u8,
    /// The lowest of them: requests for the same node agree on it.
    lowest: u32,
    block: u32,
    element: u32,
    support: u32,
}

/// Appends the missing nodes to `nodes` and returns the full blocks, in the same order.
///
/// `nodes` holds the corner positions; blocks whose elements have no other nodes pass through unchanged.
pub(crate) fn complete(nodes: &mut Vec<[f64; 3]>, blocks: Vec<CornerBlock>) -> Vec<Block> {
    let carriers: Vec<Vec<Support>> = blocks.iter().map(|b| supports(b.element)).collect();
    let mut requests: Vec<Request> = Vec::new();
    let mut full: Vec<Block> = Vec::with_capacity(blocks.len());
    for (block, (b, supports)) in (0u32..).zip(blocks.iter().zip(&carriers)) {
        let mut connectivity =
            Vec::with_capacity(b.corners.len() / b.element.family.corner_count() * b.element.node_count());
        for (element, corners) in (0u32..).zip(b.corners.chunks_exact(b.element.family.corner_count())) {
            connectivity.extend_from_slice(corners);
            for (s, support) in (0u32..).zip(supports) {
                let lowest = support.corners.iter().map(|&c| corners[c as usize]).min().unwrap_or(0);
                requests.push(Request { carriers: support.corners.len() as u8, lowest, block, element, support: s });
                connectivity.push(u32::MAX);
            }
        }
        full.push(Block { element: b.element, connectivity });
    }
    // Sorting the short requests first leaves only small groups to be told apart by the long keys.
    requests.sort_unstable();
    let mut keyed: Vec<(Key, &Request)> = Vec::new();
    for group in requests.chunk_by(|a, b| (a.carriers, a.lowest) == (b.carriers, b.lowest)) {
        keyed.clear();
        keyed.extend(group.iter().map(|r| (key(carrier(&carriers, r), corners_of(&blocks, r)), r)));
        // The first request of each key makes the node, so its position does not depend on rounding.
        keyed.sort_unstable();
        for same in keyed.chunk_by(|a, b| a.0 == b.0) {
            let (first, node) = (same[0].1, nodes.len() as u32);
            let (support, corners) = (carrier(&carriers, first), corners_of(&blocks, first));
            let mut position = [0.0; 3];
            for (&c, w) in support.corners.iter().zip(&support.weights) {
                let corner = nodes[corners[c as usize] as usize];
                position = std::array::from_fn(|a| position[a] + w * corner[a]);
            }
            nodes.push(position);
            for (_, r) in same {
                let element = full[r.block as usize].element;
                let slot =
                    r.element as usize * element.node_count() + element.family.corner_count() + r.support as usize;
                full[r.block as usize].connectivity[slot] = node;
            }
        }
    }
    full
}

fn carrier<'a>(carriers: &'a [Vec<Support>], r: &Request) -> &'a Support {
    &carriers[r.block as usize][r.support as usize]
}

fn corners_of<'a>(blocks: &'a [CornerBlock], r: &Request) -> &'a [u32] {
    let block = &blocks[r.block as usize];
    let n = block.element.family.corner_count();
    &block.corners[r.element as usize * n..(r.element as usize + 1) * n]
}

/// A replacement of one element by one of another family was asked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{from}` cannot become `{to}`: a {from_family} has other corners than a {to_family}; choose an element of the same family"
)]
pub struct FamilyMismatch {
    /// Element of the mesh.
    pub from: &'static str,
    /// Its family.
    pub from_family: &'static str,
    /// Element asked for.
    pub to: &'static str,
    /// Its family.
    pub to_family: &'static str,
}

/// The same mesh with other elements of the same families, chosen by `choose` from each present one; nodes that are
/// not corners are dropped and made anew on straight sides.
///
/// For meshes that pass [`crate::check::validate`]. This is how a linear mesh becomes a quadratic one, and back. Corners keep their order and come first. Regions keep
/// their elements and corner nodes, and gain each new node all of whose carrying corners they hold.
pub fn with_elements(
    mesh: &Mesh,
    choose: impl Fn(&'static Element) -> &'static Element,
) -> Result<Mesh, FamilyMismatch> {
    let mut corner_blocks: Vec<CornerBlock> = Vec::new();
    // Where each old block went: two old kinds may become the same new one.
    let mut moved: Vec<(u32, u32)> = Vec::new();
    for block in &mesh.blocks {
        let (from, to) = (block.element, choose(block.element));
        if from.family != to.family {
            let [from_family, to_family] = [from.family.name(), to.family.name()];
            return Err(FamilyMismatch { from: from.id, from_family, to: to.id, to_family });
        }
        let corner_count = to.family.corner_count();
        let at = corner_blocks.iter().position(|b| b.element.id == to.id).unwrap_or_else(|| {
            corner_blocks.push(CornerBlock { element: to, corners: Vec::new() });
            corner_blocks.len() - 1
        });
        let corners = &mut corner_blocks[at].corners;
        moved.push((at as u32, (corners.len() / corner_count) as u32));
        corners.extend((0..block.len()).flat_map(|e| &block.nodes(e)[..corner_count]));
    }

    let (mut corner, mut carried) = (vec![false; mesh.nodes.len()], vec![false; mesh.nodes.len()]);
    mesh.blocks.iter().flat_map(|b| &b.connectivity).for_each(|&n| carried[n as usize] = true);
    corner_blocks.iter().flat_map(|b| &b.corners).for_each(|&n| corner[n as usize] = true);
    // Nodes of no element (markers, particles of springs) stay; nodes that only carried the old interpolation go.
    let kept: Vec<usize> = (0..mesh.nodes.len()).filter(|&n| corner[n] || !carried[n]).collect();
    let mut renumbered = vec![None; mesh.nodes.len()];
    kept.iter().enumerate().for_each(|(new, &old)| renumbered[old] = Some(new as u32));
    for node in corner_blocks.iter_mut().flat_map(|b| &mut b.corners) {
        *node = renumbered[*node as usize].expect("corners are kept");
    }
    let mut nodes: Vec<[f64; 3]> = kept.iter().map(|&n| mesh.nodes[n]).collect();
    let blocks = complete(&mut nodes, corner_blocks);

    let carriers = carriers(&blocks, kept.len(), nodes.len());
    let mut regions = mesh.regions.clone();
    for region in regions.values_mut() {
        let mut inside = vec![false; nodes.len()];
        region.nodes.iter().filter_map(|&n| renumbered[n as usize]).for_each(|n| inside[n as usize] = true);
        for (new, corners) in carriers.iter().enumerate() {
            inside[kept.len() + new] = corners.iter().all(|&c| inside[c as usize]);
        }
        region.nodes = (0..nodes.len() as u32).filter(|&n| inside[n as usize]).collect();
        for element in &mut region.elements {
            let (block, first) = moved[element.block as usize];
            *element = ElementId { block, index: first + element.index };
        }
        region.elements.sort_unstable();
    }
    Ok(Mesh { nodes, blocks, regions })
}

/// For each node from `first` on, the global corners that carry it.
fn carriers(blocks: &[Block], first: usize, count: usize) -> Vec<Vec<u32>> {
    let mut carriers = vec![Vec::new(); count - first];
    for block in blocks {
        let supports = supports(block.element);
        let corner_count = block.element.family.corner_count();
        for e in 0..block.len() {
            let local = block.nodes(e);
            for (support, &node) in supports.iter().zip(&local[corner_count..]) {
                carriers[node as usize - first] = support.corners.iter().map(|&c| local[c as usize]).collect();
            }
        }
    }
    carriers
}
