#![expect(
    unsafe_code,
    reason = "a function compiled for an instruction set may be called only where that set was found"
)]
//! Programs on the processor's widest vectors.
//!
//! The instruction set is chosen when the backend is opened, from what the processor reports; [`Backend::about`] says
//! which. The interpreter's loops are compiled once per set.

use souple_kernels::plan::{Plan, plan};
use souple_kernels::{About, Backend, CompileError, Input, Kernel, LANES, Scratch, execute};
use souple_program::{Program, verify};
use std::sync::Arc;

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// AVX-512F: 8 doubles.
    Avx512,
    /// AVX2 with fused multiply-add: 4 doubles.
    Avx2,
    /// Whatever every processor of the family has.
    Baseline,
}

impl InstructionSet {
    /// Every set, widest first.
    pub const ALL: [InstructionSet; 3] = [InstructionSet::Avx512, InstructionSet::Avx2, InstructionSet::Baseline];

    /// Name used in commands and reports.
    pub fn name(self) -> &'static str {
        match self {
            InstructionSet::Avx512 => "avx512",
            InstructionSet::Avx2 => "avx2",
            InstructionSet::Baseline => "baseline",
        }
    }

    /// Whether this processor has it.
    pub fn available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            InstructionSet::Avx512 => is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("fma"),
            InstructionSet::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            InstructionSet::Baseline => true,
        }
        #[cfg(not(target_arch = "x86_64"))]
        matches!(self, InstructionSet::Baseline)
    }
}

/// The processor as a backend.
#[derive(Clone, Debug)]
pub struct Cpu {
    about: About,
    set: InstructionSet,
}

impl Cpu {
    /// With the widest instruction set of this processor.
    pub fn open() -> Cpu {
        let set = InstructionSet::ALL.into_iter().find(|s| s.available());
        Cpu::with(set.expect("the baseline is always available")).expect("an available set opens")
    }

    /// With a given instruction set; `None` when this processor lacks it.
    pub fn with(set: InstructionSet) -> Option<Cpu> {
        let description = format!("vector interpreter, {}, {LANES} doubles per group", set.name());
        set.available().then(|| Cpu { about: About { name: "cpu".into(), description }, set })
    }
}

impl Backend for Cpu {
    fn about(&self) -> &About {
        &self.about
    }

    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Vectorised { program: program.clone(), plan: plan(program), set: self.set }))
    }
}

struct Vectorised {
    program: Program,
    plan: Plan,
    set: InstructionSet,
}

impl Kernel for Vectorised {
    fn program(&self) -> &Program {
        &self.program
    }

    fn run(&self, scratch: &mut Scratch, groups: usize, inputs: &[Input<'_>], outputs: &mut [&mut [f64]]) {
        match self.set {
            // SAFETY: `Cpu::with` checked that this processor has the instruction set before making the backend.
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => unsafe { avx512(&self.program, &self.plan, scratch, groups, inputs, outputs) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => unsafe { avx2(&self.program, &self.plan, scratch, groups, inputs, outputs) },
            _ => execute::<false>(&self.program, &self.plan, scratch, groups, inputs, outputs),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,fma")]
fn avx512(p: &Program, plan: &Plan, s: &mut Scratch, groups: usize, inputs: &[Input<'_>], outputs: &mut [&mut [f64]]) {
    execute::<true>(p, plan, s, groups, inputs, outputs);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2(p: &Program, plan: &Plan, s: &mut Scratch, groups: usize, inputs: &[Input<'_>], outputs: &mut [&mut [f64]]) {
    execute::<true>(p, plan, s, groups, inputs, outputs);
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_kernels::conformance;

    souple_kernels::conformance!(Cpu::open());

    /// Every instruction set that this processor has agrees with the oracle.
    #[test]
    fn every_instruction_set_agrees() {
        for set in InstructionSet::ALL {
            if let Some(cpu) = Cpu::with(set) {
                conformance::random_programs(&cpu, 7, 100);
            }
        }
    }
}
