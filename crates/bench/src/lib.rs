//! Honest measurements: what kernels, operators, steps and set-ups cost, and against what.
//!
//! | measurement | function | what stands beside it |
//! |---|---|---|
//! | one kernel on one batch of elements | [`kernels::measure`] | the processor's peaks, kernels written by hand ([`handwritten`]), the same programs compiled ahead ([`ahead`]) |
//! | the programs of a step on a graphics device | [`graphics::measure`](graphics) | the device's peaks |
//! | force, products and assembly of a model | [`operators::measure`] | matrix-free beside assembled |
//! | a step of a simulation | [`step::measure`] | its parts |
//! | what comes before the first step | [`setup::measure`] | its parts, the highest memory |
//!
//! Rules that hold for every figure: it is the median of many short rounds with its quartiles ([`stopwatch`]); what is
//! compared runs in the same process on the same data, one contender after the other in every round; the machine is
//! named ([`machine`]), the date only with graphics devices, whose drivers change under them.
//! Nothing here checks that something is fast enough: that is for whoever reads the figures.

pub mod ahead;
pub mod batch;
#[cfg(feature = "gpu")]
pub mod graphics;
pub mod handwritten;
pub mod kernels;
pub mod machine;
pub mod operators;
pub mod peak;
pub mod setup;
pub mod singles;
pub mod step;
pub mod stopwatch;
pub mod vectors;

/// What measurements are asked for; re-exported because the command stands on no crate below.
pub use souple_elements::{Element, all as all_elements};
/// Likewise.
pub use souple_laws::{Law, all as all_laws};
