//! From regions to what MSH has: entities, each with its groups.
//!
//! Elements of one dimension with the same set of regions form one entity; nodes of a region that none of its elements
//! holds become points.
//! Once there is a region, elements of none get a group of their own, see [`NO_REGION`].

use super::NO_REGION;
use crate::formats::error::FormatError;
use crate::{ElementId, Mesh};
use std::collections::{BTreeMap, BTreeSet};

/// Tags of the groups of an entity, sorted.
pub(super) type Groups = Vec<usize>;

/// The entities of a mesh.
pub(super) struct Entities {
    /// Groups of each entity, by dimension; the tag of an entity is its position plus one.
    pub(super) groups: [Vec<Groups>; 4],
    /// Entity of every element, per block.
    pub(super) elements: Vec<Vec<usize>>,
    /// Nodes of every entity that is made of points.
    pub(super) points: BTreeMap<usize, Vec<u32>>,
    /// `(dimension, tag, name)` of every group.
    pub(super) names: Vec<(usize, usize, String)>,
}

/// Makes the entities; the only error is a name that MSH cannot hold.
pub(super) fn entities(mesh: &Mesh) -> Result<Entities, FormatError> {
    let mut of_elements: Vec<Vec<Groups>> = mesh.blocks.iter().map(|b| vec![Vec::new(); b.len()]).collect();
    let mut of_points: BTreeMap<u32, Groups> = BTreeMap::new();
    let mut names = BTreeSet::new();
    for (at, (name, region)) in mesh.regions.iter().enumerate() {
        check_name(name)?;
        let tag = at + 1;
        let mut dimensions = BTreeSet::new();
        let mut covered: BTreeSet<u32> = BTreeSet::new();
        for &ElementId { block, index } in &region.elements {
            let (block, index) = (block as usize, index as usize);
            of_elements[block][index].push(tag);
            dimensions.insert(mesh.blocks[block].element.dimension());
            covered.extend(mesh.blocks[block].nodes(index));
        }
        for &node in region.nodes.iter().filter(|n| !covered.contains(n)) {
            of_points.entry(node).or_default().push(tag);
            dimensions.insert(0);
        }
        if dimensions.is_empty() {
            dimensions.insert(mesh.dimension());
        }
        names.extend(dimensions.into_iter().map(|d| (d, tag, name.clone())));
    }
    if !names.is_empty() {
        let rest = mesh.regions.len() + 1;
        for (block, of) in mesh.blocks.iter().zip(&mut of_elements) {
            for groups in of.iter_mut().filter(|groups| groups.is_empty()) {
                groups.push(rest);
                names.insert((block.element.dimension(), rest, NO_REGION.to_owned()));
            }
        }
    }
    let mut made = Maker::default();
    let elements = of_elements.iter().enumerate().map(|(at, of)| {
        let (family, dimension) = (mesh.blocks[at].element.family, mesh.blocks[at].element.dimension());
        // Gmsh expects one element type per family in an entity, so the second one gets entities of its own.
        let rank = mesh.blocks[..at].iter().filter(|b| b.element.family == family).count();
        of.iter().map(|groups| made.entity(dimension, rank, groups)).collect()
    });
    let elements = elements.collect();
    let mut points: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (&node, groups) in &of_points {
        points.entry(made.entity(0, 0, groups)).or_default().push(node);
    }
    Ok(Entities { groups: made.groups, elements, points, names: names.into_iter().collect() })
}

/// Entities by what they are made for.
#[derive(Default)]
struct Maker {
    groups: [Vec<Groups>; 4],
    known: BTreeMap<(usize, usize, Groups), usize>,
}

impl Maker {
    fn entity(&mut self, dimension: usize, rank: usize, groups: &Groups) -> usize {
        *self.known.entry((dimension, rank, groups.clone())).or_insert_with(|| {
            self.groups[dimension].push(groups.clone());
            self.groups[dimension].len()
        })
    }
}

fn check_name(name: &str) -> Result<(), FormatError> {
    let unusable = name.is_empty() || name == NO_REGION || name.trim() != name || name.contains('"');
    if !unusable && !name.chars().any(char::is_control) {
        return Ok(());
    }
    Err(FormatError::NotWritable {
        what: format!("region \"{}\"", name.escape_debug()),
        format: "MSH",
        why: "its name is empty, reserved, or holds quotes, outer blanks or control characters; rename it".to_owned(),
    })
}
