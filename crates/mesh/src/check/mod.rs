//! Is this mesh fit to compute with? A report for a person, and repairs of what has one obvious cure.
//!
//! Orientation is judged by the determinant of the edge vectors at each corner, which is det J there for linear
//! elements: all positive is good, all negative is inverted (its nodes are listed the other way round, [`repair()`]
//! mirrors it), both signs is tangled (no order of nodes helps). Elements with more nodes than corners are judged by
//! det J at their corners and quadrature points as well: a mid-side node that strays folds the element.
//! On surfaces in space orientation is relative: an element is compared with its own mean normal.
//!
//! What is not here: conformity and manifoldness ([`crate::topology`]).

mod coincidence;
mod jacobian;
mod measure;
mod quality;
mod repair;

pub use coincidence::first_at_same_place;
pub use repair::{Merge, RepairReport, repair};

use crate::geometry::{BoundingBox, tolerance};
use crate::mesh::{ElementId, Mesh};
use jacobian::Judge;

/// Mean-ratio quality below which an element counts as a sliver.
///
/// The mean ratio bounds the condition of the map from the ideal element: at 0.1 the stiffness of the element is an
/// order of magnitude worse conditioned than that of its ideal shape.
pub const SLIVER_QUALITY: f64 = 0.1;

/// What a mesh holds and what is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshReport {
    /// Number of nodes.
    pub nodes: usize,
    /// Kinds of elements with their numbers, in the order of the blocks.
    pub kinds: Vec<(&'static str, usize)>,
    /// Highest dimension of the elements.
    pub dimension: usize,
    /// The box around the nodes; `None` for a mesh without nodes.
    pub bounds: Option<BoundingBox>,
    /// Volume in m³ (area in m², length in m) of the elements of highest dimension; inverted ones count negative.
    pub measure: f64,
    /// Elements whose nodes are listed the other way round.
    pub inverted: Vec<ElementId>,
    /// Elements that are positive in one place and negative in another.
    pub tangled: Vec<ElementId>,
    /// Elements that are flat at a corner: coincident or collinear or coplanar corners.
    pub degenerate: Vec<ElementId>,
    /// Other elements of quality below [`SLIVER_QUALITY`].
    pub slivers: Vec<ElementId>,
    /// Shape quality of the elements of highest dimension; `None` when there are none.
    pub quality: Option<Quality>,
    /// Nodes of no element.
    pub unreferenced: Vec<u32>,
    /// Nodes at the place of an earlier one: (node, that earlier one).
    pub duplicates: Vec<(u32, u32)>,
    /// What the coordinates are probably measured in.
    pub unit: UnitGuess,
}

/// Mean ratio over elements: 1 for the ideal shape of the family, 0 for a degenerate or inverted element.
///
/// At a corner with edge vectors as columns of A and those of the ideal shape as columns of W, T = A W⁻¹ and
/// q = d (det T)^(2/d) / ‖T‖²; an element has the least q of its corners.
/// Reference: P. Knupp, "Algebraic mesh quality metrics", SIAM J. Sci. Comput. 23 (2001), eq. 4.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// The least.
    pub min: f64,
    /// The mean.
    pub mean: f64,
    /// The element with the least; the first one of several.
    pub worst: ElementId,
}

/// A guess at the unit of the coordinates; everything here computes in metres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitGuess {
    /// The largest extent is at most 10: bodies of that many metres or less.
    Metres,
    /// The largest extent is above 10, as for organs in millimetres.
    Millimetres,
    /// Nothing to judge by.
    Unknown,
}

/// A mesh that refers to what is not there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is infinite or not a number.
    #[error("node {node} lies at {position:?}: expected three finite coordinates in metres")]
    NotFinite {
        /// The node.
        node: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A block whose list of nodes is not a whole number of elements.
    #[error("block {block} ({element}) lists {length} nodes, which is no multiple of the {node_count} of one element")]
    RaggedBlock {
        /// Index of the block.
        block: usize,
        /// What its elements are.
        element: &'static str,
        /// Length of its list.
        length: usize,
        /// Nodes of one element.
        node_count: usize,
    },
    /// An element refers to a node that does not exist.
    #[error(
        "element {index} of block {block} ({element}) has node {node}, but the mesh has {nodes} nodes (numbered from 0)"
    )]
    NodeOutOfRange {
        /// Index of the block.
        block: usize,
        /// Index inside the block.
        index: usize,
        /// What it is.
        element: &'static str,
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// A region refers to a node or an element that does not exist.
    #[error("region `{region}` holds {what}, which the mesh does not have")]
    RegionOutOfRange {
        /// Name of the region.
        region: String,
        /// What it refers to.
        what: String,
    },
}

/// Checks that every number in the mesh is finite and every index points at something.
///
/// Everything else in this crate may be called on a mesh that passes.
pub fn validate(mesh: &Mesh) -> Result<(), MeshError> {
    if let Some(node) = mesh.nodes.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite { node, position: mesh.nodes[node] });
    }
    for (block, b) in mesh.blocks.iter().enumerate() {
        let (element, length, node_count) = (b.element.id, b.connectivity.len(), b.element.node_count());
        if length % node_count != 0 {
            return Err(MeshError::RaggedBlock { block, element, length, node_count });
        }
        if let Some(at) = b.connectivity.iter().position(|&n| n as usize >= mesh.nodes.len()) {
            let (index, node, nodes) = (at / node_count, b.connectivity[at], mesh.nodes.len());
            return Err(MeshError::NodeOutOfRange { block, index, element, node, nodes });
        }
    }
    for (name, region) in &mesh.regions {
        let node = region.nodes.iter().find(|&&n| n as usize >= mesh.nodes.len());
        let exists = |e: &ElementId| mesh.blocks.get(e.block as usize).is_some_and(|b| (e.index as usize) < b.len());
        let element = region.elements.iter().find(|e| !exists(e));
        let what = node.map(|n| format!("node {n}"));
        let what = what.or_else(|| element.map(|e| format!("element {} of block {}", e.index, e.block)));
        if let Some(what) = what {
            return Err(MeshError::RegionOutOfRange { region: name.clone(), what });
        }
    }
    Ok(())
}

/// Looks at every node and element.
///
/// # Errors
/// Those of [`validate`]: with numbers or indices missing there is nothing to report on.
pub fn report(mesh: &Mesh) -> Result<MeshReport, MeshError> {
    validate(mesh)?;
    let dimension = mesh.dimension();
    let flat = is_flat(mesh);
    let (mut inverted, mut tangled, mut degenerate, mut slivers) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut sum, mut count, mut least): (f64, usize, Option<(f64, ElementId)>) = (0.0, 0, None);
    let (mut measure, mut points) = (Sum::default(), Vec::new());
    for (block, b) in mesh.blocks.iter().enumerate() {
        let judge = Judge::new(b.element, flat);
        let meter = measure::Meter::new(b.element, flat);
        for index in 0..b.len() {
            let id = ElementId { block: block as u32, index: index as u32 };
            points.clear();
            points.extend(b.nodes(index).iter().map(|&n| mesh.nodes[n as usize]));
            let judgement = judge.judge(&points);
            match judgement.orientation {
                jacobian::Orientation::Inverted => inverted.push(id),
                jacobian::Orientation::Tangled => tangled.push(id),
                jacobian::Orientation::Degenerate => degenerate.push(id),
                jacobian::Orientation::Good if judgement.quality < SLIVER_QUALITY => slivers.push(id),
                jacobian::Orientation::Good => {}
            }
            if b.element.dimension() == dimension {
                measure.add(meter.measure(&points));
                sum += judgement.quality;
                count += 1;
                if least.is_none_or(|(quality, _)| judgement.quality < quality) {
                    least = Some((judgement.quality, id));
                }
            }
        }
    }
    let bounds = BoundingBox::around(&mesh.nodes);
    let first = first_at_same_place(&mesh.nodes, tolerance(mesh));
    let duplicates = first.iter().zip(0u32..).filter(|(first, node)| *first != node).map(|(&f, n)| (n, f)).collect();
    Ok(MeshReport {
        nodes: mesh.nodes.len(),
        kinds: mesh.blocks.iter().map(|b| (b.element.id, b.len())).collect(),
        dimension,
        bounds,
        measure: measure.value(),
        inverted,
        tangled,
        degenerate,
        slivers,
        quality: least.map(|(min, worst)| Quality { min, mean: sum / count as f64, worst }),
        unreferenced: unreferenced(mesh),
        duplicates,
        unit: guess_unit(bounds),
    })
}

/// The quality of every element, 1 for the ideal shape of its family, `[block][element]`; see [`Quality`].
///
/// # Errors
/// Those of [`validate`].
pub fn qualities(mesh: &Mesh) -> Result<Vec<Vec<f64>>, MeshError> {
    validate(mesh)?;
    let flat = is_flat(mesh);
    let of_block = |b: &crate::mesh::Block| {
        let judge = Judge::new(b.element, flat);
        let points = |index| b.nodes(index).iter().map(|&n| mesh.nodes[n as usize]).collect::<Vec<_>>();
        (0..b.len()).map(|index| judge.judge(&points(index)).quality).collect()
    };
    Ok(mesh.blocks.iter().map(of_block).collect())
}

/// A sum that keeps the digits that plain addition drops (Neumaier): a million volumes add up to the body's to the
/// last digits.
#[derive(Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - sum) + x } else { (x - sum) + self.sum };
        self.sum = sum;
    }

    fn value(&self) -> f64 {
        self.sum + self.lost
    }
}

/// Whether the mesh is a flat one in a plane of constant z, where "inverted" has a meaning for surfaces.
fn is_flat(mesh: &Mesh) -> bool {
    let thickness = BoundingBox::around(&mesh.nodes).map_or(0.0, |b| b.extent()[2]);
    mesh.dimension() == 2 && thickness <= tolerance(mesh)
}

fn unreferenced(mesh: &Mesh) -> Vec<u32> {
    let mut used = vec![false; mesh.nodes.len()];
    mesh.blocks.iter().flat_map(|b| &b.connectivity).for_each(|&n| used[n as usize] = true);
    (0..mesh.nodes.len() as u32).filter(|&n| !used[n as usize]).collect()
}

fn guess_unit(bounds: Option<BoundingBox>) -> UnitGuess {
    let largest = bounds.map_or(0.0, |b| b.extent().into_iter().fold(0.0, f64::max));
    match largest {
        0.0 => UnitGuess::Unknown,
        l if l > 10.0 => UnitGuess::Millimetres,
        _ => UnitGuess::Metres,
    }
}
