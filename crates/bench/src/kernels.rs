//! One kernel on one batch: time per element, what binds it, and how it compares with code that a specialist wrote.
//!
//! Every program is measured twice: on so few elements that their data stays in the second-level cache, and on a batch
//! that comes from memory, of which each sample takes the next part. One thread runs, because a kernel does not know of
//! others.

use crate::ahead::{Ahead, Call, ahead};
use crate::batch::{Batch, BatchError, association};
use crate::handwritten::{Handwritten, handwritten};
use crate::machine::{Machine, machine};
use crate::peak::{Bound, Peak, least_ns};
use crate::singles::Singles;
use crate::stopwatch::{Effort, Spread, race, ratio};
use crate::vectors::Vectors;
use serde::Serialize;
use souple_elements::Element;
use souple_kernels::{Aligned, Backend, Kernel, LANES, Scratch};
use souple_laws::Law;
use souple_program::{Counts, Program};
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Programs that are measured, by name.
pub const PROGRAMS: [&str; 6] =
    ["force", "linearise", "tangent_apply", "tangent_apply_uncached", "tangent_blocks", "energy"];

/// Groups per call of a kernel: what a task of a simulation takes at once.
const WINDOW: usize = 64;

/// Bytes that a cached batch may touch: less than the second-level cache of any processor with AVX2.
const CACHED_BYTES: f64 = 256.0 * 1024.0;

/// Bytes that a streamed batch may carry, and a program may write: large elements get fewer.
const STREAMED_BYTES: f64 = 512.0 * 1024.0 * 1024.0;

/// Whether other code runs beside the generated one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// Generated kernels alone.
    Nothing,
    /// Kernels written by hand, and the same programs compiled ahead, wherever there are any.
    Others,
}

/// What to measure.
pub struct Request<'a> {
    /// The elements.
    pub elements: Vec<&'static Element>,
    /// The laws; each goes with each element.
    pub laws: Vec<&'static Law>,
    /// What runs the programs.
    pub backend: &'a dyn Backend,
    /// The name by which it was opened; it says which vectors the comparison uses.
    pub device: String,
    /// Number of elements of a streamed batch.
    pub streamed: usize,
    /// What runs beside it.
    pub against: Against,
    /// How long.
    pub effort: Effort,
}

/// Where a batch lives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Residence {
    /// In the second-level cache.
    Cached,
    /// In memory.
    Streamed,
}

/// A contender beside the generated kernel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Its own time in ns per element.
    pub ns_per_element: Spread,
    /// Its time over that of the generated kernel, round by round: 1 is as fast, above 1 the generated one is faster.
    pub ratio: Spread,
}

/// One program on one batch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Id of the element.
    pub element: &'static str,
    /// Id of the law.
    pub law: &'static str,
    /// Name of the program.
    pub program: &'static str,
    /// Where the data lives.
    pub batch: Residence,
    /// Number of elements.
    pub elements: usize,
    /// Operations per element, counted from the program; a fused multiply-add is two.
    pub operations: usize,
    /// Bytes read and written per element, each once.
    pub bytes: f64,
    /// Time per element in ns.
    pub ns_per_element: Spread,
    /// The same in single precision, where the backend has it.
    pub singles_ns_per_element: Option<Spread>,
    /// The least time that the binding limit allows, as a percentage of the median.
    pub percent_of_peak: f64,
    /// Which limit that is.
    pub bound: Bound,
    /// Time to derive all programs of this association, in ms, once.
    pub derive_ms: f64,
    /// From the program to the first group done, in ms.
    pub compile_ms: Spread,
    /// What runs it.
    pub isa: String,
    /// The kernel written by hand: its time, and `ratio_to_handwritten`.
    pub handwritten_ns: Option<Spread>,
    /// Time of the kernel written by hand over the generated one's: 1 is as fast, above 1 the generated one is faster.
    pub ratio_to_handwritten: Option<Spread>,
    /// The same program compiled ahead: its time.
    pub ahead_of_time_ns: Option<Spread>,
    /// Time of the same program compiled ahead over the generated one's.
    pub ratio_to_ahead_of_time: Option<Spread>,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// On what.
    pub machine: Machine,
    /// Name and description of the backend.
    pub device: String,
    /// Threads that ran.
    pub threads: usize,
    /// What one thread can do at most.
    pub peak: Peak,
    /// The figures.
    pub rows: Vec<Row>,
}

/// Measures. `progress` is told what comes next.
///
/// # Errors
/// When a batch cannot be made, or no vectors are there to measure peaks with.
pub fn measure(request: &Request<'_>, progress: &mut dyn FnMut(&str)) -> Result<Report, BatchError> {
    let vectors = Vectors::of_device(&request.device).ok_or(BatchError::NoVectors)?;
    progress("peaks of the processor");
    let peak = crate::peak::measure(vectors, request.effort);
    let about = request.backend.about();
    let mut rows = Vec::new();
    for element in &request.elements {
        for law in &request.laws {
            progress(&format!("{} with {}: deriving, setting up", element.id, law.id));
            let start = Instant::now();
            let derived = association(element, law);
            let derive_ms = start.elapsed().as_secs_f64() * 1e3;
            let points = derived.association.rule.points.len();
            let (setup, step) = (derived.staged.setup_to_step, derived.staged.step_to_apply);
            let carried = 8 * (setup.0 + step.0 + (setup.1 + step.1) * points) + 1;
            let batch = Batch::new(derived, whole(request.streamed, carried as f64), request.backend)?;
            let mut others = Others::new(&batch, request.against, vectors);
            for name in PROGRAMS {
                let Some(program) = batch.derived.staged.program(name) else { continue };
                progress(&format!("{} with {}: {name}", element.id, law.id));
                let compile_ms = compile_ms(&batch, program, request)?;
                let kernel = request.backend.compile(program)?;
                for residence in [Residence::Cached, Residence::Streamed] {
                    let timed = time(&batch, &kernel, &mut others, residence, request);
                    let bytes = batch.bytes(program);
                    let rate = match residence {
                        Residence::Cached => peak.cache_bytes_per_ns.median,
                        Residence::Streamed => peak.memory_bytes_per_ns.median,
                    };
                    let operations = Counts::of(program).operations;
                    let (least, bound) = least_ns(operations as f64, bytes, peak.operations_per_ns.median, rate);
                    rows.push(Row {
                        element: element.id,
                        law: law.id,
                        program: name,
                        batch: residence,
                        elements: timed.groups * LANES,
                        operations,
                        bytes,
                        percent_of_peak: 100.0 * least / timed.generated.median,
                        ns_per_element: timed.generated,
                        singles_ns_per_element: timed.singles,
                        bound,
                        derive_ms,
                        compile_ms,
                        isa: about.description.clone(),
                        handwritten_ns: timed.handwritten.map(|c| c.ns_per_element),
                        ratio_to_handwritten: timed.handwritten.map(|c| c.ratio),
                        ahead_of_time_ns: timed.ahead.map(|c| c.ns_per_element),
                        ratio_to_ahead_of_time: timed.ahead.map(|c| c.ratio),
                    });
                }
            }
        }
    }
    let device = format!("{}: {}", about.name, about.description);
    Ok(Report { machine: machine(), device, threads: 1, peak, rows })
}

/// Number of elements of a streamed batch: whole windows, no more than the memory allowed at so many bytes each.
fn whole(wanted: usize, bytes: f64) -> usize {
    let most = (STREAMED_BYTES / bytes) as usize;
    groups_of(wanted.min(most).div_ceil(LANES)) * LANES
}

/// This many groups or fewer, whole windows where there is more than one.
fn groups_of(groups: usize) -> usize {
    if groups > WINDOW { groups / WINDOW * WINDOW } else { groups.max(1) }
}

/// From a program to its first group done, for a kernel that is made afresh every time.
fn compile_ms(batch: &Batch, program: &Program, request: &Request<'_>) -> Result<Spread, BatchError> {
    let mut outputs = Batch::outputs(program, 1);
    let mut samples = Vec::new();
    for _ in 0..request.effort.rounds.clamp(1, 7) {
        let start = Instant::now();
        let kernel = request.backend.compile(program)?;
        batch.run(&*kernel, &mut Scratch::default(), 0..1, &mut outputs);
        samples.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(Spread::of(&samples))
}

/// Code beside the generated one.
struct Others {
    vectors: Vectors,
    handwritten: Option<Box<dyn Handwritten>>,
    against: Against,
}

impl Others {
    fn new(batch: &Batch, against: Against, vectors: Vectors) -> Others {
        let mut set = if against == Against::Others { handwritten(batch) } else { None };
        if let Some(set) = &mut set {
            let force = batch.derived.staged.program("force").expect("every association has forces");
            let mut out = vec![0.0; Batch::output_len(force, 0, batch.groups)];
            set.linearise(vectors, batch, 0..batch.groups, &mut out);
        }
        Others { vectors, handwritten: set, against }
    }

    fn ahead(&self, batch: &Batch, program: &str) -> Option<&'static Ahead> {
        let association = batch.derived.association;
        let known = || ahead(association.element.id, association.law.id, program);
        if self.against == Against::Others { known() } else { None }
    }
}

/// Windows of a batch, one after the other, from the beginning again at the end. Contenders begin a third of the batch
/// apart, or the first would fetch from memory what the next ones then find in a cache.
struct Windows {
    at: usize,
    length: usize,
    groups: usize,
}

impl Windows {
    fn over(groups: usize, thirds: usize) -> Windows {
        let length = WINDOW.min(groups);
        Windows { at: thirds * (groups / length) / 3 * length, length, groups }
    }

    fn next(&mut self) -> Range<usize> {
        let start = self.at;
        self.at = (start + self.length) % self.groups;
        start..start + self.length
    }
}

/// Times of the contenders on one batch.
struct Timed {
    groups: usize,
    generated: Spread,
    singles: Option<Spread>,
    handwritten: Option<Comparison>,
    ahead: Option<Comparison>,
}

fn time(
    batch: &Batch,
    kernel: &Arc<dyn Kernel>,
    others: &mut Others,
    residence: Residence,
    request: &Request<'_>,
) -> Timed {
    let program = kernel.program();
    let limit = match residence {
        Residence::Cached => CACHED_BYTES,
        Residence::Streamed => STREAMED_BYTES,
    };
    let fitting = (limit / (batch.bytes(program) * LANES as f64)) as usize;
    let groups = groups_of(fitting.clamp(1, batch.groups));
    let (vectors, compiled) = (others.vectors, others.ahead(batch, &program.name));

    let (mut windows, mut scratch, mut outputs) =
        (Windows::over(groups, 0), Scratch::default(), Batch::outputs(program, groups));
    let mut generated = || batch.run(&**kernel, &mut scratch, windows.next(), &mut outputs);

    let (mut ahead_windows, mut ahead_outputs) = (Windows::over(groups, 1), Batch::outputs(program, groups));
    let mut run_ahead = || {
        let groups = ahead_windows.next();
        let inputs = batch.inputs(program, &groups);
        let mut outputs = Batch::slices(program, &groups, &mut ahead_outputs);
        let run = compiled.expect("only called where there is one").run;
        run(vectors, Call { groups: groups.len(), inputs: &inputs, outputs: &mut outputs });
    };

    let by_hand = ["force", "linearise", "tangent_apply"].contains(&program.name.as_str());
    let mut set = others.handwritten.as_mut().filter(|_| by_hand);
    let there = set.is_some();
    let per_group = Batch::output_len(program, 0, 1);
    let (mut hand_windows, mut hand_output) = (Windows::over(groups, 2), Aligned::filled(per_group * groups, f64::NAN));
    let mut run_by_hand = || {
        let groups = hand_windows.next();
        let out = &mut hand_output[groups.start * per_group..groups.end * per_group];
        let set = set.as_mut().expect("only called where there is one");
        match program.name.as_str() {
            "force" => set.force(vectors, batch, groups, out),
            "linearise" => set.linearise(vectors, batch, groups, out),
            _ => set.tangent_apply(vectors, batch, groups, out),
        }
    };

    let mut singles = Singles::new(batch, program, request.backend, groups);
    let has_singles = singles.is_some();
    let mut single_windows = Windows::over(groups, 1);
    let mut run_singles = || {
        let next = single_windows.next();
        singles.as_mut().expect("only called where there are any").run(next);
    };

    let mut contenders: Vec<&mut dyn FnMut()> = vec![&mut generated];
    if there {
        contenders.push(&mut run_by_hand);
    }
    if compiled.is_some() {
        contenders.push(&mut run_ahead);
    }
    if has_singles {
        contenders.push(&mut run_singles);
    }
    let seconds = race(request.effort, &mut contenders);
    let to_ns = 1e9 / (WINDOW.min(groups) * LANES) as f64;
    let ns = |samples: &[f64]| Spread::of(&samples.iter().map(|s| s * to_ns).collect::<Vec<_>>());
    let compared = |k: usize| Comparison { ns_per_element: ns(&seconds[k]), ratio: ratio(&seconds[k], &seconds[0]) };
    Timed {
        groups,
        generated: ns(&seconds[0]),
        singles: has_singles.then(|| ns(&seconds[seconds.len() - 1])),
        handwritten: there.then(|| compared(1)),
        ahead: compiled.map(|_| compared(1 + usize::from(there))),
    }
}
