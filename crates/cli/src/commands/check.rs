//! `souple check`: reads a scene with its meshes and says what was found, without computing anything.

use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::{note, say, say_json, table};
use clap::Args;
use serde::Serialize;
use souple_simulation::prepare::{Prepared, PreparedBody, catalogue, prepare};
use souple_simulation::scene::{Named as _, Scene, parse_with_overrides};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  souple check scenes/bar.toml\n  souple check bar.toml --set time.step=0.001 --json"
)]
pub(crate) struct Arguments {
    /// The scene file
    scene: PathBuf,
    /// Change a value of the scene; repeat it
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// One line of JSON instead of text
    #[arg(long)]
    json: bool,
}

/// What a scene holds.
#[derive(Serialize)]
struct Found {
    scene: String,
    title: String,
    dimension: usize,
    nodes: usize,
    elements: BTreeMap<&'static str, usize>,
    integrator: &'static str,
    step: f64,
    end: f64,
    bodies: Vec<FoundBody>,
    probes: Vec<FoundProbe>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct FoundBody {
    name: String,
    nodes: usize,
    elements: BTreeMap<&'static str, usize>,
    materials: Vec<FoundMaterial>,
    /// Nodes and elements of the regions of the mesh, by name.
    regions: BTreeMap<String, FoundRegion>,
    /// Nodes with at least one fixed axis.
    fixed_nodes: usize,
    /// Nodes that are moved.
    moved_nodes: usize,
    /// What reading or generating the mesh had to report.
    mesh: String,
}

#[derive(Serialize)]
struct FoundMaterial {
    law: &'static str,
    element: &'static str,
    quadrature: &'static str,
    elements: usize,
    density: f64,
    parameters: BTreeMap<&'static str, f64>,
}

#[derive(Serialize)]
struct FoundRegion {
    nodes: usize,
    elements: usize,
}

#[derive(Serialize)]
struct FoundProbe {
    name: String,
    nodes: usize,
    elements: usize,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = arguments.scene.display().to_string();
    let text = files::read_text(&arguments.scene)?;
    let overrides: Vec<&str> = arguments.overrides.iter().map(String::as_str).collect();
    let (scene, warnings) = parse_with_overrides(&text, &file, &overrides, &catalogue()).map_err(input)?;
    let mut warnings: Vec<String> = warnings.iter().map(|w| w.in_file(&file)).collect();
    let (prepared, more) = prepare(&scene, &file, &mut reader(&arguments.scene)).map_err(input)?;
    warnings.extend(more);

    let found = found(file, &scene, &prepared, warnings);
    if arguments.json {
        return say_json(&found);
    }
    for warning in &found.warnings {
        note(warning);
    }
    say(&text_of(&found))
}

/// Reads the files that a scene names: relative to the scene's folder.
pub(in crate::commands) fn reader(scene: &Path) -> impl FnMut(&str) -> Result<Vec<u8>, String> + use<> {
    let folder = scene.parent().map(Path::to_owned).unwrap_or_default();
    move |name| {
        let path = folder.join(name);
        std::fs::read(&path).map_err(|e| format!("cannot read {}: {e}", path.display()))
    }
}

fn found(file: String, scene: &Scene, prepared: &Prepared, warnings: Vec<String>) -> Found {
    let bodies: Vec<FoundBody> = prepared.bodies.iter().map(|body| found_body(prepared, body)).collect();
    let mut elements = BTreeMap::new();
    for (id, count) in bodies.iter().flat_map(|b| &b.elements) {
        *elements.entry(*id).or_default() += count;
    }
    let probes = scene.probes.iter().zip(&prepared.probes);
    Found {
        scene: file,
        title: scene.title.clone(),
        dimension: prepared.dimension,
        nodes: prepared.nodes.len(),
        elements,
        integrator: scene.integrator.method.value.name(),
        step: scene.time.step.value,
        end: scene.time.end.value,
        bodies,
        probes: probes
            .map(|(p, r)| FoundProbe { name: p.name.value.clone(), nodes: r.nodes.len(), elements: r.elements.len() })
            .collect(),
        warnings,
    }
}

fn found_body(prepared: &Prepared, body: &PreparedBody) -> FoundBody {
    let nodes = body.first_node..body.first_node + body.mesh.nodes.len() as u32;
    let last = body.first_element + body.elements.len() as u32;
    let materials = prepared.blocks.iter().filter_map(|block| {
        let count = block.ids.iter().filter(|id| (body.first_element..last).contains(id)).count();
        let names = block.law.parameters.iter().map(|p| p.name);
        (count > 0).then(|| FoundMaterial {
            law: block.law.id,
            element: block.element.id,
            quadrature: block.rule.id,
            elements: count,
            density: block.density,
            parameters: names.zip(block.parameters.iter().copied()).collect(),
        })
    });
    let materials: Vec<FoundMaterial> = materials.collect();
    // Regions overlap: a node counts once.
    let distinct = |lists: &mut dyn Iterator<Item = &u32>| {
        let mut held: Vec<u32> = lists.filter(|n| nodes.contains(n)).copied().collect();
        held.sort_unstable();
        held.dedup();
        held.len()
    };
    let regions = body
        .mesh
        .regions
        .iter()
        .map(|(name, r)| (name.clone(), FoundRegion { nodes: r.nodes.len(), elements: r.elements.len() }));
    FoundBody {
        name: body.name.clone(),
        nodes: body.mesh.nodes.len(),
        elements: body.kinds().into_iter().map(|(element, count)| (element.id, count)).collect(),
        materials,
        regions: regions.collect(),
        fixed_nodes: distinct(&mut prepared.fixed.iter().flat_map(|f| &f.0)),
        moved_nodes: distinct(&mut prepared.moved.iter().flat_map(|m| &m.nodes)),
        mesh: body.report.clone(),
    }
}

fn counted(elements: &BTreeMap<&'static str, usize>) -> String {
    elements.iter().map(|(id, count)| format!("{count} {id}")).collect::<Vec<_>>().join(", ")
}

fn text_of(found: &Found) -> String {
    let mut out = format!("{}: {}\n", found.scene, if found.title.is_empty() { "untitled" } else { &found.title });
    out.push_str(&format!("  {} nodes, {}\n", found.nodes, counted(&found.elements)));
    out.push_str(&format!("  {}, steps of {} s until {} s\n", found.integrator, found.step, found.end));
    for body in &found.bodies {
        out.push_str(&format!("\nbody {}: {} nodes, {}\n", body.name, body.nodes, counted(&body.elements)));
        out.push_str(&format!("  {} nodes fixed, {} moved\n", body.fixed_nodes, body.moved_nodes));
        for line in body.mesh.lines() {
            out.push_str(&format!("  mesh: {}\n", line.trim()));
        }
        let rows: Vec<Vec<String>> = body
            .materials
            .iter()
            .map(|m| {
                let parameters: Vec<String> = m.parameters.iter().map(|(n, v)| format!("{n} {}", number(*v))).collect();
                let start = [m.law, m.element, m.quadrature].map(str::to_owned);
                start
                    .into_iter()
                    .chain([m.elements.to_string(), m.density.to_string(), parameters.join(", ")])
                    .collect()
            })
            .collect();
        out.push_str(&table(&["  law", "element", "quadrature", "elements", "density", "parameters"], &indented(rows)));
        let rows: Vec<Vec<String>> = body
            .regions
            .iter()
            .map(|(name, r)| vec![name.clone(), r.nodes.to_string(), r.elements.to_string()])
            .collect();
        if !rows.is_empty() {
            out.push_str(&table(&["  region", "nodes", "elements"], &indented(rows)));
        }
    }
    if !found.probes.is_empty() {
        out.push('\n');
        let rows: Vec<Vec<String>> =
            found.probes.iter().map(|p| vec![p.name.clone(), p.nodes.to_string(), p.elements.to_string()]).collect();
        out.push_str(&table(&["probe", "nodes", "elements"], &rows));
    }
    out
}

/// A number as short as it can be without losing a digit.
fn number(x: f64) -> String {
    let (plain, scientific) = (x.to_string(), format!("{x:e}"));
    if plain.len() <= scientific.len() + 2 { plain } else { scientific }
}

fn indented(mut rows: Vec<Vec<String>>) -> Vec<Vec<String>> {
    rows.iter_mut().for_each(|row| row[0].insert_str(0, "  "));
    rows
}
