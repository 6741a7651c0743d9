//! Work on data that stays on a device, run again and again between two readings of the device's clock.
//!
//! | work | function |
//! |---|---|
//! | a program on its items | [`Loaded::new`] |
//! | sums of contributions per row, as steps take them | [`crate::resident::row_sums`] |
//! | what the device can do at most: a copy, the triad a ← b + s c, fused multiply-adds on registers | [`exercise`] |
//!
//! Repetitions within a run wait for each other, as dispatches of a step do.
//! What it is not: a clock of the host. A device without one of its own gives no time, and the caller takes the host's.

use crate::device::{DeviceError, Gpu, Pipeline};
use crate::kernel::{WORKGROUP, accesses, layout, uniforms};
use crate::print::{Binding, Layout};
use souple_kernels::Input;
use souple_program::Program;

/// Items side by side in a group of what [`Loaded::new`] takes, as in steps.
pub const LANES: usize = WORKGROUP;

/// Work with all that it reads and writes, on the device.
#[derive(Debug)]
pub struct Loaded {
    gpu: Gpu,
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
    outputs: Vec<wgpu::Buffer>,
}

impl Loaded {
    /// A program on this many groups of [`LANES`] items; inputs lie as [`Input`] says, with that many lanes.
    ///
    /// # Errors
    /// When a buffer does not fit or the program is not compiled.
    pub fn new(gpu: &Gpu, program: &Program, groups: usize, inputs: &[Input<'_, f32>]) -> Result<Loaded, DeviceError> {
        let (access, tables) = accesses(inputs);
        let layout = layout(program, LANES, access);
        let (pipeline, _) = gpu.program(program, &layout)?;
        Loaded::bind(gpu, program, &pipeline, &layout, groups, inputs, &tables)
    }

    /// A compiled program with its data.
    pub(crate) fn bind(
        gpu: &Gpu,
        program: &Program,
        pipeline: &Pipeline,
        layout: &Layout,
        groups: usize,
        inputs: &[Input<'_, f32>],
        tables: &[&[u32]],
    ) -> Result<Loaded, DeviceError> {
        let mut buffers = Vec::new();
        let mut outputs = Vec::new();
        for binding in layout.bindings(program) {
            let buffer = match binding {
                Binding::Uniforms => {
                    let given = inputs.iter().filter_map(|i| if let Input::Uniform(v) = i { Some(*v) } else { None });
                    upload(gpu, "uniforms", &uniforms(program, given))?
                }
                Binding::Rows(t) => upload(gpu, "rows", tables[t])?,
                Binding::Input(k) => match inputs[k] {
                    Input::Lanes(values) | Input::Uniform(values) | Input::Gathered { values, .. } => {
                        upload(gpu, &program.inputs[k].name, values)?
                    }
                },
                Binding::Output(k) => {
                    let values = groups * layout.lanes * program.outputs[k].total(program.points);
                    let buffer = gpu.buffer(&program.outputs[k].name, 4 * values as u64, None)?;
                    outputs.push(buffer.clone());
                    buffer
                }
            };
            buffers.push(buffer);
        }
        let workgroups = (groups * layout.lanes).div_ceil(layout.workgroup);
        Ok(Loaded::of(gpu, pipeline, &buffers.iter().collect::<Vec<_>>(), outputs, workgroups))
    }

    /// A pipeline with its buffers, of which `outputs` can be read.
    pub(crate) fn of(
        gpu: &Gpu,
        pipeline: &Pipeline,
        buffers: &[&wgpu::Buffer],
        outputs: Vec<wgpu::Buffer>,
        workgroups: usize,
    ) -> Loaded {
        Loaded {
            gpu: gpu.clone(),
            pipeline: pipeline.pipeline.clone(),
            group: gpu.bind(pipeline, buffers),
            workgroups: gpu.workgroups(workgroups),
            outputs,
        }
    }

    /// Runs it this many times and waits for the end. Gives the seconds from the beginning of the first to the end of the
    /// last by the device's clock, where it has one.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn run(&self, times: usize) -> Result<Option<f64>, DeviceError> {
        let inner = &self.gpu.inner;
        let timed = inner.description.features.timestamps;
        let clock = timed.then(|| Stopwatch::new(&self.gpu));
        let mut encoder = self.gpu.encoder();
        {
            let timestamp_writes = clock.as_ref().map(|c| wgpu::ComputePassTimestampWrites {
                query_set: &c.readings,
                beginning_of_pass_write_index: Some(0),
                end_of_pass_write_index: Some(1),
            });
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            (0..times).for_each(|_| pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1));
        }
        let staging = self.gpu.staging(STAMPS);
        if let Some(clock) = &clock {
            encoder.resolve_query_set(&clock.readings, 0..2, &clock.resolved, 0);
            encoder.copy_buffer_to_buffer(&clock.resolved, 0, &staging, 0, STAMPS);
        }
        inner.queue.submit([encoder.finish()]);
        let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&self.gpu.read(&staging, STAMPS)?);
        let ticks = stamps[1].saturating_sub(stamps[0]);
        Ok(timed.then(|| 1e-9 * ticks as f64 * f64::from(inner.queue.get_timestamp_period())))
    }

    /// Content of output `k`.
    ///
    /// # Errors
    /// When the device is lost.
    ///
    /// # Panics
    /// When there are fewer outputs.
    pub fn output(&self, k: usize) -> Result<Vec<f32>, DeviceError> {
        Ok(bytemuck::pod_collect_to_vec(&self.gpu.download(&self.outputs[k])?))
    }
}

/// Bytes of two readings of the clock.
const STAMPS: u64 = 16;

/// Where two readings of the clock go.
struct Stopwatch {
    readings: wgpu::QuerySet,
    resolved: wgpu::Buffer,
}

impl Stopwatch {
    fn new(gpu: &Gpu) -> Stopwatch {
        let device = &gpu.inner.device;
        let readings = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("clock"),
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolved = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("clock"),
            size: STAMPS,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Stopwatch { readings, resolved }
    }
}

fn upload<T: bytemuck::NoUninit>(gpu: &Gpu, what: &str, values: &[T]) -> Result<wgpu::Buffer, DeviceError> {
    let content: &[u8] = bytemuck::cast_slice(values);
    gpu.buffer(what, content.len() as u64, Some(content))
}

/// What shows a limit of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exercise {
    /// a ← b, eight bytes per number.
    Copy,
    /// a ← b + 3 c, twelve bytes per number.
    Triad,
    /// x ← x a + b on registers: [`CHAINS`] · [`ROUNDS`] fused multiply-adds per invocation.
    MultiplyAdds,
}

/// Chains of multiply-adds side by side, enough to hide their latency.
pub const CHAINS: usize = 8;
/// Multiply-adds of each chain.
pub const ROUNDS: usize = 1024;
/// Multiply-adds of each chain between two turns of the loop, so that the loop's own work does not count.
const WRITTEN_OUT: usize = 16;
/// Invocations of a workgroup of exercises.
const EXERCISERS: usize = 256;
/// Results of multiply-adds that are kept.
const KEPT: usize = 4 * EXERCISERS;

/// An exercise, and what one run of it does.
#[derive(Debug)]
pub struct Exercised {
    /// The work. Its output 0 is a, or the sums of the first invocations' chains.
    pub work: Loaded,
    /// Bytes read and written.
    pub bytes: f64,
    /// Operations, a multiply-add being two.
    pub operations: f64,
}

/// Makes an exercise of `size` numbers per array, or invocations; rounded up to whole workgroups.
/// The arrays hold b = 1 and c = 2 throughout.
///
/// # Errors
/// When an array does not fit.
pub fn exercise(gpu: &Gpu, which: Exercise, size: usize) -> Result<Exercised, DeviceError> {
    let per_workgroup = if which == Exercise::MultiplyAdds { EXERCISERS } else { 4 * EXERCISERS };
    let workgroups = size.div_ceil(per_workgroup).max(1);
    let numbers = workgroups * per_workgroup;
    let array = |value: f32| upload(gpu, "an exercise", &vec![value; numbers]);
    let (name, source, read) = match which {
        Exercise::Copy => ("copy", streams("a[i] = b[i];", 1), vec![array(1.0)?]),
        Exercise::Triad => ("triad", streams("a[i] = b[i] + 3.0f * c[i];", 2), vec![array(1.0)?, array(2.0)?]),
        Exercise::MultiplyAdds => ("multiply-adds", multiply_adds(), vec![upload(gpu, "numbers", &FACTORS)?]),
    };
    let writable: Vec<bool> = (0..=read.len()).map(|k| k == read.len()).collect();
    let pipeline = gpu.compile(name, &source, Some("main"), &writable)?;
    let kept = if which == Exercise::MultiplyAdds { KEPT } else { numbers };
    let out = gpu.buffer("an exercise", 4 * kept as u64, None)?;
    let buffers: Vec<&wgpu::Buffer> = read.iter().chain([&out]).collect();
    let work = Loaded::of(gpu, &pipeline, &buffers, vec![out.clone()], workgroups);
    let (bytes, operations) = match which {
        Exercise::Copy => (8 * numbers, 0),
        Exercise::Triad => (12 * numbers, 2 * numbers),
        Exercise::MultiplyAdds => (0, 2 * CHAINS * ROUNDS * numbers),
    };
    Ok(Exercised { work, bytes: bytes as f64, operations: operations as f64 })
}

/// a and b of x ← x a + b: numbers that a compiler does not know. The chains come to rest at b / (1 − a).
const FACTORS: [f32; 2] = [0.999, 1e-3];

/// Number of the invocation, in both texts.
const PLACE: &str = "@compute @workgroup_size(256)\nfn main(@builtin(workgroup_id) w: vec3<u32>, @builtin(num_workgroups) \
                     n: vec3<u32>, @builtin(local_invocation_index) k: u32) {\n    let i = (w.y * n.x + w.x) * 256u + k;\n";

fn streams(statement: &str, read: usize) -> String {
    let mut out = String::new();
    for (binding, name) in ["b", "c"][..read].iter().enumerate() {
        out += &format!("@group(0) @binding({binding}) var<storage, read> {name}: array<vec4<f32>>;\n");
    }
    out += &format!("@group(0) @binding({read}) var<storage, read_write> a: array<vec4<f32>>;\n{PLACE}");
    out + &format!("    if (i < arrayLength(&a)) {{\n        {statement}\n    }}\n}}\n")
}

fn multiply_adds() -> String {
    let mut out = String::from(
        "@group(0) @binding(0) var<storage, read> factors: array<f32>;\n\
         @group(0) @binding(1) var<storage, read_write> sums: array<f32>;\n",
    );
    out += PLACE;
    out += "    let a = factors[0];\n    let b = factors[1];\n";
    for chain in 0..CHAINS {
        out += &format!("    var x{chain} = b * f32(k + {chain}u);\n");
    }
    out += &format!("    for (var turn = 0u; turn < {}u; turn++) {{\n", ROUNDS / WRITTEN_OUT);
    for _ in 0..WRITTEN_OUT {
        for chain in 0..CHAINS {
            out += &format!("        x{chain} = fma(x{chain}, a, b);\n");
        }
    }
    let sum: Vec<String> = (0..CHAINS).map(|chain| format!("x{chain}")).collect();
    out + &format!("    }}\n    if (i < {KEPT}u) {{\n        sums[i] = {};\n    }}\n}}\n", sum.join(" + "))
}

/// What the chains of invocation `k` of the first workgroup come to, in double precision: for tests.
pub fn chains_of(k: usize) -> f64 {
    let [a, b] = FACTORS.map(f64::from);
    let chain = |c: usize| (0..ROUNDS).fold(b * (k + c) as f64, |x, _| x * a + b);
    (0..CHAINS).map(chain).sum()
}
