//! The same kernel and batch in single precision: twice as many elements per operation.

use crate::batch::Batch;
use souple_kernels::{Aligned, Backend, Input, Kernel, LANES, Scratch};
use souple_program::Program;
use std::ops::Range;
use std::sync::Arc;

/// A kernel in singles with a copy of what it reads.
pub struct Singles {
    kernel: Arc<dyn Kernel<f32>>,
    inputs: Vec<Single>,
    outputs: Vec<Aligned<f32>>,
    scratch: Scratch,
}

enum Single {
    /// Values with their number per group.
    Lanes(Aligned<f32>, usize),
    /// Nodal values with their width, rows with their number per group.
    Gathered(Vec<f32>, usize, Vec<u32>, usize),
    Uniform(Vec<f32>),
}

impl Singles {
    /// A program on the first `groups` groups of a batch; none where the backend has no singles.
    pub fn new(batch: &Batch, program: &Program, backend: &dyn Backend, groups: usize) -> Option<Singles> {
        let kernel = backend.compile_singles(program).ok()?;
        let rounded = |values: &[f64]| -> Vec<f32> { values.iter().map(|&v| v as f32).collect() };
        let copy = |input: Input<'_>| match input {
            Input::Lanes(values) => {
                let mut lanes = Aligned::zeros(values.len());
                lanes.copy_from_slice(&rounded(values));
                Single::Lanes(lanes, values.len() / groups)
            }
            Input::Gathered { values, rows, width } => {
                Single::Gathered(rounded(values), width, rows.to_vec(), rows.len() / groups)
            }
            Input::Uniform(values) => Single::Uniform(rounded(values)),
        };
        let inputs = batch.inputs(program, &(0..groups)).into_iter().map(copy).collect();
        let outputs = Batch::outputs(program, groups).into_iter().map(|o| Aligned::filled(o.len(), f32::NAN)).collect();
        Some(Singles { kernel, inputs, outputs, scratch: Scratch::default() })
    }

    /// Runs it on these groups.
    pub fn run(&mut self, groups: Range<usize>) {
        let part = |per_group: usize| groups.start * per_group..groups.end * per_group;
        let input = |input| match input {
            &Single::Lanes(ref values, per_group) => Input::Lanes(&values[part(per_group)]),
            &Single::Gathered(ref values, width, ref rows, per_group) => {
                Input::Gathered { values, rows: &rows[part(per_group)], width }
            }
            Single::Uniform(values) => Input::Uniform(values),
        };
        let inputs: Vec<Input<'_, f32>> = self.inputs.iter().map(input).collect();
        let program = self.kernel.program();
        let mut outputs: Vec<&mut [f32]> = (self.outputs.iter_mut().zip(&program.outputs))
            .map(|(values, buffer)| &mut values[part(buffer.total(program.points) * LANES)])
            .collect();
        self.kernel.run(&mut self.scratch, groups.len(), &inputs, &mut outputs);
    }

    /// What was written, per output.
    pub fn outputs(&self) -> &[Aligned<f32>] {
        &self.outputs
    }
}
