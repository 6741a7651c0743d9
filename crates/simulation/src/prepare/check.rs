//! Is a body's mesh fit to compute with? What cannot be computed is an error, what is odd a warning.
//!
//! An element computes only where det ∂x/∂ξ > 0. Elements listed inside out are turned and counted; elements that are
//! negative or flat in one place stay an error, because no order of their nodes helps.

use super::error::Findings;
use super::{PreparedBody, described};
use souple_mesh::check::{Merge, MeshReport, UnitGuess, repair, report};
use souple_mesh::{ElementId, Mesh, tolerance};
use souple_scene::Location;
use souple_scene::body::Body;
use souple_scene::mesh::Mesh as MeshSource;

/// How many elements a message names before it counts the rest.
const NAMED: usize = 5;

/// Checks, turns what is inside out, and drops what no deformable element uses; `None` after a problem was noted.
///
/// `claimed` are the elements of lower dimension that deform, sorted.
pub(super) fn check(
    prepared: &mut PreparedBody,
    claimed: &[ElementId],
    body: &Body,
    at: &Location,
    findings: &mut Findings,
) -> Option<()> {
    let name = body.name.as_str();
    let space = prepared.dimension;
    let (mesh, text) = (&mut prepared.mesh, &mut prepared.report);
    let refused = |error: souple_mesh::check::MeshError, findings: &mut Findings| {
        findings.problem(at, format!("mesh of body \"{name}\": {error}"));
    };
    let found = match report(mesh) {
        Ok(found) => found,
        Err(error) => {
            refused(error, findings);
            return None;
        }
    };
    if found.dimension == 0 {
        findings.problem(at, format!("the mesh of body \"{name}\" has no element; a body needs elements that deform"));
        return None;
    }
    if !lies_in_its_space(mesh, found.dimension.min(1), space) {
        let (what, plane) = match space {
            2 => ("triangles and quadrangles", "in one plane of constant z"),
            _ => ("edges", "on one line along x"),
        };
        let quantity = if space == 2 { "thickness" } else { "section" };
        let message = format!(
            "the mesh of body \"{name}\" has elements of dimension {} at most, and its nodes do not lie {plane}; a \
             `{quantity}` in their [[body.material]] makes {what} in space {}, or fill the surface with solid elements in a \
             mesher",
            found.dimension,
            if space == 2 { "membranes" } else { "cables" },
        );
        findings.problem(at, message);
        return None;
    }
    let deforms = |mesh: &Mesh, id: &ElementId| {
        mesh.blocks[id.block as usize].element.dimension() == found.dimension || claimed.binary_search(id).is_ok()
    };
    let turnable = |id: &ElementId| deforms(mesh, id);
    let broken: [(Vec<ElementId>, &str); 2] = [
        (
            found.tangled.iter().copied().filter(turnable).collect(),
            "negative volume in one part and positive in another",
        ),
        (found.degenerate.iter().copied().filter(turnable).collect(), "no volume at a corner"),
    ];
    let before = report_broken(mesh, name, &broken, at, findings);
    drop_loose_sides(mesh, found.dimension, claimed, name, at, findings);
    let repaired = match repair(mesh, Merge::Never) {
        Ok(repaired) => repaired,
        Err(error) => {
            refused(error, findings);
            return None;
        }
    };
    if repaired.mirrored > 0 {
        let message =
            format!("body \"{name}\": {} elements were inside out; their nodes were reordered", repaired.mirrored);
        findings.warning(at, message);
    }
    if repaired.dropped > 0 {
        let message = format!("body \"{name}\": {} nodes belong to no element and were dropped", repaired.dropped);
        findings.warning(at, message);
        text.push_str(&format!("dropped {} nodes of no element\n", repaired.dropped));
    }
    let after = if found.inverted.is_empty() { true } else { still_inverted(mesh, name, at, findings) };
    warn(&found, body, at, findings);
    (before && after).then_some(())
}

/// Whether the elements of dimension `least` and more lie in a plane of constant z (`space` 2), on a line along x (1).
pub(super) fn lies_in_its_space(mesh: &Mesh, least: usize, space: usize) -> bool {
    let slack = tolerance(mesh);
    let used = mesh.blocks.iter().filter(|b| b.element.dimension() >= least).flat_map(|b| &b.connectivity);
    let mut first: Option<[f64; 3]> = None;
    used.map(|&n| mesh.nodes[n as usize]).all(|p| {
        let reference = *first.get_or_insert(p);
        (space..3).all(|a| (p[a] - reference[a]).abs() <= slack)
    })
}

/// Notes each kind of broken element; whether there was none.
fn report_broken(
    mesh: &Mesh,
    body: &str,
    kinds: &[(Vec<ElementId>, &str)],
    at: &Location,
    findings: &mut Findings,
) -> bool {
    for (elements, what) in kinds.iter().filter(|kind| !kind.0.is_empty()) {
        let mut names: Vec<String> = elements.iter().take(NAMED).map(|&id| described(mesh, body, id)).collect();
        if elements.len() > NAMED {
            names.push(format!("and {} more", elements.len() - NAMED));
        }
        let message = format!(
            "inverted elements: {} with {what}: {}; every element must have positive volume everywhere: move these nodes \
             or mesh again (numbers count from 0 in the order of the mesh)",
            elements.len(),
            names.join(", ")
        );
        findings.problem(at, message);
    }
    kinds.iter().all(|kind| kind.0.is_empty())
}

/// Notes elements that stay inside out because their nodes have no mirror order; whether there was none.
fn still_inverted(mesh: &Mesh, body: &str, at: &Location, findings: &mut Findings) -> bool {
    let dimension = mesh.dimension();
    let inverted = report(mesh).map(|found| found.inverted).unwrap_or_default();
    let inverted = inverted.into_iter().filter(|id| mesh.blocks[id.block as usize].element.dimension() == dimension);
    report_broken(mesh, body, &[(inverted.collect(), "negative volume")], at, findings)
}

/// Drops elements of lower dimension that hang on nodes of no deformable element: such nodes would have no mass.
fn drop_loose_sides(
    mesh: &mut Mesh,
    dimension: usize,
    claimed: &[ElementId],
    body: &str,
    at: &Location,
    findings: &mut Findings,
) {
    let mut carried = vec![false; mesh.nodes.len()];
    let deformable = mesh.blocks.iter().filter(|b| b.element.dimension() == dimension);
    deformable.flat_map(|b| &b.connectivity).for_each(|&n| carried[n as usize] = true);
    claimed.iter().flat_map(|&id| mesh.nodes_of(id)).for_each(|&n| carried[n as usize] = true);
    let mut renumbered: Vec<Option<Vec<Option<u32>>>> = vec![None; mesh.blocks.len()];
    let mut dropped = 0;
    for (block, new) in mesh.blocks.iter_mut().zip(&mut renumbered) {
        if block.connectivity.iter().all(|&n| carried[n as usize]) {
            continue;
        }
        let (mut kept, mut indices, mut next) = (Vec::new(), Vec::with_capacity(block.len()), 0);
        for index in 0..block.len() {
            let nodes = block.nodes(index);
            let stays = nodes.iter().all(|&n| carried[n as usize]);
            indices.push(stays.then_some(next));
            if stays {
                kept.extend_from_slice(nodes);
                next += 1;
            } else {
                dropped += 1;
            }
        }
        block.connectivity = kept;
        *new = Some(indices);
    }
    if dropped == 0 {
        return;
    }
    for region in mesh.regions.values_mut() {
        region.elements = region
            .elements
            .iter()
            .filter_map(|id| match &renumbered[id.block as usize] {
                Some(indices) => indices[id.index as usize].map(|index| ElementId { block: id.block, index }),
                None => Some(*id),
            })
            .collect();
    }
    let message = format!(
        "body \"{body}\": {dropped} elements of lower dimension lie on nodes that no element of dimension {dimension} \
         uses; they were dropped"
    );
    findings.warning(at, message);
}

fn warn(found: &MeshReport, body: &Body, at: &Location, findings: &mut Findings) {
    let name = body.name.as_str();
    if !found.slivers.is_empty() {
        let message = format!(
            "body \"{name}\": {} elements are very flat (mean ratio below {}); solvers will be slow and stresses rough",
            found.slivers.len(),
            souple_mesh::check::SLIVER_QUALITY
        );
        findings.warning(at, message);
    }
    if !found.duplicates.is_empty() {
        let message = format!(
            "body \"{name}\": {} nodes lie at the place of another one; unless these are cracks, merge them in the mesher",
            found.duplicates.len()
        );
        findings.warning(at, message);
    }
    let scale = match &body.mesh.value {
        MeshSource::File(file) => file.scale,
        // The size of a bar stands in the scene, in metres.
        MeshSource::Bar(_) => return,
    };
    if let (UnitGuess::Millimetres, Some(bounds)) = (found.unit, found.bounds) {
        let largest = bounds.extent().into_iter().fold(0.0, f64::max);
        let message = format!(
            "body \"{name}\" is {largest} m long with `scale = {scale}`; if the file is in millimetres, write \
             `scale = \"1 mm\"` in [body.mesh]"
        );
        findings.warning(at, message);
    }
}
