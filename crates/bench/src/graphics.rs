//! The programs of a step on a graphics device: time per element, and how near that is to what the device can do.
//!
//! ```text
//! bound = max(operations / arithmetic peak, bytes / bandwidth)        percent_of_bound = 100 · bound / time
//! ```
//!
//! Both peaks are measured on the same device in the same run: fused multiply-adds on registers, and the faster of a copy
//! and the triad on arrays larger than caches are. Times are those of the device's own clock where it has one, around so
//! many runs that a sample is long against its ticks; else of the host's around the same, submission included.
//!
//! Data lies as in a step, [group of 64][place][lane], in single precision; it stays on the device. Before anything is
//! timed the results are compared with the oracle's on the same numbers: what is wrong is not fast.

use crate::batch::{Batch, BatchError, association};
use crate::machine::{Machine, machine, today};
use crate::peak::{Bound, least_ns};
use crate::stopwatch::{Effort, Spread};
use serde::Serialize;
use souple_elements::Element;
use souple_kernels::oracle::{Bounded, Precision, run_in, spread};
use souple_kernels::{Input, LANES as HOST_LANES};
use souple_kernels_cpu::Cpu;
use souple_kernels_gpu::measure::{Exercise, LANES, Loaded, exercise};
use souple_kernels_gpu::resident::row_sums;
use souple_kernels_gpu::{DeviceError, Gpu};
use souple_laws::Law;
use souple_laws::check::{Inversion, inversion};
use souple_operators::derive_diagonal;
use souple_program::{Costs, Counts, Program};
use std::time::{Duration, Instant};
use thiserror::Error;

/// What to measure.
pub struct Request<'a> {
    /// The elements.
    pub elements: Vec<&'static Element>,
    /// The laws; each goes with each element.
    pub laws: Vec<&'static Law>,
    /// The device.
    pub gpu: &'a Gpu,
    /// Number of elements; fewer where their values do not fit into half a GiB.
    pub count: usize,
    /// How long.
    pub effort: Effort,
}

/// Why nothing was measured.
#[derive(Debug, Error)]
pub enum GraphicsError {
    /// No data.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// The device could not do it.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A result is not the oracle's.
    #[error(
        "{element} with {law}: `{program}` gives {found:e} on the device where the oracle says {expected:e} ± {bound:e}; \
         nothing was timed: run `cargo test -p souple-kernels-gpu`, and update the device's driver"
    )]
    Disagrees {
        /// Id of the element.
        element: &'static str,
        /// Id of the law.
        law: &'static str,
        /// The program.
        program: String,
        /// What the device gave.
        found: f64,
        /// What it should have given.
        expected: f64,
        /// How far it may be from that.
        bound: f64,
    },
}

/// Whose clock times are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// The device's: time stamps before and after the runs.
    Device,
    /// The host's: the submission and the wait for its end are in it.
    Host,
}

/// What the device can do at most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Operations per nanosecond in single precision, a fused multiply-add being two.
    pub operations_per_ns: Spread,
    /// Bytes per nanosecond of a copy, read and written.
    pub copy_bytes_per_ns: Spread,
    /// Bytes per nanosecond of the triad, likewise.
    pub triad_bytes_per_ns: Spread,
}

/// One program on one batch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Id of the element.
    pub element: &'static str,
    /// Id of the law.
    pub law: &'static str,
    /// Name of the program, or `row_sums` for the sum of contributions at the nodes.
    pub program: String,
    /// Number of elements.
    pub elements: usize,
    /// Operations per element, counted from the program; a fused multiply-add is two.
    pub operations: usize,
    /// Bytes read and written per element, each once.
    pub bytes: f64,
    /// Time per element in ns.
    pub ns_per_element: Spread,
    /// Operations per ns: 10⁹ operations per second.
    pub operations_per_ns: f64,
    /// Bytes per ns: 10⁹ bytes per second.
    pub bytes_per_ns: f64,
    /// The least time that the binding limit allows, as a percentage of the median.
    pub percent_of_bound: f64,
    /// Which limit that is.
    pub bound: Bound,
    /// Largest error found beside the oracle, in parts of what it allows.
    pub error_of_bound: f64,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The host.
    pub machine: Machine,
    /// Day of the measurement, UTC.
    pub date: String,
    /// Name of the adapter.
    pub adapter: String,
    /// Its driver, with version.
    pub driver: String,
    /// The interface it is reached by: "vulkan", "metal", "dx12".
    pub backend: String,
    /// Whose clock times are.
    pub clock: Clock,
    /// What the device can do at most.
    pub peak: Peak,
    /// The figures.
    pub rows: Vec<Row>,
}

/// Numbers per array of streaming exercises: 256 MiB, more than caches hold; a driver on the processor has less.
const STREAMED: usize = 64 << 20;
/// The same for a driver on the processor.
const STREAMED_BY_PROCESSOR: usize = 4 << 20;
/// Invocations of multiply-adds: some thousands for each of a hundred units.
const EXERCISED: usize = 1 << 20;
/// The same for a driver on the processor.
const EXERCISED_BY_PROCESSOR: usize = 1 << 13;
/// Bytes that the values of a batch may take, in doubles on the host.
const MOST_BYTES: f64 = 512.0 * 1024.0 * 1024.0;
/// A sample, if the device's ticks are not finer: many of them, and of submissions.
const SAMPLE: Duration = Duration::from_millis(2);
/// Elements that are compared with the oracle.
const COMPARED: usize = 3;

/// Measures. `progress` is told what comes next.
///
/// # Errors
/// When a batch cannot be made, the device refuses something or is lost, or a result is wrong.
pub fn measure(request: &Request<'_>, progress: &mut dyn FnMut(&str)) -> Result<Report, GraphicsError> {
    let d = request.gpu.description();
    progress(&format!("peaks of {}", d.name));
    let timer = Timer::new(request)?;
    let peak = peak(request.gpu, &timer)?;
    let mut rows = Vec::new();
    for element in &request.elements {
        for law in &request.laws {
            progress(&format!("{} with {}: deriving, setting up", element.id, law.id));
            pair(request, element, law, &timer, &peak, &mut rows, progress)?;
        }
    }
    Ok(Report {
        machine: machine(),
        date: today(),
        adapter: d.name.clone(),
        driver: format!("{} {}", d.driver, d.driver_version).trim().to_owned(),
        backend: d.interface.clone(),
        clock: timer.clock,
        peak,
        rows,
    })
}

fn peak(gpu: &Gpu, timer: &Timer) -> Result<Peak, GraphicsError> {
    let (numbers, invocations) = match gpu.description().kind.as_str() {
        "processor" => (STREAMED_BY_PROCESSOR, EXERCISED_BY_PROCESSOR),
        _ => (STREAMED, EXERCISED),
    };
    let fitting = (gpu.granted().binding_bytes.min(gpu.granted().buffer_bytes) / 8) as usize;
    let rate = |which: Exercise, size: usize| -> Result<Spread, GraphicsError> {
        let made = exercise(gpu, which, size.min(fitting))?;
        let seconds = timer.samples(&made.work)?;
        let work = made.bytes.max(made.operations);
        Ok(Spread::of(&seconds.iter().map(|s| 1e-9 * work / s).collect::<Vec<_>>()))
    };
    // The triad has two operations for twelve bytes: its work is its bytes.
    Ok(Peak {
        operations_per_ns: rate(Exercise::MultiplyAdds, invocations)?,
        copy_bytes_per_ns: rate(Exercise::Copy, numbers)?,
        triad_bytes_per_ns: rate(Exercise::Triad, numbers)?,
    })
}

/// Takes samples.
struct Timer {
    clock: Clock,
    effort: Effort,
}

impl Timer {
    /// With the device's clock where that moves, and not faster than the host's.
    fn new(request: &Request<'_>) -> Result<Timer, GraphicsError> {
        let trial = exercise(request.gpu, Exercise::Triad, 1 << 20)?;
        trial.work.run(1)?;
        let start = Instant::now();
        let told = trial.work.run(4)?;
        let passed = start.elapsed().as_secs_f64();
        let clock = if told.is_some_and(|t| t > 0.0 && t <= passed) { Clock::Device } else { Clock::Host };
        Ok(Timer { clock, effort: Effort { sample: request.effort.sample.max(SAMPLE), ..request.effort } })
    }

    fn seconds(&self, work: &Loaded, times: usize) -> Result<f64, GraphicsError> {
        let start = Instant::now();
        let told = work.run(times)?;
        let passed = start.elapsed().as_secs_f64();
        Ok(match (self.clock, told) {
            (Clock::Device, Some(told)) => told,
            _ => passed,
        })
    }

    /// Seconds per run, one sample per round; as many runs per sample as make it long enough.
    fn samples(&self, work: &Loaded) -> Result<Vec<f64>, GraphicsError> {
        self.seconds(work, 1)?;
        let mut times = 1;
        while self.seconds(work, times)? < self.effort.sample.as_secs_f64() && times < 1 << 16 {
            times *= 2;
        }
        (0..self.effort.rounds.max(1)).map(|_| Ok(self.seconds(work, times)? / times as f64)).collect()
    }
}

/// All programs of an element with a law.
fn pair(
    request: &Request<'_>,
    element: &'static Element,
    law: &'static Law,
    timer: &Timer,
    peak: &Peak,
    rows: &mut Vec<Row>,
    progress: &mut dyn FnMut(&str),
) -> Result<(), GraphicsError> {
    let derived = association(element, law);
    let points = derived.association.rule.points.len();
    let (setup, step) = (derived.staged.setup_to_step, derived.staged.step_to_apply);
    let (n, d) = (element.node_count(), element.dimension());
    // The widest array per element that a binding must hold: carried values, or blocks of the diagonal.
    let carried = setup.0 + step.0 + (setup.1 + step.1) * points;
    let limits = request.gpu.granted();
    let in_binding = limits.binding_bytes.min(limits.buffer_bytes) as f64 / (4 * carried.max(n * d * d)) as f64;
    let most = (MOST_BYTES / (8 * carried.max(n * d)) as f64).min(in_binding) as usize / LANES * LANES;
    let count = request.count.next_multiple_of(LANES).min(most.max(LANES));
    let batch = Batch::new(derived, count, &Cpu::open())?;
    let mut programs = Vec::new();
    let carries = batch.derived.staged.step_to_apply != (0, 0);
    for name in ["force", "linearise", "tangent_apply"] {
        if name != "linearise" || carries {
            programs.extend(batch.derived.staged.program(name).cloned());
        }
    }
    programs.push(derive_diagonal(&batch.derived, Costs::default()));
    if inversion(law, &batch.parameters) == Inversion::Fatal {
        programs.extend(batch.derived.staged.program("volume_ratio").cloned());
    }
    let row = |name: &str, operations: usize, bytes: f64, seconds: &[f64], error: f64| {
        let ns = Spread::of(&seconds.iter().map(|s| 1e9 * s / count as f64).collect::<Vec<_>>());
        let bandwidth = peak.copy_bytes_per_ns.median.max(peak.triad_bytes_per_ns.median);
        let (least, bound) = least_ns(operations as f64, bytes, peak.operations_per_ns.median, bandwidth);
        Row {
            element: element.id,
            law: law.id,
            program: name.to_owned(),
            elements: count,
            operations,
            bytes,
            operations_per_ns: operations as f64 / ns.median,
            bytes_per_ns: bytes / ns.median,
            percent_of_bound: 100.0 * least / ns.median,
            ns_per_element: ns,
            bound,
            error_of_bound: error,
        }
    };
    let nodes_per_element = batch.nodes as f64 / count as f64;
    let table = Singles::rows(&batch);
    for program in &programs {
        progress(&format!("{} with {}: {}", element.id, law.id, program.name));
        let data = Singles::of(&batch, program);
        let loaded = Loaded::new(request.gpu, program, count / LANES, &data.inputs(&table))?;
        loaded.run(1)?;
        let error = compare(program, &batch, &data, &table, &loaded)?;
        let seconds = timer.samples(&loaded)?;
        let bytes = 4.0 * data.numbers_per_element(program, nodes_per_element, n);
        rows.push(row(&program.name, Counts::of(program).operations, bytes, &seconds, error));
        if program.name == "force" {
            progress(&format!("{} with {}: row_sums", element.id, law.id));
            let own: Vec<u32> = by_element(&table, n);
            let contributions = loaded.output(0)?;
            let sums = row_sums(request.gpu, &own, n, batch.nodes, d, &contributions)?;
            sums.run(1)?;
            let error = compare_sums(&own, n, d, &contributions, &sums.output(0)?)
                .map_err(|(found, expected, bound)| disagrees(&batch, "row_sums", found, expected, bound))?;
            let seconds = timer.samples(&sums)?;
            // Contributions, their places, the beginnings of rows, the sums.
            let numbers = (n * d + n) as f64 + nodes_per_element * (1 + d) as f64;
            rows.push(row("row_sums", n * d, 4.0 * numbers, &seconds, error));
        }
    }
    Ok(())
}

/// Data of a program in single precision, in the device's groups.
struct Singles {
    inputs: Vec<Single>,
}

enum Single {
    Lanes(Vec<f32>),
    Gathered(Vec<f32>, usize),
    Uniform(Vec<f32>),
}

impl Singles {
    fn of(batch: &Batch, program: &Program) -> Singles {
        let rounded = |values: &[f64]| -> Vec<f32> { values.iter().map(|&v| v as f32).collect() };
        let single = |input: Input<'_>| match input {
            Input::Lanes(values) => Single::Lanes(regrouped(&rounded(values), batch.elements())),
            Input::Gathered { values, width, .. } => Single::Gathered(rounded(values), width),
            Input::Uniform(values) => Single::Uniform(rounded(values)),
        };
        Singles { inputs: batch.inputs(program, &(0..batch.groups)).into_iter().map(single).collect() }
    }

    /// The table of rows that all share.
    fn rows(batch: &Batch) -> Vec<u32> {
        regrouped(&batch.rows, batch.elements())
    }

    fn inputs<'a>(&'a self, rows: &'a [u32]) -> Vec<Input<'a, f32>> {
        let input = |single: &'a Single| match single {
            Single::Lanes(values) => Input::Lanes(values),
            Single::Gathered(values, width) => Input::Gathered { values, rows, width: *width },
            Single::Uniform(values) => Input::Uniform(values),
        };
        self.inputs.iter().map(input).collect()
    }

    /// What one item is given, as the oracle wants it.
    fn item(&self, program: &Program, rows: &[u32], nodes: usize, item: usize) -> Vec<Vec<f64>> {
        let of = |(b, single): (&souple_program::Buffer, &Single)| -> Vec<f64> {
            let total = b.total(program.points);
            match single {
                Single::Lanes(values) => (0..total).map(|p| f64::from(values[at(total, p, item)])).collect(),
                Single::Gathered(values, width) => (0..total)
                    .map(|p| f64::from(values[width * rows[at(nodes, p / width, item)] as usize + p % width]))
                    .collect(),
                Single::Uniform(values) => values.iter().map(|v| f64::from(*v)).collect(),
            }
        };
        program.inputs.iter().zip(&self.inputs).map(of).collect()
    }

    /// Numbers read and written per element: lanes, rows once, its share of nodal vectors, outputs.
    fn numbers_per_element(&self, program: &Program, nodes_per_element: f64, nodes: usize) -> f64 {
        let gathers = self.inputs.iter().any(|i| matches!(i, Single::Gathered(..)));
        let read = |(b, single): (&souple_program::Buffer, &Single)| match single {
            Single::Lanes(_) => b.total(program.points) as f64,
            Single::Gathered(_, width) => nodes_per_element * *width as f64,
            Single::Uniform(_) => 0.0,
        };
        let written: usize = program.outputs.iter().map(|b| b.total(program.points)).sum();
        let read: f64 = program.inputs.iter().zip(&self.inputs).map(read).sum();
        read + written as f64 + if gathers { nodes as f64 } else { 0.0 }
    }
}

/// Place of number `p` of an item among groups of the device.
fn at(total: usize, p: usize, item: usize) -> usize {
    (item / LANES * total + p) * LANES + item % LANES
}

/// From groups of the host to those of the device.
fn regrouped<T: Copy + Default>(values: &[T], items: usize) -> Vec<T> {
    let total = values.len() / items;
    let mut out = vec![T::default(); values.len()];
    for item in 0..items {
        for p in 0..total {
            out[at(total, p, item)] = values[(item / HOST_LANES * total + p) * HOST_LANES + item % HOST_LANES];
        }
    }
    out
}

/// Rows element by element.
fn by_element(table: &[u32], n: usize) -> Vec<u32> {
    (0..table.len() / n).flat_map(|item| (0..n).map(move |p| table[at(n, p, item)])).collect()
}

/// Compares elements at both ends and in the middle with the oracle; the largest error in parts of its bound.
fn compare(
    program: &Program,
    batch: &Batch,
    data: &Singles,
    rows: &[u32],
    loaded: &Loaded,
) -> Result<f64, GraphicsError> {
    let last = batch.elements() - 1;
    let n = batch.derived.association.element.node_count();
    let outputs: Vec<Vec<f32>> = (0..program.outputs.len()).map(|k| loaded.output(k)).collect::<Result<_, _>>()?;
    let mut worst: f64 = 0.0;
    for k in 0..COMPARED {
        let item = k * last / (COMPARED - 1);
        let expected = expected(program, &data.item(program, rows, n, item));
        for (values, want) in outputs.iter().zip(&expected) {
            for (p, want) in want.iter().enumerate().filter(|(_, w)| w.error.is_finite()) {
                let found = f64::from(values[at(want_len(values, batch), p, item)]);
                let error = (found - want.value).abs();
                if error.is_nan() || error > want.error {
                    return Err(disagrees(batch, &program.name, found, want.value, want.error));
                }
                worst = worst.max(if want.error > 0.0 { error / want.error } else { 0.0 });
            }
        }
    }
    Ok(worst)
}

/// Numbers per element of an output.
fn want_len(values: &[f32], batch: &Batch) -> usize {
    values.len() / batch.elements()
}

/// The oracle's values with its bound for singles; where that says nothing, with an estimate from random roundings.
fn expected(program: &Program, given: &[Vec<f64>]) -> Vec<Vec<Bounded>> {
    let bounded = run_in(program, given, Precision::SINGLE);
    let sharp = |values: &Vec<Bounded>| {
        let largest = values.iter().fold(1.0, |m: f64, v| m.max(v.value.abs()));
        values.iter().all(|v| v.error <= 1e-2 * largest)
    };
    if bounded.iter().all(sharp) {
        return bounded;
    }
    let mut estimated = spread(program, given);
    let scale = Precision::SINGLE.epsilon / Precision::DOUBLE.epsilon;
    estimated.iter_mut().flatten().for_each(|v| v.error *= scale);
    estimated
}

/// Every sum beside that of the host in doubles; the largest error in parts of n ε Σ|c|, or the first that is larger:
/// what was found, what should be, how far it may be.
fn compare_sums(
    rows: &[u32],
    n: usize,
    d: usize,
    contributions: &[f32],
    found: &[f32],
) -> Result<f64, (f64, f64, f64)> {
    let mut sums = vec![[0.0f64; 3]; found.len()];
    for (k, &row) in rows.iter().enumerate() {
        let (item, place) = (k / n, k % n);
        for axis in 0..d {
            let c = f64::from(contributions[at(n * d, place * d + axis, item)]);
            let [sum, size, count] = &mut sums[row as usize * d + axis];
            (*sum, *size, *count) = (*sum + c, *size + c.abs(), *count + 1.0);
        }
    }
    let mut worst: f64 = 0.0;
    for (&found, [sum, size, count]) in found.iter().zip(sums) {
        let (found, bound) = (f64::from(found), count * f64::from(f32::EPSILON) * size);
        let error = (found - sum).abs();
        if error.is_nan() || error > bound {
            return Err((found, sum, bound));
        }
        worst = worst.max(if bound > 0.0 { error / bound } else { 0.0 });
    }
    Ok(worst)
}

fn disagrees(batch: &Batch, program: &str, found: f64, expected: f64, bound: f64) -> GraphicsError {
    let pair = &batch.derived.association;
    let (element, law) = (pair.element.id, pair.law.id);
    GraphicsError::Disagrees { element, law, program: program.to_owned(), found, expected, bound }
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_kernels::conformance::Random;

    /// Regrouping moves every number to its item's place in the wider groups, and back by element.
    #[test]
    fn numbers_keep_their_items() {
        let (items, n) = (2 * LANES, 3);
        let of = |item: usize, p: usize| (10 * item + p) as u32;
        let mut host = vec![0; items * n];
        for item in 0..items {
            for p in 0..n {
                host[(item / HOST_LANES * n + p) * HOST_LANES + item % HOST_LANES] = of(item, p);
            }
        }
        let table = regrouped(&host, items);
        let rows = by_element(&table, n);
        for item in 0..items {
            for p in 0..n {
                assert_eq!((table[at(n, p, item)], rows[item * n + p]), (of(item, p), of(item, p)));
            }
        }
    }

    /// Sums that are right pass, and one that is wrong by more than rounding is found.
    #[test]
    fn wrong_sums_are_found() {
        let mut random = Random::new(3);
        let (n, d, items) = (2, 3, LANES);
        let rows: Vec<u32> = (0..items * n).map(|k| (k % 7) as u32).collect();
        let contributions: Vec<f32> = (0..items * n * d).map(|_| random.between(-1.0, 1.0) as f32).collect();
        let mut sums = vec![0.0f32; 7 * d];
        for (k, &row) in rows.iter().enumerate() {
            for axis in 0..d {
                sums[row as usize * d + axis] += contributions[at(n * d, k % n * d + axis, k / n)];
            }
        }
        assert!(compare_sums(&rows, n, d, &contributions, &sums).is_ok_and(|worst| worst < 1.0));
        sums[4] += 0.01;
        assert!(compare_sums(&rows, n, d, &contributions, &sums).is_err());
        sums[4] = f32::NAN;
        assert!(compare_sums(&rows, n, d, &contributions, &sums).is_err());
    }
}
