//! Particles, blocks of mixed elements, regions, topology, generators, and mesh formats (bytes in, bytes out).

mod mesh;

pub use mesh::{Block, ElementId, Mesh, Region};
