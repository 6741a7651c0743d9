//! The stages of `cargo xtask test`, in order: what is cheap and finds most comes first.

use crate::checks::{arrows, documents, format, lint, names, newcomer, reference_data, scenes, tests, text, words};
use crate::workspace::Workspace;

/// One stage.
pub(crate) struct Stage {
    /// What `--only` calls it.
    pub(crate) name: &'static str,
    /// What it promises, in a line.
    pub(crate) about: &'static str,
    /// Does it.
    pub(crate) run: fn(&Workspace) -> Outcome,
}

/// How a stage ended.
pub(crate) enum Outcome {
    /// What it promises holds.
    Passed {
        /// What was looked at, in a line.
        note: String,
        /// Parts that could not be looked at, each with its reason.
        skipped: Vec<String>,
    },
    /// It could not run here.
    Skipped {
        /// Why, and what would let it run.
        why: String,
    },
    /// What it promises does not hold.
    Failed {
        /// Where, what was expected and what to do, one line each.
        findings: Vec<String>,
    },
}

impl Outcome {
    /// Passed without findings, failed with them.
    pub(crate) fn of(findings: Vec<String>, note: impl FnOnce() -> String) -> Outcome {
        if findings.is_empty() {
            Outcome::Passed { note: note(), skipped: Vec::new() }
        } else {
            Outcome::Failed { findings }
        }
    }

    /// Failed with one finding.
    pub(crate) fn failed(finding: impl Into<String>) -> Outcome {
        Outcome::Failed { findings: vec![finding.into()] }
    }
}

/// All stages.
pub(crate) static ALL: &[Stage] = &[
    Stage { name: "format", about: "rustfmt would change nothing, scanned folders included", run: format::run },
    Stage { name: "words", about: "symbols, program and kernels know no finite-element word", run: words::run },
    Stage { name: "names", about: "laws and elements type no derivative", run: names::run },
    Stage {
        name: "arrows",
        about: "crates depend on each other, and on heavy crates, only as the table says",
        run: arrows::run,
    },
    Stage { name: "text", about: "file sizes, forbidden texts, unsafe only where it is expected", run: text::run },
    Stage {
        name: "documents",
        about: "README's commands exist, links in Markdown lead somewhere",
        run: documents::run,
    },
    Stage {
        name: "data",
        about: "every law and element here has its reference numbers and counted operations",
        run: reference_data::run,
    },
    Stage { name: "clippy", about: "no compiler or clippy warning anywhere", run: lint::run },
    Stage { name: "tests", about: "unit, integration and documentation tests", run: tests::run },
    Stage {
        name: "newcomer",
        about: "a law and an element dropped into a copy are found and tested without any other edit",
        run: newcomer::run,
    },
    Stage { name: "scenes", about: "every scene with expected values gives them", run: scenes::run },
];
