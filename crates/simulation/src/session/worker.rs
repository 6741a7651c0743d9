//! The loop of the simulation's thread: commands, a step when it is due, a snapshot.

use super::exchange::Writer;
use super::history::{Entry, History};
use super::recorder::Recorder;
use super::script::{Script, Stamped, replay};
use super::{Command, Sample, SessionOptions, Snapshot};
use crate::fields::ElementField;
use crate::interaction::Controls;
use crate::run::{RunError, Simulation};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::time::{Duration, Instant};

/// While the reader does not take snapshots, one is still offered this often.
const UNREAD: Duration = Duration::from_millis(30);
/// A simulation that falls behind the clock by more than this does not catch up.
const PATIENCE: Duration = Duration::from_millis(250);
/// Warnings that are kept.
const WARNINGS: usize = 50;

/// Why the loop goes on.
enum Next {
    Command(Command),
    Step,
    End,
}

pub(super) struct Worker {
    simulation: Simulation,
    inbox: Receiver<Command>,
    samples: Sender<Sample>,
    snapshots: Writer<Snapshot>,
    wake: Box<dyn Fn() + Send>,
    history: History,
    script: Script,
    /// Whether the state is one of the past, and what came after it is still known.
    rewound: bool,
    playing: bool,
    /// Steps to make before a pause.
    steps_left: Option<u64>,
    speed: Option<f64>,
    /// When simulated and real time were last made equal.
    clock: (Instant, f64),
    watched: Vec<ElementField>,
    recorder: Option<Recorder>,
    error: Option<String>,
    warnings: Vec<String>,
    controls: Arc<Controls>,
    published: Instant,
    offered: u64,
    factor: f64,
    stepped: Option<(Instant, f64)>,
}

impl Worker {
    pub(super) fn new(
        simulation: Simulation,
        warnings: Vec<String>,
        options: SessionOptions,
        inbox: Receiver<Command>,
        samples: Sender<Sample>,
        snapshots: Writer<Snapshot>,
        wake: Box<dyn Fn() + Send>,
    ) -> Worker {
        let controls = Arc::new(simulation.controls().clone());
        let first = Entry { step: simulation.steps, checkpoint: simulation.state_bytes(), controls: controls.clone() };
        let now = Instant::now();
        Worker {
            history: History::new(options.history_bytes, first),
            clock: (now, simulation.time()),
            simulation,
            inbox,
            samples,
            snapshots,
            wake,
            script: Script::new(),
            rewound: false,
            playing: options.playing,
            steps_left: None,
            speed: options.speed,
            watched: Vec::new(),
            recorder: None,
            error: None,
            warnings,
            controls,
            published: now,
            offered: 0,
            factor: 0.0,
            stepped: None,
        }
    }

    pub(super) fn run(mut self) {
        self.publish();
        loop {
            match self.next() {
                Next::End => return,
                Next::Command(command) => {
                    self.obey(command);
                    self.publish();
                }
                Next::Step => {
                    self.step();
                    // Somebody who does not look needs no new picture, but whoever begins to look needs a recent one.
                    if self.snapshots.was_taken() || self.published.elapsed() > UNREAD || !self.moving() {
                        self.publish();
                    }
                }
            }
        }
    }

    fn moving(&self) -> bool {
        self.playing && self.simulation.ending.is_none()
    }

    /// Waits for a command, or for the time of the next step.
    fn next(&mut self) -> Next {
        if !self.moving() {
            self.stepped = None;
            return self.inbox.recv().map_or(Next::End, Next::Command);
        }
        match self.inbox.try_recv() {
            Ok(command) => return Next::Command(command),
            Err(TryRecvError::Disconnected) => return Next::End,
            Err(TryRecvError::Empty) => {}
        }
        // Steps that were asked for by number are not paced.
        let (Some(speed), None) = (self.speed, self.steps_left) else { return Next::Step };
        let ahead = (self.simulation.time() - self.clock.1) / speed;
        let due = self.clock.0 + Duration::from_secs_f64(ahead.clamp(0.0, 1e6));
        let now = Instant::now();
        if due <= now {
            if now - due > PATIENCE {
                self.clock = (now, self.simulation.time());
            }
            return Next::Step;
        }
        match self.inbox.recv_timeout(due - now) {
            Ok(command) => Next::Command(command),
            Err(RecvTimeoutError::Timeout) => Next::Step,
            Err(RecvTimeoutError::Disconnected) => Next::End,
        }
    }

    fn obey(&mut self, command: Command) {
        self.error = None;
        match command {
            Command::Play => self.set_playing(None),
            Command::Pause => self.playing = false,
            Command::Step(count) => self.set_playing(Some(count)),
            Command::Speed(speed) => {
                self.speed = speed.filter(|s| *s > 0.0 && s.is_finite());
                self.clock = (Instant::now(), self.simulation.time());
            }
            Command::Change(change) => {
                self.forget_future();
                match change.make(&mut self.simulation) {
                    Ok(()) => {
                        self.controls = Arc::new(self.simulation.controls().clone());
                        self.script.push(Stamped { step: self.simulation.steps, change });
                    }
                    Err(error) => self.error = Some(error.to_string()),
                }
            }
            Command::Reset => {
                self.script.clear();
                let result = self.go_to(0);
                self.history.forget_after(self.simulation.steps);
                self.rewound = false;
                self.warnings.clear();
                self.note_failure(result);
            }
            Command::Seek(step) => {
                let result = self.go_to(step.min(self.history.range().last));
                self.rewound = true;
                self.note_failure(result);
            }
            Command::Watch(fields) => self.watched = fields,
            Command::Record(None) => self.recorder = None,
            Command::Record(Some((folder, every))) => match Recorder::start(folder, every, &mut self.simulation) {
                Ok(recorder) => self.recorder = Some(recorder),
                Err(error) => self.error = Some(error.message),
            },
            Command::Save(path) => self.save(&path),
            Command::Give(to) => {
                // Whoever asked may be gone.
                let _ = to.send((self.simulation.checkpoint(), self.script.clone()));
            }
        }
    }

    fn set_playing(&mut self, steps: Option<u64>) {
        self.playing = steps != Some(0);
        self.steps_left = steps;
        self.clock = (Instant::now(), self.simulation.time());
    }

    fn note_failure(&mut self, result: Result<(), RunError>) {
        if let Err(error) = result {
            self.error = Some(error.message);
            self.playing = false;
        }
        self.clock = (Instant::now(), self.simulation.time());
    }

    /// Puts the simulation into the state after a step, with the changes that led there.
    fn go_to(&mut self, step: u64) -> Result<(), RunError> {
        let entry = self.history.before(step);
        self.simulation.set_controls(&entry.controls).map_err(|e| RunError { message: e.to_string() })?;
        self.simulation.restore_state(&entry.checkpoint)?;
        replay(&mut self.simulation, &self.script, step)?;
        self.controls = Arc::new(self.simulation.controls().clone());
        Ok(())
    }

    /// From here on the past is another one.
    fn forget_future(&mut self) {
        if self.rewound {
            let step = self.simulation.steps;
            self.history.forget_after(step);
            self.script.retain(|s| s.step < step);
            self.rewound = false;
        }
    }

    fn step(&mut self) {
        self.forget_future();
        let before = Instant::now();
        match self.simulation.advance() {
            Err(error) => {
                self.error = Some(error.message);
                self.playing = false;
                return;
            }
            Ok(progress) => {
                let strain_energy = self.simulation.strain_energy();
                // Nobody counts when the receiver is gone.
                let _ = self.samples.send(Sample {
                    step: progress.step,
                    time: progress.time,
                    milliseconds: before.elapsed().as_secs_f64() * 1e3,
                    phases: self.simulation.phases().unwrap_or_default(),
                    cg_iterations: progress.cg_iterations,
                    residual: progress.residual,
                    kinetic_energy: progress.kinetic_energy,
                    strain_energy,
                });
                self.warnings.extend(progress.warnings);
                let surplus = self.warnings.len().saturating_sub(WARNINGS);
                self.warnings.drain(..surplus);
            }
        }
        let (simulation, controls) = (&self.simulation, &self.controls);
        let entry =
            || Entry { step: simulation.steps, checkpoint: simulation.state_bytes(), controls: controls.clone() };
        self.history.note(simulation.steps, entry);
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.note(&mut self.simulation)
        {
            self.error = Some(error.message);
            self.recorder = None;
        }
        let (now, time) = (Instant::now(), self.simulation.time());
        if let Some((then, before)) = self.stepped {
            let real = (now - then).as_secs_f64().max(1e-9);
            let factor = (time - before) / real;
            self.factor = if self.factor > 0.0 { 0.9 * self.factor + 0.1 * factor } else { factor };
        }
        self.stepped = Some((now, time));
        if let Some(left) = &mut self.steps_left {
            *left -= 1;
            if *left == 0 {
                self.steps_left = None;
                self.playing = false;
            }
        }
        if self.simulation.ending.is_some() {
            self.playing = false;
        }
    }

    /// A checkpoint, and the script beside it where there is one.
    fn save(&mut self, path: &std::path::Path) {
        let write = |path: &std::path::Path, bytes: &[u8]| {
            std::fs::write(path, bytes).map_err(|e| format!("cannot write {}: {e}", path.display()))
        };
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
        let made = folder.map_or(Ok(()), std::fs::create_dir_all);
        let made = made.map_err(|e| format!("cannot make the folder of {}: {e}", path.display()));
        let written = made.and_then(|()| write(path, &self.simulation.checkpoint()));
        let script = || serde_json::to_vec_pretty(&self.script).map_err(|e| e.to_string());
        let written = written.and_then(|()| match self.script.is_empty() {
            true => Ok(()),
            false => write(&path.with_extension("json"), &script()?),
        });
        self.error = written.err();
    }

    fn publish(&mut self) {
        let simulation = &mut self.simulation;
        let out = &mut *self.snapshots.own;
        self.offered += 1;
        out.number = self.offered;
        out.step = simulation.steps;
        out.time = simulation.time();
        out.positions.clear();
        out.positions.extend(simulation.positions().into_iter().map(|p| p.map(|x| x as f32)));
        out.fields.clear();
        // What cannot be had once is not asked for again.
        self.watched.retain(|&field| match simulation.element_field(field) {
            Ok(values) => {
                out.fields.push((field, values.into_iter().map(|v| v as f32).collect()));
                true
            }
            Err(error) => {
                self.error = Some(error.message);
                false
            }
        });
        let numbers: Vec<u32> = simulation.controls().pulls.keys().copied().collect();
        out.pulls = numbers.into_iter().filter_map(|n| Some((n, simulation.pull(n)?))).collect();
        out.tool_force = simulation.tool_force();
        out.inverted = simulation.inverted_elements();
        out.controls = Some(self.controls.clone());
        out.playing = self.playing;
        out.ending = simulation.ending;
        out.error.clone_from(&self.error);
        out.warnings.clone_from(&self.warnings);
        out.real_time_factor = self.factor;
        out.history = self.history.range();
        out.recorded = self.recorder.as_ref().map(Recorder::frames);
        self.snapshots.publish();
        self.published = Instant::now();
        (self.wake)();
    }
}
