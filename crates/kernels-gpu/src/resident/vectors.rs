//! Memory and kernels of vectors: every slot's buffer, every kernel bound to them.

use super::kernels::{CONTROL_WORDS, MOST_GROUPS, PER_INVOCATION, SUM_BYTES, Slot, Text, WORKGROUP};
use super::model::Model;
use crate::device::{DeviceError, Gpu, Pipeline};

/// The vectors of a model, and what kernels share.
pub(super) struct Memory {
    slots: Vec<(Slot, wgpu::Buffer)>,
    /// Unknowns.
    pub(super) len: usize,
    /// Workgroups of kernels that sum.
    pub(super) groups: usize,
}

/// A kernel with its buffers.
pub(super) struct Bound {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

impl Bound {
    /// Runs it.
    pub(super) fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
    }
}

/// Words of the numbers of a step.
pub(super) const PARAMETER_WORDS: usize = 18;

impl Memory {
    /// Reserves the vectors of a model.
    pub(super) fn new(gpu: &Gpu, model: &Model<'_>) -> Result<Memory, DeviceError> {
        let len = model.mass.len();
        let bytes = 4 * len as u64;
        let singles = |what: &str, values: &[f32]| {
            let content: &[u8] = bytemuck::cast_slice(values);
            gpu.buffer(what, content.len() as u64, Some(content))
        };
        // Held unknowns are marked by the sign; a mass of zero would hide it.
        let mass: Vec<f32> = model
            .mass
            .iter()
            .zip(&model.held)
            .map(|(&m, &held)| if held { -(m as f32).max(f32::MIN_POSITIVE) } else { m as f32 })
            .collect();
        let constant: Vec<f32> = model.constant.iter().map(|&f| f as f32).collect();
        let square = bytes * model.axes as u64;
        let mut slots = vec![
            (Slot::Parameters, gpu.buffer("numbers of a step", 4 * PARAMETER_WORDS as u64, None)?),
            (Slot::Control, gpu.buffer("record of a solve", 4 * CONTROL_WORDS as u64, None)?),
            (Slot::Sums, gpu.buffer("parts of sums", SUM_BYTES, None)?),
            (Slot::Mass, singles("masses", &mass)?),
            (Slot::Constant, singles("constant forces", &constant)?),
            (Slot::Inverse, gpu.buffer("the preconditioner", square, None)?),
            (Slot::Blocks, gpu.buffer("diagonal blocks", square, None)?),
            (Slot::Judged, gpu.buffer("checks", 4 * WORKGROUP as u64, None)?),
        ];
        for slot in [Slot::U, Slot::ULow, Slot::V, Slot::A, Slot::R, Slot::P, Slot::Q, Slot::S] {
            slots.push((slot, gpu.buffer("a vector of unknowns", bytes, None)?));
        }
        Ok(Memory { slots, len, groups: len.div_ceil(PER_INVOCATION * WORKGROUP).clamp(1, MOST_GROUPS) })
    }

    /// The buffer of a slot.
    ///
    /// # Panics
    /// When there is none: those that belong to one kernel are given where it is bound.
    pub(super) fn get(&self, slot: Slot) -> &wgpu::Buffer {
        &self.slots.iter().find(|(s, _)| *s == slot).expect("every shared slot has a buffer").1
    }

    /// Binds a kernel; `own` are the slots that belong to it alone, or stand for another's.
    pub(super) fn bind(
        &self,
        gpu: &Gpu,
        text: &Text,
        pipeline: &Pipeline,
        own: &[(Slot, &wgpu::Buffer)],
        workgroups: usize,
    ) -> Bound {
        let buffer = |slot: &Slot| own.iter().find(|(s, _)| s == slot).map_or_else(|| self.get(*slot), |(_, b)| *b);
        let buffers: Vec<&wgpu::Buffer> = text.reads.iter().chain(text.writes).map(buffer).collect();
        Bound {
            pipeline: pipeline.pipeline.clone(),
            group: gpu.bind(pipeline, &buffers),
            workgroups: gpu.workgroups(workgroups),
        }
    }

    /// Compiles and binds a kernel.
    pub(super) fn kernel(
        &self,
        gpu: &Gpu,
        text: &Text,
        own: &[(Slot, &wgpu::Buffer)],
        workgroups: usize,
    ) -> Result<Bound, DeviceError> {
        Ok(self.bind(gpu, text, &text.compile(gpu)?, own, workgroups))
    }
}
