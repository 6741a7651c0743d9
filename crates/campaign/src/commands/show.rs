//! `souple campaign show`: the simulations of a group.

use super::open;
use crate::output::{csv, say, text_table};
use souple_campaign::database::{Table, latest_group, table};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign show softness --csv softness.csv")]
pub(crate) struct Arguments {
    /// Its name; without it, the last group
    group: Option<String>,
    /// The database: a file, or postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// Write all columns to this file instead; - is standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let database = open(&arguments.db)?;
    let name = arguments.group.as_deref();
    let group = latest_group(&database, name).map_err(|e| e.to_string())?;
    let group = group.ok_or_else(|| {
        format!("{} has no group {}; see: souple campaign list", database.place, name.unwrap_or("at all"))
    })?;
    let table = table(&database, group.id).map_err(|e| e.to_string())?;
    match &arguments.csv {
        None => say(&text_table(&shortened(table)))?,
        Some(path) if path == Path::new("-") => say(&csv(&table))?,
        Some(path) => std::fs::write(path, csv(&table)).map_err(|e| format!("cannot write {}: {e}", path.display()))?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Without the columns in which all rows agree, and with the first line of each reason.
fn shortened(table: Table) -> Table {
    let varies = |c: usize| {
        let always = ["number", "status"].contains(&table.heads[c].as_str());
        always || table.rows.iter().any(|row| row[c] != table.rows[0][c])
    };
    let kept: Vec<usize> = (0..table.heads.len()).filter(|&c| varies(c)).collect();
    let line = |cell: &str| cell.lines().next().unwrap_or("").to_owned();
    let rows = table.rows.iter().map(|row| kept.iter().map(|&c| line(&row[c])).collect()).collect();
    Table { heads: kept.iter().map(|&c| table.heads[c].clone()).collect(), rows }
}
