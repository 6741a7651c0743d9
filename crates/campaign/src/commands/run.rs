//! `souple campaign run`: what is not done yet of a group.

use super::elsewhere::{Elsewhere, Executor, hand_over};
use super::why;
use crate::output::{note, say};
use souple_campaign::campaign::{Request, prepare, read, this_machine};
use souple_campaign::database::{Database, GroupRow, Location, group};
use souple_campaign::group::Group;
use souple_campaign::owner::Owner;
use souple_campaign::queue::{Place, Progress, work};
use souple_campaign::verdict::differences;
use souple_campaign::worker::remove_leftovers;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  souple campaign run DIR --jobs 4\n  \
    souple campaign run DIR --db postgres://me@server/campaigns")]
pub(crate) struct Arguments {
    /// Folder with campaign.toml, or with params.csv, barres.csv and Barre/
    folder: PathBuf,
    /// The database: a file, or postgres://USER@HOST/DATABASE
    #[arg(long, value_name = "FILE|URL", default_value = "campaign.db")]
    db: String,
    /// Folder of the results of simulations; without it, beside the database's file or named after the server's database
    #[arg(long, value_name = "DIR")]
    results: Option<PathBuf>,
    /// Simulations at the same time; 0 takes as many as the machine has threads, or as the scheduler gives
    #[arg(long, default_value_t = 0)]
    jobs: usize,
    /// Who runs the simulations
    #[arg(long, value_enum, default_value = "local")]
    executor: Executor,
    /// Folder that all machines see, for tasks of a scheduler; without it, named like the results
    #[arg(long, value_name = "DIR")]
    spool: Option<PathBuf>,
    /// Threads of each simulation; 0 shares this machine's among those that run at the same time
    #[arg(long, default_value_t = 0)]
    threads: usize,
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
    /// Do not draw a picture of the end of each simulation, as is done where souple-view lies beside souple
    #[arg(long)]
    no_pictures: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let mut described = read(&arguments.folder).map_err(|problems| problems.to_string())?;
    if let Some(device) = &arguments.device {
        described.devices = vec![device.clone()];
        described.bars.iter_mut().for_each(|bar| bar.device = None);
    }
    let machine = this_machine();
    let places = if arguments.jobs == 0 { machine.cores } else { arguments.jobs };
    let program = souple(arguments.souple.as_deref())?;
    let location = Location::parse(&arguments.db);
    let database = Database::connect(&location).map_err(|e| e.to_string())?;
    let results = arguments.results.clone().unwrap_or_else(|| location.results());
    let again: &[&str] = if arguments.retry { &["failed", "invalid"] } else { &[] };
    let request = Request {
        group: &described,
        folder: &arguments.folder,
        machine: &machine,
        program: &program,
        results: &results,
        again,
    };
    let mut prepared = prepare(&request, &database)?;
    prepared.workshop.threads = match (arguments.threads, arguments.executor) {
        (0, Executor::Local) => (machine.cores / places).max(1),
        (0, _) => 1,
        (threads, _) => threads,
    };
    let view = program.with_file_name(format!("souple-view{}", std::env::consts::EXE_SUFFIX));
    prepared.workshop.view = Some(view).filter(|view| !arguments.no_pictures && view.is_file());
    note(&format!(
        "{}: {} simulations, {} to do, {places} at a time",
        described.name,
        prepared.members,
        prepared.jobs.len()
    ));
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
        .map_err(|e| format!("cannot listen for Ctrl-C: {e}"))?;
    if arguments.executor != Executor::Local && !prepared.jobs.is_empty() {
        let spool = arguments.spool.clone().unwrap_or_else(|| results.with_extension("spool"));
        let elsewhere = Elsewhere {
            name: &described.name,
            spool: &spool,
            workshop: &prepared.workshop,
            database: &database,
            db: &arguments.db,
            at_most: Some(arguments.jobs).filter(|&jobs| jobs > 0),
        };
        let finished = hand_over(&prepared.jobs, arguments.executor, &elsewhere, &stop)?;
        closing(&database, prepared.group)?;
        return if finished {
            verdict(arguments, &described, prepared.group, &database)
        } else {
            Ok(ExitCode::from(130))
        };
    }
    let place = Place {
        workshop: &prepared.workshop,
        places,
        database: &database,
        machine: &machine,
        owner: &Owner::this(),
        stop: &stop,
    };
    let finished = work(prepared.jobs, &place, &mut tell).map_err(|e| e.to_string())?;
    remove_leftovers(&prepared.workshop.results);
    closing(&database, prepared.group)?;
    if finished {
        return verdict(arguments, &described, prepared.group, &database);
    }
    note("interrupted; the same command goes on");
    Ok(ExitCode::from(130))
}

/// What `--check` says of a group that is done.
fn verdict(arguments: &Arguments, described: &Group, id: i64, database: &Database) -> Result<ExitCode, String> {
    if !arguments.check {
        return Ok(ExitCode::SUCCESS);
    }
    let wrong = differences(described, id, database).map_err(|e| e.to_string())?;
    wrong.iter().for_each(|line| note(&format!("not as described: {line}")));
    Ok(if wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Says how far the group is.
fn closing(database: &Database, id: i64) -> Result<(), String> {
    match group(database, id).map_err(|e| e.to_string())? {
        Some(GroupRow { members, done, succeeded, .. }) => {
            say(&format!("{done} of {members} done: {succeeded} came to their end, {} did not", done - succeeded))
        }
        None => Ok(()),
    }
}

fn tell(progress: &Progress) {
    let (number, status, reason) = &progress.last;
    let left = progress.left.as_secs();
    note(&format!(
        "{}/{} simulation {number} {status}{} (left: {}:{:02}:{:02})",
        progress.done,
        progress.all,
        why(reason),
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
