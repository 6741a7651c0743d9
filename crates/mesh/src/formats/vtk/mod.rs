//! VTK's formats: XML unstructured grids, their time series, and the legacy format.
//!
//! Node order is VTK's, so nothing is permuted; the one trap is the linear wedge, see [`VtkWedge`].

mod arrays;
mod cells;
mod legacy_attributes;
mod legacy_read;
mod legacy_write;
mod pvd;
mod vtu_data;
mod vtu_read;
mod vtu_write;

pub(super) use legacy_read::read as read_legacy;
pub use legacy_write::write_vtk;
pub use pvd::{PvdEntry, write_pvd};
pub(super) use vtu_read::read as read_vtu;
pub use vtu_read::read_vtu_with_fields;
pub use vtu_write::{VtuEncoding, VtuOptions, write_vtu};

use souple_elements::{Element, Family};

/// How six-node wedges are written.
///
/// Versions of VTK do not agree which way round a wedge of type 13 is: the shape functions are positive in our order in
/// every version, the surface filter of versions before 9.7 and the cell size of versions before 9.7 are negative.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VtkWedge {
    /// Type 13 in the order that makes det ∂x/∂ξ positive.
    #[default]
    PositiveJacobian,
    /// Type 73, the Lagrange wedge, whose order is the same in every version and whose surface and volume are right
    /// in all of them; fewer programs read it.
    Lagrange,
}

/// VTK's number of the Lagrange hexahedron.
const LAGRANGE_HEXAHEDRON: u8 = 72;
/// VTK's number of the Lagrange wedge.
const LAGRANGE_WEDGE: u8 = 73;

/// What the names of our region arrays start with.
const REGION_PREFIX: &str = "region:";

/// The cell type to write for an element.
fn cell_type(element: &Element, wedge: VtkWedge) -> u8 {
    let linear = element.family == Family::Prism && element.node_count() == Family::Prism.corner_count();
    if linear && wedge == VtkWedge::Lagrange { LAGRANGE_WEDGE } else { element.exchange.vtk }
}
