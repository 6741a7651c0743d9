//! Held and moved nodes, and what probes look at.

use super::error::Findings;
use super::regions::{Needs, Place, find, nothing, select};
use super::{MovedNodes, ProbeRegion};
use souple_scene::body::Body;
use souple_scene::probe::{Probe, Quantity};
use souple_scene::{Location, Scene};

/// Held nodes: global nodes, sorted, and their axes.
pub(super) type Fixed = (Vec<u32>, [bool; 3]);

/// Adds the fixed and moved nodes of body `index` of the scene.
pub(super) fn constrain(
    place: Place<'_>,
    index: usize,
    dimension: usize,
    fixed: &mut Vec<Fixed>,
    moved: &mut Vec<MovedNodes>,
    findings: &mut Findings,
) {
    let global = |nodes: Vec<u32>| -> Vec<u32> { nodes.into_iter().map(|n| n + place.body.first_node).collect() };
    // The axes of each node of the body that something prescribes already.
    let mut taken = vec![[false; 3]; place.body.mesh.nodes.len()];
    for fix in &place.scene.fixes {
        if let Some(selected) = select(place, &fix.region, Needs::Nodes, findings) {
            for &node in &selected.nodes {
                (0..3).for_each(|a| taken[node as usize][a] |= fix.axes[a]);
            }
            fixed.push((global(selected.nodes), fix.axes));
        }
    }
    for (at, motion) in place.scene.moves.iter().enumerate() {
        let Some(selected) = select(place, &motion.region, Needs::Nodes, findings) else { continue };
        let twice = |n: &&u32| (0..dimension).any(|a| motion.axes[a] && taken[**n as usize][a]);
        let clashes = selected.nodes.iter().filter(twice).count();
        if clashes > 0 {
            let message = format!(
                "{clashes} nodes of this moved region are already held, or moved by an earlier [[body.move]], along the \
                 same axis; take them out of one of the regions, or restrict `axes`"
            );
            findings.problem(&motion.region.at, message);
        }
        for &node in &selected.nodes {
            (0..3).for_each(|a| taken[node as usize][a] |= motion.axes[a]);
        }
        moved.push(MovedNodes { nodes: global(selected.nodes), source: (index, at) });
    }
}

/// Refuses what would leave the plane (or the line) of the elements, where nothing could move.
pub(super) fn keep_in_space(scene: &Scene, body: &Body, dimension: usize, findings: &mut Findings) {
    if dimension == 3 {
        return;
    }
    let missing = |v: &[f64; 3]| v[dimension..].iter().any(|x| *x != 0.0);
    let refuse = |what: &str, at: &Location, findings: &mut Findings| {
        let axes = if dimension == 2 { "z" } else { "y or z" };
        let message = format!(
            "this {what} has a part along {axes}, but the elements of body \"{}\" have dimension {dimension} and move \
             only along {}; set that part to 0",
            *body.name,
            if dimension == 2 { "x and y" } else { "x" }
        );
        findings.problem(at, message);
    };
    if missing(&scene.gravity) {
        refuse("scene's gravity", &Location::Default, findings);
    }
    if missing(&body.initial_velocity) {
        refuse("body's initial velocity", &body.name.at, findings);
    }
    for motion in &body.moves {
        let translated = motion.translation.iter().flatten().any(|key| missing(&key.value));
        let axis_tilted = |axis: &[f64; 3]| dimension == 1 || axis[0] != 0.0 || axis[1] != 0.0;
        if translated || motion.rotation.as_ref().is_some_and(|rotation| axis_tilted(&rotation.axis)) {
            refuse("motion", &motion.at, findings);
        }
    }
    for force in &body.forces {
        let (souple_scene::load::ForceAmount::Total(amount) | souple_scene::load::ForceAmount::PerNode(amount)) =
            &force.amount;
        if missing(amount) {
            refuse("force", &force.at, findings);
        }
    }
    for traction in body.tractions.iter().filter(|traction| missing(&traction.traction)) {
        refuse("traction", &traction.at, findings);
    }
}

/// The nodes and elements of a probe; empty after a problem was noted.
///
/// Without a body the probe looks at every body in which its region selects something.
/// A body without place has no mesh because of an earlier problem.
pub(super) fn probe(probe: &Probe, places: &[Option<Place<'_>>], findings: &mut Findings) -> ProbeRegion {
    let mut region = ProbeRegion { nodes: Vec::new(), elements: Vec::new() };
    let wanted = |at: usize| probe.body.as_ref().is_none_or(|body| body.value == at);
    let candidates: Vec<Option<Place<'_>>> =
        places.iter().enumerate().filter(|(at, _)| wanted(*at)).map(|(_, place)| *place).collect();
    let needs = needs(probe);
    let mut first_refusal: Option<(Location, String)> = None;
    for place in candidates.iter().flatten() {
        match find(*place, &probe.region) {
            Ok(selected) if selected.lacks(needs) => {
                let refusal = || (probe.region.at.clone(), nothing(*place, &probe.region, needs));
                first_refusal.get_or_insert_with(refusal);
            }
            Ok(selected) => {
                region.nodes.extend(selected.nodes.iter().map(|n| n + place.body.first_node));
                region.elements.extend(selected.elements.iter().map(|e| e + place.body.first_element));
            }
            Err(refusal) => {
                first_refusal.get_or_insert(refusal);
            }
        }
    }
    let empty = region.nodes.is_empty() && region.elements.is_empty();
    // A body that failed has been reported; it may well be the one that the probe is about.
    if let (true, Some((at, message))) = (empty && candidates.iter().all(Option::is_some), first_refusal) {
        let at = if at == Location::Default { probe.name.at.clone() } else { at };
        findings.problem(&at, format!("probe \"{}\": {message}", *probe.name));
    }
    region
}

/// What the quantities of a probe are computed from.
fn needs(probe: &Probe) -> Needs {
    if probe.quantities.iter().any(|q| q.value.of_elements()) {
        Needs::Elements
    } else if probe.quantities.iter().all(|q| q.value == Quantity::Energy) {
        Needs::Anything
    } else {
        Needs::Nodes
    }
}
