//! From a scene to everything that a model is made of: meshes read or generated, regions found, materials assigned,
//! constraints and loads per node.

use souple_mesh::Mesh;
use souple_operators::BlockSpec;

/// A scene with its meshes read and its regions found. Nodes of all bodies are numbered one after the other.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Number of space dimensions: those of the elements (2 means plane strain).
    pub dimension: usize,
    /// The bodies' meshes, nodes that no element uses dropped, in scene order.
    pub bodies: Vec<PreparedBody>,
    /// Rest positions of all nodes in m, [node][axis].
    pub nodes: Vec<[f64; 3]>,
    /// The elements that deform, grouped by element, law, rule, parameters and density.
    pub blocks: Vec<BlockSpec>,
    /// Fixed axes: global nodes (sorted) and which of their axes are held at rest.
    pub fixed: Vec<(Vec<u32>, [bool; 3])>,
    /// Moved regions: global nodes and index into the body's `moves` of the scene.
    pub moved: Vec<MovedNodes>,
    /// Loads.
    pub loads: Vec<Load>,
    /// Initial velocities, [node][axis].
    pub velocities: Vec<[f64; 3]>,
    /// Nodes and elements of each probe, in scene order.
    pub probes: Vec<ProbeRegion>,
}

/// One body of a prepared scene.
#[derive(Clone, Debug)]
pub struct PreparedBody {
    /// Its name.
    pub name: String,
    /// Its mesh.
    pub mesh: Mesh,
    /// Global index of its first node.
    pub first_node: u32,
    /// Global number ([`BlockSpec::ids`]) of its first deformable element; they follow the order of the mesh's blocks
    /// of the highest dimension.
    pub first_element: u32,
    /// What reading or generating the mesh had to report, in words.
    pub report: String,
}

/// Nodes whose motion is prescribed.
#[derive(Clone, Debug)]
pub struct MovedNodes {
    /// Global node indices, sorted.
    pub nodes: Vec<u32>,
    /// Body and index into its `moves`.
    pub source: (usize, usize),
}

/// A load that does not depend on the deformation: forces per node times a factor of time.
#[derive(Clone, Debug)]
pub struct Load {
    /// Global nodes and the force on each in N.
    pub forces: Vec<(u32, [f64; 3])>,
    /// Times and factors, linear in between, held outside; empty means one.
    pub factor: Vec<(f64, f64)>,
}

/// What a probe looks at.
#[derive(Clone, Debug)]
pub struct ProbeRegion {
    /// Global nodes, sorted.
    pub nodes: Vec<u32>,
    /// Global element numbers, sorted.
    pub elements: Vec<u32>,
}
