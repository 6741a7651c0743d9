//! `souple mesh bar`: a bar of one or several kinds of elements, from arguments or from a configuration file.

use super::Style;
use super::exchange::{Writer, encode};
use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::{note, say, say_json};
use anyhow::Context as _;
use clap::{Args, ValueEnum};
use serde_json::json;
use souple_simulation::lists::find_element;
use souple_simulation::mesh::bar::{Axis, BarReport, BarSpec, Section, Split, Transition, generate};
use souple_simulation::mesh::triple::{Triple, bar_config};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
    souple mesh bar --size 8,1,1 --cells 24,4,4 --section 0.25:prism6 --section 1.0:tet4 -o bar.vtu\n  \
    souple mesh bar --size 1,0.1,0.1 --cells 10,1,1 --section 1:hex8 -o bar.msh\n  \
    souple mesh bar --config barreMixte.txt\n\n\
    OUT ends in .msh, .vtu, .vtk, .inp, or .element (the three files of a mixed model).")]
pub(super) struct Arguments {
    /// Lengths in metres: x,y,z
    #[arg(long, value_name = "X,Y,Z", required_unless_present = "config")]
    size: Option<String>,
    /// Numbers of cells: x,y,z
    #[arg(long, value_name = "X,Y,Z", required_unless_present = "config")]
    cells: Option<String>,
    /// Corner with the least coordinates, in metres
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    origin: String,
    /// A section along x: the fraction of the length where it ends, and its element; repeat it, the last one ends at 1
    #[arg(long = "section", value_name = "UNTIL:ELEMENT", required_unless_present = "config")]
    sections: Vec<String>,
    /// What to do where quadrangles of one section meet triangles of the next
    #[arg(long, value_enum, default_value = "keep")]
    transition: TransitionName,
    /// Tetrahedra per cell
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u8).range(5..=6))]
    tetrahedra: u8,
    /// Axis along which prisms are extruded
    #[arg(long, value_enum, default_value = "x")]
    prism_axis: AxisName,
    /// Take the bar from a configuration file (longueur, largeurSection, …) instead of the options above
    #[arg(long, value_name = "FILE", conflicts_with_all = ["size", "cells", "sections", "origin", "transition", "tetrahedra", "prism_axis"])]
    config: Option<PathBuf>,
    /// The file to write; with --config, the folder and name that the configuration says if not given
    #[arg(short, long, value_name = "OUT", required_unless_present = "config")]
    output: Option<PathBuf>,
    #[command(flatten)]
    style: Style,
    /// One line of JSON about what was made
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TransitionName {
    /// Keep the elements as asked for and report the faces that do not match
    Keep,
    /// Insert a layer of cells with pyramids, so that all faces match
    Pyramids,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AxisName {
    X,
    Y,
    Z,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (model, report, output) = match &arguments.config {
        Some(file) => configured(file, arguments.output.as_deref())?,
        None => {
            let output = arguments.output.clone().expect("clap requires it without a configuration");
            let (mesh, report) = generate(&specification(arguments)?).map_err(input)?;
            (Triple { mesh, ..Triple::default() }, report, output)
        }
    };
    let written = encode(Writer::of(&output)?, &output, &model, &arguments.style)?;
    for (path, bytes) in &written {
        files::write(path, bytes)?;
    }
    for warning in report.warnings() {
        note(&format!("warning: {warning}"));
    }
    let paths: Vec<String> = written.iter().map(|(path, _)| path.display().to_string()).collect();
    let elements: BTreeMap<&str, usize> = model.mesh.blocks.iter().map(|b| (b.element.id, b.len())).collect();
    if arguments.json {
        return say_json(&json!({
            "files": paths,
            "nodes": model.mesh.nodes.len(),
            "elements": elements,
            "mismatched_faces": report.mismatched_faces(),
            "transition_cells": report.transition_cells,
            "regions": model.mesh.regions.keys().collect::<Vec<_>>(),
        }));
    }
    let elements: Vec<String> = elements.iter().map(|(id, count)| format!("{count} {id}")).collect();
    let (nodes, elements, paths) = (model.mesh.nodes.len(), elements.join(", "), paths.join(", "));
    say(&format!("{nodes} nodes, {elements}; wrote {paths}"))
}

/// The model of a configuration file, and where it goes.
fn configured(file: &Path, output: Option<&Path>) -> Result<(Triple, BarReport, PathBuf), Failure> {
    let context = || file.display().to_string();
    let config = bar_config::read(&files::read_text(file)?).with_context(context)?;
    let (model, report) = bar_config::model(&config).with_context(context)?;
    let output = output.map_or_else(
        || {
            let folder = file.parent().unwrap_or(Path::new("")).join(&config.directory);
            // The name may hold dots; the ending is added, not replaced.
            folder.join(format!("{}.element", config.mesh_name))
        },
        Path::to_owned,
    );
    Ok((model, report, output))
}

fn specification(arguments: &Arguments) -> Result<BarSpec, Failure> {
    let size = three(arguments.size.as_deref(), "--size", "lengths in metres, such as 8,1,1")?;
    let cells = three(arguments.cells.as_deref(), "--cells", "numbers of cells, such as 24,4,4")?;
    let origin = three(Some(&arguments.origin), "--origin", "coordinates in metres, such as 0,0,0")?;
    let sections = arguments.sections.iter().map(|s| section(s, arguments)).collect::<Result<_, _>>()?;
    let transition = match arguments.transition {
        TransitionName::Keep => Transition::Keep,
        TransitionName::Pyramids => Transition::InsertPyramids,
    };
    Ok(BarSpec { size, cells, origin, sections, transition })
}

/// Three numbers with commas between them.
fn three<T: std::str::FromStr>(text: Option<&str>, option: &str, expected: &str) -> Result<[T; 3], Failure> {
    let text = text.expect("clap requires it without a configuration");
    let numbers: Option<Vec<T>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    numbers
        .and_then(|n| <[T; 3]>::try_from(n).ok())
        .ok_or_else(|| input(format!("{option} {text}: expected three {expected}")))
}

/// `0.25:prism6`.
fn section(text: &str, arguments: &Arguments) -> Result<Section, Failure> {
    let form = || input(format!("--section {text}: expected UNTIL:ELEMENT, such as 0.25:prism6 or 1.0:tet4"));
    let (until, id) = text.split_once(':').ok_or_else(form)?;
    let until: f64 = until.trim().parse().map_err(|_| form())?;
    let element = find_element(id.trim()).map_err(|e| input(format!("--section {text}: {e}")))?;
    let axis = match arguments.prism_axis {
        AxisName::X => Axis::X,
        AxisName::Y => Axis::Y,
        AxisName::Z => Axis::Z,
    };
    let split = match element.family.name() {
        "tetrahedron" if arguments.tetrahedra == 5 => Split::Tetrahedra5,
        "prism" => Split::Prisms(axis),
        _ => Split::Usual,
    };
    Ok(Section { until, element, split })
}
