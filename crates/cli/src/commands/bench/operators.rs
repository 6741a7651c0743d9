//! `souple bench operators`.

use super::{Rounds, at_least_one, machine_line, spread, threads};
use crate::failure::{Failure, input};
use crate::terminal::{note, say, say_json, table};
use clap::Args;
use souple_bench::operators::{Report, Request, measure};
use souple_simulation::open_device;

#[derive(Debug, Args)]
#[command(after_help = "Example: souple bench operators --element tet4,hex8 --law hooke --threads 1\n\n\
    Times are ns per element. The assembled product runs on one thread.")]
pub(crate) struct Arguments {
    /// Elements, separated by commas, or `all` (see: souple list elements)
    #[arg(long, default_value = "tet4,hex8,prism6,pyramid5,tet10,hex20")]
    element: String,
    /// Laws, separated by commas, or `all` (see: souple list laws)
    #[arg(long, default_value = "stvk,hooke")]
    law: String,
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Number of threads; 0 takes as many as the machine has
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Number of elements of each model
    #[arg(long, default_value_t = 10_000, value_parser = at_least_one)]
    elements: usize,
    #[command(flatten)]
    rounds: Rounds,
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let backend = open_device(&arguments.device).map_err(input)?;
    let request = Request {
        elements: super::elements(&arguments.element)?,
        laws: super::laws(&arguments.law)?,
        backend: &*backend,
        threads: threads(arguments.threads),
        count: arguments.elements,
        effort: arguments.rounds.effort(),
    };
    let report = measure(&request, &mut |next| note(next)).map_err(input)?;
    if arguments.json { say_json(&report) } else { say(&text(&report)) }
}

fn text(report: &Report) -> String {
    let head = machine_line(&report.machine, &report.device, report.threads);
    let heads =
        ["element", "law", "elements", "nodes", "force", "linearise", "product", "assembled product", "assembly"];
    let rows: Vec<Vec<String>> = report
        .rows
        .iter()
        .map(|row| {
            let names = [row.element.to_owned(), row.law.to_owned(), row.elements.to_string(), row.nodes.to_string()];
            let times = [&row.force, &row.linearise, &row.matrix_free_product, &row.assembled_product, &row.assembly];
            names.into_iter().chain(times.map(spread)).collect()
        })
        .collect();
    format!("{head}; ns per element\n\n{}", table(&heads, &rows))
}
