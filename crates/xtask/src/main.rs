//! `cargo xtask`: what the repository asks of itself.
//!
//! `cargo xtask test` runs every check there is, in stages ([`stages::ALL`]), and ends with a table that also names what
//! was skipped and why. It is the only command that a change has to pass. `cargo xtask bless` rewrites golden files,
//! `cargo xtask pictures` draws the pictures of the documents, `cargo xtask web` builds the window as a page.
//!
//! What it is not: a build system. It calls cargo and reads files; nothing that it does is needed to build or use
//! Souple, but for the page, which takes more than one call of cargo.

mod checks;
mod pictures;
mod rust_source;
mod scratch;
mod stages;
mod web;
mod workspace;

use stages::{Outcome, Stage};
use std::process::{Command, ExitCode};
use std::time::Instant;
use workspace::Workspace;

const HELP: &str = "\
Checks and chores of this repository.

    cargo xtask test                   every stage
    cargo xtask test --only STAGE ...  some stages
    cargo xtask test --list            what the stages are
    cargo xtask bless                  run the tests, rewriting golden files (then read the difference!)
    cargo xtask pictures               draw the pictures of the documents again
    cargo xtask web [--output FOLDER]  build the window as a page for browsers (target/web/page)
";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments.as_slice() {
        ["test", "--list"] => {
            for stage in stages::ALL {
                println!("{:10} {}", stage.name, stage.about);
            }
            ExitCode::SUCCESS
        }
        ["test", rest @ ..] => match chosen(rest) {
            Ok(chosen) => with_workspace(|workspace| test(workspace, &chosen)),
            Err(complaint) => usage(&complaint),
        },
        ["bless"] => with_workspace(bless),
        ["pictures"] => with_workspace(pictures::run),
        ["web", rest @ ..] => with_workspace(|workspace| web::run(workspace, rest)),
        [] | ["help" | "--help" | "-h"] => {
            print!("{HELP}");
            ExitCode::SUCCESS
        }
        other => usage(&format!("unknown command `{}`", other.join(" "))),
    }
}

fn usage(complaint: &str) -> ExitCode {
    eprintln!("{complaint}\n\n{HELP}");
    ExitCode::from(2)
}

fn with_workspace(act: impl FnOnce(&Workspace) -> ExitCode) -> ExitCode {
    match Workspace::load() {
        Ok(workspace) => act(&workspace),
        Err(complaint) => {
            eprintln!("cannot read the workspace: {complaint}");
            ExitCode::FAILURE
        }
    }
}

/// The stages that `--only` names, in their usual order; all of them without it.
fn chosen(arguments: &[&str]) -> Result<Vec<&'static Stage>, String> {
    let mut names = Vec::new();
    let mut rest = arguments.iter();
    while let Some(&flag) = rest.next() {
        if flag != "--only" {
            return Err(format!("unknown argument `{flag}`"));
        }
        let name = *rest.next().ok_or("`--only` needs the name of a stage")?;
        if !stages::ALL.iter().any(|s| s.name == name) {
            let known: Vec<&str> = stages::ALL.iter().map(|s| s.name).collect();
            return Err(format!("there is no stage `{name}`; the stages are {}", known.join(", ")));
        }
        names.push(name);
    }
    Ok(stages::ALL.iter().filter(|s| names.is_empty() || names.contains(&s.name)).collect())
}

/// Runs the stages, all of them even when one fails, and says how each went.
fn test(workspace: &Workspace, chosen: &[&'static Stage]) -> ExitCode {
    let started = Instant::now();
    let mut rows = Vec::new();
    for (i, stage) in chosen.iter().enumerate() {
        println!("\n== {}/{} {}: {}", i + 1, chosen.len(), stage.name, stage.about);
        let at = Instant::now();
        let outcome = (stage.run)(workspace);
        if let Outcome::Failed { findings } = &outcome {
            for finding in findings {
                println!("   {finding}");
            }
        }
        rows.push((stage.name, outcome, at.elapsed().as_secs_f64()));
    }

    println!("\n== summary ({:.0} s)", started.elapsed().as_secs_f64());
    let mut skipped = Vec::new();
    let mut failed = false;
    for (name, outcome, seconds) in &rows {
        let (word, note) = match outcome {
            Outcome::Passed { note, skipped: parts } => {
                skipped.extend(parts.iter().map(|why| format!("{name}: {why}")));
                ("passed", note.clone())
            }
            Outcome::Skipped { why } => {
                skipped.push(format!("{name}: {why}"));
                ("skipped", why.clone())
            }
            Outcome::Failed { findings } => {
                failed = true;
                (
                    "FAILED",
                    if findings.len() == 1 { findings[0].clone() } else { format!("{} findings", findings.len()) },
                )
            }
        };
        println!("   {name:10} {word:8} {seconds:7.1} s  {note}");
    }
    if chosen.len() < stages::ALL.len() {
        let left_out = stages::ALL.iter().filter(|s| !chosen.iter().any(|c| c.name == s.name)).map(|s| s.name);
        skipped.push(format!("not asked for by --only: {}", left_out.collect::<Vec<_>>().join(", ")));
    }
    if skipped.is_empty() {
        println!("\nNothing was skipped.");
    } else {
        println!("\nSkipped:");
        for line in skipped {
            println!("   {line}");
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Runs the tests with `SOUPLE_BLESS=1`: a test that compares with a golden file then writes it.
fn bless(workspace: &Workspace) -> ExitCode {
    let mut cargo = Command::new(workspace::cargo());
    cargo.current_dir(&workspace.root).args(["test", "--workspace", "--no-fail-fast"]).env("SOUPLE_BLESS", "1");
    match cargo.status() {
        Ok(status) if status.success() => {
            println!("Golden files are rewritten where they differed; read the difference before committing it.");
            ExitCode::SUCCESS
        }
        Ok(_) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("cannot start cargo: {e}");
            ExitCode::FAILURE
        }
    }
}
