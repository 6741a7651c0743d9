//! `souple bench setup`.

use super::machine_line;
use super::step::{BarArguments, DeviceArguments, failure};
use crate::failure::Failure;
use crate::terminal::{note, say, say_json, table};
use clap::Args;
use souple_bench::setup::{Report, measure};

#[derive(Debug, Args)]
#[command(after_help = "Example: souple bench setup --cells 1000000 --element tet4\n\n\
    Memory is the highest of the process until the bar was loaded (VmHWM).")]
pub(crate) struct Arguments {
    #[command(flatten)]
    bar: BarArguments,
    #[command(flatten)]
    device: DeviceArguments,
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bar = arguments.bar.bar()?;
    let report = measure(&bar, &arguments.device.options(), &mut |next| note(next)).map_err(failure)?;
    if arguments.json { say_json(&report) } else { say(&text(&report)) }
}

fn text(report: &Report) -> String {
    let rows: Vec<Vec<String>> = [
        ("load", report.load_s),
        ("  parse", report.parse_s),
        ("  prepare", report.prepare_s),
        ("  elements", report.elements_s),
        ("  pattern", report.pattern_s),
    ]
    .map(|(name, s)| vec![name.to_owned(), format!("{s:.3}")])
    .into();
    let memory = report.peak_memory_bytes.map(|b| format!(", {:.0} MiB at most", b as f64 / 1048576.0));
    format!(
        "{}\n{} elements, {} unknowns{}\n\n{}",
        machine_line(&report.machine, &report.device, report.threads),
        report.elements,
        report.unknowns,
        memory.unwrap_or_default(),
        table(&["", "s"], &rows)
    )
}
