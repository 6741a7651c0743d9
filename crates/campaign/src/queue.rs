//! Running what is to do, some processes at a time.
//!
//! One loop: start processes where places are free, look at each of them, record what has ended, each in one
//! transaction. Nothing else decides what is done, so that a run that is killed at any moment repeats only what was not
//! recorded.

use crate::database::{Database, DatabaseError, Machine, record};
use crate::worker::{Job, Worker, Workshop, start};
use std::collections::VecDeque;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two looks at the processes.
const LOOK: Duration = Duration::from_millis(2);
/// Time that processes have to stop before they are ended.
const PATIENCE: Duration = Duration::from_secs(5);

/// How far the queue is.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Simulations recorded.
    pub done: usize,
    /// Simulations in all.
    pub all: usize,
    /// Status and reason of the one that was recorded last.
    pub last: (usize, String, String),
    /// Time that is left, if what remains takes as long as what was done.
    pub left: Duration,
}

/// Why a queue stops.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// The database cannot be written.
    #[error(transparent)]
    Database(#[from] DatabaseError),
    /// A folder cannot be written, or the program cannot be started.
    #[error("{what}: {source}")]
    System {
        /// What was tried.
        what: String,
        /// Why it failed.
        source: io::Error,
    },
}

/// Works until nothing is left, or `stop` is set; whether it came to its end.
///
/// # Errors
///
/// When the database or a folder cannot be written, or the program cannot be started; processes are ended first.
pub fn work(
    jobs: Vec<Job>,
    places: usize,
    workshop: &Workshop,
    database: &mut Database,
    machine: &Machine,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(&Progress),
) -> Result<bool, QueueError> {
    let mut waiting = VecDeque::from(jobs);
    let mut working: Vec<(usize, Worker)> = Vec::new();
    let result = rounds(&mut waiting, &mut working, places, workshop, database, machine, stop, tell);
    for (_, worker) in working {
        worker.abandon();
    }
    result
}

fn rounds(
    waiting: &mut VecDeque<Job>,
    working: &mut Vec<(usize, Worker)>,
    places: usize,
    workshop: &Workshop,
    database: &mut Database,
    machine: &Machine,
    stop: &AtomicBool,
    tell: &mut dyn FnMut(&Progress),
) -> Result<bool, QueueError> {
    let (all, started) = (waiting.len(), Instant::now());
    let mut done = 0;
    let mut asked: Option<Instant> = None;
    let system = |what: String| move |source| QueueError::System { what, source };
    while !(working.is_empty() && (waiting.is_empty() || asked.is_some())) {
        if asked.is_none() && stop.load(Ordering::Relaxed) {
            asked = Some(Instant::now());
            working.iter_mut().for_each(|(_, worker)| worker.ask_to_stop());
        }
        if asked.is_some_and(|at| at.elapsed() > PATIENCE) {
            return Ok(false);
        }
        while asked.is_none() && working.len() < places {
            let Some(job) = waiting.pop_front() else { break };
            let number = job.number;
            let what = format!("cannot start simulation {number} with {}", workshop.program.display());
            working.push((number, start(workshop, job).map_err(system(what))?));
        }
        let mut index = 0;
        let mut ended = 0;
        while index < working.len() {
            let number = working[index].0;
            let what = || format!("cannot see how simulation {number} ended");
            let Some(status) = working[index].1.ended().map_err(system(what()))? else {
                index += 1;
                continue;
            };
            let (_, worker) = working.swap_remove(index);
            ended += 1;
            if let Some(outcome) = worker.outcome(status, workshop).map_err(system(what()))? {
                record(database, &outcome, machine)?;
                done += 1;
                let left = started.elapsed().mul_f64((all - done) as f64 / done as f64);
                tell(&Progress { done, all, last: (number, outcome.status, outcome.reason), left });
            } else {
                // It was interrupted together with us; we learn of it in a moment.
                stop.store(true, Ordering::Relaxed);
            }
        }
        if ended == 0 && !working.is_empty() {
            std::thread::park_timeout(LOOK);
        }
    }
    Ok(asked.is_none() && !stop.load(Ordering::Relaxed))
}
