//! Who shares which face: the gluing of the elements of highest dimension.
//!
//! The state is the set of *glued faces*: for each (element, local face) its mate or none. Everything else follows:
//! nodes are the orbits of element corners under "same material corner, across a glued face", so a node whose
//! elements hang together only at the node itself is several nodes, whatever the mesh file says, and no singular node
//! can exist. Opening a face removes it from the set ([`Topology::open`]); the orbits are a function of the set alone,
//! so the order of openings does not matter.
//!
//! Faces have dimension one less than the elements: faces of solids, edges of surfaces, ends of edges. They are known
//! by their corners; nodes that are not corners ride along.
//!
//! What is not here: geometry (positions play no role), elements of lower dimension in a mixed mesh, and the local
//! update of a running simulation, which this structure is the reference for.

mod fan;
mod glue;
mod interface;
mod orbits;
mod surface;

pub(crate) use glue::corner_set;
pub use interface::{Interface, exterior, interfaces};
pub use surface::{Surface, boundary, euler_characteristic, surface};

use crate::mesh::{ElementId, Mesh};
use crate::reference::corner_faces;
use souple_elements::Element;

/// A face of an element, packed: element · 8 + local face.
///
/// Elements are counted over the blocks of highest dimension, in order; [`Topology::id`] and [`Topology::number`]
/// translate.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FaceId(u32);

impl FaceId {
    /// No face: what a face of the boundary is glued to.
    pub const NONE: FaceId = FaceId(u32::MAX);

    /// Local face `face` (below 8) of element `element` (below 2²⁹).
    pub fn new(element: u32, face: usize) -> FaceId {
        FaceId(element << 3 | face as u32)
    }

    /// The element.
    pub fn element(self) -> u32 {
        self.0 >> 3
    }

    /// Index into the element's faces.
    pub fn face(self) -> usize {
        (self.0 & 7) as usize
    }

    /// Whether this is [`FaceId::NONE`].
    pub fn is_none(self) -> bool {
        self == FaceId::NONE
    }
}

impl std::fmt::Debug for FaceId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.is_none() {
            true => write!(f, "none"),
            false => write!(f, "{}/{}", self.element(), self.face()),
        }
    }
}

/// A run of elements of one kind: a block of the mesh that has the highest dimension.
#[derive(Clone, Debug)]
pub struct Run {
    /// Index into [`Mesh::blocks`].
    pub block: u32,
    /// Number of the block's first element.
    pub first: u32,
    /// Number of elements.
    pub count: u32,
    /// What they are.
    pub element: &'static Element,
    /// Local corners of each face.
    pub faces: Vec<&'static [u8]>,
}

/// Gluing of the elements of highest dimension of a mesh. See the module's head for what it means.
#[derive(Clone, Debug)]
pub struct Topology {
    /// Dimension of the elements.
    pub dimension: usize,
    /// The elements by kind.
    pub runs: Vec<Run>,
    /// Where an element's faces begin in `mate`, `[element + 1]`.
    pub face_start: Vec<u32>,
    /// Where an element's corners begin in `corner_material` and `corner_node`, `[element + 1]`.
    pub corner_start: Vec<u32>,
    /// The mesh's node at each corner; fixed for ever.
    pub corner_material: Vec<u32>,
    /// The node (orbit) of each corner. Up to the number of the mesh's nodes, the first orbit over a material node
    /// has its number; further ones follow.
    pub corner_node: Vec<u32>,
    /// The material node of each node, `[node]`.
    pub node_material: Vec<u32>,
    /// The face on the other side, or none; symmetric. `[face]`
    pub mate: Vec<FaceId>,
    /// Faces with the same corners as two or more others, each list sorted; they stay without mate and do not count
    /// as boundary.
    pub non_manifold: Vec<Vec<FaceId>>,
    /// Glued faces that turn the same way on both sides: one of the two elements is inverted, or they overlap.
    pub folded: Vec<[FaceId; 2]>,
    /// Faces that touch a node twice: the element is degenerate there. They have no mate and are no boundary.
    pub collapsed: Vec<FaceId>,
}

/// A mesh whose gluing cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TopologyError {
    /// A block refers to a node that does not exist.
    #[error("element {index} of block {block} ({element}) has node {node}, but the mesh has {nodes} nodes (0 to {})", .nodes.saturating_sub(1))]
    NodeOutOfRange {
        /// Index of the block.
        block: u32,
        /// Index inside the block.
        index: u32,
        /// What the element is.
        element: &'static str,
        /// The node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// More elements than face numbers can hold.
    #[error("{elements} elements: at most {} can be numbered", 1u32 << 29)]
    TooManyElements {
        /// Number of elements.
        elements: usize,
    },
}

impl Topology {
    /// Glues all faces with equal corners.
    ///
    /// # Errors
    /// A node index out of range, or more than 2²⁹ elements.
    pub fn new(mesh: &Mesh) -> Result<Topology, TopologyError> {
        let dimension = mesh.dimension();
        let elements = mesh.element_count();
        if elements >= 1 << 29 {
            return Err(TopologyError::TooManyElements { elements });
        }
        let mut runs: Vec<Run> = Vec::new();
        let (mut face_start, mut corner_start, mut corner_material) = (vec![0], vec![0], Vec::new());
        let mut first = 0;
        for (block, b) in mesh.blocks.iter().enumerate().filter(|(_, b)| b.element.dimension() == dimension) {
            let faces = corner_faces(b.element);
            let corner_count = b.element.family.corner_count();
            for index in 0..b.len() {
                let corners = &b.nodes(index)[..corner_count];
                if let Some(&node) = corners.iter().find(|&&n| n as usize >= mesh.nodes.len()) {
                    let (block, index, element) = (block as u32, index as u32, b.element.id);
                    return Err(TopologyError::NodeOutOfRange { block, index, element, node, nodes: mesh.nodes.len() });
                }
                corner_material.extend_from_slice(corners);
                corner_start.push(corner_material.len() as u32);
                face_start.push(face_start[face_start.len() - 1] + faces.len() as u32);
            }
            let count = b.len() as u32;
            runs.push(Run { block: block as u32, first, count, element: b.element, faces });
            first += count;
        }
        let face_count = face_start[face_start.len() - 1] as usize;
        let mut topology = Topology {
            dimension,
            runs,
            face_start,
            corner_start,
            corner_node: Vec::new(),
            node_material: Vec::new(),
            corner_material,
            mate: vec![FaceId::NONE; face_count],
            non_manifold: Vec::new(),
            folded: Vec::new(),
            collapsed: Vec::new(),
        };
        glue::glue(&mut topology);
        orbits::renew(&mut topology, mesh.nodes.len());
        Ok(topology)
    }

    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.corner_start.len() - 1
    }

    /// Number of nodes, those of no element included.
    pub fn node_count(&self) -> usize {
        self.node_material.len()
    }

    /// The run of an element.
    pub fn run(&self, element: u32) -> &Run {
        let at = self.runs.partition_point(|run| run.first + run.count <= element);
        &self.runs[at]
    }

    /// Where an element lies in the mesh.
    pub fn id(&self, element: u32) -> ElementId {
        let run = self.run(element);
        ElementId { block: run.block, index: element - run.first }
    }

    /// The number of an element; `None` for elements of lower dimension.
    pub fn number(&self, id: ElementId) -> Option<u32> {
        self.runs.iter().find(|run| run.block == id.block && id.index < run.count).map(|run| run.first + id.index)
    }

    /// All faces, in order.
    pub fn faces(&self) -> impl Iterator<Item = FaceId> + '_ {
        self.runs.iter().flat_map(|run| {
            (run.first..run.first + run.count)
                .flat_map(move |element| (0..run.faces.len()).map(move |face| FaceId::new(element, face)))
        })
    }

    /// The face on the other side, or [`FaceId::NONE`].
    pub fn mate(&self, face: FaceId) -> FaceId {
        self.mate[self.slot(face)]
    }

    /// Indices into `corner_material` and `corner_node` of a face's corners, turning as the element lists them
    /// (counter-clockwise seen from outside).
    pub fn face_corners(&self, face: FaceId) -> impl ExactSizeIterator<Item = usize> + '_ {
        let start = self.corner_start[face.element() as usize] as usize;
        self.run(face.element()).faces[face.face()].iter().map(move |&c| start + c as usize)
    }

    /// The material nodes of a face's corners, as [`Topology::face_corners`] orders them.
    pub fn face_material(&self, face: FaceId) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.face_corners(face).map(|c| self.corner_material[c])
    }

    /// Faces without mate, in order: the boundary, oriented outwards as long as no element is inverted.
    ///
    /// Faces of more than two elements and collapsed faces have no mate either, but bound nothing; they are left out.
    pub fn boundary(&self) -> Vec<FaceId> {
        let mut special: Vec<FaceId> = self.non_manifold.iter().flatten().chain(&self.collapsed).copied().collect();
        special.sort_unstable();
        self.faces().filter(|&f| self.mate(f).is_none() && special.binary_search(&f).is_err()).collect()
    }

    /// The boundary faces all of whose corners are in this sorted list of the mesh's nodes.
    pub fn boundary_within(&self, nodes: &[u32]) -> Vec<FaceId> {
        let mut faces = self.boundary();
        faces.retain(|&f| self.face_material(f).all(|n| nodes.binary_search(&n).is_ok()));
        faces
    }

    /// Takes faces, and their mates, out of the gluing, and finds the nodes again.
    ///
    /// Faces without mate are left as they are. Whole-mesh work: proportional to the number of corners.
    pub fn open(&mut self, faces: &[FaceId]) {
        for &face in faces {
            let mate = self.mate(face);
            if !mate.is_none() {
                let (slot, other) = (self.slot(face), self.slot(mate));
                self.mate[slot] = FaceId::NONE;
                self.mate[other] = FaceId::NONE;
            }
        }
        let material_nodes = self.node_material.iter().max().map_or(0, |&n| n as usize + 1);
        orbits::renew(self, material_nodes);
    }

    fn slot(&self, face: FaceId) -> usize {
        self.face_start[face.element() as usize] as usize + face.face()
    }
}
