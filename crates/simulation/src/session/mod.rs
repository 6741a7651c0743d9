//! A simulation that goes on while somebody looks at it and touches it: on a thread of its own, or, where there are no
//! threads (pages of a browser), between two pictures.
//!
//! ```text
//! window ── Command ──► channel ──► Simulation, step after step ──► Snapshot ──► three buffers ──► window
//!                                        │ every change, with the step at which it was made
//!                                        ▼
//!                                      Script ──► replay: the same trajectory without a window, to the last bit
//! ```
//!
//! With a thread, drawing never waits for a step, and a step never waits for drawing: the two swap buffers ([`exchange`]).
//! Without, whoever draws gives the simulation some time after each picture ([`Session::work`]). Time on the wall only
//! decides when a step is made, never what it computes.

mod exchange;
mod history;
mod recorder;
mod script;
mod worker;

pub use history::HistoryRange;
pub use script::{Change, Script, Stamped, replay};

use crate::fields::ElementField;
use crate::interaction::{Controls, PullState};
use crate::phases::PhaseTimes;
use crate::run::{Ending, Simulation};
use exchange::{Reader, exchange};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// What a session is asked to do.
#[derive(Debug)]
pub enum Command {
    /// Steps follow each other from now on.
    Play,
    /// They stop.
    Pause,
    /// This many steps, then a pause.
    Step(u64),
    /// Steps up to this simulated time in s (to the nearest step), then a pause.
    Until(f64),
    /// Simulated seconds per second; `None` is as fast as it goes.
    Speed(Option<f64>),
    /// A change to the simulation, which the script keeps.
    Change(Change),
    /// Back to the beginning; all changes are undone.
    Reset,
    /// To the state after this step, with the changes that led there. What came after is kept until a step is made.
    Seek(u64),
    /// Which fields snapshots carry.
    Watch(Vec<ElementField>),
    /// Writes a series for ParaView into this folder from now on, a frame whenever this much time in s has passed; `None`
    /// ends it.
    Record(Option<(PathBuf, f64)>),
    /// Writes a checkpoint that `souple run --resume` takes, changes by hand included, and the script beside it.
    Save(PathBuf),
    /// Gives the state as a checkpoint, and the script that led to it.
    Give(Sender<(Vec<u8>, Script)>),
}

/// What happened in one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Steps made so far.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// How long the step took in ms.
    pub milliseconds: f64,
    /// Parts of it.
    pub phases: PhaseTimes,
    /// Iterations of the linear solver.
    pub cg_iterations: usize,
    /// What the last linear solve left over, relative to where it began.
    pub residual: f64,
    /// Kinetic energy in J.
    pub kinetic_energy: f64,
    /// Strain energy in J.
    pub strain_energy: f64,
}

/// What is to be seen at one moment.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// How many were offered before this one, and this one: another number, another snapshot.
    pub number: u64,
    /// Steps made so far.
    pub step: u64,
    /// Simulated time in s.
    pub time: f64,
    /// Positions in m, [node][axis].
    pub positions: Vec<[f32; 3]>,
    /// The fields that are watched: one value per element each.
    pub fields: Vec<(ElementField, Vec<f32>)>,
    /// Springs in hands by number.
    pub pulls: Vec<(u32, PullState)>,
    /// Force of the bodies on the tool in N.
    pub tool_force: [f64; 3],
    /// What a person may change, as it is.
    pub controls: Option<Arc<Controls>>,
    /// Elements that are inside out.
    pub inverted: Vec<u32>,
    /// Whether steps follow each other.
    pub playing: bool,
    /// Whether it is over, and how.
    pub ending: Option<Ending>,
    /// Why the last command or step failed.
    pub error: Option<String>,
    /// What a person should know, the last ones of all steps.
    pub warnings: Vec<String>,
    /// Simulated seconds per second of the last steps.
    pub real_time_factor: f64,
    /// Steps that can be gone back to.
    pub history: HistoryRange,
    /// Frames of the running recording.
    pub recorded: Option<usize>,
}

impl Snapshot {
    /// The values of a field, one per element; `None` when it is not carried.
    pub fn field(&self, field: ElementField) -> Option<&[f32]> {
        self.fields.iter().find(|(which, _)| *which == field).map(|(_, values)| values.as_slice())
    }
}

/// How a session begins.
#[derive(Clone, Debug, PartialEq)]
pub struct SessionOptions {
    /// Whether steps follow each other from the start.
    pub playing: bool,
    /// Simulated seconds per second; `None` is as fast as it goes.
    pub speed: Option<f64>,
    /// Memory for states to go back to, in bytes.
    pub history_bytes: usize,
}

impl Default for SessionOptions {
    fn default() -> Self {
        SessionOptions { playing: true, speed: Some(1.0), history_bytes: 256 << 20 }
    }
}

/// A simulation that goes on; dropping this ends it.
pub struct Session {
    commands: Option<Sender<Command>>,
    samples: Receiver<Sample>,
    snapshots: Reader<Snapshot>,
    place: Place,
}

/// Where steps are made.
enum Place {
    /// On a thread of their own, until it is joined.
    Thread(Option<JoinHandle<()>>),
    /// Where [`Session::work`] is called.
    Here(Box<worker::Worker>),
}

impl Session {
    /// Starts the thread, in which the simulation goes on beyond its end ([`Simulation::run_on`]). `wake` is called after each new snapshot, from there.
    ///
    /// # Errors
    /// When the machine gives no thread, in its words.
    pub fn start(
        simulation: Simulation,
        warnings: Vec<String>,
        options: SessionOptions,
        wake: Box<dyn Fn() + Send>,
    ) -> Result<Session, String> {
        let (mut session, worker) = Session::without_place(simulation, warnings, options, wake);
        let thread = std::thread::Builder::new().name("simulation".into()).spawn(move || worker.run());
        let thread = thread.map_err(|e| format!("no thread for the simulation: {e}"))?;
        session.place = Place::Thread(Some(thread));
        Ok(session)
    }

    /// The same without a thread: nothing happens but in [`Session::work`], and `wake` is called from there.
    pub fn start_here(
        simulation: Simulation,
        warnings: Vec<String>,
        options: SessionOptions,
        wake: Box<dyn Fn() + Send>,
    ) -> Session {
        let (mut session, worker) = Session::without_place(simulation, warnings, options, wake);
        session.place = Place::Here(Box::new(worker));
        session
    }

    fn without_place(
        mut simulation: Simulation,
        warnings: Vec<String>,
        options: SessionOptions,
        wake: Box<dyn Fn() + Send>,
    ) -> (Session, worker::Worker) {
        let (commands, inbox) = channel();
        let (sampled, samples) = channel();
        let (writer, snapshots) = exchange();
        simulation.watch();
        simulation.run_on();
        let worker = worker::Worker::new(simulation, warnings, options, inbox, sampled, writer, wake);
        let session = Session { commands: Some(commands), samples, snapshots, place: Place::Thread(None) };
        (session, worker)
    }

    /// Does what is due, where there is no thread for it: everything that was asked for, and steps until `budget` has
    /// passed, at least one if one is due. Gives how long it is until the next step; `None` when none follows, and where
    /// a thread makes the steps.
    pub fn work(&mut self, budget: Duration) -> Option<Duration> {
        match &mut self.place {
            Place::Here(worker) => worker.work(budget),
            Place::Thread(_) => None,
        }
    }

    /// Asks for something; it is done before the next step.
    pub fn send(&self, command: Command) {
        if let Some(commands) = &self.commands {
            // The thread is gone only after a panic, and then nothing can be done here.
            let _ = commands.send(command);
        }
    }

    /// The newest snapshot; the same again when there is none newer.
    pub fn snapshot(&mut self) -> &Snapshot {
        self.snapshots.newest()
    }

    /// What happened since this was last asked.
    pub fn samples(&self) -> impl Iterator<Item = Sample> + '_ {
        self.samples.try_iter()
    }

    /// The state as a checkpoint and the script that led to it, after everything that was sent before.
    ///
    /// `None` when the thread is gone.
    pub fn state(&mut self) -> Option<(Vec<u8>, Script)> {
        let (sender, receiver) = channel();
        self.send(Command::Give(sender));
        if let Place::Here(worker) = &mut self.place {
            worker.listen();
        }
        receiver.recv().ok()
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // Without senders the thread ends after its step.
        self.commands = None;
        if let Place::Thread(thread) = &mut self.place
            && let Some(thread) = thread.take()
        {
            // A panic there has been reported by the thread itself.
            let _ = thread.join();
        }
    }
}
