//! `souple mesh`: generate, inspect and convert meshes.

mod bar;
mod exchange;
mod info;

use crate::failure::Failure;
use crate::files;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Example: souple mesh info liver.msh")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Generate a bar of one or several kinds of elements
    Bar(bar::Arguments),
    /// Say what a mesh file holds and what is wrong with it
    Info(info::Arguments),
    /// Write a mesh file in another format
    Convert(Convert),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  souple mesh convert liver.inp liver.vtu --scale 0.001\n  \
    souple mesh convert model.element model.msh --ascii\n\n\
    Read: .msh .vtu .vtk .inp .mesh .stl .obj .ply, and the three files .obj .element .info of a mixed model.\n\
    Written, by the ending of OUT: .msh .vtu .vtk .inp, and .obj .element .info together.")]
struct Convert {
    /// The file to read (for a mixed model, one of its three)
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The file to write; its ending says the format
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Multiply coordinates: 0.001 turns millimetres into metres
    #[arg(long, default_value_t = 1.0)]
    scale: f64,
    #[command(flatten)]
    style: Style,
}

/// How files are written.
#[derive(Debug, Args)]
struct Style {
    /// Numbers as text, where the format has both (.msh, .vtu)
    #[arg(long)]
    ascii: bool,
    /// How six-node wedges are written to .vtu and .vtk: `lagrange` looks right in every version of VTK, fewer other
    /// programs read it
    #[arg(long, value_enum, default_value = "positive")]
    vtk_wedge: Wedge,
    /// The law written for elements of .info files that come from another format
    #[arg(long, default_value = "SaintVenant")]
    law: String,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Wedge {
    /// Cell type 13
    Positive,
    /// Cell type 73
    Lagrange,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.command {
        Command::Bar(arguments) => bar::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Convert(arguments) => convert(arguments),
    }
}

fn convert(arguments: &Convert) -> Result<(), Failure> {
    // A file is read as a whole before anything is written, so IN and OUT may be the same.
    let writer = exchange::Writer::of(&arguments.output)?;
    if !(arguments.scale.is_finite() && arguments.scale > 0.0) {
        return Err(crate::failure::input(format!(
            "--scale {}: expected a positive number, such as 0.001 for millimetres",
            arguments.scale
        )));
    }
    let mut imported = exchange::read(&arguments.input)?;
    for node in &mut imported.triple.mesh.nodes {
        *node = node.map(|x| x * arguments.scale);
    }
    let written = exchange::encode(writer, &arguments.output, &imported.triple, &arguments.style)?;
    crate::terminal::note(&imported.account);
    for (path, bytes) in &written {
        files::write(path, bytes)?;
        crate::terminal::note(&format!("wrote {}", path.display()));
    }
    Ok(())
}
