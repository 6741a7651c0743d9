//! One simulation as a process of its own: `souple run SCENE --set … --json --out FOLDER`.
//!
//! The process holds a pipe from us as its standard input and stops when that closes: when we ask it to, or when we are
//! gone, however suddenly. Its folder, `HASH.OWNER`, is named after us until it is done, so that two of us never share
//! one; what those leave who were killed is removed when they are known to be gone.

mod picture;
mod process;

use crate::database::Outcome;
use crate::identity::{Source, sha256};
use crate::owner::Owner;
use crate::traction::{Traction, moduli};
use process::{Process, spawn};
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use std::fs::{self, File};
use std::io;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::Instant;

/// What a process is to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// Number of the first member that asks for it.
    pub number: usize,
    /// Hash of the simulation.
    pub hash: String,
    /// Device.
    pub device: String,
    /// Changes of the scene.
    pub overrides: Vec<String>,
    /// Body, position, law, parameters as JSON.
    pub materials: Vec<(String, usize, String, String)>,
    /// Whether it is a sequence of equilibria.
    pub quasi_static: bool,
    /// The traction test that it is.
    pub traction: Option<Traction>,
    /// Id of what is recorded of it and is to be replaced.
    pub before: Option<i64>,
    /// The files of its meshes, as they were when it was hashed.
    #[serde(default)]
    pub sources: Vec<Source>,
}

/// Where and with what processes run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Workshop {
    /// The `souple` program.
    pub program: PathBuf,
    /// SHA-256 of that program.
    pub program_hash: String,
    /// The scene's file: a copy.
    pub scene: PathBuf,
    /// What people call the scene.
    pub scene_name: String,
    /// Folder of the results of all simulations.
    pub results: PathBuf,
    /// Threads of each process.
    pub threads: usize,
    /// Whether the scene expects something.
    pub check: bool,
    /// The program that draws a picture of each simulation's end; none: no pictures.
    pub view: Option<PathBuf>,
}

/// A process at work.
#[derive(Debug)]
pub struct Worker {
    job: Job,
    /// None: its meshes were changed before it began.
    process: Option<Process>,
    folder: PathBuf,
    started: Instant,
    /// How it ended, after how many seconds.
    ended: Option<(ExitStatus, f64)>,
    /// The file of its meshes that was not what was hashed, before it began or when it ended.
    edited: Option<PathBuf>,
    /// What draws its picture, and since when.
    drawing: Option<(Process, Instant)>,
}

/// What a process leaves.
#[derive(Debug)]
pub struct Left {
    /// What became of the simulation; its files are not in it yet.
    pub outcome: Outcome,
    /// The folder with its files.
    pub folder: PathBuf,
}

/// Starts a process; the calling thread is unparked when it ends.
///
/// A simulation whose meshes are not those that were hashed does not run; it has ended at once, as `changed`.
///
/// # Errors
///
/// When its folder cannot be made or the program cannot be started.
pub fn start(workshop: &Workshop, job: Job, owner: &Owner) -> io::Result<Worker> {
    let folder = workshop.results.join(format!("{}.{owner}", job.hash));
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let edited = changed(&job);
    let new = |job, process, edited| {
        let started = Instant::now();
        Worker { job, process, folder: folder.clone(), started, ended: None, edited, drawing: None }
    };
    if edited.is_some() {
        std::thread::current().unpark();
        return Ok(new(job, None, edited));
    }
    let mut command = Command::new(&workshop.program);
    command.arg("run").arg(&workshop.scene).arg("--json").arg("--phases").arg("--stop-at-eof");
    command.arg("--out").arg(&folder).arg("--device").arg(&job.device);
    command.arg("--threads").arg(workshop.threads.to_string());
    if workshop.check {
        command.arg("--check");
    }
    for change in &job.overrides {
        command.arg("--set").arg(change);
    }
    command.stdin(Stdio::piped()).stderr(File::create(folder.join("messages.txt"))?);
    let process = spawn(&mut command)?;
    Ok(new(job, Some(process), None))
}

/// The file of its meshes that is not what it was when the simulation was hashed.
fn changed(job: &Job) -> Option<PathBuf> {
    job.sources.iter().find(|source| **source != Source::now(&source.path)).map(|source| source.path.clone())
}

impl Worker {
    /// Asks the process to stop.
    pub fn ask_to_stop(&mut self) {
        drop(self.process.as_mut().and_then(Process::take_input));
    }

    /// Ends the process, removes what it left, and does not record it.
    pub fn abandon(mut self) {
        let drawing = self.drawing.take().map(|(process, _)| process);
        for mut process in self.process.take().into_iter().chain(drawing) {
            // Nothing is kept of it, however it ends.
            let _ = process.end();
        }
        let _ = fs::remove_dir_all(&self.folder);
    }

    /// How the process ended, when it and what draws its picture have.
    ///
    /// # Errors
    ///
    /// When the system does not tell.
    pub fn ended(&mut self, workshop: &Workshop) -> io::Result<Option<ExitStatus>> {
        let Some((status, _)) = self.ended else {
            let Some(process) = &mut self.process else { return Ok(Some(ExitStatus::default())) };
            let Some(status) = process.ended()? else { return Ok(None) };
            self.ended = Some((status, self.started.elapsed().as_secs_f64()));
            // Asked again, because the process read them somewhere in between; and now, because what happens to them
            // from here on is not its affair.
            self.edited = changed(&self.job);
            self.drawing = picture::start(&self.folder, workshop.view.as_deref(), status);
            return Ok(if self.drawing.is_some() { None } else { Some(status) });
        };
        if let Some((process, since)) = &mut self.drawing {
            if process.ended()?.is_none() {
                if since.elapsed() < picture::PATIENCE {
                    return Ok(None);
                }
                // A picture that takes this long is none.
                process.end()?;
            }
            self.drawing = None;
        }
        Ok(Some(status))
    }

    /// What a process that has ended leaves; none when it was interrupted.
    ///
    /// # Errors
    ///
    /// When the folder of one whose files are of no use cannot be removed.
    pub fn left(self, status: ExitStatus, workshop: &Workshop) -> io::Result<Option<Left>> {
        if interrupted(status) {
            fs::remove_dir_all(&self.folder)?;
            return Ok(None);
        }
        if self.edited.is_some() {
            // What lies there is of another simulation.
            fs::remove_dir_all(&self.folder)?;
            fs::create_dir(&self.folder)?;
        }
        let messages = fs::read_to_string(self.folder.join("messages.txt")).unwrap_or_default();
        let messages = messages.replace(&workshop.scene.display().to_string(), &workshop.scene_name);
        // Files are named as they lie in the folder of the simulation, which is going to have another name.
        let messages = messages.replace(&format!("{}{MAIN_SEPARATOR}", self.folder.display()), "");
        let summary = summary(&self.folder);
        let said = || messages.rsplit_once("error: ").map_or(messages.as_str(), |(_, last)| last).trim().to_owned();
        let (name, reason) = match (&self.edited, status.code(), summary["status"].as_str()) {
            (Some(path), ..) => ("changed", told_of_change(path)),
            // 1: expectations that are not met are errors in the table, not failures.
            (None, Some(0 | 1), Some("at_rest" | "at rest")) => ("at rest", String::new()),
            (None, Some(0 | 1), Some(_)) => ("finished", String::new()),
            (None, Some(2), ..) => ("invalid", said()),
            (None, Some(3), ..) => ("failed", said()),
            (None, Some(4), ..) => ("unwritten", said()),
            _ => ("crashed", format!("the process ended with {status}; {}", said())),
        };
        // What still moves is no equilibrium, and its forces are not those of its strains alone.
        let balanced = name == "at rest" || name == "finished" && self.job.quasi_static;
        let test = self.job.traction.as_ref().filter(|_| balanced);
        let measured = test.map_or(Vec::new(), |test| moduli(test, &summary));
        let outcome = Outcome {
            hash: self.job.hash,
            status: name.to_owned(),
            reason,
            program: workshop.program_hash.clone(),
            device: self.job.device,
            threads: workshop.threads,
            wall_s: self.ended.map_or(0.0, |(_, wall_s)| wall_s),
            summary,
            materials: self.job.materials,
            measured: measured.into_iter().map(|(what, x)| ("traction".to_owned(), what, x)).collect(),
            meshes: Vec::new(),
            picture: None,
        };
        Ok(Some(Left { outcome, folder: self.folder }))
    }
}

/// Why a simulation is not what was hashed.
fn told_of_change(edited: &Path) -> String {
    let who = edited.display();
    format!("{who} was changed after the simulation was planned; the same command plans it anew with the file as it is")
}

/// Whether Ctrl-C ended a process: it says so itself, unless it had not come to listen yet.
pub(crate) fn interrupted(status: ExitStatus) -> bool {
    #[cfg(unix)]
    let before_it_listened = std::os::unix::process::ExitStatusExt::signal(&status) == Some(2);
    #[cfg(not(unix))]
    let before_it_listened = false;
    status.code() == Some(130) || before_it_listened
}

/// What the simulation in a folder measured; null where it came to no summary.
pub(crate) fn summary(folder: &Path) -> Json {
    let text = fs::read_to_string(folder.join("summary.json")).ok();
    text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or(Json::Null)
}

/// Puts the folder of a simulation among the results, where its hash is its name, and notes its files.
///
/// # Errors
///
/// When the folder cannot be given its name, or its files cannot be read.
pub fn keep(left: Left, results: &Path) -> io::Result<Outcome> {
    let Left { mut outcome, folder: from } = left;
    let folder = results.join(&outcome.hash);
    replace_folder(&from, &folder)?;
    outcome.meshes = meshes(&folder, results)?;
    outcome.picture = Some(folder.join(picture::FILE)).filter(|path| path.is_file()).map(|path| below(&path, results));
    Ok(outcome)
}

/// A path relative to the folder in which the results lie.
fn below(path: &Path, results: &Path) -> String {
    let base = results.parent().and_then(|base| path.strip_prefix(base).ok()).unwrap_or(path);
    base.display().to_string()
}

/// Gives a folder its final name, also while somebody else does the same, and across file systems.
fn replace_folder(from: &Path, to: &Path) -> io::Result<()> {
    let mut last = Ok(());
    for _ in 0..3 {
        match fs::remove_dir_all(to) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => last = Err(e),
            _ => match fs::rename(from, to) {
                Ok(()) => return Ok(()),
                Err(e) if e.kind() == io::ErrorKind::CrossesDevices => {
                    fs::create_dir_all(to)?;
                    for entry in fs::read_dir(from)? {
                        let path = entry?.path();
                        fs::copy(&path, to.join(path.file_name().unwrap_or_default()))?;
                    }
                    return fs::remove_dir_all(from);
                }
                Err(e) => last = Err(e),
            },
        }
    }
    last
}

/// Removes the folders of simulations whose runs are gone without having ended them.
pub fn remove_leftovers(results: &Path) {
    let Ok(entries) = fs::read_dir(results) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let Some((hash, owner)) = name.to_str().and_then(|name| name.split_once('.')) else { continue };
        let ours = hash.len() == 64 && hash.bytes().all(|b| b.is_ascii_hexdigit());
        if ours && owner.parse::<Owner>().is_ok_and(|owner| owner.is_gone()) {
            // Its process may still be writing its last state; then the next run removes it.
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

/// The last state of every body: files are `BODY_NUMBER.vtu`.
fn last_states(folder: &Path) -> io::Result<Vec<(String, String)>> {
    let mut names: Vec<String> =
        fs::read_dir(folder)?.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    let mut last: Vec<(String, String)> = Vec::new();
    for name in names {
        let Some((body, number)) = name.strip_suffix(".vtu").and_then(|stem| stem.rsplit_once('_')) else { continue };
        if number.is_empty() || !number.bytes().all(|b| b.is_ascii_digit()) {
            continue;
        }
        match last.iter_mut().find(|(b, _)| b == body) {
            // Numbers of more digits sort before those of fewer.
            Some((_, kept)) if kept.len() <= name.len() => *kept = name.clone(),
            Some(_) => {}
            None => last.push((body.to_owned(), name.clone())),
        }
    }
    Ok(last)
}

/// Body, path and SHA-256 of its last state.
fn meshes(folder: &Path, results: &Path) -> io::Result<Vec<(String, String, String)>> {
    let last = last_states(folder)?.into_iter();
    last.map(|(body, name)| {
        let path = folder.join(&name);
        Ok((body, below(&path, results), sha256(&fs::read(&path)?)))
    })
    .collect()
}
