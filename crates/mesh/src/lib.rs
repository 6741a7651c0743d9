//! Particles, blocks of mixed elements, regions, topology, generators, and mesh formats (bytes in, bytes out).

pub mod bar;
pub mod check;
mod geometry;
mod mesh;
pub mod numbering;
mod place;
mod reference;
pub mod region;
pub mod topology;
pub mod triple;

pub use geometry::{BoundingBox, tolerance};
pub use mesh::{Block, ElementId, Mesh, Region};
pub use place::{FamilyMismatch, with_elements};
