//! Every backend runs every derived program within the error bound of the oracle.

use crate::programs::{inputs, item, run_all};
use crate::sample::largest;
use souple_forms::Loops;
use souple_kernels::conformance::Random;
use souple_kernels::{Backend, Input, Interpreter, LANES, Scratch, oracle};
use souple_kernels_cpu::{Cpu, InstructionSet};
use souple_operators::{Association, derive};
use souple_program::{Costs, Program};

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
    for &element in souple_elements::all() {
        for &law in souple_laws::all() {
            let association = Association { element, law, rule: element.default_rule(), loops: Loops::Rolled };
            let derived = derive(association, Costs::default());
            // A different element in each lane, with what was carried for it.
            let items: Vec<_> = (0..GROUPS * LANES)
                .map(|_| {
                    let mut item = item(element, law, &mut random);
                    run_all(&derived, &mut item);
                    item
                })
                .collect();
            for program in derived.staged.programs.iter().map(|p| &p.program) {
                let each: Vec<Vec<Vec<f64>>> = items.iter().map(|item| inputs(program, item)).collect();
                for backend in &backends {
                    let what = format!("{} / {} {} on {}", element.id, law.id, program.name, backend.about().description);
                    compare(&what, &**backend, program, &each);
                }
            }
        }
    }
}

/// Runs a program for items with these inputs, [item][buffer][place], and compares every output with the oracle's.
fn compare(what: &str, backend: &dyn Backend, program: &Program, items: &[Vec<Vec<f64>>]) {
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
    for (k, item) in items.iter().enumerate() {
        for (b, expected) in oracle::run(program, item).iter().enumerate() {
            let values: Vec<f64> = expected.iter().map(|e| e.value).collect();
            for (row, want) in expected.iter().enumerate() {
                let got = outputs[b][(k / LANES * rows[b] + row) * LANES + k % LANES];
                let name = &program.outputs[b].name;
                // The bound itself must mean something.
                let sharp = want.error <= 1e-9 * largest(&values).max(1.0);
                assert!(sharp, "{what}: bound {:e} for {name}[{row}] = {:e}", want.error, want.value);
                let close = (got - want.value).abs() <= want.error;
                let (value, error) = (want.value, want.error);
                assert!(close, "{what}: item {k}, {name}[{row}] is {got:e}, the oracle says {value:e} ± {error:e}");
            }
        }
    }
}
