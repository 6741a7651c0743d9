//! The one door for applications: from a scene to a model, from a model to states, probes and results.

pub mod derive_report;
pub mod law_report;
pub mod lists;
mod motion;
mod output;
mod phases;
pub mod prepare;
mod probes;
mod run;
mod system;
mod tensor;

pub use output::{Iterations, Quantiles, Summary};
pub use phases::PhaseTimes;
pub use probes::{ExpectationResult, ProbeValue};
pub use run::{Ending, LoadError, Progress, RunError, RunOptions, Simulation, open_device};

/// Meshes: formats, generators, checks; re-exported because applications stand on this crate alone.
pub use souple_mesh as mesh;
/// Scenes: what a person writes; re-exported likewise.
pub use souple_scene as scene;
