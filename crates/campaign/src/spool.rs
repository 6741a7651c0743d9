//! Simulations for other machines: a folder of tasks that a scheduler runs, and of what they give.
//!
//! ```text
//! SPOOL/0001/workshop.json, tasks/N.json   what to do: written once, then only read
//!            results/HASH.OWNER/           files of a simulation, of one process alone
//!            done/HASH.json                what it gave; there as a whole or not at all
//!            collected/HASH.json           the same, when it is in the database
//! ```
//!
//! A task may run twice, on two machines at once, or again after it was collected: each process has a folder of its own,
//! the last one to end names it, and what is in the database already is not recorded again.
//! The folder must be one that all machines see under the same name.

use crate::campaign::this_machine;
use crate::database::{Claim, Database, DatabaseError, Machine, Outcome, claim, record};
use crate::owner::Owner;
use crate::worker::{Job, Left, Workshop, keep, start, summary};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Why a spool cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SpoolError {
    /// A file or folder.
    #[error("cannot {what} {path}: {source}")]
    File {
        /// What was tried.
        what: &'static str,
        /// The file or folder.
        path: String,
        /// Why it failed.
        source: io::Error,
    },
    /// A file of the spool that is none.
    #[error("{path}: {source}; a spool is a folder that `souple campaign run --executor` made")]
    Format {
        /// The file.
        path: String,
        /// What is wrong.
        source: serde_json::Error,
    },
    /// Not a spool.
    #[error("{path} holds no simulations: expected a folder that `souple campaign run --executor` made")]
    Empty {
        /// The folder.
        path: String,
    },
    /// The database.
    #[error(transparent)]
    Database(#[from] DatabaseError),
}

/// What one task gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Done {
    outcome: Outcome,
    /// Where it ran.
    machine: Machine,
    /// Folder with its files.
    folder: PathBuf,
    /// Number of the first member that asks for it.
    number: usize,
    /// Id of what it replaces.
    before: Option<i64>,
}

/// How a task ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskEnd {
    /// Its result is in the spool.
    Done,
    /// Another process had done it before.
    DoneBefore,
    /// It was to stop.
    Interrupted,
}

/// How much of a spool is in the database.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collected {
    /// Tasks.
    pub tasks: usize,
    /// Tasks that are in the database now.
    pub done: usize,
    /// Number, status and reason of those that were taken in just now.
    pub new: Vec<(usize, String, String)>,
}

fn failed<'a>(what: &'static str, path: &'a Path) -> impl FnOnce(io::Error) -> SpoolError + use<'a> {
    move |source| SpoolError::File { what, path: path.display().to_string(), source }
}

fn read<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, SpoolError> {
    let text = fs::read(path).map_err(failed("read", path))?;
    serde_json::from_slice(&text).map_err(|source| SpoolError::Format { path: path.display().to_string(), source })
}

/// Writes a file that is there as a whole or not at all.
fn write<T: Serialize>(path: &Path, value: &T) -> Result<(), SpoolError> {
    let part = path.with_extension(format!("{}.part", Owner::this()));
    let bytes =
        serde_json::to_vec(value).map_err(|source| SpoolError::Format { path: path.display().to_string(), source })?;
    fs::write(&part, bytes).and_then(|()| fs::rename(&part, path)).map_err(failed("write", path))
}

/// Puts simulations into a new folder of a spool; the folder. Tasks are numbered from 0.
///
/// # Errors
///
/// When something cannot be written.
pub fn submit(spool: &Path, workshop: &Workshop, jobs: &[Job]) -> Result<PathBuf, SpoolError> {
    fs::create_dir_all(spool).map_err(failed("make", spool))?;
    let spool = fs::canonicalize(spool).map_err(failed("find", spool))?;
    let mut number = 1;
    let folder = loop {
        let folder = spool.join(format!("{number:04}"));
        match fs::create_dir(&folder) {
            Ok(()) => break folder,
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(e) => return Err(failed("make", &folder)(e)),
        }
    };
    for name in ["tasks", "results", "done", "collected"] {
        let path = folder.join(name);
        fs::create_dir(&path).map_err(failed("make", &path))?;
    }
    // Every machine sees the spool, and perhaps nothing else of what lies here.
    let scene = folder.join("scene.toml");
    fs::copy(&workshop.scene, &scene).map_err(failed("write", &scene))?;
    for (index, job) in jobs.iter().enumerate() {
        write(&folder.join(format!("tasks/{index}.json")), job)?;
    }
    let workshop = Workshop { scene, results: folder.join("results"), ..workshop.clone() };
    write(&folder.join("workshop.json"), &workshop)?;
    Ok(folder)
}

/// Does one task.
///
/// # Errors
///
/// When the folder is no spool, or something cannot be written or started.
pub fn task(folder: &Path, index: usize, stop: &AtomicBool) -> Result<TaskEnd, SpoolError> {
    let workshop: Workshop = read(&folder.join("workshop.json"))?;
    let job: Job = read(&folder.join(format!("tasks/{index}.json")))?;
    let name = format!("{}.json", job.hash);
    if folder.join("collected").join(&name).is_file() || folder.join("done").join(&name).is_file() {
        return Ok(TaskEnd::DoneBefore);
    }
    let (number, before) = (job.number, job.before);
    let mut worker = start(&workshop, job, &Owner::this()).map_err(failed("start", &workshop.program))?;
    let mut asked = false;
    let status = loop {
        if let Some(status) = worker.ended(&workshop).map_err(failed("watch", &workshop.program))? {
            break status;
        }
        if !asked && stop.load(Ordering::Relaxed) {
            asked = true;
            worker.ask_to_stop();
        }
        std::thread::park_timeout(Duration::from_millis(50));
    };
    let left = worker.left(status, &workshop).map_err(failed("remove a folder of", &workshop.results))?;
    let Some(Left { outcome, folder: files }) = left else { return Ok(TaskEnd::Interrupted) };
    let done = Done { outcome, machine: this_machine(), folder: files, number, before };
    write(&folder.join("done").join(name), &done)?;
    Ok(TaskEnd::Done)
}

/// Takes what tasks gave into the database and among its results; all submissions of a spool, or one.
///
/// # Errors
///
/// When the folder is no spool, or the database or a folder cannot be written.
pub fn collect(spool: &Path, database: &Database, results: &Path) -> Result<Collected, SpoolError> {
    fs::create_dir_all(results).map_err(failed("make", results))?;
    let results = fs::canonicalize(results).map_err(failed("find", results))?;
    let submissions = if spool.join("workshop.json").is_file() { vec![spool.to_owned()] } else { entries(spool)? };
    let mut collected = Collected::default();
    for folder in submissions.iter().filter(|folder| folder.join("workshop.json").is_file()) {
        collect_one(folder, database, &results, &mut collected)?;
    }
    if collected.tasks == 0 {
        return Err(SpoolError::Empty { path: spool.display().to_string() });
    }
    Ok(collected)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, SpoolError> {
    let list = fs::read_dir(folder).map_err(failed("read", folder))?;
    let mut paths: Vec<PathBuf> = list.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn collect_one(
    folder: &Path,
    database: &Database,
    results: &Path,
    collected: &mut Collected,
) -> Result<(), SpoolError> {
    let owner = Owner::this();
    let is_json = |path: &PathBuf| path.extension().is_some_and(|e| e == "json");
    let tasks = entries(&folder.join("tasks"))?.into_iter().filter(is_json).count();
    for path in entries(&folder.join("done"))?.into_iter().filter(is_json) {
        let Done { outcome, machine, folder: files, number, before } = read(&path)?;
        match claim(database, &outcome.hash, &owner, before)? {
            // Somebody computes it here and now; the next time there will be something to see.
            Claim::Elsewhere => continue,
            Claim::Recorded(_) => {
                // The same is there already.
                let _ = fs::remove_dir_all(&files);
            }
            Claim::Ours => {
                let outcome = Outcome { summary: summary(&files), ..outcome };
                let outcome = keep(Left { outcome, folder: files }, results).map_err(failed("write", results))?;
                if record(database, &outcome, &machine, &owner)? {
                    collected.new.push((number, outcome.status, outcome.reason));
                }
            }
        }
        let kept = folder.join("collected").join(path.file_name().unwrap_or_default());
        fs::rename(&path, &kept).map_err(failed("write", &kept))?;
    }
    collected.tasks += tasks;
    collected.done += entries(&folder.join("collected"))?.into_iter().filter(is_json).count();
    Ok(())
}
