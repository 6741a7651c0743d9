//! A law and an element are one file each: two files are dropped into a copy of the repository, and nothing else is
//! touched.
//!
//! In the first copy they are as they should be: `souple list` shows them, and the tests that run over the registries
//! pass. That alone would also happen if no test ever looked at them; so in the second copy each has one mistake, and
//! the same tests must fail, naming the newcomer.
//!
//! The files are those of the two how-to pages, which show them in full. Each copy has its own build folder, which is kept
//! for the next run. Why not one for both? Cargo knows a package by its place in the workspace, so it would take what a
//! build script found in one copy for what is in the other.

use crate::checks::format::NEWCOMERS;
use crate::scratch;
use crate::stages::Outcome;
use crate::workspace::{Workspace, cargo};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// A file to drop.
struct Newcomer {
    /// Its name.
    file: &'static str,
    /// Where it goes.
    folder: &'static str,
    /// The page that shows how to write it.
    page: &'static str,
    /// What `souple list` calls its kind.
    kind: &'static str,
    /// What it is called there.
    id: &'static str,
    /// What it says rightly, once, and what it says in the copy with mistakes.
    mistake: [&'static str; 2],
    /// Tests that must see the mistake, each with words of its complaint.
    noticed: &'static [(Suite, &'static str, &'static str)],
}

/// Where a test is.
#[derive(Clone, Copy, PartialEq)]
enum Suite {
    /// `souple-elements` and `souple-laws`.
    Registries,
    /// `souple-operators`.
    Operators,
}

const ALL: &[Newcomer] = &[
    Newcomer {
        file: "prism18.rs",
        folder: "crates/elements/src/elements/",
        page: "docs/add-an-element.md",
        kind: "elements",
        id: "prism18",
        // 3 λᵢ λⱼ is ¾ at its own node, and the functions no longer sum to one.
        mistake: ["g.int(4)", "g.int(3)"],
        noticed: &[
            (Suite::Registries, "interpolation::shape_functions_belong_to_their_nodes", "prism18: N_"),
            (Suite::Registries, "interpolation::shape_functions_sum_to_one", "prism18 at "),
            (Suite::Operators, "invariance::internal_forces_sum_to_zero", "prism18 "),
        ],
    },
    Newcomer {
        file: "blatz_ko.rs",
        folder: "crates/laws/src/laws/",
        page: "docs/add-a-law.md",
        kind: "laws",
        id: "blatz-ko",
        // The pressure of 3 J is not balanced at rest.
        mistake: ["(Number::Rational(2, 1), J)", "(Number::Rational(3, 1), J)"],
        noticed: &[
            (Suite::Registries, "registry::rest_is_free_of_energy_and_stress", "blatz-ko ["),
            (Suite::Operators, "invariance::translations_give_no_force", "/ blatz-ko /"),
        ],
    },
];

/// Settings with which the copies are built sooner: nobody debugs them, and the crates of others do little of the work.
const QUICK: [&str; 4] = ["--config", "profile.dev.debug=false", "--config", "profile.dev.package.\"*\".opt-level=0"];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let attempt = || -> Result<Vec<String>, String> {
        let texts = ALL
            .iter()
            .map(|newcomer| workspace.read(&format!("{NEWCOMERS}{}", newcomer.file)))
            .collect::<Result<Vec<String>, String>>()?;
        let mut findings = Vec::new();
        for (newcomer, text) in ALL.iter().zip(&texts) {
            if !workspace.read(newcomer.page)?.contains(&format!("```rust\n{text}```")) {
                findings.push(format!("{}: does not show {NEWCOMERS}{} word for word", newcomer.page, newcomer.file));
            }
        }
        findings.extend(right(workspace, &texts)?);
        findings.extend(wrong(workspace, &texts)?);
        Ok(findings)
    };
    match attempt() {
        Ok(findings) => {
            let ids: Vec<&str> = ALL.iter().map(|n| n.id).collect();
            Outcome::of(findings, || format!("{}: listed, tested, and caught when wrong", ids.join(", ")))
        }
        Err(complaint) => Outcome::failed(complaint),
    }
}

/// With the newcomers as they are, they are listed and every test passes.
fn right(workspace: &Workspace, texts: &[String]) -> Result<Vec<String>, String> {
    let added: Vec<_> =
        ALL.iter().zip(texts).map(|(n, text)| (format!("{}{}", n.folder, n.file), text.clone())).collect();
    let copy = scratch::copy(workspace, "right", &added)?;
    let mut findings = Vec::new();
    for newcomer in ALL {
        // Without what takes minutes to build and lists neither elements nor laws.
        let build = ["run", "--quiet", "--package", "souple-cli", "--no-default-features"];
        let arguments = [&build[..], &["--", "list", newcomer.kind, "--json"]].concat();
        let output = in_copy(workspace, &copy, &arguments)?;
        if !output.status.success() {
            findings.push(format!("`cargo {}` failed in {}", arguments.join(" "), copy.display()));
            findings.extend(complaint(&output));
        } else if !ids(&output.stdout).iter().any(|id| id == newcomer.id) {
            findings.push(format!("`souple list {}` does not show `{}`", newcomer.kind, newcomer.id));
        }
    }
    for suite in [Suite::Registries, Suite::Operators] {
        let output = in_copy(workspace, &copy, &tests_of(suite))?;
        if !output.status.success() {
            findings.push(format!("`cargo {}` failed in {}", tests_of(suite).join(" "), copy.display()));
            findings.extend(complaint(&output));
        }
    }
    Ok(findings)
}

/// With a mistake in each newcomer, the tests that should see it do.
fn wrong(workspace: &Workspace, texts: &[String]) -> Result<Vec<String>, String> {
    let mut added = Vec::new();
    for (newcomer, text) in ALL.iter().zip(texts) {
        let [from, to] = newcomer.mistake;
        if text.matches(from).count() != 1 {
            return Err(format!("{NEWCOMERS}{}: `{from}`, where the mistake goes, is not there once", newcomer.file));
        }
        added.push((format!("{}{}", newcomer.folder, newcomer.file), text.replace(from, to)));
    }
    let copy = scratch::copy(workspace, "wrong", &added)?;
    let mut findings = Vec::new();
    for suite in [Suite::Registries, Suite::Operators] {
        let wanted: Vec<_> = ALL.iter().flat_map(|n| n.noticed).filter(|(of, ..)| *of == suite).collect();
        let mut arguments = tests_of(suite);
        arguments.push("--");
        arguments.extend(wanted.iter().map(|(_, test, _)| *test));
        let output = in_copy(workspace, &copy, &arguments)?;
        let said = String::from_utf8_lossy(&output.stdout);
        for (_, test, words) in wanted {
            match failure(&said, test) {
                Some(text) if text.contains(words) => {}
                Some(text) => findings.push(format!("`{test}` failed, but not with `{words}`: {}", text.trim())),
                None => {
                    findings.push(format!("`{test}` passes in {}, where `{words}…` is wrong", copy.display()));
                    findings.extend(complaint(&output));
                }
            }
        }
    }
    Ok(findings)
}

/// Arguments of cargo that run a suite.
fn tests_of(suite: Suite) -> Vec<&'static str> {
    match suite {
        Suite::Registries => {
            vec!["test", "--package", "souple-elements", "--package", "souple-laws", "--tests", "--no-fail-fast"]
        }
        Suite::Operators => vec!["test", "--package", "souple-operators", "--test", "contracts", "--no-fail-fast"],
    }
}

fn in_copy(workspace: &Workspace, copy: &Path, arguments: &[&str]) -> Result<Output, String> {
    let name = copy.file_name().unwrap_or_default().to_string_lossy();
    println!("   {name}: cargo {}", arguments.join(" "));
    Command::new(cargo())
        .current_dir(copy)
        .args(QUICK)
        .args(arguments)
        // Not the repository's own: `souple` with newcomers must not take the place of the one that people run.
        .env("CARGO_TARGET_DIR", workspace.target.join("xtask").join("newcomer").join(format!("{name}-build")))
        .env("RUST_BACKTRACE", "0")
        .output()
        .map_err(|e| format!("cannot start cargo: {e}"))
}

/// The ids in a list printed as JSON.
fn ids(stdout: &[u8]) -> Vec<String> {
    let list: Value = serde_json::from_slice(stdout).unwrap_or_default();
    let entries = list.as_array().into_iter().flatten();
    entries.filter_map(|entry| entry["id"].as_str().map(str::to_owned)).collect()
}

/// What a failed test said.
fn failure<'a>(said: &'a str, test: &str) -> Option<&'a str> {
    let after = said.split_once(&format!("---- {test} stdout ----"))?.1;
    let end = ["\n---- ", "\nfailures:"].iter().filter_map(|mark| after.find(mark)).min();
    Some(&after[..end.unwrap_or(after.len())])
}

/// The end of what a command said, for a person to read.
fn complaint(output: &Output) -> Vec<String> {
    const LINES: usize = 40;
    let both = [&output.stderr, &output.stdout].map(|o| String::from_utf8_lossy(o).into_owned());
    let lines: Vec<&str> = both.iter().flat_map(|text| text.lines()).filter(|l| !l.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(LINES)..].iter().map(|line| format!("    {line}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What one test said is told from what others said, and from silence.
    #[test]
    fn failures_are_read() {
        let said =
            "\nfailures:\n\n---- a::b stdout ----\nno\n\n---- a::c stdout ----\nprism18: N_1\n\nfailures:\n    a::b\n";
        assert_eq!(failure(said, "a::b").map(str::trim), Some("no"));
        assert_eq!(failure(said, "a::c").map(str::trim), Some("prism18: N_1"));
        assert_eq!(failure(said, "a"), None);
    }

    /// Ids are read from a list; anything else has none.
    #[test]
    fn ids_are_read() {
        assert_eq!(ids(br#"[{"id": "stvk"}, {"id": "hooke"}, {"name": 1}]"#), ["stvk", "hooke"]);
        assert_eq!(ids(b"not JSON"), Vec::<String>::new());
    }
}
