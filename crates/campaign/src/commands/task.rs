//! `souple-campaign task`: one simulation of a spool, for schedulers.

use souple_campaign::scheduler::TASK_VARIABLES;
use souple_campaign::spool::{TaskEnd, task};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign task campaign.spool/0001 7")]
pub(crate) struct Arguments {
    /// A numbered folder of a spool
    folder: PathBuf,
    /// Number of the task; without it, the one that the scheduler says in HQ_TASK_ID or SLURM_ARRAY_TASK_ID
    number: Option<usize>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let told = || TASK_VARIABLES.iter().find_map(|name| std::env::var(name).ok()?.parse().ok());
    let number = arguments
        .number
        .or_else(told)
        .ok_or_else(|| format!("say which task: its number, or one of the variables {}", TASK_VARIABLES.join(", ")))?;
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
        .map_err(|e| format!("cannot listen for signals: {e}"))?;
    match task(&arguments.folder, number, &stop).map_err(|e| e.to_string())? {
        TaskEnd::Done | TaskEnd::DoneBefore => Ok(ExitCode::SUCCESS),
        TaskEnd::Interrupted => Ok(ExitCode::from(130)),
    }
}
