//! Mesh formats: bytes in, mesh and report out; mesh in, bytes out.
//!
//! | format | read | write |
//! |---|---|---|
//! | Gmsh MSH | 2.x and 4.1, text and binary | 4.1 text and binary, 2.2 text |
//! | VTK XML unstructured grid (`.vtu`) | every encoding, zlib | appended zlib, appended raw, text; `.pvd` series |
//! | legacy VTK | text and binary, versions 1 to 5.1 | text |
//! | Abaqus, CalculiX (`.inp`) | yes, with includes | yes |
//! | MEDIT (`.mesh`), STL, OBJ, PLY | yes | no |
//!
//! Nothing here opens a file: what a format includes is asked for through [`ReadOptions::include`].
//! Nothing here knows an element: types, numbers and node orders come from the registry of `souple-elements`.
//! Lengths are taken as they stand in the file; units are the caller's matter.
//!
//! Every reader ends in the same steps, in this order: nodes into VTK's order, complete second-order elements reduced
//! where the registry has no such element (and then everywhere, so that neighbours agree), inside-out elements
//! turned, regions completed. Each step is counted in the [`ImportReport`].
//!
//! A region that a file gives as elements holds these elements and their nodes, unless the file lists the region's
//! nodes as well; then it holds the listed ones.

mod abaqus;
mod detect;
mod draft;
mod error;
mod field;
mod gmsh;
mod kinds;
mod medit;
mod obj;
mod orientation;
mod ply;
mod polygon;
mod report;
mod stl;
mod stream;
mod vtk;

pub use abaqus::write_inp;
pub use detect::{Format, detect};
pub use error::{FormatError, Place};
pub use field::{Field, Location, Values};
pub use gmsh::{MshVersion, write_msh};
pub use report::{FoundRegion, ImportReport, Skipped};
pub use vtk::{PvdEntry, VtkWedge, VtuEncoding, VtuOptions, read_vtu_with_fields, write_pvd, write_vtk, write_vtu};

use crate::Mesh;

/// What to do with second-order elements that have nodes at face and volume centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompleteElements {
    /// Keep those that the registry has, unless the file holds others that must be reduced: then reduce all, so that
    /// neighbouring elements keep the same nodes on the face that they share.
    #[default]
    KeepKnown,
    /// Reduce all of them to corners and edge nodes.
    Reduce,
}

/// Gives the bytes of a file that the mesh file names, or says why not.
pub type Include<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// Choices when reading.
#[derive(Default)]
pub struct ReadOptions<'a> {
    /// Complete second-order elements.
    pub complete: CompleteElements,
    /// Where included files come from (Abaqus `*INCLUDE`); without it an inclusion is an error.
    pub include: Option<Include<'a>>,
}

/// Reads a mesh.
///
/// `name` is a file name or an extension; the content decides where it can, the name where it must.
///
/// # Errors
///
/// Says where in the file, what was expected and what to do; no input makes this panic or allocate more than a small
/// multiple of what the file holds.
pub fn read(name: &str, bytes: &[u8], options: ReadOptions<'_>) -> Result<(Mesh, ImportReport), FormatError> {
    let complete = options.complete;
    let draft = match detect(name, bytes)? {
        Format::Msh => gmsh::read(bytes)?,
        Format::Vtu => vtk::read_vtu(bytes)?,
        Format::LegacyVtk => vtk::read_legacy(bytes)?,
        Format::Abaqus => abaqus::read(bytes, options.include)?,
        Format::Medit => medit::read(bytes)?,
        Format::Stl => stl::read(bytes)?,
        Format::Obj => obj::read(bytes)?,
        Format::Ply => ply::read(bytes)?,
    };
    let finished = draft.finish(complete)?;
    Ok((finished.mesh, finished.report))
}
