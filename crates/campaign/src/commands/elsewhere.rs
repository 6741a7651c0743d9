//! `souple campaign run --executor`: the simulations as tasks of a scheduler.

use super::why;
use crate::output::{note, say};
use souple_campaign::database::Database;
use souple_campaign::scheduler::{Submission, hyperqueue, slurm};
use souple_campaign::spool::{collect, submit};
use souple_campaign::worker::{Job, Workshop};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time between two looks at what tasks have given.
const LOOK: Duration = Duration::from_millis(200);

/// Who runs the simulations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Executor {
    /// This machine
    Local,
    /// HyperQueue: `hq submit`, and wait for the results
    Hyperqueue,
    /// Slurm: write a script for `sbatch`; `souple campaign collect` takes the results in
    Slurm,
}

/// What goes where.
#[derive(Debug)]
pub(crate) struct Elsewhere<'a> {
    pub(crate) name: &'a str,
    pub(crate) spool: &'a Path,
    pub(crate) workshop: &'a Workshop,
    pub(crate) database: &'a Database,
    /// `--db` as it was given.
    pub(crate) db: &'a str,
    pub(crate) at_most: Option<usize>,
}

/// Hands simulations to a scheduler; whether all were done when it came back.
pub(crate) fn hand_over(
    jobs: &[Job],
    executor: Executor,
    elsewhere: &Elsewhere<'_>,
    stop: &AtomicBool,
) -> Result<bool, String> {
    let program = std::env::current_exe().map_err(|e| format!("cannot find this program: {e}"))?;
    let folder = submit(elsewhere.spool, elsewhere.workshop, jobs).map_err(|e| e.to_string())?;
    let submission = Submission {
        name: elsewhere.name,
        folder: &folder,
        program: &program,
        tasks: jobs.len(),
        threads: elsewhere.workshop.threads,
        at_most: elsewhere.at_most,
    };
    if executor == Executor::Slurm {
        let script = folder.join("submit.sbatch");
        std::fs::write(&script, slurm(&submission)).map_err(|e| format!("cannot write {}: {e}", script.display()))?;
        say(&format!(
            "submit with:           sbatch {}\nwhen tasks are done:   souple campaign collect {} --db {} --results {}",
            script.display(),
            elsewhere.spool.display(),
            elsewhere.db,
            elsewhere.workshop.results.display()
        ))?;
        return Ok(true);
    }
    wait_for_hyperqueue(&hyperqueue(&submission), &folder, elsewhere, stop)
}

/// Submits, and takes in what tasks give until HyperQueue says that all have ended.
fn wait_for_hyperqueue(
    words: &[String],
    folder: &Path,
    elsewhere: &Elsewhere<'_>,
    stop: &AtomicBool,
) -> Result<bool, String> {
    let mut submit =
        Command::new("hq").args(words).stdin(Stdio::null()).stdout(Stdio::null()).spawn().map_err(|e| {
            format!("cannot start hq: {e}; HyperQueue must be on the search path, with a server and workers")
        })?;
    loop {
        // Looked at first, so that what came in between is taken in.
        let ended = submit.try_wait().map_err(|e| format!("cannot see how hq ended: {e}"))?;
        let collected = collect(folder, elsewhere.database, &elsewhere.workshop.results).map_err(|e| e.to_string())?;
        for (number, status, reason) in &collected.new {
            note(&format!("{}/{} simulation {number} {status}{}", collected.done, collected.tasks, why(reason)));
        }
        let missing = collected.tasks - collected.done;
        if let Some(status) = ended {
            return match (missing, status.success() || stop.load(Ordering::Relaxed)) {
                (0, _) => Ok(true),
                (_, true) => Ok(false),
                _ => Err(format!(
                    "hq ended with {status}, and {missing} tasks gave nothing; see: hq job list --all. \
                     The same command submits what is missing"
                )),
            };
        }
        if stop.load(Ordering::Relaxed) {
            // HyperQueue goes on by itself; only the waiting ends.
            let _ = submit.kill();
            let _ = submit.wait();
            let spool = elsewhere.spool.display();
            note(&format!("tasks go on in HyperQueue; souple campaign collect {spool} takes in what they give"));
            return Ok(false);
        }
        std::thread::park_timeout(LOOK);
    }
}
