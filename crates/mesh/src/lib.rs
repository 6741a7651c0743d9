//! Particles, blocks of mixed elements, regions, topology, generators, and mesh formats (bytes in, bytes out).
//!
//! A [`Mesh`] is plain data; everything else is a function of it:
//!
//! | to | use |
//! |---|---|
//! | generate a bar of mixed elements | [`bar::generate`] |
//! | read and write files | [`formats`]; the first thesis' three files: [`triple`] |
//! | know whether it is fit to compute with, and repair it | [`check::report`], [`check::repair`] |
//! | select a part of it | [`region::select`] |
//! | know who shares which face, its boundary, where it does not conform | [`topology::Topology`] |
//! | know which nodes must follow others for it to conform | [`constraint::conformity`] |
//! | turn linear elements into quadratic ones | [`with_elements`] |
//! | number nodes and elements for locality | [`numbering`] |
//!
//! Elements are those of the registry of `souple-elements`, in VTK's node order; positions are in metres.

pub mod bar;
pub mod check;
pub mod constraint;
pub mod formats;
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
