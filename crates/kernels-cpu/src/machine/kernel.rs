//! Kernels of machine code: buffers are checked here, in safe code, before the code that checks nothing runs.

use super::allocate::Step;
use super::choice::allocate;
use super::emit::{Assembly, Layout, emit, function_at};
use super::flow::{Arrival, Flow, Function, Source, flow};
use super::functions;
use super::pages::Pages;
use super::target::Target;
use souple_kernels::{Input, LANES, Number, Scratch};
use souple_program::Program;
use std::sync::{Arc, PoisonError, RwLock};

/// Code for one combination of arrivals.
#[derive(Debug)]
struct Variant {
    flow: Flow,
    layout: Layout,
    pages: Pages,
}

/// A combination of arrivals, and its code; no code where the interpreter has to serve.
type Known = (Vec<Arrival>, Option<Arc<Variant>>);

/// A program as machine code, made for each combination of arrivals that it meets.
#[derive(Debug)]
pub(crate) struct Machine {
    target: Target,
    variants: RwLock<Vec<Known>>,
}

/// What was made of a program: sizes to judge it by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figures {
    /// Pieces of work: operations, stores of outputs and gathers, each once.
    pub work: usize,
    /// Steps: mostly one instruction each.
    pub steps: usize,
    /// Steps that only move data: loads, stores of spilled values and copies, each once.
    pub moves: usize,
    /// Spilled vectors.
    pub slots: usize,
    /// Bytes of code.
    pub code: usize,
}

/// Compiles a verified program as machine code would be, for judging it; every input arrives in lanes unless `gathered`
/// gives the width of its rows. `None` where only the interpreter serves.
pub fn figures(set: crate::InstructionSet, program: &Program, gathered: &[(&str, usize)]) -> Option<Figures> {
    let target = set.target()?;
    let arrivals: Vec<Arrival> = program
        .inputs
        .iter()
        .map(|b| match gathered.iter().find(|g| g.0 == b.name) {
            Some(g) => Arrival::Gathered(g.1),
            None => Arrival::Lanes,
        })
        .collect();
    let flow = flow(program, &arrivals)?;
    let allocation = allocate(&flow, target);
    let assembly = emit(target, &flow, &allocation, &program.tables)?;
    let work = flow.parts.iter().map(|p| p.work.len()).sum();
    let outputs = flow.parts.iter().flat_map(|p| &p.work).filter(|w| w.makes().next().is_none()).count();
    let moves = allocation.steps.iter();
    let moves = moves.filter(|s| matches!(s, Step::Load { .. } | Step::Store { .. } | Step::Copy { .. })).count();
    Some(Figures {
        work,
        steps: allocation.steps.len(),
        moves: moves - outputs,
        slots: allocation.slots as usize,
        code: assembly.code.len(),
    })
}

/// From a verified program to bytes.
pub(crate) fn assemble(target: Target, program: &Program, arrivals: &[Arrival]) -> Option<(Flow, Assembly)> {
    let flow = flow(program, arrivals)?;
    let allocation = allocate(&flow, target);
    let assembly = emit(target, &flow, &allocation, &program.tables)?;
    Some((flow, assembly))
}

impl Machine {
    /// Nothing is made yet.
    pub(crate) fn new(target: Target) -> Machine {
        Machine { target, variants: RwLock::default() }
    }

    fn variant(&self, program: &Program, arrivals: &[Arrival]) -> Option<Arc<Variant>> {
        let find = |known: &[Known]| known.iter().find(|k| k.0 == arrivals).map(|k| k.1.clone());
        // A thread that panicked while holding the lock left the list whole: entries are pushed complete.
        if let Some(found) = find(&self.variants.read().unwrap_or_else(PoisonError::into_inner)) {
            return found;
        }
        let mut known = self.variants.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = find(&known) {
            return found;
        }
        // Where the system forbids executable pages the interpreter serves, for good.
        let made = assemble(self.target, program, arrivals).and_then(|(flow, assembly)| {
            let pages = Pages::new(&assembly).ok()?;
            Some(Arc::new(Variant { flow, layout: assembly.layout, pages }))
        });
        known.push((arrivals.to_vec(), made.clone()));
        made
    }

    /// Runs the groups; false where the interpreter has to.
    ///
    /// # Panics
    /// When a buffer is shorter than the groups need.
    pub(crate) fn run<T: Number>(
        &self,
        program: &Program,
        scratch: &mut Scratch,
        groups: usize,
        inputs: &[Input<'_, T>],
        outputs: &mut [&mut [T]],
    ) -> bool {
        if groups == 0 {
            return true;
        }
        check(program, groups, inputs, outputs);
        debug_assert_eq!(T::SIZE, self.target.number() as usize, "the kernel was made for these numbers");
        if T::SIZE == 4 && inputs.iter().any(beyond_signed_indices) {
            return false;
        }
        let arrivals: Vec<Arrival> = inputs.iter().map(Arrival::of).collect();
        let Some(variant) = self.variant(program, &arrivals) else { return false };
        let pool = variant.pages.pool();
        let frame = frame(self.target, &variant.flow, variant.layout, pool, scratch, groups, inputs, outputs);
        // SAFETY: a machine is only made for a target that this processor was found to have; `check` has seen that
        // every buffer is as long as the groups need and every row number within its array; outputs are borrowed
        // exclusively, so they are neither inputs nor the frame.
        unsafe { variant.pages.run(frame) };
        true
    }
}

/// Sees that every buffer is as long as the groups need, and every row within its array.
///
/// # Panics
/// Otherwise.
pub(crate) fn check<T>(program: &Program, groups: usize, inputs: &[Input<'_, T>], outputs: &[&mut [T]]) {
    assert_eq!(inputs.len(), program.inputs.len(), "program {}: number of inputs", program.name);
    assert_eq!(outputs.len(), program.outputs.len(), "program {}: number of outputs", program.name);
    for (buffer, input) in program.inputs.iter().zip(inputs) {
        let places = buffer.total(program.points);
        let enough = match *input {
            Input::Lanes(values) => values.len() >= groups * places * LANES,
            Input::Uniform(values) => values.len() >= places,
            Input::Gathered { values, rows, width } => {
                assert!(width != 0, "program {}, input {}: rows of no width", program.name, buffer.name);
                let needed = groups * (places / width) * LANES;
                rows.len() >= needed && (needed == 0 || (highest(&rows[..needed]) as usize + 1) * width <= values.len())
            }
        };
        assert!(enough, "program {}: input {} is too short for {groups} groups", program.name, buffer.name);
    }
    for (buffer, output) in program.outputs.iter().zip(outputs) {
        let needed = groups * buffer.total(program.points) * LANES;
        let given = output.len();
        assert!(given >= needed, "program {}: output {} has {given} of {needed} places", program.name, buffer.name);
    }
}

/// Whether a shared array is longer than the gather of singles can index.
fn beyond_signed_indices<T>(input: &Input<'_, T>) -> bool {
    matches!(input, Input::Gathered { values, .. } if i32::try_from(values.len()).is_err())
}

/// The highest row number.
fn highest(rows: &[u32]) -> u32 {
    #[target_feature(enable = "avx2")]
    fn wide(rows: &[u32]) -> u32 {
        rows.iter().fold(0, |m, r| m.max(*r))
    }
    // SAFETY: machine code runs only on processors that have AVX2 or more.
    unsafe { wide(rows) }
}

/// Fills the scratch block as the code expects it; its address.
pub(crate) fn frame<T: Number>(
    target: Target,
    flow: &Flow,
    layout: Layout,
    pool: u64,
    scratch: &mut Scratch,
    groups: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) -> *mut u64 {
    let line = size_of::<[f64; LANES]>();
    // One more, so that the frame can begin at a line of the cache.
    let lines = (layout.size as usize).div_ceil(line) + 1;
    if scratch.slots.len() < lines {
        scratch.slots.resize(lines, [0.0; LANES]);
    }
    let block = scratch.slots.as_flattened_mut();
    let skip = block.as_ptr().align_offset(64);
    let block = &mut block[skip..];
    let mut word = |at: u32, value: u64| block[at as usize / 8] = f64::from_bits(value);
    word(Layout::GROUPS, groups as u64);
    word(Layout::POOL, pool);
    for function in [Function::Ln, Function::Exp, Function::Pow] {
        word(function_at(function), functions::address(target, function));
    }
    for (k, stream) in flow.streams.iter().enumerate() {
        let address = match stream.source {
            Source::Input(b) | Source::Points(b) => match inputs[b as usize] {
                Input::Lanes(values) | Input::Uniform(values) => values.as_ptr().expose_provenance(),
                Input::Gathered { .. } => unreachable!("a stream of lanes comes from an input in lanes"),
            },
            Source::Rows(b) | Source::Shared(b) => match inputs[b as usize] {
                Input::Gathered { values, rows, .. } => match stream.source {
                    Source::Rows(_) => rows.as_ptr().expose_provenance(),
                    _ => values.as_ptr().expose_provenance(),
                },
                _ => unreachable!("a stream of rows comes from a gathered input"),
            },
            Source::Output(b) => outputs[b as usize].as_mut_ptr().expose_provenance(),
        };
        word(Layout::STREAMS + 8 * k as u32, address as u64);
    }
    for (k, &(buffer, place)) in flow.uniforms.iter().enumerate() {
        let Input::Uniform(values) = inputs[buffer] else { unreachable!("a uniform value comes from a uniform input") };
        let (at, words) = (layout.uniforms + k as u32 * target.constant(), target.constant() as usize / 8);
        block[at as usize / 8..][..words].fill(f64::from_bits(values[place].word()));
    }
    block.as_mut_ptr().expose_provenance();
    block.as_mut_ptr().cast()
}
