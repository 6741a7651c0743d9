//! An opened device: memory, transfers with their counters, compiled programs, and what went wrong.
//!
//! Nothing here panics when a driver fails: an allocation that does not fit, a text that its compiler refuses and a lost
//! device come back as [`DeviceError`]s.

use crate::adapters::{Adapter, BINDINGS, Description, INVOCATIONS, Limits, OpenError, adapters, find, mebibytes};
use crate::print::{Layout, Loops, PrintError, Printed, print, wgsl::Wgsl};
use souple_program::Program;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use thiserror::Error;

/// What a device could not do.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DeviceError {
    /// A buffer is larger than the device allows.
    #[error("{what} takes {} and the device `{device}` allows {} in one buffer; {advice}", mebibytes(*.bytes), mebibytes(*.limit))]
    TooLarge {
        /// What the buffer is for.
        what: String,
        /// Bytes that it needs.
        bytes: u64,
        /// Bytes that the device allows.
        limit: u64,
        /// The device.
        device: String,
        /// What to do.
        advice: &'static str,
    },
    /// The device has no memory left.
    #[error("the device `{device}` has no memory left for {what} ({}; {} are in use already); use a coarser model or the device `cpu`", mebibytes(*.bytes), mebibytes(*.used))]
    OutOfMemory {
        /// What the buffer is for.
        what: String,
        /// Bytes that it needs.
        bytes: u64,
        /// Bytes in buffers before it.
        used: u64,
        /// The device.
        device: String,
    },
    /// The compiler of the device refused a text.
    #[error("the device `{device}` did not compile `{program}`: {message}")]
    Compile {
        /// The program.
        program: String,
        /// What the compiler said.
        message: String,
        /// The device.
        device: String,
    },
    /// The program cannot be printed.
    #[error(transparent)]
    Print(#[from] PrintError),
    /// The device is gone, or refused an operation.
    #[error("the device `{device}` was lost: {message}")]
    Lost {
        /// What the driver said.
        message: String,
        /// The device.
        device: String,
    },
}

/// Bytes moved between host and device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Transfers {
    /// To the device.
    pub uploaded: u64,
    /// From the device.
    pub downloaded: u64,
}

/// How a device is opened.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// What [`Gpu::cache_data`] gave for the same adapter and driver; the driver checks it.
    pub cache: Option<&'a [u8]>,
    /// Statements that the longest part of a program may have, as printed: longer texts are refused as if the device's
    /// compiler had refused them. Compilers of shaders become slow, or fail, on texts that are too long for them.
    pub longest: usize,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Options { cache: None, longest: usize::MAX }
    }
}

/// An opened device. Cheap to share.
#[derive(Clone, Debug)]
pub struct Gpu {
    pub(crate) inner: Arc<Inner>,
}

#[derive(Debug)]
pub(crate) struct Inner {
    pub(crate) description: Description,
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    cache: Option<wgpu::PipelineCache>,
    longest: usize,
    lost: Arc<OnceLock<String>>,
    uploaded: AtomicU64,
    downloaded: AtomicU64,
    allocated: AtomicU64,
    notes: Mutex<Vec<String>>,
}

/// A program or a kernel of vectors, compiled, with the layout of what it is given.
#[derive(Debug)]
pub(crate) struct Pipeline {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

impl Gpu {
    /// Opens a device by the part of its name behind `gpu:`; empty for the first one.
    ///
    /// `cache` is what [`Gpu::cache_data`] gave for the same adapter and driver; the driver checks it.
    ///
    /// # Errors
    /// When there is no adapter, none of that name, or the driver refuses.
    pub fn open(name: &str, cache: Option<&[u8]>) -> Result<Gpu, OpenError> {
        Gpu::of(&find(&adapters(), name)?, cache)
    }

    /// Opens an adapter.
    ///
    /// # Errors
    /// When the driver refuses, or a limit is too low.
    pub fn of(adapter: &Adapter, cache: Option<&[u8]>) -> Result<Gpu, OpenError> {
        Gpu::with(adapter, &Options { cache, ..Options::default() })
    }

    /// Opens an adapter with other than the usual options. What is asked of it are its own limits, not the least that
    /// every device has: a large model on a large device is not cut into more parts than that device needs.
    ///
    /// # Errors
    /// When the driver refuses, or a limit is too low.
    pub fn with(adapter: &Adapter, options: &Options<'_>) -> Result<Gpu, OpenError> {
        let mut description = adapter.description.clone();
        // Whoever opens a device may allow it less than it has, and not more.
        description.limits = description.limits.least(Limits::of(&adapter.handle.limits()));
        let refused = |reason: String| OpenError::Refused { adapter: description.name.clone(), reason };
        let limits = description.limits;
        if limits.bindings < BINDINGS || limits.invocations < INVOCATIONS {
            return Err(refused(format!(
                "it has {} buffers per program and workgroups of {}, and {BINDINGS} and {INVOCATIONS} are needed",
                limits.bindings, limits.invocations
            )));
        }
        let wanted = wgpu::Features::PIPELINE_CACHE | wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.handle.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("souple"),
            required_features: features,
            required_limits: adapter.handle.limits(),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) =
            pollster::block_on(adapter.handle.request_device(&descriptor)).map_err(|e| refused(e.to_string()))?;
        let lost: Arc<OnceLock<String>> = Arc::default();
        let (first, second) = (lost.clone(), lost.clone());
        device.set_device_lost_callback(move |reason, message| {
            let _ = first.set(format!("{reason:?}: {message}"));
        });
        // Without this an error that no scope catches ends the program.
        device.on_uncaptured_error(Arc::new(move |error| {
            let _ = second.set(error.to_string());
        }));
        let cache =
            features.contains(wgpu::Features::PIPELINE_CACHE).then(|| crate::cache::open(&device, options.cache));
        Ok(Gpu {
            inner: Arc::new(Inner {
                description,
                device,
                queue,
                cache,
                longest: options.longest,
                lost,
                uploaded: AtomicU64::new(0),
                downloaded: AtomicU64::new(0),
                allocated: AtomicU64::new(0),
                notes: Mutex::new(Vec::new()),
            }),
        })
    }

    /// What the device is.
    pub fn description(&self) -> &Description {
        &self.inner.description
    }

    /// The limits that it was opened with.
    pub fn granted(&self) -> Limits {
        Limits::of(&self.inner.device.limits())
    }

    /// Bytes moved since the device was opened.
    pub fn transfers(&self) -> Transfers {
        let get = |n: &AtomicU64| n.load(Ordering::Relaxed);
        Transfers { uploaded: get(&self.inner.uploaded), downloaded: get(&self.inner.downloaded) }
    }

    /// What was done another way than planned, and why, since this was last asked.
    pub fn take_notes(&self) -> Vec<String> {
        std::mem::take(&mut *self.inner.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Something that whoever asks for notes should be told.
    pub fn note(&self, note: String) {
        self.inner.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note);
    }

    /// Compiled pipelines as bytes for the next start, where the driver gives them.
    pub fn cache_data(&self) -> Option<Vec<u8>> {
        self.inner.cache.as_ref()?.get_data()
    }

    /// Gives the device up as if its driver had lost it.
    pub fn destroy(&self) {
        let _ = self.inner.lost.set("it was given up".into());
        self.inner.device.destroy();
    }

    /// An error when the device is gone.
    ///
    /// # Errors
    /// [`DeviceError::Lost`].
    pub fn alive(&self) -> Result<(), DeviceError> {
        match self.inner.lost.get() {
            None => Ok(()),
            Some(message) => Err(self.lost(message)),
        }
    }

    fn lost(&self, message: &str) -> DeviceError {
        DeviceError::Lost { message: message.to_owned(), device: self.inner.description.name.clone() }
    }

    /// A buffer that programs see, with its first content where it is given; at least one word long.
    pub(crate) fn buffer(&self, what: &str, bytes: u64, content: Option<&[u8]>) -> Result<wgpu::Buffer, DeviceError> {
        self.alive()?;
        let bytes = bytes.max(4);
        let limits = self.inner.description.limits;
        let limit = limits.binding_bytes.min(limits.buffer_bytes);
        let device = || self.inner.description.name.clone();
        if bytes > limit {
            let advice = "use a coarser model or the device `cpu`";
            return Err(DeviceError::TooLarge { what: what.into(), bytes, limit, device: device(), advice });
        }
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let scope = self.inner.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size: bytes, usage, mapped_at_creation: false };
        let buffer = self.inner.device.create_buffer(&descriptor);
        let used = self.inner.allocated.load(Ordering::Relaxed);
        if pollster::block_on(scope.pop()).is_some() {
            return Err(DeviceError::OutOfMemory { what: what.into(), bytes, used, device: device() });
        }
        self.inner.allocated.fetch_add(bytes, Ordering::Relaxed);
        if let Some(content) = content.filter(|c| !c.is_empty()) {
            self.write(&buffer, content);
        }
        Ok(buffer)
    }

    /// Overwrites the beginning of a buffer.
    pub(crate) fn write(&self, buffer: &wgpu::Buffer, content: &[u8]) {
        self.inner.queue.write_buffer(buffer, 0, content);
        self.inner.uploaded.fetch_add(content.len() as u64, Ordering::Relaxed);
    }

    /// Buffers that bytes pass through on their way back.
    pub(crate) fn staging(&self, bytes: u64) -> wgpu::Buffer {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let descriptor =
            wgpu::BufferDescriptor { label: Some("staging"), size: bytes.max(4), usage, mapped_at_creation: false };
        self.inner.device.create_buffer(&descriptor)
    }

    /// Waits for the device and reads the first bytes of a staging buffer.
    pub(crate) fn read(&self, staging: &wgpu::Buffer, bytes: u64) -> Result<Vec<u8>, DeviceError> {
        self.alive()?;
        let slice = staging.slice(0..bytes.max(4));
        let (send, receive) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            let _ = send.send(result);
        });
        let waited = self.inner.device.poll(wgpu::PollType::wait_indefinitely());
        let refused = |message: String| match self.alive() {
            Err(lost) => lost,
            Ok(()) => self.lost(&message),
        };
        waited.map_err(|e| refused(e.to_string()))?;
        match receive.try_recv() {
            Ok(Ok(())) => {}
            Ok(Err(e)) => return Err(refused(e.to_string())),
            Err(e) => return Err(refused(e.to_string())),
        }
        let view = slice.get_mapped_range().map_err(|e| refused(e.to_string()))?;
        let mut content = view.to_vec();
        drop(view);
        staging.unmap();
        content.truncate(bytes as usize);
        self.inner.downloaded.fetch_add(bytes, Ordering::Relaxed);
        Ok(content)
    }

    /// The content of a buffer.
    pub(crate) fn download(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, DeviceError> {
        self.alive()?;
        let bytes = buffer.size();
        let staging = self.staging(bytes);
        let mut encoder = self.encoder();
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, bytes);
        self.inner.queue.submit([encoder.finish()]);
        self.read(&staging, bytes)
    }

    pub(crate) fn encoder(&self) -> wgpu::CommandEncoder {
        self.inner.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// Compiles a text whose bindings are storage buffers: read-only, or not, in order.
    pub(crate) fn compile(
        &self,
        label: &str,
        source: &str,
        entry: Option<&str>,
        writable: &[bool],
    ) -> Result<Pipeline, DeviceError> {
        self.alive()?;
        let device = &self.inner.device;
        let most = self.inner.description.limits.bindings as usize;
        let refuse = |message: String| DeviceError::Compile {
            program: label.to_owned(),
            message,
            device: self.inner.description.name.clone(),
        };
        if writable.len() > most {
            return Err(refuse(format!("it needs {} buffers and the device allows {most}", writable.len())));
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let entries: Vec<wgpu::BindGroupLayoutEntry> = writable
            .iter()
            .enumerate()
            .map(|(binding, &writable)| wgpu::BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Storage { read_only: !writable },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let layout =
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries });
        let whole = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            ..wgpu::PipelineLayoutDescriptor::default()
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&whole),
            module: &module,
            entry_point: entry,
            compilation_options: wgpu::PipelineCompilationOptions {
                zero_initialize_workgroup_memory: false,
                ..wgpu::PipelineCompilationOptions::default()
            },
            cache: self.inner.cache.as_ref(),
        });
        let errors = [pollster::block_on(internal.pop()), pollster::block_on(scope.pop())];
        match errors.into_iter().flatten().next() {
            Some(error) => Err(refuse(error.to_string())),
            None => Ok(Pipeline { pipeline, layout }),
        }
    }

    /// Prints and compiles a program: written out where that is short, rolled where it is not or where the compiler
    /// refuses it.
    pub(crate) fn program(&self, program: &Program, layout: &Layout) -> Result<(Pipeline, Printed), DeviceError> {
        let print_as = |loops: Loops| print(program, &Layout { loops, ..layout.clone() }, &Wgsl, &[]);
        let writable: Vec<bool> =
            layout.bindings(program).iter().map(|b| matches!(b, crate::print::Binding::Output(_))).collect();
        let compile = |printed: &Printed| {
            let (longest, most) = (printed.longest, self.inner.longest);
            if longest > most {
                return Err(DeviceError::Compile {
                    program: program.name.clone(),
                    message: format!("its longest part has {longest} statements and at most {most} are compiled"),
                    device: self.inner.description.name.clone(),
                });
            }
            self.compile(&program.name, &printed.source, Some("main"), &writable)
        };
        with_fallback(layout.loops, &print_as, &compile, &mut |note| self.note(note))
    }

    /// Binds buffers to a pipeline, in order.
    pub(crate) fn bind(&self, pipeline: &Pipeline, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry<'_>> = buffers
            .iter()
            .enumerate()
            .map(|(k, b)| wgpu::BindGroupEntry { binding: k as u32, resource: b.as_entire_binding() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &pipeline.layout, entries: &entries };
        self.inner.device.create_bind_group(&descriptor)
    }

    /// Workgroups along the axes, for this many in all.
    pub(crate) fn workgroups(&self, count: usize) -> [u32; 2] {
        let most = self.inner.description.limits.workgroups as usize;
        let x = count.clamp(1, most);
        [x as u32, count.div_ceil(x).max(1) as u32]
    }
}

/// Compiles the wanted form, and the rolled one where the compiler refuses that; `note` is told.
fn with_fallback<P>(
    wanted: Loops,
    print_as: &dyn Fn(Loops) -> Result<Printed, PrintError>,
    compile: &dyn Fn(&Printed) -> Result<P, DeviceError>,
    note: &mut dyn FnMut(String),
) -> Result<(P, Printed), DeviceError> {
    let printed = print_as(wanted)?;
    match compile(&printed) {
        Ok(compiled) => Ok((compiled, printed)),
        Err(error @ DeviceError::Compile { .. }) if wanted == Loops::Unrolled => {
            let rolled = print_as(Loops::Rolled)?;
            let compiled = compile(&rolled)?;
            let (before, after) = (printed.longest, rolled.longest);
            note(format!("{error}; it runs with its loops rolled instead ({after} statements rather than {before})"));
            Ok((compiled, rolled))
        }
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_program::parse;

    const LOOP: &str = "program twice\npoints 3\ninput a 1\noutput o 1\ntable 1 2 3\nstraight\n  v0 = input a[0]\n  \
                        v1 = accumulator\nloop\n  v2 = table 0\n  v1 += v0 * v2\nstraight\n  output o[0] = v1\nend\n";

    /// A compiler that refuses the program written out gets it rolled, and somebody is told; one that refuses both gives
    /// the error.
    #[test]
    fn what_is_refused_written_out_is_rolled() {
        let program = parse(LOOP).unwrap_or_else(|e| panic!("{e}"));
        let layout =
            Layout { lanes: 8, workgroup: 64, inputs: vec![crate::print::Access::Lanes], loops: Loops::Unrolled };
        let print_as = |loops| print(&program, &Layout { loops, ..layout.clone() }, &Wgsl, &[]);
        let refuse =
            || DeviceError::Compile { program: "twice".into(), message: "too long".into(), device: "d".into() };
        let only_loops = |p: &Printed| if p.source.contains("for (") { Ok(()) } else { Err(refuse()) };
        let mut notes = Vec::new();
        let (_, printed) =
            with_fallback(Loops::Unrolled, &print_as, &only_loops, &mut |n| notes.push(n)).expect("it is rolled");
        assert!(printed.source.contains("for ("));
        assert!(notes.len() == 1 && notes[0].contains("too long") && notes[0].contains("rolled"), "{notes:?}");
        let nothing = |_: &Printed| -> Result<(), DeviceError> { Err(refuse()) };
        assert_eq!(with_fallback(Loops::Unrolled, &print_as, &nothing, &mut |_| {}).err(), Some(refuse()));
    }
}
