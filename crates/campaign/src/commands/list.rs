//! `souple campaign list`: the groups of a database.

use super::open;
use crate::output::{say, text_table};
use souple_campaign::database::{Table, groups};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign list --db campaign.db")]
pub(crate) struct Arguments {
    /// The database: a file, or postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let heads = ["group", "simulations", "done", "to their end", "described in"].map(String::from).to_vec();
    let rows = groups(&open(&arguments.db)?).map_err(|e| e.to_string())?;
    let rows = rows
        .into_iter()
        .map(|g| vec![g.name, g.members.to_string(), g.done.to_string(), g.succeeded.to_string(), g.folder])
        .collect();
    say(&text_table(&Table { heads, rows }))?;
    Ok(ExitCode::SUCCESS)
}
