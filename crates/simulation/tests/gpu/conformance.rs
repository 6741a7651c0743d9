//! Every element with every law: the programs that steps run agree with the oracle in singles, and their texts are
//! printed in the second language too.

use super::gpu;
use souple_elements::Element;
use souple_kernels::conformance::Random;
use souple_kernels::oracle::{self, Bounded, Precision};
use souple_kernels::{Backend as _, Input, LANES, Scratch};
use souple_kernels_gpu::GpuBackend;
use souple_kernels_gpu::print::{Access, Layout, Loops, cuda::Cuda, print};
use souple_laws::{Bound, Law, Parameter};
use souple_operators::{Association, Derived, derive, derive_diagonal};
use souple_program::{Costs, LINEARISE, Program, SETUP};
use std::collections::BTreeMap;

type Item = BTreeMap<String, Vec<f64>>;

/// Parameters well inside their ranges; defaults where there are any that are not zero.
fn parameters(law: &Law) -> Vec<f64> {
    let limit = |b: Bound| match b {
        Bound::None | Bound::NonZero => None,
        Bound::Open(v) | Bound::Closed(v) => Some(v),
    };
    let inside = |p: &Parameter| match (limit(p.minimum), limit(p.maximum)) {
        (Some(low), Some(high)) => low + 0.87 * (high - low),
        (Some(low), None) => low + 1.25,
        (None, Some(high)) => high - 1.25,
        (None, None) => 0.75,
    };
    let of = |p: &Parameter| p.default.filter(|&v| v != 0.0).unwrap_or_else(|| inside(p));
    // What a program reads in singles is the same number for the oracle.
    law.parameters.iter().map(|p| single(of(p))).collect()
}

fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

/// A skewed element with small displacements and any direction; all numbers are singles.
fn item(element: &Element, law: &Law, random: &mut Random) -> Item {
    let d = element.dimension();
    let skew = [[1.1, 0.2, -0.1], [0.15, 0.9, 0.25], [-0.2, 0.1, 1.2]];
    let mut rest = Vec::new();
    for node in element.nodes {
        rest.extend((0..d).map(|i| {
            let x: f64 = (0..d).map(|j| skew[i][j] * node[j]).sum();
            single(0.3 + x + random.between(-0.01, 0.01))
        }));
    }
    let n = rest.len();
    let mut vector = |size: f64| -> Vec<f64> { (0..n).map(|_| single(random.between(-size, size))).collect() };
    let (u, v) = (vector(0.02), vector(1.0));
    Item::from([
        ("rest".to_owned(), rest),
        ("parameters".to_owned(), parameters(law)),
        ("density".to_owned(), vec![single(1.3)]),
        ("section".to_owned(), vec![1.0]),
        ("displacement".to_owned(), u),
        ("direction".to_owned(), v),
    ])
}

fn inputs(program: &Program, item: &Item) -> Vec<Vec<f64>> {
    program.inputs.iter().map(|b| item[&b.name].clone()).collect()
}

/// Values that the set-up and the linearisation carry, rounded to singles: what is compared is one program at a time.
fn carry(derived: &Derived, item: &mut Item) {
    for name in [SETUP, LINEARISE] {
        let Some(program) = derived.staged.program(name) else { continue };
        let outputs = oracle::run(program, &inputs(program, item));
        for (b, values) in program.outputs.iter().zip(outputs).filter(|(b, _)| b.name.ends_with("values")) {
            item.insert(b.name.clone(), values.iter().map(|v| single(v.value)).collect());
        }
    }
}

/// The oracle's values with its bound for singles where that means something, and an estimate from random roundings
/// where it does not: rotations that find eigenvectors correct themselves, which no bound from step to step knows.
fn expected(program: &Program, given: &[Vec<f64>]) -> Vec<Vec<Bounded>> {
    let bounded = oracle::run_in(program, given, Precision::SINGLE);
    let sharp = |values: &Vec<Bounded>| {
        let largest = values.iter().fold(1.0, |m: f64, v| m.max(v.value.abs()));
        values.iter().all(|v| v.error <= 1e-2 * largest)
    };
    if bounded.iter().all(sharp) {
        return bounded;
    }
    let mut spread = oracle::spread(program, given);
    let scale = Precision::SINGLE.epsilon / Precision::DOUBLE.epsilon;
    spread.iter_mut().flatten().for_each(|v| v.error *= scale);
    spread
}

/// Elements up to here are compared with both programs of every law.
const SMALL: usize = 8;

/// The programs that implicit steps run; with one law after the other in turn also those that do not depend on it, or
/// are contained in these: compiling texts is what takes the time.
fn programs(derived: &Derived) -> Vec<Program> {
    let Association { element, law, .. } = derived.association;
    let carries = derived.staged.step_to_apply != (0, 0);
    let both = [if carries { LINEARISE } else { "force" }, "tangent_apply"];
    let place = |found: Option<usize>| found.expect("it is in its registry");
    let laws = souple_laws::all();
    let turn = place(souple_elements::all().iter().position(|e| e.id == element.id));
    let number = place(laws.iter().position(|l| l.id == law.id));
    let all = number == turn % laws.len();
    // Large elements take forces with one law and products with the next: a law enters point by point.
    let mut names = match element.node_count() <= SMALL || all {
        true => both.to_vec(),
        false => vec![both[(number + turn) % 2]],
    };
    if all {
        names.push("volume_ratio");
        names.extend(carries.then_some("force"));
    }
    let mut programs: Vec<Program> = names.iter().map(|n| derived.staged.program(n).unwrap().clone()).collect();
    if all {
        programs.push(derive_diagonal(derived, Costs::default()));
    }
    programs
}

/// Which associations a part of the test covers: compiling them is most of the work, and parts run side by side.
fn part(which: usize, of: usize) -> impl Iterator<Item = (&'static Element, &'static Law)> {
    let pairs = souple_elements::all().iter().flat_map(|&e| souple_laws::all().iter().map(move |&l| (e, l)));
    pairs.enumerate().filter(move |(k, _)| k % of == which).map(|(_, pair)| pair)
}

fn agree(which: usize, of: usize) {
    let Some(gpu) = gpu() else { return };
    let backend = GpuBackend::new(gpu);
    let mut random = Random::new(31 + which as u64);
    let mut unbounded = 0;
    let mut compared = 0;
    for (element, law) in part(which, of) {
        let derived = derive(Association::new(element, law), Costs::default());
        let items: Vec<Item> = (0..2)
            .map(|_| {
                let mut item = item(element, law, &mut random);
                carry(&derived, &mut item);
                item
            })
            .collect();
        for program in programs(&derived) {
            let what = format!("{} / {} {}", element.id, law.id, program.name);
            let kernel = backend.compile_singles(&program).unwrap_or_else(|e| panic!("{what}: {e}"));
            // Lanes take turns between the items.
            let lanes: Vec<Vec<f32>> = (0..program.inputs.len())
                .map(|b| {
                    let rows = items[0][&program.inputs[b].name].len();
                    let value = |row: usize, lane: usize| items[lane % 2][&program.inputs[b].name][row] as f32;
                    (0..rows)
                        .flat_map(|row| (0..LANES).map(move |lane| (row, lane)))
                        .map(|(r, l)| value(r, l))
                        .collect()
                })
                .collect();
            let given: Vec<Input<'_, f32>> = lanes.iter().map(|v| Input::Lanes(v)).collect();
            let rows: Vec<usize> = program.outputs.iter().map(|b| b.total(program.points)).collect();
            let mut outputs: Vec<Vec<f32>> = rows.iter().map(|r| vec![f32::NAN; r * LANES]).collect();
            let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
            kernel.run(&mut Scratch::default(), 1, &given, &mut slices);
            for (lane, item) in items.iter().enumerate() {
                let want = expected(&program, &inputs(&program, item));
                for (b, want) in want.iter().enumerate() {
                    for (row, want) in want.iter().enumerate() {
                        let got = f64::from(outputs[b][row * LANES + lane]);
                        let near = (got - want.value).abs() <= want.error;
                        unbounded += usize::from(!want.error.is_finite());
                        compared += 1;
                        let name = &program.outputs[b].name;
                        assert!(
                            near || !want.error.is_finite(),
                            "{what}: {name}[{row}] is {got:e}, the oracle says {:e} ± {:e}",
                            want.value,
                            want.error
                        );
                    }
                }
            }
        }
    }
    assert!(compared > 1000 && unbounded * 100 < compared, "{unbounded} of {compared} values have no bound");
}

/// The programs of a quarter of all elements × laws agree with the oracle within its bound for singles.
#[test]
fn elements_and_laws_agree_first_quarter() {
    agree(0, 4);
}

/// The second quarter.
#[test]
fn elements_and_laws_agree_second_quarter() {
    agree(1, 4);
}

/// The third quarter.
#[test]
fn elements_and_laws_agree_third_quarter() {
    agree(2, 4);
}

/// The last quarter.
#[test]
fn elements_and_laws_agree_last_quarter() {
    agree(3, 4);
}

/// Every element with one law after the other is printed as CUDA C; where a compiler for it is installed (nvcc, or the
/// Python package nvidia-cuda-nvrtc-cu12, which needs no device), it accepts those of forces and products.
#[test]
fn the_second_language_is_printed() {
    let folder = std::env::temp_dir().join(format!("souple-cuda-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut files = Vec::new();
    let laws = souple_laws::all();
    for (k, element) in souple_elements::all().iter().enumerate() {
        let law = laws[k % laws.len()];
        let derived = derive(Association::new(element, law), Costs::default());
        let mut text = String::new();
        for program in programs(&derived) {
            let d = element.dimension();
            let access = |b: &souple_program::Buffer| match b.name.as_str() {
                "displacement" | "direction" | "rest" => Access::Gathered { width: d, table: 0 },
                "parameters" => Access::Uniform,
                _ => Access::Lanes,
            };
            let inputs = program.inputs.iter().map(access).collect();
            let layout = Layout { lanes: 32, workgroup: 128, inputs, loops: Loops::Rolled };
            let printed = print(&program, &layout, &Cuda, &[format!("{} {}", element.id, law.id)]).unwrap();
            // Every value is defined once and every output written: as many of both as the program has.
            let defined =
                printed.source.matches("const float v").count() + printed.source.matches("    float v").count();
            let sections = program.sections.iter().flat_map(|s| s.statements());
            assert_eq!(defined, sections.clone().filter(|s| s.op.defines()).count(), "{}", program.name);
            // Linearisation and diagonal blocks of large elements keep the compiler busy for minutes.
            if ["force", "tangent_apply"].contains(&program.name.as_str()) {
                text += &printed.source.replace(" run(", &format!(" run_{}(", program.name));
            }
        }
        files.push(folder.join(format!("{}.cu", element.id)));
        std::fs::write(files.last().unwrap(), &text).unwrap();
    }
    let compiled = compile_cuda(&files);
    std::fs::remove_dir_all(&folder).unwrap();
    match compiled {
        Some(Ok(())) => {}
        Some(Err(complaint)) => panic!("{complaint}"),
        None => {
            println!("skipped: no compiler");
            if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
                let note = std::path::Path::new(&folder).join("simulation, CUDA C.txt");
                std::fs::write(note, "no compiler").unwrap();
            }
        }
    }
}

/// Compiles texts with what is installed: what the compiler complains of, or none where there is no compiler.
fn compile_cuda(files: &[std::path::PathBuf]) -> Option<Result<(), String>> {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tools/compile_cuda.py");
    let said = |out: &std::process::Output| {
        format!("{}{}", String::from_utf8_lossy(&out.stdout), String::from_utf8_lossy(&out.stderr))
    };
    if let Ok(out) = std::process::Command::new("python3").arg(script).args(files).output() {
        match out.status.code() {
            Some(0) => return Some(Ok(())),
            // The script found no compiler.
            Some(77) => {}
            _ => return Some(Err(said(&out))),
        }
    }
    std::process::Command::new("nvcc").arg("--version").output().ok()?;
    // It takes seconds per file.
    for file in files.iter().take(3) {
        let to = file.with_extension("ptx");
        let out = std::process::Command::new("nvcc").arg("--ptx").arg(file).arg("-o").arg(to).output().ok()?;
        if !out.status.success() {
            return Some(Err(said(&out)));
        }
    }
    Some(Ok(()))
}
