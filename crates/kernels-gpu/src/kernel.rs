//! The backend: programs in single precision on buffers of the host. Every run moves its data to the device and back,
//! which is for tests and measurements; steps keep theirs there ([`crate::resident`]).

use crate::device::{DeviceError, Gpu, Pipeline};
use crate::print::{Access, Binding, Layout, Loops};
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
        let program = &self.program;
        let mut tables: Vec<&[u32]> = Vec::new();
        let access: Vec<Access> = inputs
            .iter()
            .map(|input| match *input {
                Input::Lanes(_) => Access::Lanes,
                Input::Uniform(_) => Access::Uniform,
                Input::Gathered { rows, width, .. } => {
                    tables.push(rows);
                    Access::Gathered { width, table: tables.len() - 1 }
                }
            })
            .collect();
        let pipeline = self.form(&access)?;
        let layout = layout(program, LANES, access);
        let mut buffers = Vec::new();
        let mut results = Vec::new();
        for binding in layout.bindings(program) {
            let buffer = match binding {
                Binding::Uniforms => {
                    let given = inputs.iter().filter_map(|i| if let Input::Uniform(v) = i { Some(*v) } else { None });
                    self.upload("uniforms", &uniforms(program, given))?
                }
                Binding::Rows(t) => self.upload("rows", tables[t])?,
                Binding::Input(k) => match inputs[k] {
                    Input::Lanes(values) | Input::Uniform(values) | Input::Gathered { values, .. } => {
                        self.upload(&program.inputs[k].name, values)?
                    }
                },
                Binding::Output(k) => {
                    let values = groups * LANES * program.outputs[k].total(program.points);
                    let buffer = self.gpu.buffer(&program.outputs[k].name, 4 * values as u64, None)?;
                    results.push((k, values, buffer.clone()));
                    buffer
                }
            };
            buffers.push(buffer);
        }
        let group = self.gpu.bind(&pipeline, &buffers.iter().collect::<Vec<_>>());
        let mut encoder = self.gpu.encoder();
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            let [x, y] = self.gpu.workgroups((groups * LANES).div_ceil(WORKGROUP));
            pass.set_pipeline(&pipeline.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(x, y, 1);
        }
        self.gpu.inner.queue.submit([encoder.finish()]);
        for (k, values, buffer) in results {
            let content = self.gpu.download(&buffer)?;
            let singles: Vec<f32> = bytemuck::pod_collect_to_vec(&content);
            outputs[k][..values].copy_from_slice(&singles[..values]);
        }
        Ok(())
    }

    fn upload<T: bytemuck::NoUninit>(&self, what: &str, values: &[T]) -> Result<wgpu::Buffer, DeviceError> {
        let content: &[u8] = bytemuck::cast_slice(values);
        self.gpu.buffer(what, content.len() as u64, Some(content))
    }
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
