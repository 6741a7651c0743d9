//! Where the time of a step goes, by the device's own clock.
//!
//! ```text
//! step = force (with linearisation, right-hand side) + products + the rest of the solve + the end of the step
//! ```
//!
//! Only while somebody watches: then every product of the solve has a pass of its own, with a reading of the clock before
//! and after, which makes the step itself a little longer. A device without a clock tells nothing.

use crate::device::{DeviceError, Gpu};

/// A part of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Force,
    Product,
    Rest,
    End,
}

/// Seconds that the parts of steps took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// Forces, with what a linearisation keeps for products, and the right-hand side.
    pub force: f64,
    /// Products of the solve with its matrix.
    pub product: f64,
    /// The solve without them: preconditioner, start, vectors.
    pub rest_of_solve: f64,
    /// The end of the step: state, checks, energy.
    pub end: f64,
}

/// Readings of the clock in one submission.
pub(super) struct Marks {
    readings: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    parts: Vec<Part>,
}

/// Readings that a set holds at most, on any device.
const MOST: u32 = wgpu::QUERY_SET_MAX_QUERIES;

impl Marks {
    /// Room for this many passes.
    pub(super) fn new(gpu: &Gpu, passes: usize) -> Marks {
        let device = &gpu.inner.device;
        let count = (2 * passes as u32).clamp(2, MOST);
        let descriptor = wgpu::QuerySetDescriptor { label: Some("parts"), ty: wgpu::QueryType::Timestamp, count };
        let bytes = 8 * u64::from(count);
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let resolved = wgpu::BufferDescriptor { label: Some("parts"), size: bytes, usage, mapped_at_creation: false };
        Marks {
            readings: device.create_query_set(&descriptor),
            resolved: device.create_buffer(&resolved),
            staging: gpu.staging(bytes),
            parts: Vec::new(),
        }
    }

    /// A pass that belongs to a part.
    pub(super) fn pass<'e>(&mut self, encoder: &'e mut wgpu::CommandEncoder, part: Part) -> wgpu::ComputePass<'e> {
        let first = 2 * self.parts.len() as u32;
        self.parts.push(part);
        let timestamp_writes = Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.readings,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        });
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes })
    }

    /// Sends the readings back, at the end of a submission.
    pub(super) fn send(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.readings, 0..2 * self.parts.len() as u32, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 0, self.bytes());
    }

    /// Bytes that come back.
    pub(super) fn bytes(&self) -> u64 {
        16 * self.parts.len() as u64
    }

    /// Adds what they say.
    pub(super) fn add_to(&self, gpu: &Gpu, times: &mut Times) -> Result<(), DeviceError> {
        let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&gpu.read(&self.staging, self.bytes())?);
        let period = 1e-9 * f64::from(gpu.inner.queue.get_timestamp_period());
        for (part, stamps) in self.parts.iter().zip(stamps.chunks_exact(2)) {
            let seconds = period * stamps[1].saturating_sub(stamps[0]) as f64;
            match part {
                Part::Force => times.force += seconds,
                Part::Product => times.product += seconds,
                Part::Rest => times.rest_of_solve += seconds,
                Part::End => times.end += seconds,
            }
        }
        Ok(())
    }
}
