//! `souple campaign collect`: what tasks of a scheduler gave, into the database.

use super::open;
use crate::output::{note, say};
use souple_campaign::database::Location;
use souple_campaign::spool::collect;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign collect campaign.spool")]
pub(crate) struct Arguments {
    /// The spool of `souple campaign run --executor`
    spool: PathBuf,
    /// The database: a file, or postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// Folder of the results of simulations; without it, beside the database's file or named after the server's database
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let database = open(&arguments.db)?;
    let results = arguments.results.clone().unwrap_or_else(|| Location::parse(&arguments.db).results());
    let collected = collect(&arguments.spool, &database, &results).map_err(|e| e.to_string())?;
    for (number, status, reason) in &collected.new {
        note(&format!("simulation {number} {status}{}", super::why(reason)));
    }
    say(&format!(
        "{} taken in; {} of {} tasks are in the database",
        collected.new.len(),
        collected.done,
        collected.tasks
    ))?;
    Ok(ExitCode::SUCCESS)
}
