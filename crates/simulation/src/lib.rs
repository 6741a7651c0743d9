//! The one door for applications: from a scene to a model, from a model to states, probes and results.

mod criteria;
pub mod derive_report;
mod end;
mod fields;
pub mod gpu;
pub mod interaction;
pub mod law_report;
pub mod lists;
mod motion;
mod nodes;
mod output;
mod phases;
pub mod prepare;
mod probes;
mod remote;
mod run;
pub mod session;
pub mod surface;
mod system;
mod tensor;

pub use fields::ElementField;
pub use nodes::Nodes;
pub use output::{Iterations, Quantiles, Summary};
pub use phases::PhaseTimes;
pub use probes::{ExpectationResult, ProbeValue};
pub use run::{Ending, LoadError, Progress, RunError, RunOptions, Simulation, open_device};

/// Elements: what they are; re-exported because applications stand on this crate alone.
pub use souple_elements as elements;
/// Laws: what they are; re-exported likewise.
pub use souple_laws as laws;
/// Meshes: formats, generators, checks; re-exported likewise.
pub use souple_mesh as mesh;
/// A block of like elements, of which a prepared scene has a list.
pub use souple_operators::BlockSpec;
/// Scenes: what a person writes; re-exported likewise.
pub use souple_scene as scene;
