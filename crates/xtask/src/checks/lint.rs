//! Clippy on everything, warnings denied.

use crate::stages::Outcome;
use crate::workspace::{Workspace, cargo};
use std::process::Command;

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    // Windows are a feature that no test needs; that it compiles is seen here.
    for what in [&["--workspace", "--all-targets"][..], &["--package", "souple-viewer", "--features", "window"]] {
        let mut clippy = Command::new(cargo());
        clippy.current_dir(&workspace.root);
        clippy.args(["clippy", "--quiet"]).args(what).args(["--", "--deny", "warnings"]);
        match clippy.status() {
            Ok(status) if status.success() => {}
            Ok(_) => return Outcome::failed("clippy has something to say (see above)"),
            Err(e) => return Outcome::failed(format!("cannot start cargo: {e}")),
        }
    }
    Outcome::Passed { note: format!("{} packages, and windows", workspace.packages.len()), skipped: Vec::new() }
}
