//! The `souple-campaign` program: what `souple campaign` starts.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | every simulation is done and recorded, however it ended |
//! | 1 | with `--check`: something did not end or measure as the description says |
//! | 2 | bad input, or something cannot be read, written or started |
//! | 130 | interrupted; the same command goes on |

mod commands;
mod output;

use clap::{Parser, Subcommand};
use output::{csv, note, say, text_table};
use souple_campaign::campaign::{prepare, read, results_of, this_machine};
use souple_campaign::database::{Database, GroupRow, Table, groups, latest_group, table};
use souple_campaign::queue::{Progress, work};
use souple_campaign::verdict::differences;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Run groups of simulations and keep their results in a database.
#[derive(Debug, Parser)]
#[command(name = "souple campaign", version, after_help = "Example: souple campaign run DIR && souple campaign show")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run what is not done yet of the group described in a folder
    #[command(visible_alias = "resume", after_help = "Example: souple campaign run DIR --jobs 4")]
    Run(Run),
    /// Write a page with graphs and a table of a group, which opens in a browser without a network
    Report(commands::report::Arguments),
    /// Show such pages in a browser while the database is being filled
    Serve(commands::serve::Arguments),
    /// Write a group as CSV or Parquet
    Export(commands::export::Arguments),
    /// Compare two groups, or one group in two databases
    Compare(commands::compare::Arguments),
    /// List the groups of a database
    #[command(after_help = "Example: souple campaign list --db campaign.db")]
    List {
        /// The database
        #[arg(long, value_name = "FILE", default_value = "campaign.db")]
        db: PathBuf,
    },
    /// Show the simulations of a group
    #[command(after_help = "Example: souple campaign show softness --csv softness.csv")]
    Show {
        /// Its name; without it, the last group
        group: Option<String>,
        /// The database
        #[arg(long, value_name = "FILE", default_value = "campaign.db")]
        db: PathBuf,
        /// Write all columns to this file instead; - is standard output
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
    },
}

#[derive(Debug, clap::Args)]
struct Run {
    /// Folder with campaign.toml, or with params.csv, barres.csv and Barre/
    folder: PathBuf,
    /// The database; results of simulations lie beside it
    #[arg(long, value_name = "FILE", default_value = "campaign.db")]
    db: PathBuf,
    /// Simulations at the same time; 0 takes as many as the machine has threads
    #[arg(long, default_value_t = 0)]
    jobs: usize,
    /// Compute all on this device instead of what the description says
    #[arg(long)]
    device: Option<String>,
    /// Repeat simulations that failed or were invalid
    #[arg(long)]
    retry: bool,
    /// Exit with 1 when a simulation does not end as its case says, or misses an [[expect]]
    #[arg(long)]
    check: bool,
    /// The souple program; without it, the one beside this one, or on the search path
    #[arg(long, value_name = "FILE")]
    souple: Option<PathBuf>,
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run(&arguments),
        Command::Report(arguments) => commands::report::run(&arguments),
        Command::Serve(arguments) => commands::serve::run(&arguments),
        Command::Export(arguments) => commands::export::run(&arguments),
        Command::Compare(arguments) => commands::compare::run(&arguments),
        Command::List { db } => list(&db),
        Command::Show { group, db, csv } => show(&db, group.as_deref(), csv.as_deref()),
    };
    match done {
        Ok(code) => code,
        Err(message) => {
            note(&format!("error: {message}"));
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Run) -> Result<ExitCode, String> {
    let mut group = read(&arguments.folder).map_err(|problems| problems.to_string())?;
    if let Some(device) = &arguments.device {
        group.devices = vec![device.clone()];
        group.bars.iter_mut().for_each(|bar| bar.device = None);
    }
    let machine = this_machine();
    let places = if arguments.jobs == 0 { machine.cores } else { arguments.jobs };
    let program = souple(arguments.souple.as_deref())?;
    let mut database = Database::open(&arguments.db).map_err(|e| e.to_string())?;
    let again: &[&str] = if arguments.retry { &["failed", "invalid"] } else { &[] };
    let results = results_of(&arguments.db);
    let mut prepared = prepare(&group, &arguments.folder, &mut database, &machine, &program, &results, again)?;
    prepared.workshop.threads = (machine.cores / places).max(1);
    note(&format!(
        "{}: {} simulations, {} to do, {places} at a time",
        group.name,
        prepared.members,
        prepared.jobs.len()
    ));
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
        .map_err(|e| format!("cannot listen for Ctrl-C: {e}"))?;
    let finished = work(prepared.jobs, places, &prepared.workshop, &mut database, &machine, &stop, &mut tell)
        .map_err(|e| e.to_string())?;
    let row = latest_group(&database, Some(&group.name)).map_err(|e| e.to_string())?;
    if let Some(GroupRow { members, done, succeeded, .. }) = row {
        say(&format!("{done} of {members} done: {succeeded} came to their end, {} did not", done - succeeded))?;
    }
    if finished {
        let wrong = if arguments.check {
            differences(&group, prepared.group, &database).map_err(|e| e.to_string())?
        } else {
            Vec::new()
        };
        wrong.iter().for_each(|line| note(&format!("not as described: {line}")));
        return Ok(if wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) });
    }
    note("interrupted; the same command goes on");
    Ok(ExitCode::from(130))
}

fn tell(progress: &Progress) {
    let (number, status, reason) = &progress.last;
    let why = reason.lines().next().filter(|line| !line.is_empty()).map_or(String::new(), |line| format!(": {line}"));
    let left = progress.left.as_secs();
    note(&format!(
        "{}/{} simulation {number} {status}{why} (left: {}:{:02}:{:02})",
        progress.done,
        progress.all,
        left / 3600,
        left / 60 % 60,
        left % 60
    ));
}

/// The `souple` program.
fn souple(given: Option<&Path>) -> Result<PathBuf, String> {
    let name = format!("souple{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().map(|here| here.with_file_name(&name));
    let on_path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&on_path).map(|folder| folder.join(&name)).collect();
    let candidates: Vec<PathBuf> = match given {
        Some(path) => vec![path.to_owned()],
        None => beside.into_iter().chain(folders).collect(),
    };
    candidates.into_iter().find(|path| path.is_file()).ok_or_else(|| match given {
        Some(path) => format!("there is no program {}", path.display()),
        None => "souple is neither beside this program nor on the search path; say where with --souple".to_owned(),
    })
}

fn open(db: &Path) -> Result<Database, String> {
    if !db.is_file() {
        return Err(format!("there is no database {}; say which one with --db", db.display()));
    }
    Database::open(db).map_err(|e| e.to_string())
}

fn list(db: &Path) -> Result<ExitCode, String> {
    let heads = ["group", "simulations", "done", "to their end", "described in"].map(String::from).to_vec();
    let rows = groups(&open(db)?).map_err(|e| e.to_string())?;
    let rows = rows
        .into_iter()
        .map(|g| vec![g.name, g.members.to_string(), g.done.to_string(), g.succeeded.to_string(), g.folder])
        .collect();
    say(&text_table(&Table { heads, rows }))?;
    Ok(ExitCode::SUCCESS)
}

fn show(db: &Path, name: Option<&str>, file: Option<&Path>) -> Result<ExitCode, String> {
    let database = open(db)?;
    let group = latest_group(&database, name).map_err(|e| e.to_string())?;
    let group = group.ok_or_else(|| {
        format!("{} has no group {}; see: souple campaign list", db.display(), name.unwrap_or("at all"))
    })?;
    let table = table(&database, group.id).map_err(|e| e.to_string())?;
    match file {
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
