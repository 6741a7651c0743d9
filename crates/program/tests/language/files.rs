//! File tests: every `filetests/**/*.prog` says in its header what is promised of the program below it.
//!
//! ```text
//! # One sentence on what is promised.
//! # check: verify                      the program is valid
//! # check: run a=1,2 b=3 -> o=3.0      outputs for these inputs, [point][place]; the program is valid, too
//! # error: …                           it is refused, by the parser or the verifier, with this message
//! ```
//!
//! A program that can be read is in the printer's own form. `SOUPLE_BLESS=1 cargo test -p souple-program` rewrites
//! outputs, messages and form by what is found; read the difference before you keep it.

#![allow(
    clippy::disallowed_methods,
    reason = "file tests are found in a folder, and rewritten when a person asks for it by SOUPLE_BLESS=1"
)]

use souple_kernels::oracle;
use souple_program::{Program, parse, print, verify};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What a file is expected to look like, given what the library does with it.
fn expected(text: &str) -> String {
    let header: Vec<&str> = text.lines().take_while(|l| l.starts_with('#')).collect();
    let body: String = text.lines().skip(header.len()).map(|l| format!("{l}\n")).collect();
    let parsed = parse(&body);
    let checked: Result<&Program, String> = match &parsed {
        Ok(p) => verify(p).map(|()| p).map_err(|e| e.to_string()),
        Err(e) => Err(e.to_string()),
    };
    let mut out = String::new();
    for line in header {
        let line = match (line.strip_prefix("# check: "), line.strip_prefix("# error: "), &checked) {
            (Some(_), _, Err(e)) | (None, Some(_), Err(e)) => format!("# error: {e}"),
            (None, Some(_), Ok(_)) | (Some("verify"), _, Ok(_)) => "# check: verify".into(),
            (Some(check), _, Ok(p)) => format!("# check: {}", run(p, check)),
            _ => line.to_string(),
        };
        writeln!(out, "{line}").unwrap();
    }
    out + &parsed.map_or(body, |p| print(&p))
}

/// The line `run inputs -> outputs` with the outputs that the oracle gives.
fn run(program: &Program, check: &str) -> String {
    let given =
        check.strip_prefix("run").unwrap_or_else(|| panic!("`{check}` is no check: expected `verify` or `run`"));
    let given = given.split("->").next().unwrap().trim();
    let mut inputs: Vec<Vec<f64>> = program.inputs.iter().map(|_| Vec::new()).collect();
    for pair in given.split_whitespace() {
        let (name, values) = pair.split_once('=').unwrap_or_else(|| panic!("`{pair}`: expected `input=1,2`"));
        let buffer = program.input(name).unwrap_or_else(|| panic!("there is no input `{name}`"));
        inputs[buffer] =
            values.split(',').map(|v| v.parse().unwrap_or_else(|_| panic!("`{v}` is no number"))).collect();
    }
    for (buffer, values) in program.inputs.iter().zip(&inputs) {
        assert_eq!(values.len(), buffer.total(program.points), "values of the input `{}`", buffer.name);
    }
    let outputs = oracle::run(program, &inputs);
    let mut line = format!("run {given} ->").replace("run  ->", "run ->");
    for (buffer, values) in program.outputs.iter().zip(outputs) {
        let values: Vec<String> = values.iter().map(|v| format!("{:?}", v.value)).collect();
        write!(line, " {}={}", buffer.name, values.join(",")).unwrap();
    }
    line
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    paths.sort();
    let nested = paths.into_iter().flat_map(|p| if p.is_dir() { files(&p) } else { vec![p] });
    nested.filter(|p| p.extension().is_some_and(|e| e == "prog")).collect()
}

/// Every file test gives what its header says.
#[test]
fn file_tests_give_what_they_say() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("filetests");
    let paths = files(&folder);
    assert!(paths.len() >= 20, "{} files in {}", paths.len(), folder.display());
    let mut failures = String::new();
    for path in paths {
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.strip_prefix(&folder).unwrap().display();
        let header = text.lines().take_while(|l| l.starts_with('#'));
        assert!(
            header.clone().any(|l| l.starts_with("# check: ") || l.starts_with("# error: ")),
            "{name}: the header has no line `# check: …` or `# error: …`"
        );
        let found = expected(&text);
        if found == text {
            continue;
        }
        if std::env::var_os("SOUPLE_BLESS").is_some() {
            std::fs::write(&path, found).unwrap();
            continue;
        }
        for (at, (old, new)) in text.lines().zip(found.lines()).enumerate().filter(|(_, (a, b))| a != b) {
            writeln!(failures, "{name}:{}\n- {old}\n+ {new}", at + 1).unwrap();
        }
        if text.lines().count() != found.lines().count() {
            writeln!(failures, "{name}: {} lines, found {}", text.lines().count(), found.lines().count()).unwrap();
        }
    }
    assert!(
        failures.is_empty(),
        "{failures}If this is what you want, run\n  SOUPLE_BLESS=1 cargo test -p souple-program\nand read the difference."
    );
}
