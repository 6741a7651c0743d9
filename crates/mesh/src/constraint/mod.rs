//! Nodes that must follow others for the mesh to conform: where a quadratic element meets a linear one, and where a
//! fine side meets a coarse one.
//!
//! ```text
//! u_m = Σ_a N_a(ξ_m) u_a        N: interpolation of the coarser side, ξ_m: where node m lies on it
//! ```
//!
//! Displacements on both sides of an interface are then the same function, as long as the finer side can represent
//! that of the coarser one. Found here:
//!
//! * [`Cause::Interpolation`]: sides with the same corners and different interpolations. No position is looked at.
//! * [`Cause::Hanging`]: nodes in the middle of a face of the boundary to which they do not belong. Found by position.
//! * [`Cause::Tie`]: nodes that somebody wants on a surface ([`tie()`]).
//!
//! A node at the place of a node of the other side is not tied to it: that is how cracks are written.
//! What is not here: how an equation is solved under these constraints; that needs the weights only.

mod hanging;
mod interpolation;
mod near;
mod resolve;
mod side;
mod tie;

pub use resolve::{ConstraintError, resolve};
pub use tie::{TieFace, tie};

use crate::mesh::Mesh;
use crate::topology::{FaceId, Topology, exterior};
use side::Shapes;
use std::collections::BTreeMap;

/// Why a node follows others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The other side of its edge or face has an interpolation without it.
    Interpolation,
    /// It lies in the middle of a side of another element.
    Hanging,
    /// It was asked to.
    Tie,
}

/// A node whose displacement is a weighted mean of those of others.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// The node that follows.
    pub node: u32,
    /// The nodes that it follows, ascending, with their weights, whose sum is one.
    pub masters: Vec<(u32, f64)>,
    /// Why.
    pub cause: Cause,
}

impl Constraint {
    /// Distance in m between the node and the place where its masters put it; not zero where a curved side meets a
    /// straight one. Rotations are free of forces only where it is zero.
    pub fn gap(&self, nodes: &[[f64; 3]]) -> f64 {
        let mut apart = nodes[self.node as usize];
        for &(master, weight) in &self.masters {
            (0..3).for_each(|a| apart[a] -= weight * nodes[master as usize][a]);
        }
        crate::geometry::norm(apart)
    }
}

/// What makes a mesh conform.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conformity {
    /// The nodes that follow, ascending. No master is one of them: chains are already put into each other.
    pub constraints: Vec<Constraint>,
    /// Number of faces and edges of other elements that nodes were found on.
    pub sides: usize,
    /// Number of faces on which finer elements lie that cannot follow them between their nodes: displacements are equal
    /// at the nodes and nearly so elsewhere, and patch tests fail. Triangles on a quadrangle of linear elements are such.
    pub rough: usize,
    /// Faces without mate that lie on each other all the same, sorted: no part of the body's skin.
    pub inner: Vec<FaceId>,
}

impl Conformity {
    /// Number of nodes that follow for this reason.
    pub fn count(&self, cause: Cause) -> usize {
        self.constraints.iter().filter(|c| c.cause == cause).count()
    }

    /// The exterior of the body without the faces at which nodes hang.
    pub fn skin(&self, topology: &Topology) -> Vec<FaceId> {
        let mut faces = exterior(topology);
        faces.retain(|face| self.inner.binary_search(face).is_err());
        faces
    }
}

impl std::fmt::Display for Conformity {
    /// `12 hanging nodes and 3 nodes between different interpolations tied to 8 sides`; empty when nothing is tied.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let plural = |n: usize, one: &str, more: &str| format!("{n} {}", if n == 1 { one } else { more });
        let mut parts = Vec::new();
        for (cause, [one, more]) in [
            (Cause::Hanging, ["hanging node", "hanging nodes"]),
            (Cause::Interpolation, ["node between different interpolations", "nodes between different interpolations"]),
        ] {
            let count = self.count(cause);
            parts.extend((count > 0).then(|| plural(count, one, more)));
        }
        if parts.is_empty() {
            return Ok(());
        }
        write!(f, "{} tied to {}", parts.join(" and "), plural(self.sides, "side", "sides"))
    }
}

/// Nodes to be tied, each once, before chains are put into each other.
type Rows = BTreeMap<u32, Constraint>;

/// Finds all nodes that must follow others for the elements of highest dimension to conform.
///
/// # Errors
/// [`ConstraintError::Cycle`] when nodes would follow each other in a circle.
pub fn conformity(mesh: &Mesh, topology: &Topology) -> Result<Conformity, ConstraintError> {
    let mut shapes = Shapes::default();
    let mut rows = Rows::new();
    let glued = interpolation::find(mesh, topology, &mut shapes, &mut rows);
    let hanging::Found { sides, rough, inner } = hanging::find(mesh, topology, &mut shapes, &mut rows);
    let constraints = resolve(rows.into_values().collect())?;
    Ok(Conformity { constraints, sides: glued + sides, rough, inner })
}
