//! The backend: programs in single precision on buffers of the host. Every run moves its data to the device and back,
//! which is for tests and measurements; steps keep theirs there ([`crate::resident`]).

use crate::device::{DeviceError, Gpu, Pipeline};
use crate::measure::Loaded;
use crate::print::{Access, Layout, Loops};
use souple_kernels::{About, Backend, CompileError, Input, Kernel, LANES, Scratch};
use souple_program::{Program, verify};
use std::sync::{Arc, Mutex, PoisonError};

/// Invocations of a workgroup of programs.
pub(crate) const WORKGROUP: usize = 64;

/// The backend of a device.
#[derive(Clone, Debug)]
pub struct GpuBackend {
    about: About,
    gpu: Gpu,
}

impl GpuBackend {
    /// The backend of an opened device.
    pub fn new(gpu: Gpu) -> GpuBackend {
        let d = gpu.description();
        let description = format!("{} through {} ({}), single precision", d.name, d.interface, d.driver);
        GpuBackend { about: About { name: "gpu".into(), description }, gpu }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }
}

impl Backend for GpuBackend {
    fn about(&self) -> &About {
        &self.about
    }

    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError> {
        verify(program)?;
        Err(CompileError::Unsupported {
            backend: self.about.name.clone(),
            program: program.name.clone(),
            capability: "arithmetic in double precision; it has singles".into(),
        })
    }

    fn compile_singles(&self, program: &Program) -> Result<Arc<dyn Kernel<f32>>, CompileError> {
        verify(program)?;
        let kernel = Compiled { program: program.clone(), gpu: self.gpu.clone(), forms: Mutex::default() };
        // Whatever way inputs will arrive: a program that its compiler refuses is refused now.
        let lanes = vec![Access::Lanes; program.inputs.len()];
        kernel.form(&lanes).map_err(|error| CompileError::Unsupported {
            backend: self.about.name.clone(),
            program: program.name.clone(),
            capability: error.to_string(),
        })?;
        Ok(Arc::new(kernel))
    }
}

/// A program, compiled for each way in which its inputs arrived so far.
struct Compiled {
    program: Program,
    gpu: Gpu,
    forms: Mutex<Vec<(Vec<Access>, Arc<Pipeline>)>>,
}

impl Compiled {
    fn form(&self, inputs: &[Access]) -> Result<Arc<Pipeline>, DeviceError> {
        let mut forms = self.forms.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, known)) = forms.iter().find(|(i, _)| i == inputs) {
            return Ok(known.clone());
        }
        let (pipeline, _) = self.gpu.program(&self.program, &layout(&self.program, LANES, inputs.to_vec()))?;
        let pipeline = Arc::new(pipeline);
        forms.push((inputs.to_vec(), pipeline.clone()));
        Ok(pipeline)
    }

    fn try_run(&self, groups: usize, inputs: &[Input<'_, f32>], outputs: &mut [&mut [f32]]) -> Result<(), DeviceError> {
        let (access, tables) = accesses(inputs);
        let pipeline = self.form(&access)?;
        let layout = layout(&self.program, LANES, access);
        let loaded = Loaded::bind(&self.gpu, &self.program, &pipeline, &layout, groups, inputs, &tables)?;
        loaded.run(1)?;
        for (k, values) in outputs.iter_mut().enumerate() {
            let content = loaded.output(k)?;
            values[..content.len()].copy_from_slice(&content);
        }
        Ok(())
    }
}

/// How inputs arrive, and the tables of rows that they share: those of the same place in memory are one.
pub(crate) fn accesses<'a>(inputs: &[Input<'a, f32>]) -> (Vec<Access>, Vec<&'a [u32]>) {
    let mut tables: Vec<&[u32]> = Vec::new();
    let access = |input: &Input<'a, f32>| match *input {
        Input::Lanes(_) => Access::Lanes,
        Input::Uniform(_) => Access::Uniform,
        Input::Gathered { rows, width, .. } => {
            let known = tables.iter().position(|t| std::ptr::eq(*t, rows));
            let table = known.unwrap_or_else(|| {
                tables.push(rows);
                tables.len() - 1
            });
            Access::Gathered { width, table }
        }
    };
    let accesses = inputs.iter().map(access).collect();
    (accesses, tables)
}

impl Kernel<f32> for Compiled {
    fn program(&self) -> &Program {
        &self.program
    }

    /// As the contract says. When the device is lost on the way, every output is NaN: there is no other answer that
    /// nobody takes for a result.
    fn run(&self, _: &mut Scratch, groups: usize, inputs: &[Input<'_, f32>], outputs: &mut [&mut [f32]]) {
        if self.try_run(groups, inputs, outputs).is_err() {
            outputs.iter_mut().for_each(|o| o.fill(f32::NAN));
        }
    }
}

/// Statements up to which loops are written out: below, a loop's own work and the reading of its tables count.
const WRITTEN_OUT: usize = 300;

/// The layout of a program with these accesses.
pub(crate) fn layout(program: &Program, lanes: usize, inputs: Vec<Access>) -> Layout {
    let written_out: usize = program
        .sections
        .iter()
        .map(|s| match s {
            souple_program::Section::Straight(s) => s.len(),
            souple_program::Section::Loop(s) => s.len() * program.points,
        })
        .sum();
    let loops = if written_out <= WRITTEN_OUT { Loops::Unrolled } else { Loops::Rolled };
    Layout { lanes, workgroup: WORKGROUP, inputs, loops }
}

/// Content of the uniforms: what is the same for all items in the order of the inputs, then the tables.
pub(crate) fn uniforms<'a>(program: &Program, given: impl Iterator<Item = &'a [f32]>) -> Vec<f32> {
    let mut values: Vec<f32> = given.flatten().copied().collect();
    values.extend(program.tables.iter().flatten().map(|&v| v as f32));
    values
}
