//! What there is to draw: the surfaces of all bodies, cut once into triangles that follow the nodes.
//!
//! ```text
//! solids       faces of one element only (the boundary)
//! membranes    the elements themselves
//! cables       lines
//! ```
//!
//! Nothing here knows a graphics device or a position: triangles and lines name nodes. Insides are never cut into
//! triangles beforehand, so that memory follows the surface and not the volume.

use crate::geometry::Vector;
use crate::triangles::outline;
use souple_simulation::Simulation;
use souple_simulation::elements::{Element, Family};
use souple_simulation::mesh::{ElementId, Mesh};
use souple_simulation::surface::{self, triangles};

/// An element as pictures know it.
#[derive(Clone, Debug)]
pub struct DrawnElement {
    /// What it is.
    pub kind: &'static Element,
    /// Index into [`Model::materials`].
    pub material: u32,
    /// Index into [`Model::bodies`].
    pub body: u32,
    /// Part of the matrix' rows that its first node belongs to.
    pub part: u32,
    /// Where it is in the body's mesh.
    pub id: ElementId,
    /// Shape quality at rest, 1 for the ideal shape, not positive for an inverted element.
    pub quality: f32,
}

/// A block of like elements in words.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnMaterial {
    /// The law.
    pub law: &'static str,
    /// The law with its first parameters: `"stvk, young 20 kPa"`.
    pub label: String,
}

/// Triangles and lines on numbered nodes.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// Nodes of each triangle, turning counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The element of each triangle.
    pub owners: Vec<u32>,
    /// The face that each triangle is part of, counted over the whole skin.
    pub faces: Vec<u32>,
    /// Edges of elements, as pieces from node to node.
    pub edges: Vec<[u32; 2]>,
    /// The element of each piece.
    pub edge_owners: Vec<u32>,
    /// Number of faces.
    pub face_count: u32,
}

/// All that a picture needs to know once.
#[derive(Clone, Debug)]
pub struct Model {
    /// Title of the scene.
    pub title: String,
    /// Rest positions in m, [node][axis].
    pub rest: Vec<Vector>,
    /// Elements by their number.
    pub elements: Vec<DrawnElement>,
    /// Blocks of like elements.
    pub materials: Vec<DrawnMaterial>,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// The bodies' meshes, with the number of their first node.
    meshes: Vec<(Mesh, u32)>,
    /// What is seen from outside.
    pub skin: Skin,
    /// Cables: node to node, with their elements.
    pub cables: Vec<([u32; 2], u32)>,
    /// Nodes held by the scene, by number.
    pub fixed: Vec<u32>,
    /// Upwards, not a unit vector: against gravity, zero without.
    pub up: Vector,
    /// Whether elements fill space (and have an inside to look into).
    pub solid: bool,
}

impl Model {
    /// The model of a simulation.
    pub fn of(simulation: &Simulation) -> Model {
        let prepared = simulation.prepared();
        let count = simulation.element_count();
        let mut materials = Vec::new();
        let mut block_of = vec![0u32; count];
        for (number, block) in (0u32..).zip(&prepared.blocks) {
            materials.push(DrawnMaterial {
                law: block.law.id,
                label: described(block.law.id, block.law.parameters, &block.parameters),
            });
            block.ids.iter().for_each(|&id| block_of[id as usize] = number);
        }
        let mut model = Model {
            title: simulation.scene().title.clone(),
            rest: prepared.nodes.iter().map(|n| n.map(|x| x as f32)).collect(),
            elements: Vec::with_capacity(count),
            materials,
            bodies: prepared.bodies.iter().map(|b| b.name.clone()).collect(),
            meshes: prepared.bodies.iter().map(|b| (b.mesh.clone(), b.first_node)).collect(),
            skin: Skin::default(),
            cables: Vec::new(),
            fixed: prepared.fixed.iter().flat_map(|(nodes, _)| nodes.iter().copied()).collect(),
            up: simulation.scene().gravity.map(|g| -g as f32),
            solid: false,
        };
        let parts = simulation.parts_of_elements();
        for (body, (number, b)) in prepared.bodies.iter().zip((0u32..).zip(&model.meshes)) {
            // A mesh that was prepared is sound; without qualities every element counts as ideal.
            let qualities = souple_simulation::mesh::check::qualities(&b.0).unwrap_or_default();
            let quality_of = |id: ElementId| -> f64 {
                qualities.get(id.block as usize).and_then(|q| q.get(id.index as usize)).copied().unwrap_or(1.0)
            };
            for &id in &body.elements {
                let (material, part) = (block_of[model.elements.len()], parts[model.elements.len()]);
                let quality = quality_of(id) as f32;
                model.elements.push(DrawnElement { kind: body.element(id), material, body: number, part, id, quality });
            }
        }
        for face in surface::faces(prepared) {
            model.skin.add(face.kind, &face.nodes, face.element);
        }
        for element in 0..model.elements.len() as u32 {
            let kind = model.elements[element as usize].kind;
            model.solid |= kind.dimension() == 3;
            if kind.dimension() == 1 {
                let nodes = model.nodes_of(element);
                model.cables.extend(outline(kind).iter().map(|p| (p.map(|n| nodes[n as usize]), element)));
            }
        }
        model
    }

    /// The nodes of an element.
    pub fn nodes_of(&self, element: u32) -> Vec<u32> {
        self.node_numbers(element).collect()
    }

    /// The same, one after the other.
    pub fn node_numbers(&self, element: u32) -> impl Iterator<Item = u32> + '_ {
        let drawn = &self.elements[element as usize];
        let (mesh, first) = &self.meshes[drawn.body as usize];
        mesh.nodes_of(drawn.id).iter().map(move |n| n + first)
    }

    /// All faces of these solid elements, whoever shares them; elements of other kinds as they are in the skin.
    pub fn faces_of(&self, elements: impl Iterator<Item = u32>) -> Skin {
        let mut skin = Skin::default();
        for owner in elements {
            let kind = self.elements[owner as usize].kind;
            let nodes = self.nodes_of(owner);
            match kind.dimension() {
                3 => {
                    for side in kind.faces {
                        let Some(face) = souple_simulation::elements::by_id(side.element) else { continue };
                        let nodes: Vec<u32> = side.nodes.iter().map(|&n| nodes[n as usize]).collect();
                        skin.add(face, &nodes, owner);
                    }
                }
                2 => skin.add(kind, &nodes, owner),
                _ => {}
            }
        }
        skin
    }

    /// Families that occur, in order, each with its number of elements.
    pub fn families(&self) -> Vec<(Family, usize)> {
        let count = |family| (family, self.elements.iter().filter(|e| e.kind.family == family).count());
        Family::ALL.into_iter().map(count).filter(|f| f.1 > 0).collect()
    }

    /// An element in words: "hex8 number 17 of body `bar`, stvk, young 20 kPa".
    pub fn describe(&self, element: u32) -> String {
        let e = &self.elements[element as usize];
        let (body, material) = (&self.bodies[e.body as usize], &self.materials[e.material as usize].label);
        format!("{} number {} of body `{body}`, {material}", e.kind.id, e.id.index)
    }
}

impl Skin {
    /// Adds a face with its outline.
    fn add(&mut self, kind: &'static Element, nodes: &[u32], owner: u32) {
        for triangle in triangles(kind).iter() {
            self.triangles.push(triangle.map(|n| nodes[n as usize]));
            self.owners.push(owner);
            self.faces.push(self.face_count);
        }
        for piece in outline(kind).iter() {
            self.edges.push(piece.map(|n| nodes[n as usize]));
            self.edge_owners.push(owner);
        }
        self.face_count += 1;
    }

    /// The elements that own a face, each once, in order.
    pub fn elements(&self) -> Vec<u32> {
        let mut owners = self.owners.clone();
        owners.sort_unstable();
        owners.dedup();
        owners
    }
}

/// A law with its first three parameters, for legends.
fn described(law: &str, parameters: &[souple_simulation::laws::Parameter], values: &[f64]) -> String {
    let mut text = law.to_owned();
    for (parameter, &value) in parameters.iter().zip(values).take(3) {
        let unit = if parameter.unit == "1" { "" } else { parameter.unit };
        text += &format!(", {} {}", parameter.name, crate::numbers::with_unit(value, unit));
    }
    text
}
