//! Golden files: text that changes only on purpose.
//!
//! `SOUPLE_BLESS=1 cargo test -p souple-operators` writes what the tests find. Look at the difference before you keep
//! it: a count that rose needs a reason in the commit message.

#![allow(
    clippy::disallowed_methods,
    reason = "golden files are read when a test runs, and written when a person asks for it by SOUPLE_BLESS=1"
)]

use crate::counts::table;
use souple_operators::{Association, derive};
use souple_program::{Costs, parse, print};

/// Compares `found` with the golden file `name`, or writes it.
fn compare(name: &str, found: &str) {
    let path = format!("{}/tests/goldens/{name}", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("SOUPLE_BLESS").is_some() {
        std::fs::write(&path, found).unwrap_or_else(|e| panic!("{path}: {e}"));
        return;
    }
    let golden = std::fs::read_to_string(&path).unwrap_or_default();
    let difference: Vec<String> = golden
        .lines()
        .zip(found.lines())
        .filter(|(a, b)| a != b)
        .take(12)
        .map(|(a, b)| format!("- {a}\n+ {b}"))
        .collect();
    assert!(
        golden == found,
        "tests/goldens/{name} has {} lines, found {}:\n{}\nIf this is what you want, run\n  SOUPLE_BLESS=1 cargo test -p souple-operators\nand commit the file with the reason.",
        golden.lines().count(),
        found.lines().count(),
        difference.join("\n")
    );
}

/// Operations and carried values of every law are those of `goldens/counts/LAW.txt`: a file per law, so that a new law
/// touches no other's, and in it a paragraph per element.
///
/// A law or an element that has just been dropped into its folder has no counts yet: its own are computed, and left out
/// of the comparison. `cargo xtask test --only data` asks for them.
#[test]
fn counts_are_golden() {
    let blessing = std::env::var_os("SOUPLE_BLESS").is_some();
    for law in souple_laws::all() {
        let name = format!("counts/{}.txt", law.id);
        let path = format!("{}/tests/goldens/{name}", env!("CARGO_MANIFEST_DIR"));
        let found = table(law);
        match std::fs::read_to_string(&path) {
            Ok(golden) if !blessing => compare(&name, &known(&golden, &found)),
            Err(e) if !blessing => assert!(e.kind() == std::io::ErrorKind::NotFound, "{path}: {e}"),
            _ => compare(&name, &found),
        }
    }
}

/// The paragraphs of `found` about elements that `golden` speaks of, and its head.
fn known(golden: &str, found: &str) -> String {
    let element = |paragraph: &str| paragraph.split_whitespace().next().map(str::to_owned);
    let elements: Vec<_> = golden.split("\n\n").map(element).collect();
    let kept: Vec<&str> = found.trim_end().split("\n\n").filter(|p| elements.contains(&element(p))).collect();
    kept.join("\n\n") + "\n"
}

/// The text of two programs is that of the golden files, and reads back as the same program.
#[test]
fn program_texts_are_golden() {
    for (element, law, name) in [("tet4", "stvk", "force"), ("hex8", "stvk", "tangent_apply")] {
        let element = souple_elements::by_id(element).unwrap();
        let law = souple_laws::by_id(law).unwrap();
        let association = Association::new(element, law);
        let derived = derive(association, Costs::default());
        let program = derived.staged.program(name).unwrap();
        let text = print(program);
        assert_eq!(&parse(&text).unwrap(), program, "{name} of {}", element.id);
        compare(&format!("{}-{}-{name}.prog", element.id, law.id), &text);
    }
}
