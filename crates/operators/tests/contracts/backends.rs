//! Every backend runs every derived program within the error bound of the oracle.

use crate::programs::{inputs, item, run_all};
use crate::sample::with_default_rules;
use souple_kernels::conformance::Random;
use souple_kernels::oracle::{self, Bounded};
use souple_kernels::{Backend, Input, Interpreter, LANES, Scratch};
use souple_kernels_cpu::{Cpu, InstructionSet};
use souple_operators::{Association, derive};
use souple_program::{Buffer, Costs, Program};

/// Groups: more than one, fewer than a batch.
const GROUPS: usize = 2;

fn backends() -> Vec<Box<dyn Backend>> {
    let mut all: Vec<Box<dyn Backend>> = vec![Box::new(Interpreter::default())];
    for set in InstructionSet::ALL {
        if let Some(cpu) = Cpu::with(set) {
            all.push(Box::new(cpu));
        }
    }
    all
}

/// Interpreter and processor, with each instruction set that it has, agree with the oracle on every program of every
/// element and law.
#[test]
fn backends_agree_with_the_oracle_on_derived_programs() {
    let backends = backends();
    let mut random = Random::new(21);
    for (element, law, rule) in with_default_rules() {
        let association = Association { rule, ..Association::new(element, law) };
        let derived = derive(association, Costs::default());
        // A different element in each lane, with what was carried for it.
        let (items, expected): (Vec<_>, Vec<_>) = (0..GROUPS * LANES)
            .map(|_| {
                let mut item = item(element, law, element.dimension(), &mut random);
                let expected = run_all(&derived, &mut item);
                (item, expected)
            })
            .unzip();
        for program in derived.staged.programs.iter().map(|p| &p.program) {
            let each: Vec<Vec<Vec<f64>>> = items.iter().map(|item| inputs(program, item)).collect();
            let oracle: Vec<Vec<Vec<Bounded>>> = expected
                .iter()
                .zip(&each)
                .map(|(all, inputs)| {
                    let of = |b: &Buffer| all[&(program.name.clone(), b.name.clone())].clone();
                    let bounded: Vec<Vec<Bounded>> = program.outputs.iter().map(of).collect();
                    // The rotations that find eigenvectors correct themselves, which no bound from step to step knows.
                    if bounded.iter().all(|values| sharp(values)) { bounded } else { oracle::spread(program, inputs) }
                })
                .collect();
            for backend in &backends {
                let what = format!("{} / {} {} on {}", element.id, law.id, program.name, backend.about().description);
                compare(&what, &**backend, program, &each, &oracle);
            }
        }
    }
}

/// Runs a program for items with these inputs and compares its outputs with what the oracle says, both
/// [item][buffer][place].
fn compare(
    what: &str,
    backend: &dyn Backend,
    program: &Program,
    items: &[Vec<Vec<f64>>],
    oracle: &[Vec<Vec<Bounded>>],
) {
    let kernel = backend.compile(program).unwrap();
    let lanes: Vec<Vec<f64>> = (0..program.inputs.len())
        .map(|b| {
            let rows = items[0][b].len();
            let mut values = vec![0.0; rows * items.len()];
            for (k, item) in items.iter().enumerate() {
                for (row, &v) in item[b].iter().enumerate() {
                    values[(k / LANES * rows + row) * LANES + k % LANES] = v;
                }
            }
            values
        })
        .collect();
    let inputs: Vec<Input<'_>> = lanes.iter().map(|v| Input::Lanes(v)).collect();
    let rows: Vec<usize> = program.outputs.iter().map(|b| b.total(program.points)).collect();
    let mut outputs: Vec<Vec<f64>> = rows.iter().map(|r| vec![f64::NAN; r * items.len()]).collect();
    let mut slices: Vec<&mut [f64]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    kernel.run(&mut Scratch::default(), GROUPS, &inputs, &mut slices);
    for (k, expected) in oracle.iter().enumerate() {
        for (b, expected) in expected.iter().enumerate() {
            assert!(sharp(expected), "{what}: bounds for {}: {expected:?}", program.outputs[b].name);
            for (row, want) in expected.iter().enumerate() {
                let got = outputs[b][(k / LANES * rows[b] + row) * LANES + k % LANES];
                let name = &program.outputs[b].name;
                let close = (got - want.value).abs() <= want.error;
                let (value, error) = (want.value, want.error);
                assert!(close, "{what}: item {k}, {name}[{row}] is {got:e}, the oracle says {value:e} ± {error:e}");
            }
        }
    }
}

/// Whether bounds mean something.
fn sharp(values: &[Bounded]) -> bool {
    let largest = values.iter().fold(1.0, |m: f64, v| m.max(v.value.abs()));
    values.iter().all(|v| v.error <= 1e-6 * largest)
}
