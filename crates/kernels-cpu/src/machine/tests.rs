//! Machine code against the oracle: on this processor where it can run it, emulated for every target.

use super::emulator::Emulated;
use super::target::Target;
use crate::{Cpu, InstructionSet};
use souple_kernels::conformance::{self, Random, compare, compare_singles, random_program};
use souple_kernels::{Backend, Input, LANES, Scratch};

/// Random programs on each set that this processor has, as many as asked for by `SOUPLE_FUZZ` (3000 otherwise).
#[test]
fn random_programs_run_as_the_oracle_says() {
    #[expect(clippy::disallowed_methods, reason = "a test may be asked to try harder")]
    let asked = std::env::var("SOUPLE_FUZZ").ok().and_then(|n| n.parse().ok());
    let count: usize = asked.unwrap_or(3000);
    for set in [InstructionSet::Avx512, InstructionSet::Avx2] {
        if let Some(cpu) = Cpu::with(set) {
            let mut random = Random::new(11);
            for k in 0..count {
                let program = random_program(&mut random, 1 + (k * 7) % 150);
                compare(&cpu, &program, &mut random);
                assert!(compare_singles(&cpu, &program, &mut random));
            }
        }
    }
}

/// Emulated code of every target passes the suite, and touches no memory but its own.
#[test]
fn emulated_code_passes_the_suite() {
    for target in [Target::Avx512, Target::Avx2] {
        let emulated = Emulated::new(target);
        conformance::random_programs(&emulated, 5, 150);
        conformance::long_programs(&emulated, 6);
        conformance::text_round_trip(&emulated, 7);
    }
}

/// So does emulated code for singles.
#[test]
fn emulated_code_for_singles_passes_the_suite() {
    let emulated = Emulated::new(Target::Avx2Single);
    conformance::random_programs_in_singles(&emulated, 9, 150);
    let mut random = Random::new(23);
    for length in [500, 1500] {
        let program = random_program(&mut random, length);
        assert!(compare_singles(&emulated, &program, &mut random));
    }
}

/// The emulator and the processor give the same bits, where the processor has the instructions: so what the emulator
/// says of the other targets can be trusted.
#[test]
fn emulator_and_processor_give_the_same_bits() {
    for (set, target) in [(InstructionSet::Avx512, Target::Avx512), (InstructionSet::Avx2, Target::Avx2)] {
        let Some(cpu) = Cpu::with(set) else { continue };
        let emulated = Emulated::new(target);
        let mut random = Random::new(13);
        for k in 0..60 {
            let program = random_program(&mut random, 10 + 3 * k);
            let data = Data::new(&program, 3, &mut random);
            assert_eq!(data.run(&cpu, &program, &[3]), data.run(&emulated, &program, &[3]), "{target:?}, program {k}");
        }
    }
}

/// However many groups a call runs, every group's numbers have the same bits.
#[test]
fn bits_do_not_depend_on_groups_per_call() {
    let cpu = Cpu::open();
    let mut random = Random::new(17);
    for k in 0..100 {
        let program = random_program(&mut random, 10 + 3 * k);
        let data = Data::new(&program, 7, &mut random);
        let whole = data.run(&cpu, &program, &[7]);
        assert_eq!(whole, data.run(&cpu, &program, &[1, 2, 4]), "program {k}");
        assert_eq!(whole, data.run(&cpu, &program, &[1; 7]), "program {k}");
    }
}

type Breaking<'a> = dyn Fn(&mut Vec<Input<'_>>, &mut Vec<&mut [f64]>) + 'a;

/// Each way in which a buffer can be too short panics before any machine code runs.
#[test]
fn short_buffers_are_refused() {
    let mut random = Random::new(19);
    let program = random_program(&mut random, 20);
    let data = Data::new(&program, 2, &mut random);
    let cpu = Cpu::open();
    let kernel = cpu.compile(&program).unwrap();
    let refused = |break_it: &Breaking<'_>| {
        let mut outputs = data.outputs(&program, 2);
        let mut inputs = data.inputs(0, 2);
        let mut slices: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        break_it(&mut inputs, &mut slices);
        let run = std::panic::AssertUnwindSafe(|| kernel.run(&mut Scratch::default(), 2, &inputs, &mut slices));
        std::panic::catch_unwind(run).is_err()
    };
    assert!(!refused(&|_, _| {}), "whole buffers are fine");
    let shorter = |input: &mut Input<'_>| match input {
        Input::Lanes(v) | Input::Uniform(v) => *v = &v[..v.len() - 1],
        Input::Gathered { rows, .. } => *rows = &rows[..rows.len() - 1],
    };
    for k in 0..program.inputs.len() {
        assert!(refused(&|inputs, _| shorter(&mut inputs[k])), "input {k}");
    }
    for k in 0..program.outputs.len() {
        let cut = |_: &mut Vec<Input<'_>>, outputs: &mut Vec<&mut [f64]>| {
            let all = std::mem::take(&mut outputs[k]);
            let shorter = all.len() - 1;
            outputs[k] = &mut all[..shorter];
        };
        assert!(refused(&cut), "output {k}");
    }
    let beyond = |inputs: &mut Vec<Input<'_>>, _: &mut Vec<&mut [f64]>| {
        for input in inputs.iter_mut() {
            if let Input::Gathered { values, .. } = input {
                *values = &values[..3];
            }
        }
    };
    assert!(refused(&beyond), "rows beyond the shared array");
}

/// Inputs of a program for a number of groups: uniform, laned if per point, gathered in rows of three.
struct Data {
    values: Vec<Vec<f64>>,
    rows: Vec<Vec<u32>>,
    places: Vec<usize>,
    uniform: Vec<bool>,
    gathered: Vec<bool>,
}

impl Data {
    fn new(program: &souple_program::Program, groups: usize, random: &mut Random) -> Data {
        let items = groups * LANES;
        let mut data = Data {
            values: Vec::new(),
            rows: Vec::new(),
            places: program.inputs.iter().map(|b| b.total(program.points)).collect(),
            uniform: (0..program.inputs.len()).map(|k| k == 0).collect(),
            gathered: program.inputs.iter().map(|b| !b.per_point && b.len % 3 == 0).collect(),
        };
        for places in &data.places {
            data.values.push((0..items * places).map(|_| random.between(-2.0, 2.0)).collect());
            data.rows.push((0..items * places / 3).map(|_| random.below(items) as u32).collect());
        }
        data
    }

    /// Inputs of `count` groups from `first` on.
    fn inputs(&self, first: usize, count: usize) -> Vec<Input<'_>> {
        (0..self.values.len())
            .map(|k| {
                let part = |places: usize| first * places * LANES..(first + count) * places * LANES;
                if self.uniform[k] {
                    Input::Uniform(&self.values[k][..self.places[k]])
                } else if self.gathered[k] {
                    Input::Gathered { values: &self.values[k], rows: &self.rows[k][part(self.places[k] / 3)], width: 3 }
                } else {
                    Input::Lanes(&self.values[k][part(self.places[k])])
                }
            })
            .collect()
    }

    fn outputs(&self, program: &souple_program::Program, groups: usize) -> Vec<Vec<f64>> {
        program.outputs.iter().map(|b| vec![0.0; groups * LANES * b.total(program.points)]).collect()
    }

    /// Bits of all outputs, of calls with so many groups each.
    fn run(&self, backend: &dyn Backend, program: &souple_program::Program, calls: &[usize]) -> Vec<Vec<u64>> {
        let kernel = backend.compile(program).unwrap();
        let mut bits: Vec<Vec<u64>> = vec![Vec::new(); program.outputs.len()];
        let mut first = 0;
        for &count in calls {
            let mut outputs = self.outputs(program, count);
            let mut slices: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
            kernel.run(&mut Scratch::default(), count, &self.inputs(first, count), &mut slices);
            first += count;
            // Signs and payloads of NaN are nobody's promise.
            let canonical = |v: &f64| if v.is_nan() { f64::NAN } else { *v }.to_bits();
            bits.iter_mut().zip(&outputs).for_each(|(b, o)| b.extend(o.iter().map(canonical)));
        }
        bits
    }
}
