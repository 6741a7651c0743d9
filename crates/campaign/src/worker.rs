//! One simulation as a process of its own: `souple run SCENE --set … --json --out FOLDER`.
//!
//! The process holds a pipe from us as its standard input and stops when that closes: when we ask it to, or when we are
//! gone, however suddenly. Its folder is named after us until it is done, so that two of us never share one.

use crate::database::Outcome;
use crate::identity::sha256;
use serde_json::Value as Json;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Instant;

/// What a process is to do.
#[derive(Clone, Debug)]
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
}

/// Where and with what processes run.
#[derive(Clone, Debug)]
pub struct Workshop {
    /// The `souple` program.
    pub program: PathBuf,
    /// SHA-256 of that program.
    pub program_hash: String,
    /// The scene's file.
    pub scene: PathBuf,
    /// Folder of the results of all simulations.
    pub results: PathBuf,
    /// Threads of each process.
    pub threads: usize,
    /// Whether the scene expects something.
    pub check: bool,
}

/// A process at work.
#[derive(Debug)]
pub struct Worker {
    job: Job,
    child: Child,
    folder: PathBuf,
    started: Instant,
}

/// Starts a process.
///
/// # Errors
///
/// When its folder cannot be made or the program cannot be started.
pub fn start(workshop: &Workshop, job: Job) -> io::Result<Worker> {
    let folder = workshop.results.join(format!("{}.{}", job.hash, std::process::id()));
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
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
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(File::create(folder.join("messages.txt"))?);
    let child = command.spawn()?;
    Ok(Worker { job, child, folder, started: Instant::now() })
}

impl Worker {
    /// Asks the process to stop.
    pub fn ask_to_stop(&mut self) {
        drop(self.child.stdin.take());
    }

    /// Ends the process, removes what it left, and does not record it.
    pub fn abandon(mut self) {
        // It may have ended by itself just now.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = fs::remove_dir_all(&self.folder);
    }

    /// Whether the process has ended.
    ///
    /// # Errors
    ///
    /// When the system does not tell.
    pub fn ended(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()
    }

    /// What a process that has ended leaves; none when it was interrupted.
    ///
    /// # Errors
    ///
    /// When its folder cannot be given its final name.
    pub fn outcome(self, status: ExitStatus, workshop: &Workshop) -> io::Result<Option<Outcome>> {
        if status.code() == Some(130) {
            fs::remove_dir_all(&self.folder)?;
            return Ok(None);
        }
        let wall_s = self.started.elapsed().as_secs_f64();
        let messages = fs::read_to_string(self.folder.join("messages.txt")).unwrap_or_default();
        let summary = fs::read_to_string(self.folder.join("summary.json")).ok();
        let summary: Json = summary.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or(Json::Null);
        let said = || messages.rsplit_once("error: ").map_or(messages.as_str(), |(_, last)| last).trim().to_owned();
        let (name, reason) = match (status.code(), summary["status"].as_str()) {
            // 1: expectations that are not met are errors in the table, not failures.
            (Some(0 | 1), Some("at_rest" | "at rest")) => ("at rest", String::new()),
            (Some(0 | 1), Some(_)) => ("finished", String::new()),
            (Some(2), _) => ("invalid", said()),
            (Some(3), _) => ("failed", said()),
            _ => ("crashed", format!("the process ended with {status}; {}", said())),
        };
        let folder = workshop.results.join(&self.job.hash);
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::rename(&self.folder, &folder)?;
        Ok(Some(Outcome {
            hash: self.job.hash,
            status: name.to_owned(),
            reason,
            program: workshop.program_hash.clone(),
            device: self.job.device,
            threads: workshop.threads,
            wall_s,
            summary,
            materials: self.job.materials,
            meshes: meshes(&folder, &workshop.results)?,
        }))
    }
}

/// The last picture of every body: files are `BODY_NUMBER.vtu`.
fn meshes(folder: &Path, results: &Path) -> io::Result<Vec<(String, String, String)>> {
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
    last.into_iter()
        .map(|(body, name)| {
            let hash = sha256(&fs::read(folder.join(&name))?);
            let below = results.parent().and_then(|base| folder.strip_prefix(base).ok()).unwrap_or(folder);
            Ok((body, below.join(name).display().to_string(), hash))
        })
        .collect()
}
