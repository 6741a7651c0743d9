//! The interpreter's loops compiled for each vector instruction set: what serves where machine code cannot.

use crate::InstructionSet;
use souple_kernels::plan::Plan;
use souple_kernels::{Input, Number, Scratch, execute};
use souple_program::Program;

/// Runs a plan with the loops compiled for `set`, which the caller must have found on this processor.
pub(crate) fn run<T: Number>(
    set: InstructionSet,
    program: &Program,
    plan: &Plan,
    scratch: &mut Scratch,
    groups: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) {
    match set {
        // SAFETY: `Cpu::with` checked that this processor has the instruction set before making the backend.
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => unsafe { avx512(program, plan, scratch, groups, inputs, outputs) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => unsafe { avx2(program, plan, scratch, groups, inputs, outputs) },
        _ => execute::<T, false>(program, plan, scratch, groups, inputs, outputs),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,fma")]
fn avx512<T: Number>(
    p: &Program,
    plan: &Plan,
    s: &mut Scratch,
    groups: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) {
    execute::<T, true>(p, plan, s, groups, inputs, outputs);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<T: Number>(
    p: &Program,
    plan: &Plan,
    s: &mut Scratch,
    groups: usize,
    inputs: &[Input<'_, T>],
    outputs: &mut [&mut [T]],
) {
    execute::<T, true>(p, plan, s, groups, inputs, outputs);
}
