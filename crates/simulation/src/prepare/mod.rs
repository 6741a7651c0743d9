//! From a scene to everything that a model is made of: meshes read or generated, regions found, materials assigned,
//! constraints and loads per node.
//!
//! ```text
//! Scene ── unsupported ──► refused or not
//!   [body.mesh] ── meshes, check ──► meshes in metres, fit to compute with
//!   [[body.material]] ── parameters, materials ──► blocks of like elements
//!   [[body.fix]], [[body.move]], [[probe]] ── regions, conditions ──► nodes and elements
//!   conforming, [[tie]] ── constraints ──► nodes that follow others
//!   [[body.force]], [[body.traction]] ── loads ──► forces on nodes
//! ```
//!
//! Nothing here opens a file or computes a force of the body itself. All problems are found in one go, each with its
//! place in the scene.

mod catalogue;
mod check;
mod conditions;
mod constraints;
mod embedded;
mod error;
pub mod judge;
mod loads;
mod materials;
mod mesh_files;
mod meshes;
mod parameters;
mod regions;
#[cfg(test)]
mod tests;
mod unsupported;

pub use catalogue::catalogue;
pub use error::{PrepareError, PrepareProblem};
pub use mesh_files::mesh_files;
pub use meshes::Read;

use error::Findings;
use regions::Place;
use souple_elements::Element;
use souple_mesh::constraint::{Conformity, Constraint};
use souple_mesh::{ElementId, Mesh};
use souple_operators::BlockSpec;
use souple_scene::{Location, Scene};

/// A scene with its meshes read and its regions found. Nodes of all bodies are numbered one after the other.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Number of space dimensions: those of the elements that fill their space (2 means plane strain); 3 with membranes.
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
    /// Nodes that follow others, by global indices, ascending; no master follows anybody.
    pub constraints: Vec<Constraint>,
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
    /// Global number ([`BlockSpec::ids`]) of its first deformable element.
    pub first_element: u32,
    /// Its deformable elements in the order in which they are numbered: those of the mesh's highest dimension, then those
    /// of lower dimension that a material makes membranes or cables; each part in the order of the mesh.
    pub elements: Vec<ElementId>,
    /// Number of space dimensions; more than the mesh's highest one for a body of membranes or cables alone.
    pub dimension: usize,
    /// What makes the mesh conform, by nodes of the mesh; nothing where the scene wants it left as it is.
    pub conformity: Conformity,
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

/// Prepares a scene: reads or generates its meshes, finds its regions and assigns its materials.
///
/// `scene_file` is only used in messages. `read` gives the bytes of a mesh file, named as the scene names it: relative
/// to the scene's folder. The texts beside the result are warnings, `scene.toml:12:9: warning: …`.
///
/// # Errors
/// Everything that is wrong: meshes that cannot be read or computed with, regions that select nothing, elements without
/// material, parameters out of range, loads and laws that are not supported yet.
pub fn prepare(
    scene: &Scene,
    scene_file: &str,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<(Prepared, Vec<String>), PrepareError> {
    let mut findings = Findings::default();
    unsupported::refuse(scene, &mut findings);
    let (bodies, dimension) = bodies(scene, read, &mut findings);

    let places: Vec<Option<Place<'_>>> = scene
        .bodies
        .iter()
        .zip(&bodies)
        .map(|(scene, body)| body.as_ref().map(|body| Place { scene: &scene.value, body }))
        .collect();
    let (mut blocks, mut loads, mut fixed, mut moved) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut nodes, mut velocities) = (Vec::new(), Vec::new());
    for (index, place) in places.iter().enumerate() {
        let Some(place) = *place else { continue };
        nodes.extend_from_slice(&place.body.mesh.nodes);
        velocities.resize(nodes.len(), place.scene.initial_velocity);
        conditions::keep_in_space(scene, place.scene, dimension, &mut findings);
        materials::group(place, &mut blocks, &mut findings);
        conditions::constrain(place, index, dimension, &mut fixed, &mut moved, &mut findings);
        loads::load(place, &mut loads, &mut findings);
    }
    let constraints = constraints::gather(scene, &places, &mut findings);
    constraints::check_prescribed(&constraints, scene, &places, &fixed, &moved, &mut findings);
    let probes = scene.probes.iter().map(|probe| conditions::probe(probe, &places, &mut findings)).collect();

    let warnings = findings.outcome(scene_file)?;
    let bodies = bodies.into_iter().flatten().collect();
    let prepared = Prepared { dimension, bodies, nodes, blocks, fixed, moved, loads, constraints, velocities, probes };
    Ok((prepared, warnings))
}

/// The bodies with their meshes, `None` where there was a problem, and the dimension of their space.
fn bodies(scene: &Scene, read: meshes::Read<'_>, findings: &mut Findings) -> (Vec<Option<PreparedBody>>, usize) {
    let mut bodies: Vec<Option<PreparedBody>> =
        scene.bodies.iter().map(|body| meshes::mesh_of(&body.value, read, findings)).collect();
    // Bodies of cables alone fit into any space but a line: they follow the others.
    let free: Vec<bool> =
        bodies.iter().map(|b| b.as_ref().is_some_and(|b| b.mesh.dimension() == 1 && b.dimension > 1)).collect();
    let mut first: Option<(usize, String, Location)> = None;
    let fixed_first = (0..bodies.len()).filter(|&k| !free[k]).chain((0..bodies.len()).filter(|&k| free[k]));
    for k in fixed_first.collect::<Vec<_>>() {
        let Some(body) = &mut bodies[k] else { continue };
        let at = meshes::place(&scene.bodies[k]);
        let (known, other, place) = first.get_or_insert_with(|| (body.dimension, body.name.clone(), at.clone()));
        let name = &body.name;
        if free[k] && *known == 2 {
            if !check::lies_in_its_space(&body.mesh, 1, 2) {
                let message = format!(
                    "the cables of body \"{name}\" do not lie in one plane of constant z, and body \"{other}\" ({place}) is \
                     a plane one; put them into that plane, or make separate scenes"
                );
                findings.problem(at, message);
                bodies[k] = None;
            } else {
                body.dimension = 2;
            }
        } else if *known != body.dimension {
            let message = format!(
                "body \"{name}\" has elements of dimension {}, body \"{other}\" ({place}) of dimension {known}; \
                 all bodies of a scene have one dimension: make separate scenes, or give faces a `thickness` and edges a \
                 `section` in their [[body.material]] to put them into space",
                body.dimension
            );
            findings.problem(at, message);
            bodies[k] = None;
        }
    }
    let (mut first_node, mut first_element) = (0u32, 0u32);
    for (slot, scene) in bodies.iter_mut().zip(&scene.bodies) {
        let Some(body) = slot else { continue };
        (body.first_node, body.first_element) = (first_node, first_element);
        let count = |first: u32, more: usize| u32::try_from(more).ok().and_then(|more| first.checked_add(more));
        let (Some(next_node), Some(next_element)) =
            (count(first_node, body.mesh.nodes.len()), count(first_element, body.elements.len()))
        else {
            let message = format!("with body \"{}\" the scene has more than {} nodes or elements", body.name, u32::MAX);
            findings.problem(meshes::place(scene), message);
            *slot = None;
            continue;
        };
        (first_node, first_element) = (next_node, next_element);
    }
    // Without any mesh there is a problem already, and nothing depends on the dimension.
    (bodies, first.map_or(3, |first| first.0))
}

impl Prepared {
    /// An element in words, for messages: "hex8 number 17 of body `bar` (nodes 3, 4, …)".
    ///
    /// `id` is a global element number ([`BlockSpec::ids`]). The number in the text counts the elements of this kind in
    /// the body from 0, the nodes are those of the body's mesh, from 0.
    pub fn describe_element(&self, id: u32) -> String {
        let found = self.bodies.iter().rev().find(|body| body.first_element <= id);
        let located = found.and_then(|body| Some((body, body.id_in_body(id - body.first_element)?)));
        match located {
            Some((body, element)) => described(&body.mesh, &body.name, element),
            None => format!("element {id}, which the scene does not have"),
        }
    }
}

impl PreparedBody {
    /// Kinds of deformable elements with their numbers, in the order of the numbering.
    pub fn kinds(&self) -> Vec<(&'static Element, usize)> {
        let mut kinds: Vec<(&'static Element, usize)> = Vec::new();
        for id in &self.elements {
            let element = self.element(*id);
            match kinds.iter_mut().find(|known| known.0.id == element.id) {
                Some(known) => known.1 += 1,
                None => kinds.push((element, 1)),
            }
        }
        kinds
    }

    /// What an element of the mesh is.
    pub fn element(&self, id: ElementId) -> &'static Element {
        self.mesh.blocks[id.block as usize].element
    }

    /// Number of each deformable element from 0 in this body, by the elements' ids, sorted.
    pub fn numbers(&self) -> Vec<(ElementId, u32)> {
        let mut numbers: Vec<(ElementId, u32)> = self.elements.iter().copied().zip(0..).collect();
        numbers.sort_unstable();
        numbers
    }

    /// The element of the mesh with this number in the body; `None` when there are fewer.
    pub fn id_in_body(&self, number: u32) -> Option<ElementId> {
        self.elements.get(number as usize).copied()
    }
}

/// Nodes of an element in a message before the rest is left out.
const SHOWN_NODES: usize = 8;

/// An element in words.
fn described(mesh: &Mesh, body: &str, id: ElementId) -> String {
    let nodes = mesh.nodes_of(id);
    let mut shown: Vec<String> = nodes.iter().take(SHOWN_NODES).map(u32::to_string).collect();
    if nodes.len() > SHOWN_NODES {
        shown.push("…".to_owned());
    }
    let kind = mesh.blocks[id.block as usize].element.id;
    format!("{kind} number {} of body `{body}` (nodes {})", id.index, shown.join(", "))
}
