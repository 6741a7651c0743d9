//! Scenes that say what they expect, run as a person would run them, in the release build.
//!
//! `souple run --check` compares the probes with the scene's `[[expect]]` blocks and says so with its exit status; here
//! the scenes are found, run one after the other, and tabled.

use crate::stages::Outcome;
use crate::workspace::{Workspace, cargo};
use serde_json::Value;
use std::process::Command;
use std::time::Instant;

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut scenes = Vec::new();
    let mut without = 0;
    for file in workspace.files_in("scenes/", "toml") {
        match workspace.read(file) {
            Ok(text) if expects(&text) => scenes.push(file),
            Ok(_) => without += 1,
            Err(complaint) => findings.push(complaint),
        }
    }
    if scenes.is_empty() && findings.is_empty() {
        return Outcome::Skipped { why: format!("none of {without} scenes has an [[expect]] block") };
    }

    let mut build = Command::new(cargo());
    build.current_dir(&workspace.root).args(["build", "--quiet", "--release", "--package", "souple-cli"]);
    match build.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return Outcome::failed("the release build of souple-cli failed (see above)"),
        Err(e) => return Outcome::failed(format!("cannot start cargo: {e}")),
    }

    let souple = workspace.target.join("release").join(format!("souple{}", std::env::consts::EXE_SUFFIX));
    let out = workspace.target.join("xtask").join("scenes");
    println!("   {:48} {:>8}  {:>9}  result", "scene", "steps", "time");
    for scene in &scenes {
        let started = Instant::now();
        let name = scene.trim_start_matches("scenes/").trim_end_matches(".toml").replace('/', "-");
        let output = Command::new(&souple)
            .current_dir(&workspace.root)
            .args(["run", scene, "--json", "--quiet", "--check", "--out"])
            .arg(out.join(name))
            .output();
        let output = match output {
            Ok(output) => output,
            Err(e) => return Outcome::failed(format!("cannot start {}: {e}", souple.display())),
        };
        let said = String::from_utf8_lossy(&output.stdout);
        let summary: Option<Value> = said.lines().last().and_then(|line| serde_json::from_str(line).ok());
        let steps = summary.as_ref().and_then(|s| s["steps"].as_u64());
        // A run that says nothing has shown nothing, whatever its exit status.
        let result = match (output.status.code(), &summary) {
            (Some(0), Some(_)) => "as expected".to_owned(),
            (Some(0), None) => "no summary in the last line of its output".to_owned(),
            (Some(code), _) => format!("exit status {code}"),
            (None, _) => "killed".to_owned(),
        };
        let steps_text = steps.map_or("-".into(), |s| s.to_string());
        println!("   {scene:48} {steps_text:>8}  {:>7.1} s  {result}", started.elapsed().as_secs_f64());
        if result != "as expected" {
            let complaint = String::from_utf8_lossy(&output.stderr);
            let complaint: Vec<&str> = complaint.lines().filter(|l| !l.trim().is_empty()).collect();
            findings.push(format!("{scene}: {result}"));
            findings.extend(complaint.iter().map(|line| format!("    {line}")));
        }
    }
    if !findings.is_empty() {
        return Outcome::Failed { findings };
    }
    let skipped = match without {
        0 => Vec::new(),
        n => vec![format!("{n} scenes without an [[expect]] block were not run")],
    };
    Outcome::Passed { note: format!("{} scenes give what they promise", scenes.len()), skipped }
}

/// Whether a scene says what it expects.
fn expects(text: &str) -> bool {
    text.lines().any(|l| l.trim_start().starts_with("[[expect]]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An expectation is found at the start of a line, not in a comment.
    #[test]
    fn expectations_are_found() {
        assert!(expects("title = \"a\"\n [[expect]] # tip\n"));
        assert!(!expects("# [[expect]]\n[expected]\n"));
    }
}
