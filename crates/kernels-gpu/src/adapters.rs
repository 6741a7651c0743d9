//! Which graphics adapters this machine has, what each can do and what it cannot, in words.
//!
//! ```text
//! gpu            the first of the list
//! gpu:1          the second
//! gpu:lavapipe   the first whose name or driver contains the word; "lavapipe" is Mesa's driver on the processor
//! ```

use thiserror::Error;

/// A graphics adapter.
#[derive(Clone, Debug)]
pub struct Adapter {
    /// Place in the list, from 0: `gpu:PLACE` opens it.
    pub place: usize,
    /// What it is.
    pub description: Description,
    pub(crate) handle: wgpu::Adapter,
}

/// What an adapter is and can do.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name that the driver gives it.
    pub name: String,
    /// Name of the driver; "lavapipe" for Mesa's on the processor.
    pub driver: String,
    /// Version of the driver.
    pub driver_version: String,
    /// The interface it is reached by: "vulkan", "metal", "dx12".
    pub interface: String,
    /// "discrete", "integrated", "virtual", "processor" or "other".
    pub kind: String,
    /// What bounds programs on it. Lower ones, set before it is opened, are kept to; higher ones are not.
    pub limits: Limits,
    /// What it has beyond what is needed.
    pub features: Features,
}

/// Limits of an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest buffer in bytes.
    pub buffer_bytes: u64,
    /// Largest part of a buffer that a program sees, in bytes.
    pub binding_bytes: u64,
    /// Buffers that a program sees at most.
    pub bindings: u32,
    /// Workgroups along an axis.
    pub workgroups: u32,
    /// Invocations of a workgroup.
    pub invocations: u32,
}

impl Limits {
    /// The lower of both, one by one.
    pub(crate) fn least(self, other: Limits) -> Limits {
        Limits {
            buffer_bytes: self.buffer_bytes.min(other.buffer_bytes),
            binding_bytes: self.binding_bytes.min(other.binding_bytes),
            bindings: self.bindings.min(other.bindings),
            workgroups: self.workgroups.min(other.workgroups),
            invocations: self.invocations.min(other.invocations),
        }
    }
}

/// Optional features of an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Features {
    /// Arithmetic in double precision.
    pub doubles: bool,
    /// Compiled pipelines can be kept on disk.
    pub pipeline_cache: bool,
    /// It tells when work began and ended, by its own clock.
    pub timestamps: bool,
}

/// Bindings that the vector kernels and the programs of steps need at least.
pub const BINDINGS: u32 = 10;
/// Invocations per workgroup that they need at least.
pub const INVOCATIONS: u32 = 256;

/// Why no device could be opened.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum OpenError {
    /// The machine has no adapter at all.
    #[error(
        "there is no graphics adapter here: no Vulkan, Metal or Direct3D 12 driver answered; install the driver of the \
         graphics card, or Mesa's Vulkan driver on the processor (Debian: mesa-vulkan-drivers)"
    )]
    None,
    /// None of the adapters is called this.
    #[error("no graphics adapter is called `{name}`; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// Names of those that there are.
        known: String,
    },
    /// The driver did not open the adapter.
    #[error("the graphics adapter `{adapter}` could not be opened: {reason}")]
    Refused {
        /// Its name.
        adapter: String,
        /// What the driver said, or which limit is too low.
        reason: String,
    },
}

/// Every adapter of the machine, those that compute fastest by their kind first. Empty without a driver.
pub fn adapters() -> Vec<Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    // Checks of the interface are for its own developers; what reaches a driver is checked before in any build.
    descriptor.flags = wgpu::InstanceFlags::empty();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let mut found: Vec<(usize, wgpu::Adapter)> =
        pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY)).into_iter().enumerate().collect();
    found.sort_by_key(|(at, adapter)| (rank(adapter.get_info().device_type), *at));
    let describe = |(place, (_, handle)): (usize, (usize, wgpu::Adapter))| Adapter {
        place,
        description: describe(&handle),
        handle,
    };
    found.into_iter().enumerate().map(describe).collect()
}

fn rank(kind: wgpu::DeviceType) -> usize {
    use wgpu::DeviceType::{Cpu, DiscreteGpu, IntegratedGpu, Other, VirtualGpu};
    match kind {
        DiscreteGpu => 0,
        IntegratedGpu => 1,
        VirtualGpu => 2,
        Other => 3,
        Cpu => 4,
    }
}

fn describe(adapter: &wgpu::Adapter) -> Description {
    let (info, limits, features) = (adapter.get_info(), adapter.limits(), adapter.features());
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "processor",
        wgpu::DeviceType::Other => "other",
    };
    // Mesa calls the driver by the library that compiles for it.
    let driver = if info.driver.contains("llvmpipe") { "lavapipe".to_owned() } else { info.driver.clone() };
    Description {
        name: info.name,
        driver,
        driver_version: info.driver_info,
        interface: info.backend.to_str().to_owned(),
        kind: kind.to_owned(),
        limits: Limits::of(&limits),
        features: Features {
            doubles: features.contains(wgpu::Features::SHADER_F64),
            pipeline_cache: features.contains(wgpu::Features::PIPELINE_CACHE),
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
        },
    }
}

impl Limits {
    pub(crate) fn of(limits: &wgpu::Limits) -> Limits {
        Limits {
            buffer_bytes: limits.max_buffer_size,
            binding_bytes: limits.max_storage_buffer_binding_size,
            bindings: limits.max_storage_buffers_per_shader_stage,
            workgroups: limits.max_compute_workgroups_per_dimension,
            invocations: limits.max_compute_invocations_per_workgroup,
        }
    }
}

/// The adapter that a name means: empty or none for the first, a place, or a part of a name or driver.
///
/// # Errors
/// When there is none, or none of that name; the message lists those that there are.
pub fn find(all: &[Adapter], name: &str) -> Result<Adapter, OpenError> {
    if all.is_empty() {
        return Err(OpenError::None);
    }
    let wanted = name.to_lowercase();
    let called = |a: &&Adapter| {
        let d = &a.description;
        [&d.name, &d.driver].into_iter().any(|n| n.to_lowercase().contains(&wanted))
    };
    let found = match name.parse::<usize>() {
        _ if name.is_empty() => all.first(),
        Ok(place) => all.get(place),
        Err(_) => all.iter().find(called),
    };
    found.cloned().ok_or_else(|| {
        let known: Vec<String> =
            all.iter().map(|a| format!("gpu:{} ({}, {})", a.place, a.description.name, a.description.driver)).collect();
        OpenError::Unknown { name: format!("gpu:{name}"), known: known.join("; ") }
    })
}

impl Description {
    /// What is lacking or will be done another way, and why, one sentence each.
    pub fn shortcomings(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "Programs run in single precision{}: sums over many values are kept in two numbers each.",
            if self.features.doubles { ", although the device has double precision too" } else { "" }
        )];
        lines.push(
            "A program that its compiler refuses written out runs with its loops as loops instead, and the run says so."
                .into(),
        );
        if self.kind == "processor" {
            lines.push("This driver runs on the processor: good for tests, slower than the device `cpu`.".into());
        }
        if !self.features.pipeline_cache {
            lines.push("Its driver keeps no compiled pipelines on disk: each start compiles them again.".into());
        }
        if !self.features.timestamps {
            lines.push("It does not tell when its work began and ended: parts of steps are not timed.".into());
        }
        let Limits { binding_bytes, bindings, invocations, .. } = self.limits;
        lines.push(format!(
            "A program sees at most {} of a buffer: larger blocks are split, vectors of more than {} numbers are refused.",
            mebibytes(binding_bytes),
            binding_bytes / 4
        ));
        if bindings < BINDINGS {
            lines.push(format!("Steps need {BINDINGS} buffers per program and it has {bindings}: it cannot run them."));
        }
        if invocations < INVOCATIONS {
            lines.push(format!("Sums need workgroups of {INVOCATIONS} and it has {invocations}: it cannot run steps."));
        }
        lines
    }
}

/// A size in words.
pub(crate) fn mebibytes(bytes: u64) -> String {
    if bytes < 1 << 20 {
        return format!("{:.1} KiB", bytes as f64 / 1024.0);
    }
    format!("{:.0} MiB", bytes as f64 / f64::from(1u32 << 20))
}
