//! The stiffness matrix from the blocks of the elements.
//!
//! ```text
//! K_ij = Σ_elements K_ab      i, j the global nodes of the local nodes a, b
//! ```
//!
//! Where each block goes is found once ([`AssemblyMap`]). K is symmetric: elements add to blocks on and above the diagonal
//! only, and the others are copied from these at the end, in one pass over the matrix. Elements are taken in small waves,
//! so that what a kernel writes is added while it is in the nearest caches; they add in their own order, whatever the
//! number of threads that compute the blocks.

use crate::companion::Family;
use crate::elements::{Block, Elements};
use souple_kernels::{Kernel, LANES};
use souple_solver::BlockCsr;
use std::sync::Arc;

/// Bytes of element blocks that a thread computes before they are added: half of a small level-one cache and more of the
/// next, so that long programs still have a few groups to run over.
const WAVE: usize = 48 << 10;

/// Places of the tangent blocks in a block matrix.
pub struct AssemblyMap {
    /// For each block of elements, [element][pair of the upper triangle]: slot on or above the diagonal, shifted left by
    /// one, and whether the block is added transposed.
    slots: Vec<Vec<u32>>,
    /// Slots above the diagonal and those of their transposes, in order of the first.
    mirrors: Vec<[u32; 2]>,
}

/// Which program gives a block's matrix blocks, and of which family; `None` for a block without one.
pub(crate) type KernelOf = dyn Fn(&Block) -> Option<(Arc<dyn Kernel>, Family)>;

impl Elements {
    /// An empty stiffness matrix with the pattern of the elements, and the places of their blocks in it.
    ///
    /// # Panics
    /// When the matrix would have more than 2³¹ blocks.
    pub fn pattern(&self) -> (BlockCsr, AssemblyMap) {
        let groups = self.blocks.iter().flat_map(|b| b.spec.connectivity.chunks(b.spec.element.node_count()));
        let matrix = BlockCsr::from_groups(self.dimension(), self.node_count(), groups)
            .expect("nodes of elements are nodes of the model");
        assert!(matrix.slot_count() < 1 << 31, "slots are counted in 31 bits");
        let slot = |a: u32, b: u32| matrix.slot(a as usize, b as usize).expect("the pattern holds every pair") as u32;
        let slots = self
            .blocks
            .iter()
            .map(|block| {
                let n = block.spec.element.node_count();
                let mut slots = Vec::with_capacity(block.spec.len() * n * (n + 1) / 2);
                for nodes in block.spec.connectivity.chunks(n) {
                    for (k, &a) in nodes.iter().enumerate() {
                        slots.extend(nodes[k..].iter().map(|&b| slot(a.min(b), a.max(b)) << 1 | u32::from(a > b)));
                    }
                }
                slots
            })
            .collect();
        let mirrors = (0..matrix.row_count())
            .flat_map(|row| matrix.row_slots(row).map(move |s| (row, s)))
            .filter(|&(row, s)| matrix.columns()[s] as usize > row)
            .map(|(row, s)| [s as u32, slot(matrix.columns()[s], row as u32)])
            .collect();
        (matrix, AssemblyMap { slots, mirrors })
    }

    /// Overwrites `matrix` by K = −∂f/∂u at `u`; with projected tangents at the state of the last
    /// [`Elements::linearise`].
    pub fn assemble(&mut self, u: &[f64], map: &AssemblyMap, matrix: &mut BlockCsr) {
        let kernel_of = |block: &Block| match &block.projected {
            Some(projected) => Some((projected.blocks.clone(), Family::Projected)),
            None => Some((block.tangent_blocks(), Family::Elastic)),
        };
        self.assemble_with(u, map, matrix, &kernel_of);
    }

    /// Overwrites `matrix` by the sum of the blocks that each block's program of a family gives, if it has one.
    pub(crate) fn assemble_with(&mut self, u: &[f64], map: &AssemblyMap, matrix: &mut BlockCsr, kernel_of: &KernelOf) {
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
                let slots = &slots[first * LANES * pairs..][..elements * pairs];
                for (element, slots) in slots.chunks(pairs).enumerate() {
                    let values = &block.tangent[element / LANES * values..][..values];
                    match dimension {
                        3 => scatter::<3>(matrix, slots, values, element % LANES),
                        2 => scatter::<2>(matrix, slots, values, element % LANES),
                        _ => scatter::<1>(matrix, slots, values, element % LANES),
                    }
                }
                first += count;
            }
        }
        match dimension {
            3 => mirror::<3>(matrix, &map.mirrors),
            2 => mirror::<2>(matrix, &map.mirrors),
            _ => mirror::<1>(matrix, &map.mirrors),
        }
    }
}

/// Adds the blocks of the element in one lane; `values` are those of its group, [pair][row][column][lane].
fn scatter<const D: usize>(matrix: &mut BlockCsr, slots: &[u32], values: &[f64], lane: usize) {
    let (rows, _) = matrix.values_mut().as_chunks_mut::<D>();
    let (targets, _) = rows.as_chunks_mut::<D>();
    for (&slot, block) in slots.iter().zip(values.chunks_exact(D * D * LANES)) {
        let target = &mut targets[(slot >> 1) as usize];
        if slot & 1 == 0 {
            for k in 0..D * D {
                target[k / D][k % D] += block[k * LANES + lane];
            }
        } else {
            for k in 0..D * D {
                target[k % D][k / D] += block[k * LANES + lane];
            }
        }
    }
}

/// Copies blocks above the diagonal to their transposes below it.
fn mirror<const D: usize>(matrix: &mut BlockCsr, mirrors: &[[u32; 2]]) {
    let (rows, _) = matrix.values_mut().as_chunks_mut::<D>();
    let (blocks, _) = rows.as_chunks_mut::<D>();
    for &[upper, lower] in mirrors {
        let block = blocks[upper as usize];
        let target = &mut blocks[lower as usize];
        for k in 0..D * D {
            target[k % D][k / D] = block[k / D][k % D];
        }
    }
}
