//! Formatting: `cargo fmt --check`, and rustfmt on the scanned folders.
//!
//! Why not `cargo fmt` alone? It follows `mod` lines, and the modules of the scanned folders are named only in what the
//! build scripts write, so it would never see them.

use crate::stages::Outcome;
use crate::workspace::{Workspace, cargo};
use std::process::Command;

/// Folders whose files are modules that no `mod` line names.
pub(crate) const SCANNED: &[&str] = &["crates/elements/src/elements/", "crates/laws/src/laws/"];

/// Files that are put into a scanned folder of a copy (see [`newcomer`](super::newcomer)).
pub(crate) const NEWCOMERS: &str = "crates/xtask/newcomers/";

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut all = Command::new(cargo());
    all.current_dir(&workspace.root).args(["fmt", "--all", "--", "--check"]);
    judge(all, "run `cargo fmt --all`", &mut findings);

    let folders = SCANNED.iter().chain([&NEWCOMERS]);
    let files: Vec<&str> = folders.flat_map(|folder| workspace.files_in(folder, "rs")).collect();
    let mut scanned = Command::new("rustfmt");
    scanned.current_dir(&workspace.root).args(["--edition", "2024", "--check"]).args(&files);
    judge(scanned, "run `rustfmt --edition 2024` on the scanned files", &mut findings);
    Outcome::of(findings, || format!("the workspace and {} scanned files", files.len()))
}

fn judge(mut command: Command, advice: &str, findings: &mut Vec<String>) {
    match command.status() {
        Ok(status) if status.success() => {}
        Ok(_) => findings.push(format!("formatting differs (see above): {advice}")),
        Err(e) => {
            findings.push(format!("cannot start {:?}: {e}; `rustup component add rustfmt`", command.get_program()))
        }
    }
}
