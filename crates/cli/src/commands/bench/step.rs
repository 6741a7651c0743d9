//! `souple bench step`.

use super::{at_least_one, machine_line, spread};
use crate::commands::check::reader;
use crate::failure::{Failure, input};
use crate::files;
use crate::terminal::{note, say, say_json, table};
use clap::{Args, ValueEnum};
use souple_bench::step::{Bar, Filling, Report, Solve, StepError, measure};
use souple_simulation::RunOptions;
use souple_simulation::lists::{find_element, find_law};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  souple bench step --cells 10000 --element tet4 --cg 25 --threads 1\n  \
    souple bench step --cells 3000 --element mixed --law hooke,stvk --tolerance 1e-4 --threads 2\n  \
    souple bench step --scene scenes/mixed_bar.toml --steps 50 --json\n  \
    souple bench step --cells 1000000 --element hex8 --cg 50 --device gpu\n\n\
    A generated bar makes implicit Euler steps, with exactly so many iterations of conjugate gradients, or to a tolerance.")]
pub(crate) struct Arguments {
    #[command(flatten)]
    bar: BarArguments,
    /// Measure the steps of this scene instead of a generated bar's
    #[arg(long, conflicts_with_all = ["cells", "element", "law", "cg", "tolerance", "operator"])]
    scene: Option<PathBuf>,
    #[command(flatten)]
    device: DeviceArguments,
    /// Number of steps that are measured
    #[arg(long, default_value_t = 20, value_parser = at_least_one)]
    steps: usize,
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

/// What a bar is made of.
#[derive(Debug, Args)]
pub(super) struct BarArguments {
    /// About how many elements the bar has
    #[arg(long, default_value_t = 10_000, value_parser = at_least_one)]
    cells: usize,
    /// What fills it: an element (see: souple list elements), or `mixed` for prisms, pyramids, hexahedra and tetrahedra
    #[arg(long, default_value = "tet4")]
    element: String,
    /// Its law, one with Young's modulus and Poisson's ratio; several, separated by commas, share it along its length
    #[arg(long, default_value = "stvk", value_delimiter = ',')]
    law: Vec<String>,
    /// Iterations of conjugate gradients per step, without a preconditioner
    #[arg(long, default_value_t = 25, value_parser = at_least_one)]
    cg: usize,
    /// Solve to this relative residual instead, with the default preconditioner
    #[arg(long, conflicts_with = "cg", value_parser = tolerance)]
    tolerance: Option<f64>,
    /// How the matrix is applied
    #[arg(long, value_enum, default_value_t = Operator::Auto)]
    operator: Operator,
}

/// A tolerance between none and all.
fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value < 1.0 => Ok(value),
        _ => Err("expected a number between 0 and 1".to_owned()),
    }
}

/// The words of scenes.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Operator {
    /// As scenes do when they say nothing: assembled
    Auto,
    /// Element by element
    MatrixFree,
    /// Assembled once per step
    Assembled,
}

/// What runs it.
#[derive(Debug, Args)]
pub(super) struct DeviceArguments {
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Number of threads; 0 takes as many as the machine has
    #[arg(long, default_value_t = 1)]
    threads: usize,
}

impl DeviceArguments {
    pub(super) fn options(&self) -> RunOptions {
        RunOptions { device: self.device.clone(), threads: super::threads(self.threads) }
    }
}

impl BarArguments {
    pub(super) fn bar(&self) -> Result<Bar, Failure> {
        let filling = match self.element.as_str() {
            "mixed" => Filling::Mixed,
            id => Filling::Element(find_element(id).map_err(input)?.id.to_owned()),
        };
        let laws: Result<Vec<String>, _> = self.law.iter().map(|law| find_law(law).map(|l| l.id.to_owned())).collect();
        let laws = laws.map_err(input)?;
        let solve = self.tolerance.map_or(Solve::Iterations(self.cg), Solve::Tolerance);
        let operator = match self.operator {
            Operator::Auto => "auto",
            Operator::MatrixFree => "matrix-free",
            Operator::Assembled => "assembled",
        };
        Ok(Bar { filling, laws, elements: self.cells, solve, operator: operator.to_owned() })
    }
}

/// Failed steps have an exit code of their own.
pub(super) fn failure(error: StepError) -> Failure {
    match error {
        StepError::Run(error) => Failure::Simulation(error.to_string()),
        other => input(other),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = arguments.device.options();
    let mut progress = |next: &str| note(next);
    let report = match &arguments.scene {
        Some(path) => {
            let text = files::read_text(path)?;
            let file = path.display().to_string();
            measure(&text, &file, &mut reader(path), &options, arguments.steps, &mut progress)
        }
        None => {
            let text = arguments.bar.bar()?.scene();
            let mut read = reader(Path::new("."));
            measure(&text, "the generated bar", &mut read, &options, arguments.steps, &mut progress)
        }
    };
    let report = report.map_err(failure)?;
    if arguments.json { say_json(&report) } else { say(&text(&report)) }
}

fn text(report: &Report) -> String {
    let phases = report.phases_ms.as_ref();
    let rows: Vec<Vec<String>> = [
        ("step", Some(&report.step_ms)),
        ("  force", phases.map(|p| &p.force)),
        ("  linearise", phases.and_then(|p| p.linearise.as_ref())),
        ("  products", phases.map(|p| &p.product)),
        ("  rest of solve", phases.map(|p| &p.rest_of_solve)),
        ("  other", phases.map(|p| &p.other)),
    ]
    .map(|(name, ms)| match ms {
        Some(ms) => vec![name.to_owned(), spread(ms), format!("{:.3}", ms.least)],
        None => vec![name.to_owned(), "not measured apart".to_owned(), String::new()],
    })
    .into();
    format!(
        "{}\n{} elements, {} unknowns, {} steps of {} iterations, {} steps per second, 99 of 100 below {:.3} ms\n\n{}",
        machine_line(&report.machine, &report.device, report.threads),
        report.elements,
        report.unknowns,
        report.step_ms.rounds,
        report.iterations,
        super::digits(1e3 / report.step_ms.median),
        report.step_ms_p99,
        table(&["", "ms", "least"], &rows)
    )
}
