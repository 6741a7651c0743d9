//! Programs as machine code for x86-64.
//!
//! ```text
//! Program ──flow──▶ Flow ──order, allocate──▶ Allocation ──emit──▶ Assembly ──pages──▶ Pages
//!          what is computed     which register, when           bytes          executable
//! ```
//!
//! [`kernel`] runs the result and is the only place that knows buffers; [`pages`] is the only place that knows memory
//! protection.
//! Code depends on how each input arrives (in lanes, gathered, uniform), so it is made when a kernel first meets a
//! combination, and kept.

mod allocate;
mod choice;
mod elementary;
mod emit;
mod flow;
mod functions;
mod gather;
mod kernel;
mod order;
mod pages;
mod reuse;
mod target;
mod time;

pub(crate) use kernel::Machine;
pub use kernel::{Figures, figures};
pub(crate) use target::Target;

#[cfg(test)]
mod emulator;
#[cfg(test)]
mod tests;
