//! Every test of the workspace: with nextest where it is installed (it runs them in parallel across packages), with
//! cargo alone elsewhere; then the examples in the documentation, which nextest does not run.
//!
//! A test that finds a machine without what it needs (a graphics adapter, a Python) passes and leaves a file with the
//! reason in the folder that the environment variable `SOUPLE_SKIPPED` names; the summary lists these.

use crate::stages::Outcome;
use crate::workspace::{WINDOW, Workspace, cargo};
use std::fs;
use std::process::{Command, Stdio};

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let notes = workspace.target.join("xtask").join("skipped");
    // Notes of an earlier run would be read as this one's.
    let _ = fs::remove_dir_all(&notes);
    if let Err(e) = fs::create_dir_all(&notes) {
        return Outcome::failed(format!("{}: {e}", notes.display()));
    }

    let nextest = Command::new(cargo())
        .args(["nextest", "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|s| s.success());
    let main: &[&str] = if nextest {
        &["nextest", "run", "--workspace", "--features", WINDOW, "--no-fail-fast"]
    } else {
        &["test", "--quiet", "--workspace", "--features", WINDOW, "--all-targets", "--no-fail-fast"]
    };
    let mut findings = Vec::new();
    for arguments in [main, &["test", "--quiet", "--workspace", "--features", WINDOW, "--doc", "--no-fail-fast"]] {
        let command = format!("cargo {}", arguments.join(" "));
        println!("   {command}");
        match Command::new(cargo()).current_dir(&workspace.root).args(arguments).env("SOUPLE_SKIPPED", &notes).status()
        {
            Ok(status) if status.success() => {}
            Ok(_) => findings.push(format!("`{command}` failed (see above)")),
            Err(e) => findings.push(format!("cannot start cargo: {e}")),
        }
    }
    if !findings.is_empty() {
        return Outcome::Failed { findings };
    }

    let mut skipped = Vec::new();
    if let Ok(listing) = fs::read_dir(&notes) {
        for path in listing.flatten().map(|entry| entry.path()) {
            let test = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let reason = fs::read_to_string(&path).unwrap_or_else(|e| e.to_string());
            skipped.push(format!("{test}: {}", reason.trim()));
        }
    }
    skipped.sort();
    let runner = if nextest {
        "with cargo-nextest"
    } else {
        "with cargo test (cargo-nextest is not installed; it would be quicker)"
    };
    Outcome::Passed { note: format!("{runner}, and documentation tests"), skipped }
}
