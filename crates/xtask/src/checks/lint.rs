//! Clippy on everything, the window included, warnings denied.

use crate::stages::Outcome;
use crate::workspace::{WINDOW, Workspace, cargo};
use std::process::Command;

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut clippy = Command::new(cargo());
    clippy.current_dir(&workspace.root);
    clippy.args([
        "clippy",
        "--quiet",
        "--workspace",
        "--all-targets",
        "--features",
        WINDOW,
        "--",
        "--deny",
        "warnings",
    ]);
    match clippy.status() {
        Ok(status) if status.success() => {
            Outcome::Passed { note: format!("{} packages", workspace.packages.len()), skipped: Vec::new() }
        }
        Ok(_) => Outcome::failed("clippy has something to say (see above)"),
        Err(e) => Outcome::failed(format!("cannot start cargo: {e}")),
    }
}
