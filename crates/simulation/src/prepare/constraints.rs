//! Nodes that follow others: hanging nodes and mixed interpolations of each body, and `[[tie]]`s between surfaces.
//!
//! ```text
//! mesh ── conformity ──► constraints of the body ─┐
//! [[tie]] ── nearest faces ──► constraints ───────┴── resolve ──► constraints of the scene ── check ──► with fix, move
//! ```
//!
//! What is not here: how the equations are solved under them ([`souple_solver::Elimination`]).

use super::error::Findings;
use super::regions::{Needs, Place, described, select};
use super::{MovedNodes, conditions};
use souple_mesh::constraint::{Cause, Conformity, Constraint, ConstraintError, TieFace, conformity, resolve, tie};
use souple_mesh::topology::Topology;
use souple_mesh::{Mesh, tolerance};
use souple_scene::body::Body;
use souple_scene::conforming::Conforming;
use souple_scene::tie::Tie;
use souple_scene::{Location, Scene, Spanned};

/// Nodes named in a message before the rest is counted.
const NAMED: usize = 5;

/// What makes the mesh of a body conform, told in `report`; nothing when the scene wants it left as it is.
/// `None` after a problem was noted.
pub(super) fn of_body(
    mesh: &Mesh,
    topology: &Topology,
    body: &Body,
    at: &Location,
    report: &mut String,
    findings: &mut Findings,
) -> Option<Conformity> {
    if body.conforming == Conforming::Off {
        return Some(Conformity::default());
    }
    let name = &*body.name;
    let found = match conformity(mesh, topology) {
        Ok(found) => found,
        Err(error) => {
            findings.problem(at, format!("body \"{name}\": {error} (or write `conforming = \"off\"` in [[body]])"));
            return None;
        }
    };
    if found.constraints.is_empty() {
        return Some(found);
    }
    report.push_str(&format!("{found}\n"));
    let gaps = found.constraints.iter().map(|c| c.gap(&mesh.nodes)).filter(|gap| *gap > 1e3 * tolerance(mesh));
    let (count, worst) = gaps.fold((0, 0.0f64), |(count, worst), gap| (count + 1, worst.max(gap)));
    if count > 0 {
        let message = format!(
            "body \"{name}\": {count} nodes lie up to {worst:.1e} m off the sides that they are tied to, so that turning \
             the body deforms it a little; let the mesher make both sides of the interface straight"
        );
        findings.warning(at, message);
    }
    if found.rough > 0 {
        let message = format!(
            "body \"{name}\": on {} faces finer elements cannot follow the coarse one between their nodes, so displacements \
             are not quite continuous there; give both sides elements of the same degree and family",
            found.rough
        );
        findings.warning(at, message);
    }
    Some(found)
}

/// The constraints of the whole scene, by global nodes, ascending, with free masters.
pub(super) fn gather(scene: &Scene, places: &[Option<Place<'_>>], findings: &mut Findings) -> Vec<Constraint> {
    let mut all: Vec<Constraint> = Vec::new();
    for place in places.iter().flatten() {
        all.extend(place.body.conformity.constraints.iter().map(|c| moved(c, place.body.first_node)));
    }
    if scene.ties.is_empty() {
        return all;
    }
    let positions: Vec<[f64; 3]> =
        places.iter().flatten().flat_map(|place| place.body.mesh.nodes.iter().copied()).collect();
    for tie in &scene.ties {
        let (Some(from), Some(to)) = (places[tie.body.value], places[tie.to_body.value]) else { continue };
        let Some(rows) = tied(tie, from, to, &positions, &all, findings) else { continue };
        let together = all.iter().cloned().chain(rows).collect();
        match resolve(together) {
            Ok(resolved) => all = resolved,
            Err(error) => findings.problem(&tie.at, format!("this tie: {}", in_words(&error, places))),
        }
    }
    all
}

fn moved(c: &Constraint, first_node: u32) -> Constraint {
    let masters = c.masters.iter().map(|&(node, weight)| (node + first_node, weight)).collect();
    Constraint { node: c.node + first_node, masters, cause: c.cause }
}

/// The rows of one tie, by global nodes; `None` after a problem was noted.
fn tied(
    wanted: &Spanned<Tie>,
    from: Place<'_>,
    to: Place<'_>,
    positions: &[[f64; 3]],
    known: &[Constraint],
    findings: &mut Findings,
) -> Option<Vec<Constraint>> {
    let nodes = select(from, &wanted.region, Needs::Nodes, findings)?.nodes;
    let surface = select(to, &wanted.to_region, Needs::Nodes, findings)?.nodes;
    let faces = faces(to, &surface, &wanted.to_region.at, findings)?;
    if faces.is_empty() {
        let message = format!(
            "region {} selects nothing that nodes could be tied to: it holds {} nodes of body \"{}\", but all nodes of no \
             face of its surface; widen the region",
            described(&wanted.to_region),
            surface.len(),
            *to.scene.name
        );
        findings.problem(&wanted.to_region.at, message);
        return None;
    }
    // A node that hangs in its own body goes where its masters go, which are on the same surface.
    let hangs = |node: &u32| known.binary_search_by_key(node, |c| c.node).is_ok_and(|at| known[at].cause != Cause::Tie);
    let nodes: Vec<u32> = nodes.iter().map(|n| n + from.body.first_node).filter(|n| !hangs(n)).collect();
    let rows = tie(positions, &nodes, &faces, wanted.within);
    if rows.is_empty() {
        let message = format!(
            "this tie holds nothing: no node of region {} of body \"{}\" is within {} m of the faces of body \"{}\"; \
             increase `within`, or look at the regions",
            described(&wanted.region),
            *from.scene.name,
            wanted.within,
            *to.scene.name
        );
        findings.problem(&wanted.at, message);
        return None;
    }
    if rows.len() < nodes.len() {
        let message = format!(
            "{} of {} nodes of this tie are farther than {} m from the faces and stay free",
            nodes.len() - rows.len(),
            nodes.len(),
            wanted.within
        );
        findings.warning(&wanted.at, message);
    }
    Some(rows)
}

/// Faces of a body's surface all of whose nodes are in a sorted list of its nodes; nodes are global.
fn faces(place: Place<'_>, nodes: &[u32], at: &Location, findings: &mut Findings) -> Option<Vec<TieFace>> {
    let topology = match Topology::new(&place.body.mesh) {
        Ok(topology) => topology,
        Err(error) => {
            findings.problem(at, format!("mesh of body \"{}\": {error}", *place.scene.name));
            return None;
        }
    };
    let mut faces = Vec::new();
    for face in place.body.conformity.skin(&topology) {
        let Some(side) = topology.run(face.element()).element.faces.get(face.face()) else { continue };
        let Some(element) = souple_elements::by_id(side.element) else { continue };
        let of_element = place.body.mesh.nodes_of(topology.id(face.element()));
        let of_face: Vec<u32> = side.nodes.iter().map(|&n| of_element[n as usize]).collect();
        if of_face.iter().all(|n| nodes.binary_search(n).is_ok()) {
            faces.push(TieFace { element, nodes: of_face.iter().map(|n| n + place.body.first_node).collect() });
        }
    }
    Some(faces)
}

/// A node in words: number in its body.
fn node_in_words(node: u32, places: &[Option<Place<'_>>]) -> String {
    let body = places.iter().flatten().rev().find(|place| place.body.first_node <= node);
    body.map_or_else(
        || format!("node {node}"),
        |place| format!("node {} of body \"{}\"", node - place.body.first_node, place.body.name),
    )
}

fn nodes_in_words(nodes: impl IntoIterator<Item = u32>, places: &[Option<Place<'_>>]) -> String {
    let nodes: Vec<u32> = nodes.into_iter().collect();
    let mut shown: Vec<String> = nodes.iter().take(NAMED).map(|&n| node_in_words(n, places)).collect();
    if nodes.len() > NAMED {
        shown.push(format!("and {} more", nodes.len() - NAMED));
    }
    shown.join(", ")
}

fn in_words(error: &ConstraintError, places: &[Option<Place<'_>>]) -> String {
    match error {
        ConstraintError::Cycle { nodes } => format!(
            "these nodes would follow each other in a circle: {}; tie one of the two surfaces to the other, not both",
            nodes_in_words(nodes.iter().copied(), places)
        ),
        ConstraintError::Twice { node, .. } => {
            format!(
                "{} is tied already by an earlier [[tie]]; take it out of one of the regions",
                node_in_words(*node, places)
            )
        }
    }
}

/// What prescribes an axis of a node.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    Nothing,
    /// Held at rest, by whichever `[[body.fix]]`.
    Fix,
    /// The moved region of this number.
    Move(usize),
}

/// Refuses prescribed nodes that follow others which are not prescribed in the same way.
///
/// A following node moves as its masters do: what the scene says of it is either redundant or a contradiction.
pub(super) fn check_prescribed(
    constraints: &[Constraint],
    scene: &Scene,
    places: &[Option<Place<'_>>],
    fixed: &[conditions::Fixed],
    moved: &[MovedNodes],
    findings: &mut Findings,
) {
    // After a problem the lists may not match the scene's.
    if constraints.is_empty() || findings.any_problem() {
        return;
    }
    let count = places.iter().flatten().map(|place| place.body.mesh.nodes.len()).sum();
    let mut sources = vec![[Source::Nothing; 3]; count];
    let mut regions: Vec<(&[u32], &Location)> = Vec::new();
    let fixes = scene.bodies.iter().flat_map(|body| &body.fixes);
    for ((nodes, axes), fix) in fixed.iter().zip(fixes) {
        regions.push((nodes, &fix.region.at));
        for &n in nodes {
            (0..3).filter(|&a| axes[a]).for_each(|a| sources[n as usize][a] = Source::Fix);
        }
    }
    for (number, region) in moved.iter().enumerate() {
        let motion = &scene.bodies[region.source.0].moves[region.source.1];
        regions.push((&region.nodes, &motion.region.at));
        for &n in &region.nodes {
            (0..3).filter(|&a| motion.axes[a]).for_each(|a| sources[n as usize][a] = Source::Move(number));
        }
    }
    for (nodes, at) in regions {
        let clashes = |c: &&Constraint| {
            (0..3).any(|a| {
                let own = sources[c.node as usize][a];
                own != Source::Nothing && c.masters.iter().any(|m| sources[m.0 as usize][a] != own)
            })
        };
        let of_region = constraints.iter().filter(|c| nodes.binary_search(&c.node).is_ok());
        let bad: Vec<&Constraint> = of_region.filter(clashes).collect();
        let Some(first) = bad.first() else { continue };
        let message = format!(
            "{} nodes of this region follow nodes that are not prescribed in the same way, and cannot do both: {}; {} follows \
             {}: take these into the region too, or write `conforming = \"off\"` in [[body]]",
            bad.len(),
            nodes_in_words(bad.iter().map(|c| c.node), places),
            node_in_words(first.node, places),
            nodes_in_words(first.masters.iter().map(|m| m.0), places)
        );
        findings.problem(at, message);
    }
}
