//! Abaqus and CalculiX input (`.inp`): keywords behind `*`, comments behind `**`, numbers separated by commas.
//!
//! Only the mesh is read: nodes, elements and their sets; sections, materials and steps are passed over and listed.
//! Keywords that would make or move nodes (`*NGEN`, `*SYSTEM`, …) are refused, because the mesh would be wrong
//! without them.

mod lines;
mod read;
mod sets;
mod write;

pub(super) use read::read;
pub use write::write_inp;
