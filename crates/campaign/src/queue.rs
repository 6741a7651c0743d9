//! Running what is to do, some processes at a time.
//!
//! One loop: look at each process, claim and start simulations where places have become free, and only then record what
//! has ended, each in one transaction: the next ones work meanwhile. Nothing else decides what is done, so that a run that
//! is killed at any moment repeats only what was not recorded, and several runs on one database share the work. What
//! another run works on is asked for again until that has recorded it, given it back, or is gone.

use crate::database::{Claim, Database, DatabaseError, Machine, beat, claim, record, recorded, release};
use crate::owner::Owner;
use crate::worker::{Job, Worker, Workshop, interrupted, keep, start};
use std::collections::VecDeque;
use std::io;
use std::process::ExitStatus;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time after which we look even if nothing woke us.
const LOOK: Duration = Duration::from_millis(50);
/// Time between two looks at what other runs work on.
const LOOK_ELSEWHERE: Duration = Duration::from_millis(250);
/// Time between two signs of life.
const BEAT: Duration = Duration::from_secs(10);
/// Time that processes have to stop before they are ended.
const PATIENCE: Duration = Duration::from_secs(5);

/// Number, status and reason of a simulation.
pub type Told = (usize, String, String);

/// How far the queue is.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Simulations recorded.
    pub done: usize,
    /// Simulations in all.
    pub all: usize,
    /// The one that was recorded last.
    pub last: Told,
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

/// Where a queue works and whom it tells.
#[derive(Debug)]
pub struct Place<'a> {
    /// What processes run with.
    pub workshop: &'a Workshop,
    /// Simulations at the same time.
    pub places: usize,
    /// Where outcomes are recorded.
    pub database: &'a Database,
    /// This machine.
    pub machine: &'a Machine,
    /// This process.
    pub owner: &'a Owner,
    /// Set from outside when it is to stop.
    pub stop: &'a AtomicBool,
}

/// Works until nothing is left, or it is to stop; whether it came to its end.
///
/// # Errors
///
/// When the database or a folder cannot be written, or the program cannot be started; processes are ended first.
pub fn work(jobs: Vec<Job>, place: &Place<'_>, tell: &mut dyn FnMut(&Progress)) -> Result<bool, QueueError> {
    let mut queue =
        Queue { waiting: VecDeque::from(jobs), elsewhere: Vec::new(), working: Vec::new(), done: 0, all: 0 };
    queue.all = queue.waiting.len();
    let result = queue.rounds(place, tell);
    for (_, worker) in queue.working {
        worker.abandon();
    }
    // A claim that cannot be given back is void as soon as we are gone.
    let _ = release(place.database, place.owner);
    result
}

struct Queue {
    waiting: VecDeque<Job>,
    /// Other runs work on these.
    elsewhere: Vec<Job>,
    working: Vec<(usize, Worker)>,
    done: usize,
    all: usize,
}

impl Queue {
    fn rounds(&mut self, place: &Place<'_>, tell: &mut dyn FnMut(&Progress)) -> Result<bool, QueueError> {
        let begun = Instant::now();
        let mut asked: Option<Instant> = None;
        let (mut beaten, mut looked) = (begun, begun);
        let mut tell = |queue: &mut Queue, last: Told| {
            queue.done += 1;
            let left = begun.elapsed().mul_f64((queue.all - queue.done) as f64 / queue.done as f64);
            tell(&Progress { done: queue.done, all: queue.all, last, left });
        };
        while !self.working.is_empty() || asked.is_none() && self.waiting.len() + self.elsewhere.len() > 0 {
            if asked.is_none() && place.stop.load(Ordering::Relaxed) {
                asked = Some(Instant::now());
                self.working.iter_mut().for_each(|(_, worker)| worker.ask_to_stop());
            }
            if asked.is_some_and(|at| at.elapsed() > PATIENCE) {
                return Ok(false);
            }
            if beaten.elapsed() > BEAT {
                beaten = Instant::now();
                beat(place.database, place.owner)?;
            }
            if self.waiting.is_empty() && looked.elapsed() > LOOK_ELSEWHERE {
                looked = Instant::now();
                self.waiting.extend(self.elsewhere.drain(..));
            }
            let ended = self.ended(place)?;
            let none_ended = ended.is_empty();
            let filled = if asked.is_some() || place.stop.load(Ordering::Relaxed) {
                Ok(())
            } else {
                self.fill(place, &mut tell)
            };
            for (number, worker, status) in ended {
                let system = |source| QueueError::System { what: format!("cannot keep simulation {number}"), source };
                let Some(left) = worker.left(status, place.workshop).map_err(system)? else { continue };
                let outcome = keep(left, &place.workshop.results).map_err(system)?;
                if record(place.database, &outcome, place.machine, place.owner)? {
                    tell(self, (number, outcome.status, outcome.reason));
                } else {
                    // We were taken for dead, and another run has it or had it.
                    let status = recorded(place.database, &outcome.hash)?.map_or("elsewhere".to_owned(), |(_, s)| s);
                    tell(self, (number, status, "by another run".to_owned()));
                }
            }
            // Not before what has ended is recorded.
            filled?;
            if none_ended {
                std::thread::park_timeout(LOOK);
            }
        }
        Ok(asked.is_none() && !place.stop.load(Ordering::Relaxed))
    }

    /// Takes the processes that have ended from those that work.
    fn ended(&mut self, place: &Place<'_>) -> Result<Vec<(usize, Worker, ExitStatus)>, QueueError> {
        let mut ended = Vec::new();
        for index in (0..self.working.len()).rev() {
            let number = self.working[index].0;
            let system =
                |source| QueueError::System { what: format!("cannot see how simulation {number} ended"), source };
            let Some(status) = self.working[index].1.ended(place.workshop).map_err(system)? else { continue };
            if interrupted(status) {
                // Together with us; we learn of it in a moment.
                place.stop.store(true, Ordering::Relaxed);
            }
            let (_, worker) = self.working.swap_remove(index);
            ended.push((number, worker, status));
        }
        Ok(ended)
    }

    /// Starts simulations where places are free.
    fn fill(&mut self, place: &Place<'_>, tell: &mut dyn FnMut(&mut Queue, Told)) -> Result<(), QueueError> {
        while self.working.len() < place.places {
            let Some(job) = self.waiting.pop_front() else { break };
            match claim(place.database, &job.hash, place.owner, job.before)? {
                Claim::Ours => {
                    let number = job.number;
                    let what = format!("cannot start simulation {number} with {}", place.workshop.program.display());
                    let worker = start(place.workshop, job, place.owner);
                    let worker = worker.map_err(|source| QueueError::System { what, source })?;
                    self.working.push((number, worker));
                }
                Claim::Elsewhere => self.elsewhere.push(job),
                Claim::Recorded(status) => tell(self, (job.number, status, "by another run".to_owned())),
            }
        }
        Ok(())
    }
}
