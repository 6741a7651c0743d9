//! The stiffness matrix from the blocks of the elements.
//!
//! ```text
//! K_ij = Σ_elements K_ab      i, j the global nodes of the local nodes a, b
//! ```
//!
//! Where each block goes is found once ([`AssemblyMap`]). K is symmetric: only blocks on and above the diagonal are kept.
//! Elements are taken in small waves, so that what a kernel writes is added while it is in the nearest caches; they add in
//! their own order, whatever the number of threads that compute the blocks.

use crate::companion::Family;
use crate::elements::{Block, Elements};
use souple_kernels::{Kernel, LANES};
use souple_solver::SymmetricBlocks;
use std::sync::Arc;

/// Bytes of element blocks that a thread computes before they are added: half of a small level-one cache and more of the
/// next, so that long programs still have a few groups to run over.
const WAVE: usize = 48 << 10;

/// Places of the tangent blocks in a block matrix.
pub struct AssemblyMap {
    /// For each block of elements, [group][pair of the upper triangle][lane]: slot on or above the diagonal, shifted left by
    /// one, and whether the block is added transposed. Lanes beyond the last element have zeros, which nobody reads.
    slots: Vec<Vec<u32>>,
}

/// Which program gives a block's matrix blocks, and of which family; `None` for a block without one.
pub(crate) type KernelOf = dyn Fn(&Block) -> Option<(Arc<dyn Kernel>, Family)>;

impl Elements {
    /// An empty stiffness matrix with the pattern of the elements, and the places of their blocks in it.
    ///
    /// # Panics
    /// When the matrix would have more than 2³¹ blocks.
    pub fn pattern(&self) -> (SymmetricBlocks, AssemblyMap) {
        let groups = self.blocks.iter().flat_map(|b| b.spec.connectivity.chunks(b.spec.element.node_count()));
        let matrix = SymmetricBlocks::from_groups(self.dimension(), self.node_count(), groups)
            .expect("nodes of elements are nodes of the model");
        assert!(matrix.slot_count() < 1 << 31, "slots are counted in 31 bits");
        let slot = |a: u32, b: u32| matrix.slot(a as usize, b as usize).expect("the pattern holds every pair") as u32;
        let slots = self
            .blocks
            .iter()
            .map(|block| {
                let n = block.spec.element.node_count();
                let pairs = n * (n + 1) / 2;
                let mut slots = vec![0; block.groups * pairs * LANES];
                for (element, nodes) in block.spec.connectivity.chunks(n).enumerate() {
                    let first = element / LANES * pairs * LANES + element % LANES;
                    let of_pairs = nodes.iter().enumerate().flat_map(|(k, &a)| nodes[k..].iter().map(move |&b| (a, b)));
                    for (pair, (a, b)) in of_pairs.enumerate() {
                        slots[first + pair * LANES] = slot(a.min(b), a.max(b)) << 1 | u32::from(a > b);
                    }
                }
                slots
            })
            .collect();
        (matrix, AssemblyMap { slots })
    }

    /// Overwrites `matrix` by K = −∂f/∂u at `u`; with projected tangents at the state of the last
    /// [`Elements::linearise`].
    pub fn assemble(&mut self, u: &[f64], map: &AssemblyMap, matrix: &mut SymmetricBlocks) {
        let kernel_of = |block: &Block| match &block.projected {
            Some(projected) => Some((projected.blocks.clone(), Family::Projected)),
            None => Some((block.tangent_blocks(), Family::Elastic)),
        };
        self.assemble_with(u, map, matrix, &kernel_of);
    }

    /// Overwrites `matrix` by the sum of the blocks that each block's program of a family gives, if it has one.
    pub(crate) fn assemble_with(
        &mut self,
        u: &[f64],
        map: &AssemblyMap,
        matrix: &mut SymmetricBlocks,
        kernel_of: &KernelOf,
    ) {
        matrix.clear();
        let dimension = self.dimension();
        for (block, slots) in self.blocks.iter_mut().zip(&map.slots) {
            let Some((kernel, family)) = kernel_of(block) else { continue };
            let n = block.spec.element.node_count();
            let pairs = n * (n + 1) / 2;
            let values = pairs * dimension * dimension * LANES;
            let wave = (WAVE / (8 * values)).max(1);
            // Handing work to other threads costs as much as some waves.
            let wave = if self.threads.count() > 1 { 8 * wave * self.threads.count() } else { wave };
            let mut first = 0;
            while first < block.groups {
                let count = wave.min(block.groups - first);
                block.run_blocks(&kernel, family, u, first, count, &self.threads, &mut self.scratch);
                let elements = (block.spec.len() - first * LANES).min(count * LANES);
                let slots = slots[first * LANES * pairs..].chunks(LANES * pairs);
                for (group, (values, slots)) in block.tangent.chunks(values).zip(slots).take(count).enumerate() {
                    let lanes = (elements - group * LANES).min(LANES);
                    match dimension {
                        3 => scatter::<3, 9>(matrix, slots, values, lanes),
                        2 => scatter::<2, 4>(matrix, slots, values, lanes),
                        _ => scatter::<1, 1>(matrix, slots, values, lanes),
                    }
                }
                first += count;
            }
        }
    }
}

/// Adds the blocks of the elements in the first `lanes` of a group; `values` are theirs, [pair][row and column][lane].
fn scatter<const D: usize, const DD: usize>(matrix: &mut SymmetricBlocks, slots: &[u32], values: &[f64], lanes: usize) {
    let (targets, _) = matrix.values_mut().as_chunks_mut::<DD>();
    let (values, _) = values.as_chunks::<LANES>();
    let (blocks, _) = values.as_chunks::<DD>();
    let (slots, _) = slots.as_chunks::<LANES>();
    for (slots, block) in slots.iter().zip(blocks) {
        for lane in 0..lanes {
            let slot = slots[lane];
            let target = &mut targets[(slot >> 1) as usize];
            // No branch: in a mesh from outside, which way round a pair stands is anybody's guess.
            let turned = (slot & 1) as usize;
            for k in 0..DD {
                let mirrored = k % D * D + k / D;
                let from = if mirrored > k { k + turned * (mirrored - k) } else { k - turned * (k - mirrored) };
                target[k] += block[from][lane];
            }
        }
    }
}
