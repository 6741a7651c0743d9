//! Graphics devices: what there is, and simulations whose steps stay on one.
//!
//! A build without the feature `gpu` has a stand-in that says so wherever a device
//! is asked for.

#[cfg(not(feature = "gpu"))]
mod absent;
#[cfg(feature = "gpu")]
mod cache;
#[cfg(feature = "gpu")]
mod model;
#[cfg(feature = "gpu")]
mod present;
mod refuse;
mod report;
#[cfg(all(test, feature = "gpu"))]
mod tests;

#[cfg(not(feature = "gpu"))]
pub(crate) use absent::{OnDevice, Rows, adapters};
#[cfg(feature = "gpu")]
pub use present::open_gpu;
#[cfg(feature = "gpu")]
pub(crate) use present::{OnDevice, Rows, adapters};
pub use report::{AdapterReport, Doctor, doctor};

use serde::Serialize;

/// Bytes moved between host and device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Moved {
    /// To the device.
    pub uploaded: u64,
    /// From the device.
    pub downloaded: u64,
}

/// Bytes moved between host and device since the simulation was loaded, and what for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Transfers {
    /// To the device: the sum of the three purposes.
    pub uploaded: u64,
    /// From the device: likewise.
    pub downloaded: u64,
    /// Numbers of steps, there, and records of their solves, back: the same for every model; grows with the steps.
    pub steps: Moved,
    /// Numbers of nodes that probes or pictures look at, there, once; their values, back: grows with these nodes.
    pub nodes: Moved,
    /// Whole states, for written fields, checkpoints and quantities of elements: grows with the model.
    pub states: Moved,
    /// Everything since the last step began, readings after it included.
    pub last_step: Moved,
}

/// What of some nodes is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OfNodes {
    /// Displacements in single precision.
    Rounded,
    /// Displacements as exactly as the device has them.
    Displacements,
    /// Velocities.
    Velocities,
}

/// What a step on a device gave.
pub(crate) struct Stepped {
    /// Iterations of the linear solver.
    pub(crate) iterations: usize,
    /// Kinetic energy in J.
    pub(crate) energy: f64,
    /// What a person should know.
    pub(crate) warning: Option<String>,
}

/// Why a step on a device failed.
#[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "a build without devices makes no steps on them"))]
pub(crate) enum StepError {
    /// The state is not acceptable; the device still has it.
    State,
    /// The device is gone.
    Lost(String),
}

/// The part of a device's name that says which adapter, if it names a graphics device: `gpu`, `gpu:1`, `gpu:lavapipe`.
pub(crate) fn adapter_of(device: &str) -> Option<&str> {
    if device == "gpu" { Some("") } else { device.strip_prefix("gpu:") }
}
