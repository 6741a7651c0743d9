//! Programs on graphics devices: printed as WGSL, run through wgpu (Vulkan, Metal, Direct3D 12), in single precision.
//!
//! | question | where |
//! |---|---|
//! | which devices there are, what they lack | [`adapters()`], [`Description`] |
//! | a program as text of a device's language | [`print`] |
//! | a whole time step on the device | [`resident`] |
//! | a program run on data of the host, for tests | [`GpuBackend`] |
//! | a program run again and again on data of the device, and what the device can do at most | [`measure`] |
//! | compiled pipelines as bytes that a file can keep | [`cache`] |
//!
//! Nothing here knows what programs compute; files (the pipeline cache) belong to whoever opens the device.

mod adapters;
pub mod cache;
mod device;
mod kernel;
pub mod measure;
pub mod print;
pub mod resident;

pub use adapters::{Adapter, BINDINGS, Description, Features, INVOCATIONS, Limits, OpenError, adapters, find};
pub use device::{DeviceError, Gpu, Options, Transfers};
pub use kernel::GpuBackend;
