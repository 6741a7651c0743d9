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

#[cfg(not(feature = "gpu"))]
pub(crate) use absent::{OnDevice, adapters};
#[cfg(feature = "gpu")]
pub use present::open_gpu;
#[cfg(feature = "gpu")]
pub(crate) use present::{OnDevice, adapters};
pub use report::{AdapterReport, Doctor, doctor};

use serde::Serialize;

/// Bytes moved between host and device since the simulation was loaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Transfers {
    /// To the device.
    pub uploaded: u64,
    /// From the device.
    pub downloaded: u64,
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
