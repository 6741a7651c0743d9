//! Sums of contributions and the conjugate gradient, as sequences of kernels.

use super::chunks::{self, Chunk, Programs, Vectors};
use super::kernels::{ADVANCE, DESCEND, DIRECTION, GATHER, INVERSE, OPEN, PRODUCT, RESIDUAL, Slot, WORKGROUP};
use super::model::{Batch, Model, Preconditioner};
use super::segments::Segment;
use super::vectors::{Bound, Memory};
use crate::device::{DeviceError, Gpu, Pipeline};

/// A program of all chunks, and the sums of what it contributes into a vector.
pub(super) struct Summed {
    programs: Vec<chunks::Bound>,
    sums: Vec<Bound>,
}

impl Summed {
    /// Runs programs and sums.
    pub(super) fn dispatch(&self, programs: &Programs, pass: &mut wgpu::ComputePass<'_>) {
        self.programs.iter().for_each(|p| p.dispatch(programs, pass));
        self.sums.iter().for_each(|s| s.dispatch(pass));
    }
}

/// What makes sums: compiled once.
pub(super) struct Summing {
    gather: Pipeline,
    product: Pipeline,
}

impl Summing {
    pub(super) fn new(gpu: &Gpu) -> Result<Summing, DeviceError> {
        Ok(Summing { gather: GATHER.compile(gpu)?, product: PRODUCT.compile(gpu)? })
    }

    /// Sums of all segments into a vector.
    fn sums(&self, gpu: &Gpu, memory: &Memory, segments: &[Segment], into: &wgpu::Buffer) -> Vec<Bound> {
        let bind = |s: &Segment| {
            let own = [
                (Slot::Contributions, &s.contributions),
                (Slot::Starts, &s.starts),
                (Slot::Places, &s.places),
                (Slot::Segment, &s.about),
                (Slot::Result, into),
            ];
            memory.bind(gpu, &GATHER, &self.gather, &own, into.size().div_ceil(4 * WORKGROUP as u64) as usize)
        };
        segments.iter().map(bind).collect()
    }

    /// A program and the plain sums of what it contributes.
    pub(super) fn plain(
        &self,
        gpu: &Gpu,
        memory: &Memory,
        programs: Vec<chunks::Bound>,
        segments: &[Segment],
        into: &wgpu::Buffer,
    ) -> Summed {
        Summed { programs, sums: self.sums(gpu, memory, segments, into) }
    }

    /// The product with the matrix of the system, q = P (m M + k K) x, with the parts of x · q.
    pub(super) fn product(
        &self,
        gpu: &Gpu,
        memory: &Memory,
        programs: Vec<chunks::Bound>,
        segments: &[Segment],
        x: &wgpu::Buffer,
    ) -> Summed {
        let (last, earlier) = segments.split_last().expect("a model has items");
        let mut sums = self.sums(gpu, memory, earlier, memory.get(Slot::Q));
        let own = [
            (Slot::Contributions, &last.contributions),
            (Slot::Starts, &last.starts),
            (Slot::Places, &last.places),
            (Slot::Segment, &last.about),
            (Slot::P, x),
        ];
        sums.push(memory.bind(gpu, &PRODUCT, &self.product, &own, memory.groups));
        Summed { programs, sums }
    }
}

/// The parts of a linear solve.
pub(super) struct Solve {
    /// −K p into q.
    pub(super) known_part: Summed,
    diagonal: Option<Summed>,
    inverse: Bound,
    of_guess: Summed,
    residual: Bound,
    direction: Bound,
    open: Bound,
    product: Summed,
    descend: Bound,
    advance: Bound,
}

impl Solve {
    /// Compiles and binds everything.
    pub(super) fn new<'b>(
        gpu: &Gpu,
        model: &'b Model<'b>,
        memory: &Memory,
        all: &[Chunk],
        programs: &mut Programs,
        fixed: &[(*const f64, wgpu::Buffer)],
        segments: &[Segment],
        summing: &Summing,
    ) -> Result<Solve, DeviceError> {
        let (batches, axes) = (&model.batches[..], model.axes);
        let mut product_of = |x: &wgpu::Buffer| {
            let vectors = Vectors { state: memory.get(Slot::U), direction: x, fixed };
            let which = |b: &'b Batch<'b>| b.product;
            chunks::bind(gpu, programs, batches, all, &vectors, Some(segments), &which)
        };
        let (p, a, q) = (memory.get(Slot::P), memory.get(Slot::A), memory.get(Slot::Q));
        let known_part = summing.plain(gpu, memory, product_of(p)?, segments, q);
        let of_guess = summing.product(gpu, memory, product_of(a)?, segments, a);
        let product = summing.product(gpu, memory, product_of(p)?, segments, p);
        let diagonal = match model.preconditioner {
            Preconditioner::None => None,
            Preconditioner::Diagonal | Preconditioner::Blocks => {
                let rows = memory.len / axes;
                let what = "contributions to diagonal blocks";
                let wide = chunks::segments_of(gpu, what, batches, all, rows, axes * axes)?;
                let vectors = Vectors { state: memory.get(Slot::U), direction: p, fixed };
                let which = |b: &'b Batch<'b>| b.diagonal;
                let bound = chunks::bind(gpu, programs, batches, all, &vectors, Some(&wide), &which)?;
                Some(summing.plain(gpu, memory, bound, &wide, memory.get(Slot::Blocks)))
            }
        };
        let kind: [u32; 1] = match model.preconditioner {
            Preconditioner::None => [0],
            Preconditioner::Diagonal => [1],
            Preconditioner::Blocks => [2],
        };
        let kind = gpu.buffer("kind of preconditioner", 4, Some(bytemuck::cast_slice(&kind)))?;
        let kernel = |text| memory.kernel(gpu, text, &[(Slot::Segment, &kind)], memory.groups);
        Ok(Solve {
            known_part,
            diagonal,
            inverse: kernel(&INVERSE)?,
            of_guess,
            residual: kernel(&RESIDUAL)?,
            direction: kernel(&DIRECTION)?,
            open: memory.kernel(gpu, &OPEN, &[], 1)?,
            product,
            descend: kernel(&DESCEND)?,
            advance: kernel(&ADVANCE)?,
        })
    }

    /// Everything before the iterations: the right-hand side is in r, the start in a.
    pub(super) fn prepare(&self, programs: &Programs, pass: &mut wgpu::ComputePass<'_>) {
        if let Some(diagonal) = &self.diagonal {
            diagonal.dispatch(programs, pass);
        }
        self.inverse.dispatch(pass);
        self.of_guess.dispatch(programs, pass);
        self.residual.dispatch(pass);
        self.direction.dispatch(pass);
        self.open.dispatch(pass);
    }

    /// One iteration, which does nothing after the end.
    pub(super) fn iterate(&self, programs: &Programs, pass: &mut wgpu::ComputePass<'_>) {
        self.product.dispatch(programs, pass);
        self.update(pass);
    }

    /// What an iteration does behind its product.
    pub(super) fn update(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.descend.dispatch(pass);
        self.advance.dispatch(pass);
    }

    /// The product alone, for measurements.
    pub(super) fn product(&self, programs: &Programs, pass: &mut wgpu::ComputePass<'_>) {
        self.product.dispatch(programs, pass);
    }
}
