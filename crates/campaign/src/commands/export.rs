//! `souple campaign export`: a group as a file that other programs read.

use super::{open, whole_group};
use crate::output::{csv, say};
use souple_campaign::export::{columns, parquet, table};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example: souple campaign export softness --format parquet -o softness.parquet")]
pub(crate) struct Arguments {
    /// Its name; without it, the last group
    group: Option<String>,
    /// The database
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// What is written
    #[arg(long, value_enum)]
    format: Format,
    /// The file; - is standard output, of CSV only
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Format {
    /// Comma-separated values
    Csv,
    /// Apache Parquet
    Parquet,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let group = whole_group(&open(&arguments.db)?, arguments.group.as_deref())?;
    let columns = columns(&group);
    let bytes = match arguments.format {
        Format::Csv => csv(&table(&columns)).into_bytes(),
        Format::Parquet => parquet(&columns).map_err(|e| format!("cannot make Parquet of {}: {e}", group.name))?,
    };
    if arguments.output == Path::new("-") {
        let text = String::from_utf8(bytes).ok().filter(|_| matches!(arguments.format, Format::Csv));
        let text = text.ok_or("Parquet is not text: name a file with --output")?;
        say(&text)?;
        return Ok(ExitCode::SUCCESS);
    }
    std::fs::write(&arguments.output, bytes)
        .map_err(|e| format!("cannot write {}: {e}", arguments.output.display()))?;
    Ok(ExitCode::SUCCESS)
}
