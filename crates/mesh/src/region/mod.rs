//! Regions: parts of a mesh described by name, shape, element kind or depth, and combined.
//!
//! A selection is a set of nodes and a set of elements, found independently: nodes by their position, elements by the
//! mean of their corners. Geometric selectors include their border within [`crate::tolerance`].
//! Combinations act on the two sets separately; so `Not(Named("x_min"))`, where `x_min` is a set of nodes, is the
//! other nodes and every element.
//!
//! What is not here: the spelling of regions in scenes, and what a selection is used for. A caller that needs nodes
//! asks for [`nodes`], one that needs elements for [`elements`]; each of them refuses a selection that is empty in
//! that respect, and says what there would have been.

mod depth;
mod name;

pub use depth::SurfaceDistance;

use crate::constraint::conformity;
use crate::geometry::{BoundingBox, dot, minus, norm, tolerance};
use crate::mesh::{ElementId, Mesh, Region, sorted_set};
use crate::topology::{Topology, TopologyError, exterior, surface};

/// A description of a part of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum RegionSpec {
    /// Everything.
    All,
    /// A region of the mesh ([`Mesh::regions`]); elements listed there bring their nodes.
    Named(String),
    /// An axis-parallel box, border included.
    Box {
        /// Lower corner in metres.
        min: [f64; 3],
        /// Upper corner in metres.
        max: [f64; 3],
    },
    /// A ball, border included.
    Sphere {
        /// Centre in metres.
        centre: [f64; 3],
        /// Radius in metres.
        radius: f64,
    },
    /// The side of a plane that its normal points to, the plane included.
    Plane {
        /// A point of the plane, in metres.
        point: [f64; 3],
        /// Its normal; any length but 0.
        normal: [f64; 3],
    },
    /// The elements of one kind (`"tet4"`) and their nodes.
    Element(String),
    /// What lies at most this deep under the exterior of the body.
    DistanceToSurface {
        /// Depth in metres.
        below: f64,
    },
    /// What is in all of them; everything for an empty list.
    And(Vec<RegionSpec>),
    /// What is in any of them; nothing for an empty list.
    Or(Vec<RegionSpec>),
    /// What is not in it.
    Not(Box<RegionSpec>),
}

/// A region that cannot be evaluated, or that is empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// No region of this name.
    #[error("no region is called `{name}`{}; the mesh has {}", name::hint(.nearest.as_deref()), name::list(.known))]
    UnknownName {
        /// What was asked for.
        name: String,
        /// The most similar name, if one is similar.
        nearest: Option<String>,
        /// The names that exist, sorted.
        known: Vec<String>,
    },
    /// No element of this kind in the mesh.
    #[error("the mesh has no element `{id}`{}; it has {}", name::hint(.nearest.as_deref()), name::list(.known))]
    UnknownElement {
        /// What was asked for.
        id: String,
        /// The most similar kind, if one is similar.
        nearest: Option<String>,
        /// The kinds that the mesh has.
        known: Vec<String>,
    },
    /// A shape whose numbers make no sense.
    #[error("{what}")]
    Shape {
        /// Which number, what it is, what was expected.
        what: String,
    },
    /// The region holds none of what is needed.
    #[error("the region selects no {what} of the mesh, which fills {bounds} and has the regions {}", name::list(.known))]
    Empty {
        /// `"node"`, `"element"`, or both.
        what: &'static str,
        /// Where the mesh is; `"no space"` when it has no node.
        bounds: String,
        /// The names that exist, sorted.
        known: Vec<String>,
    },
    /// The boundary could not be found.
    #[error(transparent)]
    Topology(#[from] TopologyError),
}

/// The nodes and elements of a region; an error when it has neither.
pub fn select(mesh: &Mesh, spec: &RegionSpec) -> Result<Region, RegionError> {
    let region = evaluate(mesh, spec)?;
    match region.nodes.is_empty() && region.elements.is_empty() {
        true => Err(empty(mesh, "node and no element")),
        false => Ok(region),
    }
}

/// The nodes of a region, sorted; an error when it has none.
pub fn nodes(mesh: &Mesh, spec: &RegionSpec) -> Result<Vec<u32>, RegionError> {
    let region = evaluate(mesh, spec)?;
    if region.nodes.is_empty() { Err(empty(mesh, "node")) } else { Ok(region.nodes) }
}

/// The elements of a region, sorted, of whatever dimension; an error when it has none.
pub fn elements(mesh: &Mesh, spec: &RegionSpec) -> Result<Vec<ElementId>, RegionError> {
    let region = evaluate(mesh, spec)?;
    if region.elements.is_empty() { Err(empty(mesh, "element")) } else { Ok(region.elements) }
}

fn empty(mesh: &Mesh, what: &'static str) -> RegionError {
    let bounds = BoundingBox::around(&mesh.nodes).map_or_else(|| "no space".to_owned(), |b| b.to_string());
    RegionError::Empty { what, bounds, known: mesh.regions.keys().cloned().collect() }
}

/// The region, empty or not.
///
/// # Errors
/// An unknown name or kind, a shape that makes no sense, or a mesh whose boundary cannot be found.
pub fn evaluate(mesh: &Mesh, spec: &RegionSpec) -> Result<Region, RegionError> {
    let tolerance = tolerance(mesh);
    match spec {
        RegionSpec::All => Ok(everything(mesh)),
        RegionSpec::Named(name) => named(mesh, name),
        RegionSpec::Element(id) => of_kind(mesh, id),
        RegionSpec::Box { min, max } => {
            if !(0..3).all(|a| min[a] <= max[a]) {
                let what =
                    format!("the box from {min:?} to {max:?} is empty: expected each of the first below the second");
                return Err(RegionError::Shape { what });
            }
            Ok(by_position(mesh, |p| (0..3).all(|a| p[a] >= min[a] - tolerance && p[a] <= max[a] + tolerance)))
        }
        RegionSpec::Sphere { centre, radius } => {
            if !(*radius >= 0.0 && centre.iter().all(|x| x.is_finite())) {
                let what =
                    format!("the sphere around {centre:?} has the radius {radius}: expected numbers, radius ≥ 0");
                return Err(RegionError::Shape { what });
            }
            Ok(by_position(mesh, |p| norm(minus(p, *centre)) <= radius + tolerance))
        }
        RegionSpec::Plane { point, normal } => {
            let length = norm(*normal);
            if !(length > 0.0 && length.is_finite() && point.iter().all(|x| x.is_finite())) {
                let what =
                    format!("the plane through {point:?} has the normal {normal:?}: expected numbers, not all 0");
                return Err(RegionError::Shape { what });
            }
            Ok(by_position(mesh, |p| dot(minus(p, *point), *normal) >= -tolerance * length))
        }
        RegionSpec::DistanceToSurface { below } => {
            if below.is_nan() || *below < 0.0 {
                let what = format!("the distance to the surface is {below}: expected a depth of at least 0 metres");
                return Err(RegionError::Shape { what });
            }
            let topology = Topology::new(mesh)?;
            // Faces that do not match those that they lie on are inside the body.
            let outside = conformity(mesh, &topology).map_or_else(|_| exterior(&topology), |c| c.skin(&topology));
            let skin = surface(mesh, &topology, &outside);
            let surface = SurfaceDistance::new(&skin.mesh);
            Ok(by_position(mesh, |p| surface.within(p, below + tolerance)))
        }
        RegionSpec::And(parts) => parts.iter().try_fold(everything(mesh), |all, part| {
            let part = evaluate(mesh, part)?;
            let nodes = all.nodes.into_iter().filter(|n| part.nodes.binary_search(n).is_ok()).collect();
            let elements = all.elements.into_iter().filter(|e| part.elements.binary_search(e).is_ok()).collect();
            Ok(Region { nodes, elements })
        }),
        RegionSpec::Or(parts) => {
            let (mut nodes, mut elements) = (Vec::new(), Vec::new());
            for part in parts {
                let part = evaluate(mesh, part)?;
                nodes.extend(part.nodes);
                elements.extend(part.elements);
            }
            Ok(Region { nodes: sorted_set(nodes), elements: sorted_set(elements) })
        }
        RegionSpec::Not(part) => {
            let (mut all, part) = (everything(mesh), evaluate(mesh, part)?);
            all.nodes.retain(|n| part.nodes.binary_search(n).is_err());
            all.elements.retain(|e| part.elements.binary_search(e).is_err());
            Ok(all)
        }
    }
}

fn everything(mesh: &Mesh) -> Region {
    Region { nodes: (0..mesh.nodes.len() as u32).collect(), elements: mesh.element_ids().collect() }
}

fn named(mesh: &Mesh, name: &str) -> Result<Region, RegionError> {
    let Some(region) = mesh.regions.get(name) else {
        let known: Vec<String> = mesh.regions.keys().cloned().collect();
        return Err(RegionError::UnknownName { name: name.to_owned(), nearest: name::nearest(name, &known), known });
    };
    let of_elements = region.elements.iter().flat_map(|&e| mesh.nodes_of(e)).copied();
    let nodes = sorted_set(region.nodes.iter().copied().chain(of_elements));
    Ok(Region { nodes, elements: sorted_set(region.elements.iter().copied()) })
}

fn of_kind(mesh: &Mesh, id: &str) -> Result<Region, RegionError> {
    let of_kind: Vec<ElementId> =
        mesh.element_ids().filter(|e| mesh.blocks[e.block as usize].element.id == id).collect();
    if of_kind.is_empty() {
        let present = mesh.blocks.iter().filter(|b| !b.is_empty());
        let known: Vec<String> = present.map(|b| b.element.id.to_owned()).collect();
        return Err(RegionError::UnknownElement { id: id.to_owned(), nearest: name::nearest(id, &known), known });
    }
    let nodes = sorted_set(of_kind.iter().flat_map(|&e| mesh.nodes_of(e)).copied());
    Ok(Region { nodes, elements: of_kind })
}

fn by_position(mesh: &Mesh, inside: impl Fn([f64; 3]) -> bool) -> Region {
    Region {
        nodes: (0..mesh.nodes.len() as u32).filter(|&n| inside(mesh.nodes[n as usize])).collect(),
        elements: mesh.element_ids().filter(|&e| inside(mesh.centroid(e))).collect(),
    }
}
