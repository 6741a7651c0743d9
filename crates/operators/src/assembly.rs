//! The stiffness matrix from the blocks of the elements.
//!
//! ```text
//! K_ij = Σ_elements K_ab      i, j the global nodes of the local nodes a, b
//! ```
//!
//! Where each block goes is found once ([`AssemblyMap`]). K is symmetric: only blocks on and above the diagonal are kept.
//! Elements are taken in small waves, so that what a kernel writes is added while it is in the nearest caches.
//!
//! Each thread owns a range of rows and adds to these alone, the elements that meet them in their own order; elements that
//! meet the rows of several threads are computed by each. So every sum is taken in the order of the elements, whatever the
//! number of threads, and nobody waits for anybody.

use crate::companion::Family;
use crate::elements::{Block, Elements};
use souple_kernels::{Kernel, LANES, Scratch};
use souple_solver::SymmetricBlocks;
use std::ops::Range;
use std::sync::Arc;

/// Bytes of element blocks that a thread computes before they are added: half of a small level-one cache and more of the
/// next, so that long programs still have a few groups to run over.
const WAVE: usize = 48 << 10;

/// Places of the tangent blocks in a block matrix.
pub struct AssemblyMap {
    /// For each block of elements, [group][pair of the upper triangle][lane]: slot on or above the diagonal, shifted left by
    /// one, and whether the block is added transposed. Lanes beyond the last element have zeros, which nobody reads.
    slots: Vec<Vec<u32>>,
    /// One for each thread.
    shares: Vec<Share>,
}

/// What one thread assembles.
struct Share {
    /// Slots of its rows.
    slots: Range<usize>,
    /// For each block of elements, runs of groups that meet these rows.
    runs: Vec<Vec<Range<usize>>>,
}

/// A thread's memory for element blocks.
#[derive(Default)]
pub(crate) struct Wave {
    scratch: Scratch,
    blocks: Vec<f64>,
}

/// Groups that are computed, over groups that there are, beyond which sharing is not worth it: nodes without any order
/// meet everywhere.
const DOUBLE_WORK: f64 = 1.4;

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
        let slots: Vec<Vec<u32>> = self
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
        let shares = self.shares(&matrix, &slots);
        (matrix, AssemblyMap { slots, shares })
    }

    /// Rows in as many ranges as there are threads, with about as many blocks in each; in one, where ranges would have too
    /// many elements in common.
    fn shares(&self, matrix: &SymmetricBlocks, slots: &[Vec<u32>]) -> Vec<Share> {
        let count = self.threads.count();
        let starts = matrix.row_starts();
        let bound = |share: usize| {
            let slot = matrix.slot_count() * share / count;
            starts[starts.partition_point(|&s| s < slot)]
        };
        let shares: Vec<Share> = (0..count)
            .map(|share| {
                let own = bound(share)..bound(share + 1);
                let runs = self.blocks.iter().zip(slots).map(|(block, slots)| runs_of(block, slots, &own)).collect();
                Share { slots: own, runs }
            })
            .collect();
        let computed: usize = shares.iter().flat_map(|s| s.runs.iter().flatten()).map(Range::len).sum();
        let groups: usize = self.blocks.iter().map(|b| b.groups).sum();
        if computed as f64 <= DOUBLE_WORK * groups as f64 {
            return shares;
        }
        // One run over all groups of each block.
        #[expect(clippy::single_range_in_vec_init, reason = "that is what is meant")]
        let runs = self.blocks.iter().map(|b| vec![0..b.groups]).collect();
        vec![Share { slots: 0..matrix.slot_count(), runs }]
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
        struct Task<'a> {
            share: &'a Share,
            values: &'a mut [f64],
            wave: Wave,
        }
        let dimension = self.dimension();
        let kernels: Vec<_> = self.blocks.iter().map(kernel_of).collect();
        let mut left = matrix.values_mut();
        let mut tasks: Vec<Task<'_>> = Vec::with_capacity(map.shares.len());
        for share in &map.shares {
            let (values, rest) = left.split_at_mut(share.slots.len() * dimension * dimension);
            left = rest;
            tasks.push(Task { share, values, wave: self.waves.pop().unwrap_or_default() });
        }
        let blocks = &self.blocks;
        self.threads.run(&mut tasks, |Task { share, values, wave }| {
            values.fill(0.0);
            for (((block, kernel), slots), runs) in blocks.iter().zip(&kernels).zip(&map.slots).zip(&share.runs) {
                let Some((kernel, family)) = kernel else { continue };
                let source = block.blocks_source(*family, u);
                let n = block.spec.element.node_count();
                let pairs = n * (n + 1) / 2;
                let size = pairs * dimension * dimension * LANES;
                let groups_of_wave = (WAVE / (8 * size)).max(1);
                wave.blocks.resize(groups_of_wave * size, 0.0);
                for (first, end) in runs.iter().flat_map(|run| waves(run, groups_of_wave)) {
                    let inputs = source.inputs(kernel.program(), first, end - first);
                    let written = &mut wave.blocks[..(end - first) * size];
                    kernel.run(&mut wave.scratch, end - first, &inputs, &mut [written]);
                    let slots = slots[first * LANES * pairs..].chunks(LANES * pairs);
                    for (group, (values_of_group, slots)) in
                        wave.blocks.chunks(size).zip(slots).take(end - first).enumerate()
                    {
                        let lanes = (block.spec.len() - (first + group) * LANES).min(LANES);
                        match dimension {
                            3 => scatter::<3, 9>(values, &share.slots, slots, values_of_group, lanes),
                            2 => scatter::<2, 4>(values, &share.slots, slots, values_of_group, lanes),
                            _ => scatter::<1, 1>(values, &share.slots, slots, values_of_group, lanes),
                        }
                    }
                }
            }
        });
        self.waves.extend(tasks.into_iter().map(|task| task.wave));
    }
}

/// First group and the one after the last of each wave of a run.
fn waves(run: &Range<usize>, groups: usize) -> impl Iterator<Item = (usize, usize)> {
    let end = run.end;
    run.clone().step_by(groups).map(move |first| (first, end.min(first + groups)))
}

/// Runs of groups that have a slot among `own`.
fn runs_of(block: &Block, slots: &[u32], own: &Range<usize>) -> Vec<Range<usize>> {
    let n = block.spec.element.node_count();
    let pairs = n * (n + 1) / 2;
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (group, slots) in slots.chunks(pairs * LANES).enumerate() {
        let lanes = (block.spec.len() - group * LANES).min(LANES);
        let meets = slots.chunks(LANES).flat_map(|s| &s[..lanes]).any(|&s| own.contains(&((s >> 1) as usize)));
        match runs.last_mut() {
            _ if !meets => {}
            Some(last) if last.end == group => last.end += 1,
            _ => runs.push(group..group + 1),
        }
    }
    runs
}

/// Adds the blocks of the elements in the first `lanes` of a group to those slots that are `own`, whose values are
/// `targets`; `values` are those of the group, [pair][row and column][lane].
fn scatter<const D: usize, const DD: usize>(
    targets: &mut [f64],
    own: &Range<usize>,
    slots: &[u32],
    values: &[f64],
    lanes: usize,
) {
    let (targets, _) = targets.as_chunks_mut::<DD>();
    let (values, _) = values.as_chunks::<LANES>();
    let (blocks, _) = values.as_chunks::<DD>();
    let (slots, _) = slots.as_chunks::<LANES>();
    for (slots, block) in slots.iter().zip(blocks) {
        for (lane, &slot) in slots[..lanes].iter().enumerate() {
            let Some(target) = targets.get_mut(((slot >> 1) as usize).wrapping_sub(own.start)) else { continue };
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
