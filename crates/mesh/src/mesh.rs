//! The mesh: rest positions, blocks of elements of one kind, and named regions.
//!
//! A mesh is plain data. What is derived from it (who shares which face, the boundary, quality) is computed by the
//! other modules of this crate and never stored here, so a mesh cannot contradict itself.

use souple_elements::Element;
use std::collections::BTreeMap;

/// Elements of one kind.
#[derive(Clone, Debug)]
pub struct Block {
    /// What they are.
    pub element: &'static Element,
    /// Global node indices, `[element, local node]`, in VTK order.
    pub connectivity: Vec<u32>,
}

impl Block {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.connectivity.len() / self.element.node_count()
    }

    /// Whether the block holds no element.
    pub fn is_empty(&self) -> bool {
        self.connectivity.is_empty()
    }

    /// The nodes of one element.
    pub fn nodes(&self, element: usize) -> &[u32] {
        let n = self.element.node_count();
        &self.connectivity[element * n..(element + 1) * n]
    }
}

/// One element of a mesh: block and position inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId {
    /// Index into [`Mesh::blocks`].
    pub block: u32,
    /// Index inside the block.
    pub index: u32,
}

/// A named part of a mesh. Any of the three lists may be empty; node and element lists are sorted and without repeats.
///
/// A region that a file gives as elements of lower dimension (Gmsh's physical surfaces) holds those elements and
/// their nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Region {
    /// Node indices.
    pub nodes: Vec<u32>,
    /// Elements.
    pub elements: Vec<ElementId>,
}

/// A mesh of mixed elements.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Rest positions in metres, `[node][axis]`.
    pub nodes: Vec<[f64; 3]>,
    /// Elements by kind: at most one block per kind and per dimension, in the order in which they first appeared.
    pub blocks: Vec<Block>,
    /// Parts by name.
    pub regions: BTreeMap<String, Region>,
}

impl Mesh {
    /// The block of this kind, appended when there is none yet.
    pub fn block_mut(&mut self, element: &'static Element) -> &mut Block {
        let at = match self.blocks.iter().position(|b| b.element.id == element.id) {
            Some(at) => at,
            None => {
                self.blocks.push(Block { element, connectivity: Vec::new() });
                self.blocks.len() - 1
            }
        };
        &mut self.blocks[at]
    }

    /// Highest dimension of the elements; 0 when there are none.
    pub fn dimension(&self) -> usize {
        self.blocks.iter().filter(|b| !b.is_empty()).map(|b| b.element.dimension()).max().unwrap_or(0)
    }

    /// Number of elements of the highest dimension.
    pub fn element_count(&self) -> usize {
        let d = self.dimension();
        self.blocks.iter().filter(|b| b.element.dimension() == d).map(Block::len).sum()
    }

    /// The nodes of one element, in VTK order.
    pub fn nodes_of(&self, id: ElementId) -> &[u32] {
        self.blocks[id.block as usize].nodes(id.index as usize)
    }

    /// Every element, block by block.
    pub fn element_ids(&self) -> impl Iterator<Item = ElementId> + '_ {
        self.blocks
            .iter()
            .zip(0u32..)
            .flat_map(|(b, block)| (0..b.len() as u32).map(move |index| ElementId { block, index }))
    }

    /// Mean of an element's corners, in metres.
    pub fn centroid(&self, id: ElementId) -> [f64; 3] {
        let corner_count = self.blocks[id.block as usize].element.family.corner_count();
        let corners = &self.nodes_of(id)[..corner_count];
        std::array::from_fn(|a| corners.iter().map(|&n| self.nodes[n as usize][a]).sum::<f64>() / corner_count as f64)
    }
}

/// The values in increasing order without repeats: the form of the lists in a [`Region`].
pub(crate) fn sorted_set<T: Ord>(values: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut values: Vec<T> = values.into_iter().collect();
    values.sort_unstable();
    values.dedup();
    values
}
