//! The mesh while a file is being read.
//!
//! Readers hand over nodes, elements and groups as they come; what every format needs afterwards is done once, here:
//! node order, reduction of complete elements, orientation, regions, and the counts of the report.

use super::CompleteElements;
use super::error::{FormatError, Place};
use super::kinds::{Kind, serendipity};
use super::orientation::Orientation;
use super::report::{FoundRegion, ImportReport};
use crate::check::first_at_same_place;
use crate::{Block, BoundingBox, ElementId, Mesh, Region, tolerance};
use souple_elements::Element;
use std::collections::HashMap;

/// A region of a small file can name every node in a few bytes, but not a million times.
const MEMBERSHIPS_PER_BYTE: usize = 64;

/// Position of a region in a draft.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RegionKey(usize);

struct DraftRegion {
    name: String,
    nodes: Vec<u32>,
    elements: Vec<ElementId>,
    /// The file lists the nodes, so those of the elements are not added.
    lists_nodes: bool,
}

/// See the module.
pub(super) struct Draft {
    pub(super) nodes: Vec<[f64; 3]>,
    pub(super) blocks: Vec<Block>,
    regions: Vec<DraftRegion>,
    keys: HashMap<String, RegionKey>,
    /// Nodes that only the dropped part of an element named.
    dropped: Vec<u32>,
    any_reduced: bool,
    reversed: Vec<ElementId>,
    memberships_left: usize,
    pub(super) report: ImportReport,
}

/// A mesh, the report, and where the file's nodes and elements went.
pub(super) struct Finished {
    pub(super) mesh: Mesh,
    pub(super) report: ImportReport,
    /// For each node of the mesh, its position in the file.
    pub(super) node_from: Vec<u32>,
    /// For each block of the draft: block of the mesh, and index of its first element there.
    moved: Vec<(u32, u32)>,
}

impl Finished {
    /// The element that a draft's element became.
    pub(super) fn element(&self, drafted: ElementId) -> ElementId {
        let (block, first) = self.moved[drafted.block as usize];
        ElementId { block, index: first + drafted.index }
    }
}

impl Draft {
    /// A draft of a file of so many bytes.
    pub(super) fn new(format: impl Into<String>, bytes: usize) -> Self {
        Draft {
            nodes: Vec::new(),
            blocks: Vec::new(),
            regions: Vec::new(),
            keys: HashMap::new(),
            dropped: Vec::new(),
            any_reduced: false,
            reversed: Vec::new(),
            memberships_left: bytes.saturating_mul(MEMBERSHIPS_PER_BYTE).saturating_add(1 << 20),
            report: ImportReport { format: format.into(), ..ImportReport::default() },
        }
    }

    /// Adds a node that the file calls `name`.
    pub(super) fn node<N: std::fmt::Display>(
        &mut self,
        position: [f64; 3],
        name: N,
        place: impl FnOnce() -> Place,
    ) -> Result<(), FormatError> {
        if let Some(at) = position.iter().position(|x| !x.is_finite()) {
            let axis = ['x', 'y', 'z'][at];
            return Err(FormatError::NotFinite { place: place(), node: name.to_string(), axis, value: position[at] });
        }
        if self.nodes.len() >= u32::MAX as usize {
            return Err(FormatError::Unsupported {
                place: place(),
                what: "a mesh of more than 2^32 nodes".to_owned(),
                advice: "split it".to_owned(),
            });
        }
        self.nodes.push(position);
        Ok(())
    }

    /// Adds an element given by its nodes in the order of the file; `nodes` has the length of the kind.
    pub(super) fn element(&mut self, kind: &Kind, nodes: &[u32]) -> ElementId {
        let at = self.block(kind.element);
        let kept = kind.element.node_count();
        let block = &mut self.blocks[at];
        let index = block.len() as u32;
        match &kind.order {
            None => block.connectivity.extend_from_slice(&nodes[..kept]),
            Some(order) => block.connectivity.extend(order.iter().map(|&i| nodes[i])),
        }
        if kind.order.is_some() {
            *self.report.reordered.entry(kind.element.id).or_default() += 1;
        }
        if let Some(from) = kind.reduced_from {
            self.dropped.extend_from_slice(&nodes[kept..]);
            self.any_reduced = true;
            *self.report.reduced.entry(format!("{from} → {}", kind.element.id)).or_default() += 1;
        }
        ElementId { block: at as u32, index }
    }

    fn block(&mut self, element: &'static Element) -> usize {
        self.blocks.iter().position(|b| b.element.id == element.id).unwrap_or_else(|| {
            self.blocks.push(Block { element, connectivity: Vec::new() });
            self.blocks.len() - 1
        })
    }

    /// Asks for an element to be turned round at the end.
    pub(super) fn reverse(&mut self, element: ElementId) {
        self.reversed.push(element);
    }

    /// The region of this name, made when there is none yet.
    pub(super) fn region(&mut self, name: &str) -> RegionKey {
        if let Some(&key) = self.keys.get(name) {
            return key;
        }
        let key = RegionKey(self.regions.len());
        self.regions.push(DraftRegion {
            name: name.to_owned(),
            nodes: Vec::new(),
            elements: Vec::new(),
            lists_nodes: false,
        });
        self.keys.insert(name.to_owned(), key);
        key
    }

    /// Announces that regions will take in so many nodes or elements.
    pub(super) fn claim_memberships(&mut self, count: usize) -> Result<(), FormatError> {
        self.memberships_left = self.memberships_left.checked_sub(count).ok_or_else(|| FormatError::Unsupported {
            place: Place::File,
            what: "a file whose groups overlap a hundredfold".to_owned(),
            advice: "remove groups that repeat each other".to_owned(),
        })?;
        Ok(())
    }

    pub(super) fn add_element(&mut self, region: RegionKey, element: ElementId) {
        self.regions[region.0].elements.push(element);
    }

    /// Adds a node beside those of the region's elements.
    pub(super) fn add_node(&mut self, region: RegionKey, node: u32) {
        self.regions[region.0].nodes.push(node);
    }

    /// States that the file lists the nodes of this region, so that its elements add none.
    pub(super) fn lists_nodes(&mut self, region: RegionKey) {
        self.regions[region.0].lists_nodes = true;
    }

    /// Does what all formats need; see the module.
    pub(super) fn finish(mut self, complete: CompleteElements) -> Result<Finished, FormatError> {
        if self.nodes.is_empty() {
            return Err(FormatError::Empty { format: self.report.format });
        }
        self.turn_reversed();
        let (blocks, moved) = self.reduce_blocks(complete == CompleteElements::Reduce || self.any_reduced);
        let mut mesh = Mesh { nodes: std::mem::take(&mut self.nodes), blocks, ..Mesh::default() };
        let node_from = self.remove_dropped(&mut mesh);
        self.flip(&mut mesh);
        let mut finished = Finished { mesh, report: self.report, node_from, moved };
        finished.regions(self.regions);
        finished.count();
        Ok(finished)
    }

    fn turn_reversed(&mut self) {
        let orientations: Vec<Orientation> = self.blocks.iter().map(|b| Orientation::of(b.element)).collect();
        for id in std::mem::take(&mut self.reversed) {
            let block = &mut self.blocks[id.block as usize];
            let n = block.element.node_count();
            let nodes = &mut block.connectivity[id.index as usize * n..(id.index as usize + 1) * n];
            if orientations[id.block as usize].turn(nodes) {
                *self.report.reversed.entry(block.element.id).or_default() += 1;
            }
        }
    }

    /// Reading one complete element without its centre nodes and its neighbour with them would leave their shared
    /// face with two different sets of nodes; so all of them are reduced, or none.
    fn reduce_blocks(&mut self, reduce: bool) -> (Vec<Block>, Vec<(u32, u32)>) {
        let mut mesh = Mesh::default();
        let mut moved = Vec::with_capacity(self.blocks.len());
        for old in std::mem::take(&mut self.blocks) {
            let to = if reduce { serendipity(old.element).unwrap_or(old.element) } else { old.element };
            let (listed, kept, count) = (old.element.node_count(), to.node_count(), old.len());
            let at = mesh.blocks.iter().position(|b| b.element.id == to.id).unwrap_or(mesh.blocks.len());
            let first = mesh.block_mut(to).len();
            moved.push((at as u32, first as u32));
            if listed == kept {
                mesh.block_mut(to).connectivity.extend(old.connectivity);
                continue;
            }
            for nodes in old.connectivity.chunks_exact(listed) {
                mesh.block_mut(to).connectivity.extend_from_slice(&nodes[..kept]);
                self.dropped.extend_from_slice(&nodes[kept..]);
            }
            if count > 0 {
                *self.report.reduced.entry(format!("{} → {}", old.element.id, to.id)).or_default() += count;
                if let Some(reordered) = self.report.reordered.remove(old.element.id) {
                    *self.report.reordered.entry(to.id).or_default() += reordered;
                }
            }
        }
        (mesh.blocks, moved)
    }

    /// Removes the dropped nodes that no element needs; returns where the others were.
    fn remove_dropped(&mut self, mesh: &mut Mesh) -> Vec<u32> {
        let all = mesh.nodes.len();
        if self.dropped.is_empty() {
            return (0..all as u32).collect();
        }
        let mut keep = vec![true; all];
        for &node in &self.dropped {
            keep[node as usize] = false;
        }
        for &node in mesh.blocks.iter().flat_map(|b| &b.connectivity) {
            keep[node as usize] = true;
        }
        let node_from: Vec<u32> = (0..all as u32).filter(|&n| keep[n as usize]).collect();
        let mut to = vec![0; all];
        for (new, &old) in node_from.iter().enumerate() {
            to[old as usize] = new as u32;
        }
        mesh.nodes = node_from.iter().map(|&n| mesh.nodes[n as usize]).collect();
        for node in mesh.blocks.iter_mut().flat_map(|b| &mut b.connectivity) {
            *node = to[*node as usize];
        }
        for region in &mut self.regions {
            region.nodes.retain(|&n| keep[n as usize]);
            region.nodes.iter_mut().for_each(|n| *n = to[*n as usize]);
        }
        self.report.dropped_nodes = all - node_from.len();
        node_from
    }

    /// Turns the elements of negative volume; in a plane mesh, those of negative area.
    fn flip(&mut self, mesh: &mut Mesh) {
        let dimension = mesh.dimension();
        let plane = || {
            let z = mesh.nodes[0][2];
            let diagonal = BoundingBox::around(&mesh.nodes).map_or(0.0, |b| b.diagonal());
            mesh.nodes.iter().all(|x| (x[2] - z).abs() <= 1e-12 * diagonal)
        };
        if dimension < 2 || (dimension == 2 && !plane()) {
            return;
        }
        for block in mesh.blocks.iter_mut().filter(|b| b.element.dimension() == dimension) {
            let mut orientation = Orientation::of(block.element);
            let mut flipped = 0;
            for nodes in block.connectivity.chunks_exact_mut(block.element.node_count()) {
                if orientation.measure(nodes, &mesh.nodes) < 0.0 && orientation.turn(nodes) {
                    flipped += 1;
                }
            }
            if flipped > 0 {
                self.report.flipped.insert(block.element.id, flipped);
            }
        }
    }
}

impl Finished {
    fn regions(&mut self, drafted: Vec<DraftRegion>) {
        for mut region in drafted {
            let mut elements: Vec<ElementId> = region.elements.iter().map(|&e| self.element(e)).collect();
            elements.sort_unstable();
            elements.dedup();
            if !region.lists_nodes {
                for e in &elements {
                    region.nodes.extend_from_slice(self.mesh.blocks[e.block as usize].nodes(e.index as usize));
                }
            }
            region.nodes.sort_unstable();
            region.nodes.dedup();
            self.report.regions.push(FoundRegion {
                name: region.name.clone(),
                nodes: region.nodes.len(),
                elements: elements.len(),
            });
            self.mesh.regions.insert(region.name, Region { nodes: region.nodes, elements });
        }
        self.report.regions.sort_by(|a, b| a.name.cmp(&b.name));
    }

    fn count(&mut self) {
        let (mesh, report) = (&self.mesh, &mut self.report);
        let mut used = vec![false; mesh.nodes.len()];
        for block in mesh.blocks.iter().filter(|b| !b.is_empty()) {
            *report.found.entry(block.element.id).or_default() += block.len();
            block.connectivity.iter().for_each(|&n| used[n as usize] = true);
        }
        report.nodes = mesh.nodes.len();
        report.unreferenced_nodes = used.iter().filter(|&&u| !u).count();
        let first = first_at_same_place(&mesh.nodes, tolerance(mesh));
        report.duplicate_nodes = first.iter().enumerate().filter(|&(i, &f)| f as usize != i).count();
    }
}

/// From the ids of a file to positions. Ids may be sparse and come in any order; nothing is sized by the largest one.
pub(super) struct Numbering {
    /// Set while the ids are consecutive, which nearly all are.
    first: Option<i64>,
    count: u32,
    map: HashMap<i64, u32>,
}

impl Numbering {
    pub(super) fn new() -> Self {
        Numbering { first: None, count: 0, map: HashMap::new() }
    }

    /// Gives the next position to `id`; `false` when it has one already.
    pub(super) fn push(&mut self, id: i64) -> bool {
        if self.count == 0 {
            self.first = Some(id);
        }
        match self.first {
            Some(first) if id == first.wrapping_add(i64::from(self.count)) => {}
            Some(first) => {
                self.map = (0..self.count).map(|i| (first.wrapping_add(i64::from(i)), i)).collect();
                self.first = None;
                if self.map.insert(id, self.count).is_some() {
                    return false;
                }
            }
            None => {
                if self.map.insert(id, self.count).is_some() {
                    return false;
                }
            }
        }
        self.count += 1;
        true
    }

    pub(super) fn get(&self, id: i64) -> Option<u32> {
        match self.first {
            Some(first) => u32::try_from(id.wrapping_sub(first)).ok().filter(|&at| at < self.count),
            None => self.map.get(&id).copied(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.count as usize
    }

    /// Ids and positions, by id.
    pub(super) fn sorted(&self) -> Vec<(i64, u32)> {
        match self.first {
            Some(first) => (0..self.count).map(|at| (first.wrapping_add(i64::from(at)), at)).collect(),
            None => {
                let mut sorted: Vec<(i64, u32)> = self.map.iter().map(|(&id, &at)| (id, at)).collect();
                sorted.sort_unstable();
                sorted
            }
        }
    }

    /// What ids there are, for messages.
    pub(super) fn described(&self, what: &str) -> String {
        match self.first {
            _ if self.count == 0 => format!("no {what}"),
            Some(first) => format!("{what} {first} to {}", first.wrapping_add(i64::from(self.count)).wrapping_sub(1)),
            None => format!("{} {what} with other ids", self.count),
        }
    }
}
