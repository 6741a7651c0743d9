//! What `souple doctor` says: adapters, drivers, limits, what will be done another way and why, in words.

use super::adapters;
use serde::Serialize;

/// One graphics adapter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AdapterReport {
    /// What `--device` calls it.
    pub id: String,
    /// Name that the driver gives it.
    pub name: String,
    /// Driver and its version.
    pub driver: String,
    /// "vulkan", "metal" or "dx12".
    pub interface: String,
    /// "discrete", "integrated", "virtual", "processor" or "other".
    pub kind: String,
    /// Largest buffer in bytes.
    pub max_buffer_bytes: u64,
    /// Largest part of a buffer that a program sees, in bytes.
    pub max_binding_bytes: u64,
    /// Buffers that a program sees at most.
    pub max_bindings: u32,
    /// Whether it has double precision.
    pub double_precision: bool,
    /// Whether compiled pipelines can be kept on disk.
    pub pipeline_cache: bool,
    /// Whether it tells when its work began and ended.
    pub timestamps: bool,
    /// What is lacking or done another way, one sentence each.
    pub notes: Vec<String>,
    /// Why it cannot be opened, if it cannot.
    pub refused: Option<String>,
}

/// The state of this machine's graphics devices.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doctor {
    /// Whether this build can use them at all.
    pub gpu_build: bool,
    /// Adapters, the one that `gpu` means first.
    pub adapters: Vec<AdapterReport>,
    /// What steps on a device do, what they do not, and what to do then.
    pub advice: Vec<String>,
}

/// Looks at the machine.
pub fn doctor() -> Doctor {
    let found = adapters();
    let gpu_build = found.is_some();
    let adapters = found.unwrap_or_default();
    let mut advice = Vec::new();
    if !gpu_build {
        advice.push("This build has no graphics devices: build it with the feature `gpu`.".to_owned());
    } else if adapters.is_empty() {
        advice.push(
            "No graphics adapter answered: install the driver of the graphics card, or Mesa's Vulkan driver on the \
             processor (Debian: mesa-vulkan-drivers). Everything runs on the device `cpu` without one."
                .to_owned(),
        );
    } else {
        advice.push(
            "On a graphics device whole steps run: implicit Euler and midpoint with conjugate gradients, explicit and \
             symplectic Euler. Quasi-static scenes, other integrators, direct solvers, ties and viscosity are refused \
             with what to do instead; probes and written fields are computed on the processor from the state."
                .to_owned(),
        );
    }
    Doctor { gpu_build, adapters, advice }
}
