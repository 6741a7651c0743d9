//! The interpreter: every step for a batch of groups before the next step, so that the cost of deciding what to do is
//! shared by many items and the slots stay in the nearest cache.

use crate::contract::{About, Backend, CompileError, Input, Kernel, LANES, Scratch};
use crate::number::Number;
use crate::plan::{Plan, Step, plan};
use souple_program::{Program, verify};
use std::sync::Arc;

/// Groups per batch: 64 items. Sixty slots of them fill a 32 KiB cache.
const BATCH: usize = 8;

/// The backend that runs anywhere.
#[derive(Clone, Debug)]
pub struct Interpreter {
    about: About,
}

impl Default for Interpreter {
    fn default() -> Interpreter {
        let description = format!("portable interpreter, batches of {} items", BATCH * LANES);
        Interpreter { about: About { name: "interpreter".into(), description } }
    }
}

impl Backend for Interpreter {
    fn about(&self) -> &About {
        &self.about
    }

    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Interpreted { program: program.clone(), plan: plan(program) }))
    }

    fn compile_singles(&self, program: &Program) -> Result<Arc<dyn Kernel<f32>>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Interpreted { program: program.clone(), plan: plan(program) }))
    }
}

struct Interpreted {
    program: Program,
    plan: Plan,
}

impl<T: Number> Kernel<T> for Interpreted {
    fn program(&self) -> &Program {
        &self.program
    }

    fn run(&self, scratch: &mut Scratch, groups: usize, inputs: &[Input<'_, T>], outputs: &mut [&mut [T]]) {
        execute::<T, false>(&self.program, &self.plan, scratch, groups, inputs, outputs);
    }
}

/// Runs a plan. `FUSED` rounds multiply-adds once, which is only fast where the processor does it.
///
/// Always inlined, so that a caller compiled for a wider instruction set gets its loops compiled for it too.
#[inline(always)]
pub fn execute<T: Number, const FUSED: bool>(
    program: &Program,
    plan: &Plan,
    scratch: &mut Scratch,
    groups: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) {
    let slots = T::slots(scratch);
    slots.resize(plan.slot_count * BATCH, [T::ZERO; LANES]);
    let slots = &mut slots[..];
    let mut first = 0;
    while first < groups {
        let count = BATCH.min(groups - first);
        for (in_loop, steps) in &plan.sections {
            let passes = if *in_loop { program.points } else { 1 };
            for point in 0..passes {
                for step in steps {
                    run_step::<T, FUSED>(program, *step, slots, first, count, point, inputs, outputs);
                }
            }
        }
        first += count;
    }
}

/// Slots of value `v`: one vector of lanes per group of the batch.
#[inline(always)]
fn place(v: u32) -> usize {
    v as usize * BATCH
}

#[inline(always)]
fn one<T: Number>(slots: &mut [[T; LANES]], to: u32, a: u32, f: impl Fn(T) -> T) {
    let (to, a) = (place(to), place(a));
    for g in 0..BATCH {
        let x = slots[a + g];
        let mut r = [T::ZERO; LANES];
        for l in 0..LANES {
            r[l] = f(x[l]);
        }
        slots[to + g] = r;
    }
}

#[inline(always)]
fn two<T: Number>(slots: &mut [[T; LANES]], to: u32, a: u32, b: u32, f: impl Fn(T, T) -> T) {
    let (to, a, b) = (place(to), place(a), place(b));
    for g in 0..BATCH {
        let (x, y) = (slots[a + g], slots[b + g]);
        let mut r = [T::ZERO; LANES];
        for l in 0..LANES {
            r[l] = f(x[l], y[l]);
        }
        slots[to + g] = r;
    }
}

#[inline(always)]
fn three<T: Number>(slots: &mut [[T; LANES]], to: u32, abc: [u32; 3], f: impl Fn(T, T, T) -> T) {
    let (to, [a, b, c]) = (place(to), abc.map(place));
    for g in 0..BATCH {
        let (x, y, z) = (slots[a + g], slots[b + g], slots[c + g]);
        let mut r = [T::ZERO; LANES];
        for l in 0..LANES {
            r[l] = f(x[l], y[l], z[l]);
        }
        slots[to + g] = r;
    }
}

#[inline(always)]
fn run_step<T: Number, const FUSED: bool>(
    program: &Program,
    step: Step,
    slots: &mut [[T; LANES]],
    first: usize,
    count: usize,
    point: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) {
    match step {
        Step::Constant { to, value } => slots[place(to)..place(to) + BATCH].fill([T::from_f64(value); LANES]),
        Step::Table { to, table } => {
            slots[place(to)..place(to) + BATCH].fill([T::from_f64(program.tables[table as usize][point]); LANES]);
        }
        Step::Input { to, buffer, index } => {
            let b = &program.inputs[buffer as usize];
            let row = if b.per_point { point * b.len + index as usize } else { index as usize };
            let rows = b.total(program.points);
            for g in 0..count {
                slots[place(to) + g] = read(inputs[buffer as usize], first + g, row, rows);
            }
        }
        Step::Output { buffer, index, a } => {
            let b = &program.outputs[buffer as usize];
            let row = if b.per_point { point * b.len + index as usize } else { index as usize };
            let rows = b.total(program.points);
            for g in 0..count {
                let at = ((first + g) * rows + row) * LANES;
                outputs[buffer as usize][at..at + LANES].copy_from_slice(&slots[place(a) + g]);
            }
        }
        Step::Add { to, a, b } => two(slots, to, a, b, T::add),
        Step::Sub { to, a, b } => two(slots, to, a, b, T::sub),
        Step::Mul { to, a, b } => two(slots, to, a, b, T::mul),
        Step::Neg { to, a } => one(slots, to, a, T::neg),
        Step::MulAdd { to, a, b, c } => {
            three(slots, to, [a, b, c], |x, y, z| if FUSED { x.mul_add(y, z) } else { x.mul(y).add(z) });
        }
        Step::MulSub { to, a, b, c } => {
            three(slots, to, [a, b, c], |x, y, z| if FUSED { x.mul_add(y, z.neg()) } else { x.mul(y).sub(z) });
        }
        Step::NegMulAdd { to, a, b, c } => {
            three(slots, to, [a, b, c], |x, y, z| if FUSED { x.neg().mul_add(y, z) } else { z.sub(x.mul(y)) });
        }
        Step::Recip { to, a } => one(slots, to, a, T::recip),
        Step::Sqrt { to, a } => one(slots, to, a, T::sqrt),
        Step::Ln { to, a } => one(slots, to, a, T::ln),
        Step::Exp { to, a } => one(slots, to, a, T::exp),
        Step::Pow { to, a, b } => two(slots, to, a, b, T::powf),
    }
}

#[inline(always)]
fn read<T: Number>(input: Input<'_, T>, group: usize, row: usize, rows: usize) -> [T; LANES] {
    match input {
        Input::Lanes(values) => {
            let at = (group * rows + row) * LANES;
            let mut lanes = [T::ZERO; LANES];
            lanes.copy_from_slice(&values[at..at + LANES]);
            lanes
        }
        Input::Uniform(values) => [values[row]; LANES],
        Input::Gathered { values, rows: index, width } => {
            let (node, axis) = (row / width, row % width);
            let at = (group * (rows / width) + node) * LANES;
            let mut lanes = [T::ZERO; LANES];
            for (lane, &r) in lanes.iter_mut().zip(&index[at..at + LANES]) {
                *lane = values[r as usize * width + axis];
            }
            lanes
        }
    }
}
