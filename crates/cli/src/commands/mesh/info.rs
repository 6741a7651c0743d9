//! `souple mesh info`: what a mesh file holds, and whether it is fit to compute with.

use super::exchange::{Imported, read};
use crate::failure::Failure;
use crate::terminal::{say, say_json};
use anyhow::Context as _;
use clap::Args;
use serde_json::{Value, json};
use souple_simulation::mesh::check::{self, MeshReport, UnitGuess};
use souple_simulation::mesh::constraint::{Cause, Conformity, conformity};
use souple_simulation::mesh::formats::ImportReport;
use souple_simulation::mesh::topology::{Interface, Topology, interfaces};
use souple_simulation::mesh::{ElementId, Mesh};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// How many elements or nodes of a kind are named before the rest is only counted.
const NAMED: usize = 10;

#[derive(Debug, Args)]
#[command(after_help = "Example: souple mesh info liver.msh --json")]
pub(super) struct Arguments {
    /// The mesh file (for a mixed model, one of its three)
    file: PathBuf,
    /// One line of JSON instead of text
    #[arg(long)]
    json: bool,
}

/// Faces without and with quarrels.
struct Faces {
    exterior: usize,
    interfaces: Vec<Interface>,
    conformity: Conformity,
    non_manifold: usize,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let imported = read(&arguments.file)?;
    let mesh = &imported.triple.mesh;
    let context = || arguments.file.display().to_string();
    let report = check::report(mesh).with_context(context)?;
    let topology = Topology::new(mesh).with_context(context)?;
    let conformity = conformity(mesh, &topology).with_context(context)?;
    let mut interfaces = interfaces(&topology);
    // Constraints make these conform.
    interfaces.retain(|interface| !matches!(interface, Interface::DifferentInterpolation { .. }));
    let faces = Faces {
        exterior: conformity.skin(&topology).len(),
        interfaces,
        conformity,
        non_manifold: topology.non_manifold.len(),
    };
    if arguments.json {
        return say_json(&answer(&imported, &report, &faces));
    }
    say(&text(&imported, &report, &faces))
}

fn id(mesh: &Mesh, e: ElementId) -> Value {
    json!({"element": mesh.blocks[e.block as usize].element.id, "index": e.index, "nodes": mesh.nodes_of(e)})
}

/// A list with its full length and its first members.
fn some<T>(list: &[T], show: impl Fn(&T) -> Value) -> Value {
    json!({"count": list.len(), "first": list.iter().take(NAMED).map(show).collect::<Vec<_>>()})
}

fn unit(guess: UnitGuess) -> &'static str {
    match guess {
        UnitGuess::Metres => "m",
        UnitGuess::Millimetres => "mm",
        UnitGuess::Unknown => "unknown",
    }
}

fn answer(imported: &Imported, report: &MeshReport, faces: &Faces) -> Value {
    let mesh = &imported.triple.mesh;
    let elements = |list: &[ElementId]| some(list, |e| id(mesh, *e));
    let kinds: BTreeMap<&str, usize> = report.kinds.iter().copied().collect();
    let regions: BTreeMap<&str, Value> = mesh
        .regions
        .iter()
        .map(|(name, r)| (name.as_str(), json!({"nodes": r.nodes.len(), "elements": r.elements.len()})))
        .collect();
    json!({
        "nodes": report.nodes,
        "elements": kinds,
        "dimension": report.dimension,
        "bounds": report.bounds.map(|b| json!({"min": b.min, "max": b.max})),
        "measure": report.measure,
        "quality": report.quality.map(|q| json!({"min": q.min, "mean": q.mean, "worst": id(mesh, q.worst)})),
        "inverted": elements(&report.inverted),
        "tangled": elements(&report.tangled),
        "degenerate": elements(&report.degenerate),
        "slivers": elements(&report.slivers),
        "unreferenced": some(&report.unreferenced, |n| json!(n)),
        "duplicates": some(&report.duplicates, |(node, first)| json!([node, first])),
        "unit": unit(report.unit),
        "boundary_faces": faces.exterior,
        "nonconforming_interfaces": faces.interfaces.len(),
        "constraints": {
            "hanging_nodes": faces.conformity.count(Cause::Hanging),
            "nodes_between_interpolations": faces.conformity.count(Cause::Interpolation),
            "sides": faces.conformity.sides,
            "rough_faces": faces.conformity.rough,
        },
        "non_manifold_faces": faces.non_manifold,
        "regions": regions,
        "import": imported.report.as_ref().map(import),
        "fit": problems(report, faces).is_empty(),
    })
}

fn import(r: &ImportReport) -> Value {
    json!({
        "format": r.format,
        "found": r.found,
        "skipped": r.skipped.iter().map(|s| json!({"what": s.what, "count": s.count, "why": s.why})).collect::<Vec<_>>(),
        "reordered": r.reordered,
        "flipped": r.flipped,
        "reversed": r.reversed,
        "reduced": r.reduced,
        "split": r.split,
        "dropped_nodes": r.dropped_nodes,
        "repeated_elements": r.repeated_elements,
        "welded_nodes": r.welded_nodes,
        "unreferenced_nodes": r.unreferenced_nodes,
        "duplicate_nodes": r.duplicate_nodes,
        "ignored": r.ignored,
    })
}

/// What keeps the mesh from being computed with as it stands.
fn problems(report: &MeshReport, faces: &Faces) -> Vec<String> {
    let mut found = Vec::new();
    let mut count = |n: usize, what: &str| {
        if n > 0 {
            found.push(format!("{n} {what}"));
        }
    };
    count(report.inverted.len(), "elements inside out (reading a scene turns them)");
    count(
        report.tangled.len(),
        "elements positive in one place and negative in another: move their nodes or mesh again",
    );
    count(report.degenerate.len(), "elements flat at a corner: move their nodes or mesh again");
    count(
        faces.interfaces.len(),
        "places where faces meet that are not the same: displacements are not continuous there",
    );
    count(faces.non_manifold, "faces of more than two elements");
    if report.dimension == 0 {
        found.push("no element: there is nothing to deform".to_owned());
    }
    found
}

fn text(imported: &Imported, report: &MeshReport, faces: &Faces) -> String {
    let mesh = &imported.triple.mesh;
    let mut out = format!("{}\n", imported.account.trim_end());
    let mut line = |title: &str, content: String| out.push_str(&format!("  {title:<11}{content}\n"));
    let kinds: Vec<String> = report.kinds.iter().map(|(id, count)| format!("{count} {id}")).collect();
    if imported.report.is_none() {
        line("found", kinds.join(", "));
        for (name, r) in &mesh.regions {
            line("region", format!("{name}: {} nodes, {} elements", r.nodes.len(), r.elements.len()));
        }
    }
    if let Some(b) = report.bounds {
        line("bounds", format!("{:?} to {:?}", b.min, b.max));
    }
    let measure = ["", "length", "area", "volume"][report.dimension.min(3)];
    if report.dimension > 0 {
        line(measure, format!("{} (coordinates look like {})", report.measure, unit(report.unit)));
        line("boundary", format!("{} faces", faces.exterior));
    }
    if !faces.conformity.constraints.is_empty() {
        line("conforming", faces.conformity.to_string());
    }
    if faces.conformity.rough > 0 {
        line("note", format!("{} faces that finer elements on them cannot follow quite", faces.conformity.rough));
    }
    if let Some(q) = report.quality {
        let worst = mesh.blocks[q.worst.block as usize].element.id;
        line("quality", format!("mean {:.3}, least {:.3} ({worst} {})", q.mean, q.min, q.worst.index));
    }
    let counts = [
        (report.slivers.len(), "very flat elements"),
        (report.unreferenced.len(), "nodes of no element"),
        (report.duplicates.len(), "nodes at the place of another one"),
    ];
    for (count, what) in counts.into_iter().filter(|(count, _)| *count > 0) {
        line("note", format!("{count} {what}"));
    }
    let problems = problems(report, faces);
    for problem in &problems {
        line("problem", problem.clone());
    }
    if problems.is_empty() {
        line("verdict", "fit to compute with".to_owned());
    }
    out
}
