//! `souple bench kernels`.

use super::{Rounds, at_least_one, machine_line, spread};
use crate::failure::{Failure, input};
use crate::terminal::{note, say, say_json, table};
use clap::Args;
use souple_bench::kernels::{Against, Report, Request, Residence, Row, measure};
use souple_bench::peak::Bound;
use souple_simulation::open_device;

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  souple bench kernels --element tet4,hex8 --law stvk --against\n  \
    souple bench kernels --element all --law hooke --device cpu:avx2 --json\n  \
    souple bench kernels --element tet4,hex8 --device gpu --elements 1000000 --json\n\n\
    ratio to handwritten: time of the hand-written kernel over that of the generated one, 1 is as fast, more is faster.\n\
    ratio to ahead: the same for the same program compiled with the library.")]
pub(crate) struct Arguments {
    /// Elements, separated by commas, or `all` (see: souple list elements)
    #[arg(long, default_value = "tet4,hex8")]
    element: String,
    /// Laws, separated by commas, or `all` (see: souple list laws)
    #[arg(long, default_value = "stvk")]
    law: String,
    /// What to compute on (see: souple list devices)
    #[arg(long, default_value = "cpu")]
    device: String,
    /// Number of elements of batches that come from memory
    #[arg(long, default_value_t = 100_000, value_parser = at_least_one)]
    elements: usize,
    /// Run kernels written by hand and programs compiled ahead beside the generated ones, where there are any
    #[arg(long)]
    against: bool,
    #[command(flatten)]
    rounds: Rounds,
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(name) = graphics_device(&arguments.device) {
        return on_graphics_device(name, arguments);
    }
    let backend = open_device(&arguments.device).map_err(input)?;
    let request = Request {
        elements: super::elements(&arguments.element)?,
        laws: super::laws(&arguments.law)?,
        backend: &*backend,
        device: arguments.device.clone(),
        streamed: arguments.elements,
        against: if arguments.against { Against::Others } else { Against::Nothing },
        effort: arguments.rounds.effort(),
    };
    let report = measure(&request, &mut |next| note(next)).map_err(input)?;
    if arguments.json { say_json(&report) } else { say(&text(&report)) }
}

/// The part of a graphics device's name that says which adapter.
fn graphics_device(device: &str) -> Option<&str> {
    if device == "gpu" { Some("") } else { device.strip_prefix("gpu:") }
}

#[cfg(not(feature = "gpu"))]
fn on_graphics_device(name: &str, _: &Arguments) -> Result<(), Failure> {
    Err(input(format!(
        "this build has no graphics devices, so there is no `gpu:{name}`: build with the feature `gpu`, or use --device cpu"
    )))
}

#[cfg(feature = "gpu")]
fn on_graphics_device(name: &str, arguments: &Arguments) -> Result<(), Failure> {
    use souple_bench::graphics;
    if arguments.against {
        return Err(input(
            "--against compares code of the processor; a graphics device is compared with its own bounds: leave it out",
        ));
    }
    let (elements, laws) = (super::elements(&arguments.element)?, super::laws(&arguments.law)?);
    let gpu = souple_simulation::gpu::open_gpu(name).map_err(input)?;
    let effort = arguments.rounds.effort();
    let request = graphics::Request { elements, laws, gpu: &gpu, count: arguments.elements, effort };
    let report = graphics::measure(&request, &mut |next| note(next)).map_err(input)?;
    gpu.take_notes().iter().for_each(|n| note(&format!("note: {n}")));
    if arguments.json { say_json(&report) } else { say(&graphics_text(&report)) }
}

#[cfg(feature = "gpu")]
fn graphics_text(report: &souple_bench::graphics::Report) -> String {
    let clock = match report.clock {
        souple_bench::graphics::Clock::Device => "the device's",
        souple_bench::graphics::Clock::Host => "the host's",
    };
    let peak = &report.peak;
    let head = format!(
        "{}, driver {}, through {}, {}; times by {clock} clock\n\
         peak: {} Gop/s, copy {} GB/s, triad {} GB/s\n\n",
        report.adapter,
        report.driver,
        report.backend,
        report.date,
        spread(&peak.operations_per_ns),
        spread(&peak.copy_bytes_per_ns),
        spread(&peak.triad_bytes_per_ns),
    );
    let heads = [
        "element",
        "law",
        "program",
        "elements",
        "ns/element",
        "Gop/s",
        "GB/s",
        "operations",
        "bytes",
        "of the bound",
        "error",
    ];
    let cells = |row: &souple_bench::graphics::Row| {
        vec![
            row.element.to_owned(),
            row.law.to_owned(),
            row.program.clone(),
            row.elements.to_string(),
            spread(&row.ns_per_element),
            super::digits(row.operations_per_ns),
            super::digits(row.bytes_per_ns),
            row.operations.to_string(),
            format!("{:.0}", row.bytes),
            format!("{:.0} % {}", row.percent_of_bound, bound(row.bound)),
            format!("{:.2}", row.error_of_bound),
        ]
    };
    head + &table(&heads, &report.rows.iter().map(cells).collect::<Vec<_>>())
}

fn bound(bound: Bound) -> &'static str {
    match bound {
        Bound::Arithmetic => "arithmetic",
        Bound::Bandwidth => "bandwidth",
    }
}

fn text(report: &Report) -> String {
    let peak = &report.peak;
    let head = format!(
        "{}\n\
         peak: {} operations/ns, {} bytes/ns from cache, {} bytes/ns from memory\n\n",
        machine_line(&report.machine, &report.device, report.threads),
        spread(&peak.operations_per_ns),
        spread(&peak.cache_bytes_per_ns),
        spread(&peak.memory_bytes_per_ns),
    );
    let mut heads = vec![
        "element",
        "law",
        "program",
        "batch",
        "ns/element",
        "in singles",
        "operations",
        "bytes",
        "of peak",
        "compile ms",
    ];
    let against = report.rows.iter().any(|r| r.ratio_to_handwritten.is_some() || r.ratio_to_ahead_of_time.is_some());
    if against {
        heads.extend(["ratio to handwritten", "ratio to ahead"]);
    }
    let rows: Vec<Vec<String>> = report.rows.iter().map(|row| cells(row, against)).collect();
    head + &table(&heads, &rows)
}

fn cells(row: &Row, against: bool) -> Vec<String> {
    let batch = match row.batch {
        Residence::Cached => format!("cached {}", row.elements),
        Residence::Streamed => format!("memory {}", row.elements),
    };
    let mut cells = vec![
        row.element.to_owned(),
        row.law.to_owned(),
        row.program.to_owned(),
        batch,
        spread(&row.ns_per_element),
        row.singles_ns_per_element.as_ref().map(spread).unwrap_or_default(),
        row.operations.to_string(),
        format!("{:.0}", row.bytes),
        format!("{:.0} % {}", row.percent_of_peak, bound(row.bound)),
        spread(&row.compile_ms),
    ];
    if against {
        let cell = |ratio: &Option<_>| ratio.as_ref().map(spread).unwrap_or_default();
        cells.extend([cell(&row.ratio_to_handwritten), cell(&row.ratio_to_ahead_of_time)]);
    }
    cells
}
