//! What is compared computes the same: kernels written by hand and programs compiled ahead give what the derived
//! programs give.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]
#![allow(clippy::disallowed_methods, reason = "printed sources are read, and written when a person asks for it")]

use souple_bench::ahead::{Call, PRINTED, ahead, rust};
use souple_bench::batch::{Batch, association};
use souple_bench::handwritten::handwritten;
use souple_bench::singles::Singles;
use souple_bench::vectors::Vectors;
use souple_kernels::{Aligned, Backend as _, Interpreter, Scratch};

fn batch(element: &str, law: &str, elements: usize) -> Batch {
    let element = souple_elements::by_id(element).unwrap();
    let law = souple_laws::by_id(law).unwrap();
    Batch::new(association(element, law), elements, &Interpreter::default()).unwrap()
}

/// Outputs of a derived program on the interpreter.
fn derived(batch: &Batch, name: &str) -> Vec<Aligned> {
    let program = batch.derived.staged.program(name).unwrap();
    let kernel = Interpreter::default().compile(program).unwrap();
    let mut outputs = Batch::outputs(program, batch.groups);
    batch.run(&*kernel, &mut Scratch::default(), 0..batch.groups, &mut outputs);
    outputs
}

fn assert_close(what: &str, got: &[f64], want: &[f64]) {
    assert_eq!(got.len(), want.len(), "{what}");
    let scale = want.iter().fold(0.0f64, |m, w| m.max(w.abs()));
    assert!(scale > 0.0, "{what}: nothing to compare with");
    for (k, (g, w)) in got.iter().zip(want).enumerate() {
        assert!((g - w).abs() <= 1e-12 * scale, "{what}: place {k} is {g:e}, expected {w:e} at a scale of {scale:e}");
    }
}

/// Kernels written by hand give the forces and products of the derived programs to 1e-12, on every instruction set of
/// this processor, on distorted elements with random displacements; also when groups are done in parts.
#[test]
fn handwritten_kernels_equal_derived_programs() {
    for element in ["tet4", "hex8"] {
        let batch = batch(element, "stvk", 100);
        let mut set = handwritten(&batch).unwrap();
        let (force, product) = (derived(&batch, "force").remove(0), derived(&batch, "tangent_apply").remove(0));
        for vectors in Vectors::available() {
            let per_group = force.len() / batch.groups;
            let cut = batch.groups / 3;
            for groups in [0..cut, cut..batch.groups] {
                let part = groups.start * per_group..groups.end * per_group;
                let what = format!("{element} on {}", vectors.name());
                let mut out = vec![f64::NAN; part.len()];
                set.force(vectors, &batch, groups.clone(), &mut out);
                assert_close(&format!("force of {what}"), &out, &force[part.clone()]);
                out.fill(f64::NAN);
                set.linearise(vectors, &batch, groups.clone(), &mut out);
                assert_close(&format!("linearisation of {what}"), &out, &force[part.clone()]);
                out.fill(f64::NAN);
                set.tangent_apply(vectors, &batch, groups, &mut out);
                assert_close(&format!("product of {what}"), &out, &product[part]);
            }
        }
    }
}

/// Kernels in singles run on the batch that is measured: what they give is what the derived programs give, to single
/// precision, also when groups are done in parts.
#[test]
fn singles_equal_derived_programs() {
    for (element, law) in [("tet4", "stvk"), ("hex8", "neo-hookean")] {
        let batch = batch(element, law, 100);
        for name in ["force", "tangent_apply"] {
            let program = batch.derived.staged.program(name).unwrap();
            let mut singles = Singles::new(&batch, program, &Interpreter::default(), batch.groups).unwrap();
            let cut = batch.groups / 3;
            singles.run(0..cut);
            singles.run(cut..batch.groups);
            for (got, want) in singles.outputs().iter().zip(derived(&batch, name)) {
                let scale = want.iter().fold(0.0f64, |m, w| m.max(w.abs()));
                assert!(scale > 0.0 && got.len() == want.len());
                let worst = got.iter().zip(&want).map(|(g, w)| (f64::from(*g) - w).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-4 * scale, "{name} of {element}: {worst:e} at a scale of {scale:e}");
                assert!(got.iter().all(|g| g.is_finite()), "{name} of {element}");
            }
        }
    }
}

/// Programs compiled ahead give every output of the derived programs to 1e-12 on every instruction set of this processor.
#[test]
fn programs_compiled_ahead_equal_derived_programs() {
    for [element, law, name] in PRINTED {
        let batch = batch(element, law, 50);
        let program = batch.derived.staged.program(name).unwrap();
        let want = derived(&batch, name);
        let found = ahead(element, law, name).unwrap_or_else(|| panic!("{name} of {element} is not compiled: bless"));
        for vectors in Vectors::available() {
            let mut outputs = Batch::outputs(program, batch.groups);
            let groups = 0..batch.groups;
            let inputs = batch.inputs(program, &groups);
            let mut slices = Batch::slices(program, &groups, &mut outputs);
            (found.run)(vectors, Call { groups: batch.groups, inputs: &inputs, outputs: &mut slices });
            for (output, want) in outputs.iter().zip(&want) {
                assert_close(&format!("{name} of {element} on {}", vectors.name()), output, want);
            }
        }
    }
}

/// The sources compiled ahead are those of today's programs. `SOUPLE_BLESS=1` writes them.
#[test]
fn printed_sources_are_those_of_the_programs() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/ahead/generated");
    let compare = |file: String, text: String| {
        let path = format!("{folder}/{file}.rs");
        if std::env::var_os("SOUPLE_BLESS").is_some() {
            std::fs::write(&path, text).unwrap();
            return;
        }
        let known = std::fs::read_to_string(&path).unwrap_or_default();
        let line = known.lines().zip(text.lines()).position(|(k, t)| k != t);
        assert!(
            known == text,
            "{path} differs from the program (line {:?}); run SOUPLE_BLESS=1 cargo test -p souple-bench",
            line.map(|l| l + 1)
        );
    };
    let mut modules = String::new();
    let mut entries = String::new();
    for [element, law, name] in PRINTED {
        let derived = association(souple_elements::by_id(element).unwrap(), souple_laws::by_id(law).unwrap());
        let module = format!("{element}_{law}_{name}");
        compare(module.clone(), rust(element, law, derived.staged.program(name).unwrap()).unwrap());
        modules += &format!("mod {module};\n");
        entries +=
            &format!("    Ahead {{ element: {element:?}, law: {law:?}, program: {name:?}, run: {module}::run }},\n");
    }
    compare(
        "mod".into(),
        format!(
            "//! Printed programs. Printed by a test, never edited (see the module above).\n\n{modules}\n\
             use super::Ahead;\n\n/// Every printed program.\npub(super) const AHEAD: &[Ahead] = &[\n{entries}];\n"
        ),
    );
}
