//! A family of programs from one graph: one for the set-up, any number for each step, any number for each application,
//! with the carried values that tie them together.

use crate::{Buffer, Costs, Dag, Program, Ref, Source, Target, associate, carried, lower};
use souple_symbols::{Expr, Graph, Time};
use std::collections::{HashMap, HashSet};

/// Leaves that are read from one buffer, in its order.
#[derive(Clone, Debug)]
pub struct BufferRequest {
    /// Name of the buffer.
    pub name: String,
    /// The leaves; all of one binding time, and all varying over the points (then the buffer is per point) or none.
    pub leaves: Vec<Expr>,
}

/// Values that a program writes.
#[derive(Clone, Debug)]
pub struct OutputRequest {
    /// Name of the program; requests with the same one share a program.
    pub program: String,
    /// When that program runs at the latest.
    pub time: Time,
    /// Name of the buffer.
    pub name: String,
    /// The values: if one varies over the points, the buffer is per point.
    pub values: Vec<Expr>,
    /// Whether it has a say in what is carried, and an application may read what the step carried; if not, the program
    /// takes what it finds and computes the rest from the leaves.
    pub cached: bool,
}

/// One program of a family.
#[derive(Clone, Debug)]
pub struct StagedProgram {
    /// When it runs.
    pub time: Time,
    /// The program.
    pub program: Program,
}

/// The family.
#[derive(Clone, Debug)]
pub struct Staged {
    /// The programs, those of earlier times first.
    pub programs: Vec<StagedProgram>,
    /// Values carried from set-up to later times: (once, per point).
    pub setup_to_step: (usize, usize),
    /// Values carried from step to application: (once, per point).
    pub step_to_apply: (usize, usize),
}

impl Staged {
    /// The program with this name.
    pub fn program(&self, name: &str) -> Option<&Program> {
        self.programs.iter().map(|p| &p.program).find(|p| p.name == name)
    }
}

/// Name of the program that prepares applications; requests may add outputs to it.
pub const LINEARISE: &str = "linearise";
/// Name of the program that prepares steps; requests may add outputs to it.
pub const SETUP: &str = "setup";

/// Derives the programs that compute the requested outputs.
pub fn stage(g: &Graph, inputs: &[BufferRequest], outputs: &[OutputRequest], costs: Costs) -> Staged {
    let roots: Vec<Expr> = outputs.iter().flat_map(|o| o.values.iter().copied()).collect();
    let leaves: Vec<Expr> = inputs.iter().flat_map(|b| b.leaves.iter().copied()).collect();
    let all: Vec<Expr> = roots.iter().chain(&leaves).copied().collect();
    let (dag, refs) = associate(g, &all);
    let mut outputs_refs: Vec<Vec<Ref>> = Vec::new();
    let mut at = 0;
    for o in outputs {
        outputs_refs.push(refs[at..at + o.values.len()].to_vec());
        at += o.values.len();
    }
    let leaf_refs: HashMap<Expr, Ref> = leaves.iter().copied().zip(refs[at..].iter().copied()).collect();

    let later: Vec<Ref> = outputs
        .iter()
        .zip(&outputs_refs)
        .filter(|(o, _)| o.time > Time::Setup && o.cached)
        .flat_map(|(_, r)| r.clone())
        .collect();
    let from_setup = carried(&dag, &later, Time::Setup, &HashSet::new(), costs);
    let applied: Vec<Ref> = outputs
        .iter()
        .zip(&outputs_refs)
        .filter(|(o, _)| o.time == Time::Apply && o.cached)
        .flat_map(|(_, r)| r.clone())
        .collect();
    let free: HashSet<Ref> = from_setup.iter().copied().collect();
    let from_step: Vec<Ref> =
        carried(&dag, &applied, Time::Step, &free, costs).into_iter().filter(|r| !free.contains(r)).collect();

    let setup = Carried::new(&dag, "setup", from_setup);
    let step = Carried::new(&dag, "step", from_step);
    let mut names: Vec<(Time, &str)> = vec![(Time::Setup, SETUP)];
    for (o, refs) in outputs.iter().zip(&outputs_refs) {
        if !names.iter().any(|n| n.1 == o.program) {
            // What is known earlier than it was asked for runs earlier, once.
            let known = refs.iter().map(|&r| dag.node(r).time).max().unwrap_or(Time::Setup).max(Time::Setup);
            let time = if o.cached { o.time } else { o.time.min(known) };
            names.push((time, &o.program));
        }
    }
    if !applied.is_empty() && !names.iter().any(|n| n.1 == LINEARISE) {
        names.push((Time::Step, LINEARISE));
    }
    names.sort_by_key(|n| n.0);

    let mut programs = Vec::new();
    for (time, name) in names {
        let own: Vec<usize> = (0..outputs.len()).filter(|&k| outputs[k].program == name).collect();
        let mut reads = Reads::default();
        for b in inputs {
            let refs: Vec<Ref> = b.leaves.iter().map(|l| leaf_refs[l]).collect();
            if b.leaves.iter().any(|&l| g.time(l) <= time) {
                let per_point = refs.iter().any(|&r| dag.node(r).varying);
                reads.buffer(&b.name, &refs, per_point);
            }
        }
        if time > Time::Setup {
            setup.read(&mut reads);
        }
        if time == Time::Apply && own.iter().all(|&k| outputs[k].cached) {
            step.read(&mut reads);
        }
        let mut buffers: Vec<Buffer> = Vec::new();
        let mut targets: Vec<(Ref, Target)> = Vec::new();
        for &k in &own {
            let per_point = outputs_refs[k].iter().any(|&r| dag.node(r).varying);
            write(&mut buffers, &mut targets, &outputs[k].name, &outputs_refs[k], per_point);
        }
        if name == SETUP {
            setup.write(&mut buffers, &mut targets);
        }
        if name == LINEARISE {
            step.write(&mut buffers, &mut targets);
        }
        let program = lower(&dag, name, reads.buffers, &reads.sources, buffers, &targets);
        programs.push(StagedProgram { time, program: without_unread(program) });
    }
    Staged { programs, setup_to_step: setup.sizes(), step_to_apply: step.sizes() }
}

#[derive(Default)]
struct Reads {
    buffers: Vec<Buffer>,
    sources: Vec<(Ref, Source)>,
}

impl Reads {
    fn buffer(&mut self, name: &str, refs: &[Ref], per_point: bool) {
        if refs.is_empty() {
            return;
        }
        let buffer = self.buffers.len();
        self.buffers.push(Buffer { name: name.into(), len: refs.len(), per_point });
        self.sources.extend(refs.iter().enumerate().map(|(index, &r)| (r, Source { buffer, index })));
    }
}

fn write(buffers: &mut Vec<Buffer>, targets: &mut Vec<(Ref, Target)>, name: &str, refs: &[Ref], per_point: bool) {
    if refs.is_empty() {
        return;
    }
    let buffer = buffers.len();
    buffers.push(Buffer { name: name.into(), len: refs.len(), per_point });
    targets.extend(refs.iter().enumerate().map(|(index, &r)| (r, Target { buffer, index })));
}

/// Carried values, those known once and those known per point apart.
struct Carried {
    once: (String, Vec<Ref>),
    points: (String, Vec<Ref>),
}

impl Carried {
    fn new(dag: &Dag, name: &str, refs: Vec<Ref>) -> Carried {
        let (points, once) = refs.into_iter().partition(|&r| dag.node(r).varying);
        Carried { once: (format!("{name}_values"), once), points: (format!("{name}_point_values"), points) }
    }

    fn sizes(&self) -> (usize, usize) {
        (self.once.1.len(), self.points.1.len())
    }

    fn read(&self, reads: &mut Reads) {
        reads.buffer(&self.once.0, &self.once.1, false);
        reads.buffer(&self.points.0, &self.points.1, true);
    }

    fn write(&self, buffers: &mut Vec<Buffer>, targets: &mut Vec<(Ref, Target)>) {
        write(buffers, targets, &self.once.0, &self.once.1, false);
        write(buffers, targets, &self.points.0, &self.points.1, true);
    }
}

/// Drops input buffers that the program does not read, so that nobody has to provide them.
fn without_unread(mut program: Program) -> Program {
    let mut read = vec![false; program.inputs.len()];
    for s in program.sections.iter().flat_map(|s| s.statements()) {
        if let crate::Op::Input { buffer, .. } = s.op {
            read[buffer] = true;
        }
    }
    let mut number = 0;
    let new: Vec<usize> = read
        .iter()
        .map(|&r| {
            number += usize::from(r);
            number.wrapping_sub(1)
        })
        .collect();
    for section in &mut program.sections {
        let (crate::Section::Straight(statements) | crate::Section::Loop(statements)) = section;
        for s in statements {
            if let crate::Op::Input { buffer, .. } = &mut s.op {
                *buffer = new[*buffer];
            }
        }
    }
    let mut keep = read.into_iter();
    program.inputs.retain(|_| keep.next().expect("one flag per input"));
    program
}
