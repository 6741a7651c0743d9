//! What browsers draw: the surface of all bodies as triangles, edges and cables on the nodes that lie there.
//!
//! Pages know surface nodes only, numbered from 0 in the order of the simulation's nodes; what lies inside is never sent.
//! The surface is cut once; afterwards only positions change.

use souple_simulation::Simulation;
use souple_simulation::elements::{Element, Family};
use souple_simulation::surface::{faces, triangles};
use std::collections::{BTreeMap, BTreeSet};

/// The kinds of groups that elements are sorted into, in the order of [`Surface::groups`].
pub const GROUPINGS: [&str; 4] = ["element", "law", "material", "body"];

/// A group of elements that share a colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// What people read.
    pub name: String,
    /// Its colour.
    pub colour: crate::colours::Colour,
}

/// The surface of a simulation.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The simulation's node of each surface node, ascending.
    pub nodes: Vec<u32>,
    /// Surface nodes of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The element of each triangle.
    pub owners: Vec<u32>,
    /// Edges of elements as pieces between surface nodes, each once.
    pub edges: Vec<[u32; 2]>,
    /// Cables as pieces between surface nodes.
    pub cables: Vec<[u32; 2]>,
    /// The element of each piece of a cable.
    pub cable_owners: Vec<u32>,
    /// The groups of each grouping.
    pub groups: [Vec<Group>; 4],
    /// The groups of every element of the simulation, one per grouping.
    pub groups_of: Vec<[u16; 4]>,
    /// Number of elements.
    pub element_count: usize,
    /// Whether every element fills space, so that the surface has an inside.
    pub closed: bool,
    /// Elements at each surface node, those with a face or a cable there: what values at nodes are means of.
    elements_at: Vec<Vec<u32>>,
}

/// Pairs of nodes that only one triangle of a face has: the face's rim.
fn rim(face: &Element, nodes: &[u32]) -> Vec<[u32; 2]> {
    let mut count: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for triangle in triangles(face) {
        let [a, b, c] = triangle.map(|n| nodes[n as usize]);
        for (a, b) in [(a, b), (b, c), (c, a)] {
            *count.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    count.into_iter().filter(|(_, n)| *n == 1).map(|(pair, _)| pair).collect()
}

/// Nodes of a cable from end to end.
fn in_order(edge: &Element, nodes: &[u32]) -> Vec<u32> {
    let mut order: Vec<usize> = (0..nodes.len()).collect();
    order.sort_by(|&a, &b| edge.nodes[a][0].total_cmp(&edge.nodes[b][0]));
    order.into_iter().map(|k| nodes[k]).collect()
}

impl Surface {
    /// The surface of a simulation.
    pub fn of(simulation: &Simulation) -> Surface {
        let prepared = simulation.prepared();
        let element_count = simulation.element_count();
        let mut all = Surface {
            nodes: Vec::new(),
            triangles: Vec::new(),
            owners: Vec::new(),
            edges: Vec::new(),
            cables: Vec::new(),
            cable_owners: Vec::new(),
            groups: Default::default(),
            groups_of: vec![[0; 4]; element_count],
            element_count,
            closed: prepared.blocks.iter().all(|block| block.element.dimension() == 3),
            elements_at: Vec::new(),
        };
        let mut edges = BTreeSet::new();
        for face in faces(prepared) {
            for triangle in triangles(face.kind) {
                all.triangles.push(triangle.map(|n| face.nodes[n as usize]));
                all.owners.push(face.element);
            }
            edges.extend(rim(face.kind, &face.nodes));
        }
        all.edges = edges.into_iter().collect();
        for block in prepared.blocks.iter().filter(|b| b.element.family == Family::Edge) {
            for (&id, nodes) in block.ids.iter().zip(block.connectivity.chunks(block.element.node_count())) {
                for pair in in_order(block.element, nodes).windows(2) {
                    all.cables.push([pair[0], pair[1]]);
                    all.cable_owners.push(id);
                }
            }
        }
        all.sort_into_groups(simulation);
        all.number_nodes();
        all
    }

    fn sort_into_groups(&mut self, simulation: &Simulation) {
        let prepared = simulation.prepared();
        for (number, block) in prepared.blocks.iter().enumerate() {
            let kind = block.element.id.to_owned();
            let family = crate::colours::family(block.element.family);
            let material = format!("{}, {}", block.element.id, described(block));
            let groups = [
                group(&mut self.groups[0], kind, |_| family),
                group(&mut self.groups[1], block.law.id.to_owned(), crate::colours::category),
                group(&mut self.groups[2], format!("{}: {material}", number + 1), crate::colours::category),
            ];
            for &id in &block.ids {
                self.groups_of[id as usize][..3].copy_from_slice(&groups);
            }
        }
        for body in &prepared.bodies {
            let number = group(&mut self.groups[3], body.name.clone(), crate::colours::category);
            let first = body.first_element as usize;
            for groups in &mut self.groups_of[first..first + body.elements.len()] {
                groups[3] = number;
            }
        }
    }

    /// From the simulation's nodes to those of the surface.
    fn number_nodes(&mut self) {
        let used = self.triangles.iter().flatten().chain(self.cables.iter().flatten());
        let used: BTreeSet<u32> = used.copied().collect();
        self.nodes = used.into_iter().collect();
        let nodes = &self.nodes;
        let number = |n: &mut u32| {
            *n = nodes.binary_search(n).expect("every node of a triangle or cable is in the list") as u32;
        };
        self.triangles.iter_mut().flatten().for_each(number);
        self.cables.iter_mut().flatten().for_each(number);
        self.edges.iter_mut().flatten().for_each(number);
        self.elements_at = vec![Vec::new(); self.nodes.len()];
        let pieces = self.triangles.iter().map(|t| &t[..]).zip(&self.owners);
        let cables = self.cables.iter().map(|c| &c[..]).zip(&self.cable_owners);
        for (piece, &owner) in pieces.chain(cables) {
            for &node in piece {
                self.elements_at[node as usize].push(owner);
            }
        }
        for elements in &mut self.elements_at {
            elements.sort_unstable();
            elements.dedup();
        }
    }

    /// Values of elements as values of surface nodes: the mean over the elements that are seen there.
    pub fn at_nodes(&self, values: &[f32]) -> Vec<f32> {
        let mean = |elements: &Vec<u32>| {
            let sum: f64 = elements.iter().map(|&e| f64::from(values[e as usize])).sum();
            (sum / elements.len() as f64) as f32
        };
        self.elements_at.iter().map(mean).collect()
    }
}

/// The number of the group of this name, which is made where it is missing.
fn group(groups: &mut Vec<Group>, name: String, colour: impl Fn(usize) -> crate::colours::Colour) -> u16 {
    let at = groups.iter().position(|g| g.name == name).unwrap_or_else(|| {
        groups.push(Group { name, colour: colour(groups.len()) });
        groups.len() - 1
    });
    // Nobody reads a legend of that length; what comes after shares the last colour.
    u16::try_from(at).unwrap_or(u16::MAX)
}

/// A law with its first three parameters, for legends.
fn described(block: &souple_simulation::BlockSpec) -> String {
    let mut text = block.law.id.to_owned();
    for (parameter, value) in block.law.parameters.iter().zip(&block.parameters).take(3) {
        let unit = if parameter.unit == "1" { "" } else { parameter.unit };
        text += &format!(", {} {}{}{unit}", parameter.name, short(*value), if unit.is_empty() { "" } else { " " });
    }
    text
}

/// Digits that a legend has room for.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_simulation::elements::all;

    /// The rim of every kind of face is a closed line: each of its nodes has two pieces.
    #[test]
    fn rims_are_closed() {
        for face in all().iter().filter(|e| e.dimension() == 2) {
            let nodes: Vec<u32> = (0..face.node_count() as u32).collect();
            let rim = rim(face, &nodes);
            let touched: BTreeSet<u32> = rim.iter().flatten().copied().collect();
            assert!(rim.len() >= 3 && touched.len() == rim.len(), "{}: {rim:?}", face.id);
            assert!(touched.iter().all(|n| rim.iter().flatten().filter(|m| *m == n).count() == 2), "{}", face.id);
        }
    }
}
