//! What makes a session's steps: commands, a step when it is due, a snapshot; in a loop on a thread, or by turns.

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
use std::time::Duration;
use web_time::Instant;

/// While the reader does not take snapshots, one is still offered this often.
const UNREAD: Duration = Duration::from_millis(30);
/// A simulation that falls behind the clock by more than this does not catch up.
const PATIENCE: Duration = Duration::from_millis(250);
/// Warnings that are kept.
const WARNINGS: usize = 50;

/// What is to be done now.
enum Due {
    Command(Command),
    Step,
    /// A step, but not before this has passed.
    Later(Duration),
    /// Nothing without a command.
    Nothing,
    /// Nobody can ask for anything any more.
    End,
}

/// Where steps that were asked for end.
enum Goal {
    /// After this many more.
    Steps(u64),
    /// At this time in s.
    Time(f64),
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
    /// Where a pause follows, if anywhere.
    goal: Option<Goal>,
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
            goal: None,
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
                Due::End => return,
                Due::Command(command) => {
                    self.obey(command);
                    self.publish();
                }
                Due::Step => {
                    self.step();
                    // Somebody who does not look needs no new picture, but whoever begins to look needs a recent one.
                    if self.snapshots.was_taken() || self.published.elapsed() > UNREAD || !self.moving() {
                        self.publish();
                    }
                }
                // `next` has waited for these.
                Due::Later(_) | Due::Nothing => {}
            }
        }
    }

    /// Does what is due now: every command, and steps, at least one, until `budget` has passed; what there is to see then is
    /// offered once. Gives how long it is until the next step, if one follows.
    pub(super) fn work(&mut self, budget: Duration) -> Option<Duration> {
        let began = Instant::now();
        let mut stepped = false;
        let mut news = self.offered == 0;
        let wait = loop {
            match self.due() {
                Due::Command(command) => {
                    self.obey(command);
                    news = true;
                }
                Due::Step if !stepped || began.elapsed() < budget => {
                    self.step();
                    stepped = true;
                }
                Due::Step => break Some(Duration::ZERO),
                Due::Later(wait) => break Some(wait),
                Due::Nothing | Due::End => break None,
            }
        };
        if stepped || news {
            self.publish();
        }
        wait
    }

    /// Does what was asked for, and no step.
    pub(super) fn listen(&mut self) {
        let mut news = false;
        while let Ok(command) = self.inbox.try_recv() {
            self.obey(command);
            news = true;
        }
        if news {
            self.publish();
        }
    }

    fn moving(&self) -> bool {
        self.playing && self.simulation.ending.is_none()
    }

    /// What is to be done; waits for a command, or for the time of the next step.
    fn next(&mut self) -> Due {
        match self.due() {
            Due::Nothing => self.inbox.recv().map_or(Due::End, Due::Command),
            Due::Later(wait) => match self.inbox.recv_timeout(wait) {
                Ok(command) => Due::Command(command),
                Err(RecvTimeoutError::Timeout) => Due::Step,
                Err(RecvTimeoutError::Disconnected) => Due::End,
            },
            now => now,
        }
    }

    /// What is to be done, without waiting.
    fn due(&mut self) -> Due {
        match self.inbox.try_recv() {
            Ok(command) => return Due::Command(command),
            Err(TryRecvError::Disconnected) => return Due::End,
            Err(TryRecvError::Empty) => {}
        }
        if !self.moving() {
            self.stepped = None;
            return Due::Nothing;
        }
        // Steps that were asked for by number or time are not paced.
        let (Some(speed), None) = (self.speed, &self.goal) else { return Due::Step };
        let ahead = (self.simulation.time() - self.clock.1) / speed;
        let due = self.clock.0 + Duration::from_secs_f64(ahead.clamp(0.0, 1e6));
        let now = Instant::now();
        if due > now {
            return Due::Later(due - now);
        }
        if now - due > PATIENCE {
            self.clock = (now, self.simulation.time());
        }
        Due::Step
    }

    fn obey(&mut self, command: Command) {
        self.error = None;
        match command {
            Command::Play => self.set_playing(None),
            Command::Pause => self.playing = false,
            Command::Step(count) => self.set_playing(Some(Goal::Steps(count))),
            Command::Until(time) => self.set_playing(Some(Goal::Time(time))),
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

    fn set_playing(&mut self, goal: Option<Goal>) {
        self.goal = goal;
        self.playing = true;
        self.pause_at_goal();
        self.clock = (Instant::now(), self.simulation.time());
    }

    /// Ends what was asked for when it is reached.
    fn pause_at_goal(&mut self) {
        let reached = match self.goal {
            None => false,
            Some(Goal::Steps(left)) => left == 0,
            // To the nearest step.
            Some(Goal::Time(time)) => self.simulation.time() >= time - 0.5 * self.controls.step,
        };
        if reached {
            self.goal = None;
            self.playing = false;
        }
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
        if let Some(Goal::Steps(left)) = &mut self.goal {
            *left -= 1;
        }
        self.pause_at_goal();
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
