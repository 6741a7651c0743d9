//! `souple derive`: an element with a law becomes programs; this shows what they cost and what they are.

use crate::failure::{Failure, input};
use crate::terminal::{say, say_json};
use clap::{Args, ValueEnum};
use serde::Serialize;
use souple_simulation::derive_report::{self, Association, Costs, Derived, Loops, OUTPUTS, PROGRAMS, Report};
use souple_simulation::lists::{embedding, find_element, find_law, find_name, find_rule};
use std::time::Instant;

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  souple derive --element hex8 --law stvk\n  \
    souple derive --element tet4 --law stvk --output force --show expressions\n  \
    souple derive --element tri3 --law hooke --show latex > tri3.tex\n  \
    souple derive --element hex8 --law stvk --output tangent_apply --show wgsl\n  \
    souple derive --element tri3 --law neo-hookean --embedded 3")]
pub(crate) struct Arguments {
    /// Id of the element (see: souple list elements)
    #[arg(long)]
    element: String,
    /// Id of the law (see: souple list laws)
    #[arg(long)]
    law: String,
    /// Id or number of points of the quadrature; without it, the element's default
    #[arg(long)]
    quadrature: Option<String>,
    /// Number of space dimensions, more than the element's own: a cable (edges) or a membrane (faces)
    #[arg(long, value_name = "DIMENSIONS")]
    embedded: Option<usize>,
    /// What to show with `--show expressions`, `program`, `wgsl` and `cuda`: energy, force, tangent_apply, tangent_blocks,
    /// lumped_mass, shape_mass or setup
    #[arg(long, default_value = "force")]
    output: String,
    /// What to print
    #[arg(long, value_enum, default_value = "summary")]
    show: Show,
    /// Write every quadrature point out instead of looping over them
    #[arg(long)]
    unrolled: bool,
    /// Price of carrying a value to a later program, in operations; 0 carries everything that saves one
    #[arg(long, value_name = "N")]
    carry_price: Option<u64>,
    /// One line of JSON: the numbers of the summary, with the text of `--show` if another one is asked for
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Show {
    /// Operations and carried values of every program
    Summary,
    /// The output as named formulas
    Expressions,
    /// The output's program
    Program,
    /// A LaTeX document from displacements to forces
    Latex,
    /// The output's program as graphics devices run it, in WGSL
    Wgsl,
    /// The output's program in CUDA C
    Cuda,
}

/// The JSON: the report, how long deriving took, and the text that was asked for.
#[derive(Serialize)]
struct Answer {
    #[serde(flatten)]
    report: Report,
    derive_ms: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    shown: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let element = find_element(&arguments.element).map_err(input)?;
    let law = find_law(&arguments.law).map_err(input)?;
    let rule = find_rule(element, arguments.quadrature.as_deref()).map_err(input)?;
    let output = known_output(&arguments.output, arguments.show)?;
    let dimension = match arguments.embedded {
        None => element.dimension(),
        Some(space) => embedding(element, law, space).map_err(input)?,
    };
    let loops = if arguments.unrolled { Loops::Unrolled } else { Loops::Rolled };
    let costs = arguments.carry_price.map_or_else(Costs::default, |carry| Costs { carry });

    let start = Instant::now();
    let derived = derive_report::derive(Association { element, law, rule, loops, dimension }, costs);
    let derive_ms = start.elapsed().as_secs_f64() * 1e3;

    let shown = shown(&derived, arguments.show, output)?;
    let report = derive_report::report(&derived);
    if arguments.json {
        return say_json(&Answer { report, derive_ms, shown });
    }
    match shown {
        Some(text) => say(&text),
        None => say(&format!("{}\nderived in {derive_ms:.1} ms", derive_report::summary(&report))),
    }
}

/// Programs have names of their own beside the outputs; formulas are those of the outputs.
fn known_output(name: &str, show: Show) -> Result<&'static str, Failure> {
    let mut known = OUTPUTS.to_vec();
    if matches!(show, Show::Program | Show::Wgsl | Show::Cuda) {
        known.extend(PROGRAMS.iter().filter(|p| !OUTPUTS.contains(p)));
    }
    find_name("output", name, &known).map_err(input)
}

/// The text that `--show` asks for; none for the summary.
fn shown(derived: &Derived, show: Show, output: &str) -> Result<Option<String>, Failure> {
    Ok(match show {
        Show::Summary => None,
        Show::Expressions => derive_report::expressions(derived, output),
        Show::Program => derive_report::program_text(derived, output),
        Show::Latex => Some(derive_report::latex(derived)),
        Show::Wgsl => printed(derived, output, Language::Wgsl)?,
        Show::Cuda => printed(derived, output, Language::Cuda)?,
    })
}

/// Languages of devices.
#[derive(Clone, Copy)]
enum Language {
    Wgsl,
    Cuda,
}

#[cfg(feature = "gpu")]
fn printed(derived: &Derived, output: &str, language: Language) -> Result<Option<String>, Failure> {
    let language = match language {
        Language::Wgsl => derive_report::Language::Wgsl,
        Language::Cuda => derive_report::Language::Cuda,
    };
    derive_report::device_text(derived, output, language).map_err(input)
}

#[cfg(not(feature = "gpu"))]
fn printed(_: &Derived, _: &str, language: Language) -> Result<Option<String>, Failure> {
    let name = match language {
        Language::Wgsl => "wgsl",
        Language::Cuda => "cuda",
    };
    Err(input(format!("this build has no graphics devices and does not print {name}: build with the feature `gpu`")))
}
