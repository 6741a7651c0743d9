//! Batches on the device: chunks of items that fit into what a program may see, and their programs with all they read.

use super::model::{Batch, Source};
use super::segments::{Contributors, Segment, segments};
use crate::device::{DeviceError, Gpu, Pipeline};
use crate::kernel::{WORKGROUP as LANES, layout, uniforms};
use crate::print::{Access, Binding};
use souple_kernels::LANES as HOST_LANES;
use souple_program::Program;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

/// Some items of a batch, with what they keep on the device.
pub(super) struct Chunk {
    /// Which batch.
    pub(super) batch: usize,
    /// Which of its items.
    pub(super) items: Range<usize>,
    rows: wgpu::Buffer,
    kept: BTreeMap<String, wgpu::Buffer>,
}

/// A program of a chunk with all that it is given.
pub(super) struct Bound {
    pipeline: usize,
    group: wgpu::BindGroup,
    workgroups: [u32; 2],
}

/// Compiled programs; batches of one kind share them.
#[derive(Default)]
pub(super) struct Programs {
    compiled: Vec<(Program, Vec<Access>, Pipeline)>,
}

impl Bound {
    /// Runs it.
    pub(super) fn dispatch(&self, programs: &Programs, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&programs.compiled[self.pipeline].2.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.dispatch_workgroups(self.workgroups[0], self.workgroups[1], 1);
    }
}

/// How inputs of a program arrive.
fn accesses(batch: &Batch<'_>, program: &Program) -> Vec<Access> {
    let access = |b: &souple_program::Buffer| match batch.source(&b.name) {
        Some(Source::State | Source::Direction | Source::Rows(_)) => {
            Access::Gathered { width: b.len / batch.places, table: 0 }
        }
        Some(Source::Uniform(_)) => Access::Uniform,
        Some(Source::Lanes(_)) | None => Access::Lanes,
    };
    program.inputs.iter().map(access).collect()
}

/// Numbers per item of the largest array of a batch.
fn largest(batch: &Batch<'_>, widest: usize) -> usize {
    let gathered = |name: &str| batch.source(name).is_some_and(|s| !matches!(s, Source::Lanes(_)));
    let of_program = |p: &Program| -> usize {
        let inputs = p.inputs.iter().filter(|b| !gathered(&b.name)).map(|b| b.total(p.points));
        inputs.chain(p.outputs.iter().map(|b| b.total(p.points))).max().unwrap_or(0)
    };
    batch.programs().map(of_program).max().unwrap_or(0).max(batch.places * widest).max(1)
}

/// Cuts the batches into chunks and gives these what does not change.
pub(super) fn chunks(gpu: &Gpu, batches: &[Batch<'_>], widest: usize) -> Result<Vec<Chunk>, DeviceError> {
    let limits = gpu.description().limits;
    let most = (limits.binding_bytes.min(limits.buffer_bytes) / 4) as usize;
    let mut chunks = Vec::new();
    for (number, batch) in batches.iter().enumerate() {
        let per_chunk = (most / largest(batch, widest) / LANES * LANES).max(LANES);
        let mut first = 0;
        while first < batch.items {
            let items = first..batch.items.min(first + per_chunk);
            chunks.push(chunk(gpu, batch, number, items.clone())?);
            first = items.end;
        }
    }
    Ok(chunks)
}

fn chunk(gpu: &Gpu, batch: &Batch<'_>, number: usize, items: Range<usize>) -> Result<Chunk, DeviceError> {
    let groups = items.len().div_ceil(LANES);
    // Lanes that are left over repeat the last item; nobody reads what they give.
    let item = |group: usize, lane: usize| (items.start + group * LANES + lane).min(items.end - 1);
    let mut rows = Vec::with_capacity(groups * batch.places * LANES);
    for group in 0..groups {
        for place in 0..batch.places {
            rows.extend((0..LANES).map(|lane| batch.rows[item(group, lane) * batch.places + place]));
        }
    }
    let content: &[u8] = bytemuck::cast_slice(&rows);
    let rows = gpu.buffer("row numbers", content.len() as u64, Some(content))?;
    let mut kept = BTreeMap::new();
    for program in batch.programs() {
        for b in &program.inputs {
            if let Some(Source::Lanes(values)) = batch.source(&b.name)
                && !kept.contains_key(&b.name)
            {
                let total = b.total(program.points);
                let mut singles = Vec::with_capacity(groups * total * LANES);
                for group in 0..groups {
                    for place in 0..total {
                        singles.extend((0..LANES).map(|lane| {
                            let item = item(group, lane);
                            let at = (item / HOST_LANES * total + place) * HOST_LANES + item % HOST_LANES;
                            values[at] as f32
                        }));
                    }
                }
                let content: &[u8] = bytemuck::cast_slice(&singles);
                kept.insert(b.name.clone(), gpu.buffer(&b.name, content.len() as u64, Some(content))?);
            }
        }
        // What the force program keeps, and what the check writes.
        let first_kept = usize::from(!batch.check.is_some_and(|c| std::ptr::eq(c, program)));
        for b in program.outputs.iter().skip(first_kept) {
            let bytes = 4 * groups * LANES * b.total(program.points);
            kept.insert(b.name.clone(), gpu.buffer(&b.name, bytes as u64, None)?);
        }
    }
    Ok(Chunk { batch: number, items, rows, kept })
}

impl Chunk {
    /// What it contributes to.
    pub(super) fn contributors<'a>(&self, batches: &'a [Batch<'_>]) -> Contributors<'a> {
        let batch = &batches[self.batch];
        let rows = &batch.rows[self.items.start * batch.places..self.items.end * batch.places];
        Contributors { items: self.items.len(), places: batch.places, rows }
    }

    /// What a program keeps here.
    pub(super) fn kept(&self, name: &str) -> Option<&wgpu::Buffer> {
        self.kept.get(name)
    }
}

/// Vectors that programs gather from.
pub(super) struct Vectors<'a> {
    pub(super) state: &'a wgpu::Buffer,
    pub(super) direction: &'a wgpu::Buffer,
    /// Vectors that do not change, by where they lie on the host.
    pub(super) fixed: &'a [(*const f64, wgpu::Buffer)],
}

/// Vectors that do not change, each once.
pub(super) fn fixed(gpu: &Gpu, batches: &[Batch<'_>]) -> Result<Vec<(*const f64, wgpu::Buffer)>, DeviceError> {
    let mut known: Vec<(*const f64, wgpu::Buffer)> = Vec::new();
    for (name, source) in batches.iter().flat_map(|b| &b.inputs) {
        if let Source::Rows(values) = source
            && !known.iter().any(|(at, _)| *at == values.as_ptr())
        {
            let singles: Vec<f32> = values.iter().map(|&v| v as f32).collect();
            let content: &[u8] = bytemuck::cast_slice(&singles);
            known.push((values.as_ptr(), gpu.buffer(name, content.len() as u64, Some(content))?));
        }
    }
    Ok(known)
}

/// Compiles one program of every batch that has it and binds it for every chunk. With `segments`, its first output goes
/// there; without, it is kept.
pub(super) fn bind<'b>(
    gpu: &Gpu,
    programs: &mut Programs,
    batches: &'b [Batch<'b>],
    chunks: &[Chunk],
    vectors: &Vectors<'_>,
    segments: Option<&[Segment]>,
    which: &dyn Fn(&'b Batch<'b>) -> Option<&'b Program>,
) -> Result<Vec<Bound>, DeviceError> {
    let mut bound = Vec::new();
    let mut uniform_buffers: BTreeMap<usize, wgpu::Buffer> = BTreeMap::new();
    for (number, chunk) in chunks.iter().enumerate() {
        let batch = &batches[chunk.batch];
        let Some(program) = which(batch) else { continue };
        let access = accesses(batch, program);
        let layout = layout(program, LANES, access.clone());
        let known = programs.compiled.iter().position(|(p, a, _)| p == program && *a == access);
        let pipeline = match known {
            Some(known) => known,
            None => {
                let (pipeline, _) = gpu.program(program, &layout)?;
                programs.compiled.push((program.clone(), access, pipeline));
                programs.compiled.len() - 1
            }
        };
        if let Entry::Vacant(empty) = uniform_buffers.entry(chunk.batch) {
            let given: Vec<Vec<f32>> = program
                .inputs
                .iter()
                .filter_map(|b| match batch.source(&b.name) {
                    Some(Source::Uniform(v)) => Some(v.iter().map(|&v| v as f32).collect()),
                    _ => None,
                })
                .collect();
            let values = uniforms(program, given.iter().map(Vec::as_slice));
            let content: &[u8] = bytemuck::cast_slice(&values);
            empty.insert(gpu.buffer("uniforms", content.len() as u64, Some(content))?);
        }
        let found = segments.map(|all| {
            let place = |s: &Segment| s.chunks.iter().find(|c| c.0 == number).map(|c| c.1);
            all.iter().find_map(|s| place(s).map(|offset| (s, offset))).expect("every chunk is in a segment")
        });
        let entries: Vec<wgpu::BindGroupEntry<'_>> = layout
            .bindings(program)
            .into_iter()
            .enumerate()
            .map(|(at, binding)| {
                let resource = match binding {
                    Binding::Uniforms => uniform_buffers[&chunk.batch].as_entire_binding(),
                    Binding::Rows(_) => chunk.rows.as_entire_binding(),
                    Binding::Input(k) => input(batch, chunk, vectors, &program.inputs[k].name).as_entire_binding(),
                    Binding::Output(k) => match found {
                        Some((segment, offset)) if k == 0 => {
                            let bytes = 4
                                * chunk.items.len().div_ceil(LANES)
                                * LANES
                                * program.outputs[0].total(program.points);
                            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                                buffer: &segment.contributions,
                                offset,
                                size: std::num::NonZeroU64::new(bytes as u64),
                            })
                        }
                        _ => chunk.kept[&program.outputs[k].name].as_entire_binding(),
                    },
                };
                wgpu::BindGroupEntry { binding: at as u32, resource }
            })
            .collect();
        let group = gpu.inner.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&program.name),
            layout: &programs.compiled[pipeline].2.layout,
            entries: &entries,
        });
        let workgroups = gpu.workgroups(chunk.items.len().div_ceil(LANES));
        bound.push(Bound { pipeline, group, workgroups });
    }
    Ok(bound)
}

fn input<'a>(batch: &Batch<'_>, chunk: &'a Chunk, vectors: &Vectors<'a>, name: &str) -> &'a wgpu::Buffer {
    match batch.source(name) {
        Some(Source::State) => vectors.state,
        Some(Source::Direction) => vectors.direction,
        Some(Source::Rows(values)) => {
            let known = vectors.fixed.iter().find(|(at, _)| *at == values.as_ptr());
            &known.expect("every vector of the batches was given to the device").1
        }
        Some(Source::Uniform(_)) => unreachable!("what is uniform is no input of its own"),
        Some(Source::Lanes(_)) | None => {
            chunk.kept(name).unwrap_or_else(|| panic!("no program keeps `{name}`, which another one reads"))
        }
    }
}

/// Segments of all chunks for contributions of `width` numbers per row.
pub(super) fn segments_of(
    gpu: &Gpu,
    what: &str,
    batches: &[Batch<'_>],
    chunks: &[Chunk],
    rows: usize,
    width: usize,
) -> Result<Vec<Segment>, DeviceError> {
    let contributors: Vec<Contributors<'_>> = chunks.iter().map(|c| c.contributors(batches)).collect();
    segments(gpu, what, &contributors, rows, width)
}
