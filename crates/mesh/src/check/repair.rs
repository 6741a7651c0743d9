//! Repairs with one obvious cure: mirrored elements, nodes of nothing, nodes at the same place.

use super::jacobian::{Judge, Orientation};
use super::{MeshError, first_at_same_place, is_flat, unreferenced, validate};
use crate::mesh::{ElementId, Mesh, sorted_set};
use crate::reference::mirror;

/// Whether nodes at the same place become one.
///
/// Never by itself: a crack is nodes at the same place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Merge {
    /// Leave them.
    #[default]
    Never,
    /// Merge nodes at most this many metres apart into the first of them.
    Within(f64),
}

/// What was repaired.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RepairReport {
    /// Number of inverted elements whose nodes were reordered.
    pub mirrored: usize,
    /// Number of nodes merged into an earlier one.
    pub merged: usize,
    /// Number of nodes dropped because no element uses them; merged ones are not counted again.
    pub dropped: usize,
    /// Elements that list a node twice after merging. They stay: what to do with them is not obvious.
    pub collapsed: Vec<ElementId>,
    /// The new number of each old node; `None` for dropped ones.
    pub new_node: Vec<Option<u32>>,
}

/// Mirrors inverted elements, merges nodes if asked to, and drops nodes that no element uses. Regions follow; they lose
/// the dropped nodes.
///
/// # Errors
/// Those of [`validate`]; the mesh is unchanged then.
pub fn repair(mesh: &mut Mesh, merge: Merge) -> Result<RepairReport, MeshError> {
    validate(mesh)?;
    let mut report = RepairReport::default();

    let flat = is_flat(mesh);
    for block in &mut mesh.blocks {
        let Some(order) = mirror(block.element) else { continue };
        let judge = Judge::new(block.element, flat);
        let mut points: Vec<[f64; 3]> = Vec::with_capacity(order.len());
        for nodes in block.connectivity.chunks_exact_mut(order.len()) {
            points.clear();
            points.extend(nodes.iter().map(|&n| mesh.nodes[n as usize]));
            if judge.judge(&points).orientation == Orientation::Inverted {
                let old = nodes.to_vec();
                nodes.iter_mut().zip(&order).for_each(|(node, &from)| *node = old[from as usize]);
                report.mirrored += 1;
            }
        }
    }

    let mut into: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    if let Merge::Within(distance) = merge {
        into = first_at_same_place(&mesh.nodes, distance);
        report.merged = into.iter().zip(0u32..).filter(|(first, node)| *first != node).count();
        mesh.blocks.iter_mut().flat_map(|b| &mut b.connectivity).for_each(|n| *n = into[*n as usize]);
        for id in mesh.element_ids() {
            let nodes = mesh.nodes_of(id);
            if sorted_set(nodes.iter().copied()).len() < nodes.len() {
                report.collapsed.push(id);
            }
        }
    }

    let unused = unreferenced(mesh);
    report.dropped = unused.len() - report.merged;
    let kept: Vec<u32> = (0..mesh.nodes.len() as u32).filter(|n| unused.binary_search(n).is_err()).collect();
    let mut new = vec![None; mesh.nodes.len()];
    kept.iter().zip(0u32..).for_each(|(&old, at)| new[old as usize] = Some(at));
    report.new_node = into.iter().map(|&n| new[n as usize]).collect();

    mesh.nodes = kept.iter().map(|&n| mesh.nodes[n as usize]).collect();
    for node in mesh.blocks.iter_mut().flat_map(|b| &mut b.connectivity) {
        *node = new[*node as usize].expect("a node of an element is kept");
    }
    for region in mesh.regions.values_mut() {
        region.nodes = sorted_set(region.nodes.iter().filter_map(|&n| report.new_node[n as usize]));
    }
    Ok(report)
}
