//! Particles, blocks of mixed elements, regions, topology, generators, and mesh formats (bytes in, bytes out).

pub mod bar;
mod geometry;
mod mesh;
mod place;
mod reference;
pub mod topology;

pub use geometry::{BoundingBox, tolerance};
pub use mesh::{Block, ElementId, Mesh, Region};
pub use place::{FamilyMismatch, with_elements};
