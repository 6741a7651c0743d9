//! `souple doctor`: graphics devices, their drivers and limits, and what will be done another way and why.

use crate::failure::Failure;
use crate::terminal::{say, say_json};
use clap::Args;
use souple_simulation::gpu::{AdapterReport, Doctor, doctor};

#[derive(Debug, Args)]
#[command(after_help = "Example: souple doctor --json")]
pub(crate) struct Arguments {
    /// One line of JSON instead of a text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let report = doctor();
    if arguments.json { say_json(&report) } else { say(&text(&report)) }
}

fn text(report: &Doctor) -> String {
    let mut out = String::new();
    for adapter in &report.adapters {
        out.push_str(&of_adapter(adapter));
    }
    for line in &report.advice {
        out.push_str(line);
        out.push('\n');
    }
    out
}

fn of_adapter(a: &AdapterReport) -> String {
    let mebibytes = |bytes: u64| format!("{:.0} MiB", bytes as f64 / f64::from(1u32 << 20));
    let yes = |b: bool| if b { "yes" } else { "no" };
    let mut out = format!(
        "{}: {}\n  driver {}, through {}, {}\n  buffers up to {}, programs see {} of one and {} buffers at most\n  double \
         precision: {}; pipelines kept on disk: {}; time stamps: {}\n",
        a.id,
        a.name,
        a.driver,
        a.interface,
        a.kind,
        mebibytes(a.max_buffer_bytes),
        mebibytes(a.max_binding_bytes),
        a.max_bindings,
        yes(a.double_precision),
        yes(a.pipeline_cache),
        yes(a.timestamps),
    );
    match &a.refused {
        Some(reason) => out.push_str(&format!("  it cannot be used: {reason}\n")),
        None => out.push_str("  it can be used: --device gpu or by its name\n"),
    }
    for note in &a.notes {
        out.push_str(&format!("  - {note}\n"));
    }
    out.push('\n');
    out
}
