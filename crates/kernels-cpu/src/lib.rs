#![cfg_attr(
    target_arch = "x86_64",
    expect(
        unsafe_code,
        reason = "machine code runs outside the language, and a function compiled for an instruction set may be called only \
              where that set was found"
    )
)]
//! Programs on the processor's widest vectors.
//!
//! On x86-64 with AVX-512 or AVX2 a program becomes machine code when it is first run (see
//! [the design note](../../../docs/design/machine-code.md)); anywhere else, and where the system forbids executable
//! pages, the interpreter's loops run it, compiled for whatever vectors there are.
//!
//! The instruction set is chosen when the backend is opened, from what the processor reports; [`Backend::about`] says
//! which.

mod interpreted;
#[cfg(target_arch = "x86_64")]
mod machine;

#[cfg(target_arch = "x86_64")]
pub use machine::{Figures, figures};

use souple_kernels::plan::{Plan, plan};
use souple_kernels::{About, Backend, CompileError, Input, Kernel, Number, Scratch};
use souple_program::{Program, verify};
use std::sync::Arc;

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionSet {
    /// AVX-512F and VL: 8 doubles.
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

    /// What runs programs with it, in words.
    pub fn description(self) -> &'static str {
        match self {
            InstructionSet::Avx512 => "machine code for AVX-512, 8 doubles per operation",
            InstructionSet::Avx2 => "machine code for AVX2 with FMA, 4 doubles per operation",
            InstructionSet::Baseline => "interpreter, loops compiled for any processor of the family",
        }
    }

    /// Whether this processor has it.
    pub fn available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        match self {
            InstructionSet::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && InstructionSet::Avx2.available()
            }
            InstructionSet::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            InstructionSet::Baseline => true,
        }
        #[cfg(not(target_arch = "x86_64"))]
        matches!(self, InstructionSet::Baseline)
    }

    /// What machine code is made for, where it is.
    #[cfg(target_arch = "x86_64")]
    fn target(self) -> Option<machine::Target> {
        match self {
            InstructionSet::Avx512 => Some(machine::Target::Avx512),
            InstructionSet::Avx2 => Some(machine::Target::Avx2),
            InstructionSet::Baseline => None,
        }
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
        let description = set.description().to_string();
        set.available().then(|| Cpu { about: About { name: "cpu".into(), description }, set })
    }
}

impl Backend for Cpu {
    fn about(&self) -> &About {
        &self.about
    }

    fn compile(&self, program: &Program) -> Result<Arc<dyn Kernel>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Compiled {
            program: program.clone(),
            plan: plan(program),
            set: self.set,
            #[cfg(target_arch = "x86_64")]
            machine: self.set.target().map(machine::Machine::new),
        }))
    }

    fn compile_singles(&self, program: &Program) -> Result<Arc<dyn Kernel<f32>>, CompileError> {
        verify(program)?;
        Ok(Arc::new(Compiled {
            program: program.clone(),
            plan: plan(program),
            set: self.set,
            // A group of singles is one register of AVX2, which every processor with AVX-512 has too.
            #[cfg(target_arch = "x86_64")]
            machine: self.set.target().map(|_| machine::Machine::new(machine::Target::Avx2Single)),
        }))
    }
}

struct Compiled {
    program: Program,
    /// For the interpreter.
    plan: Plan,
    set: InstructionSet,
    #[cfg(target_arch = "x86_64")]
    machine: Option<machine::Machine>,
}

impl<T: Number> Kernel<T> for Compiled {
    fn program(&self) -> &Program {
        &self.program
    }

    fn run(&self, scratch: &mut Scratch, groups: usize, inputs: &[Input<'_, T>], outputs: &mut [&mut [T]]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(machine) = &self.machine
            && machine.run(&self.program, scratch, groups, inputs, outputs)
        {
            return;
        }
        interpreted::run(self.set, &self.program, &self.plan, scratch, groups, inputs, outputs);
    }
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
                conformance::long_programs(&cpu, 8);
                conformance::random_programs_in_singles(&cpu, 9, 100);
            }
        }
    }
}
