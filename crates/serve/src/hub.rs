//! The thread that owns the session: commands of all clients in, the newest frame for each of them out.
//!
//! Frames are made at most [`RATE`] times a second, and only while somebody looks. Springs that are dragged are passed on
//! once per snapshot, so that a hand that moves faster than the simulation steps leaves no queue behind.

use crate::command::Command;
use crate::frame::{Beside, frame_message};
use crate::surface::Surface;
use axum::body::Bytes;
use souple_simulation::ElementField;
use souple_simulation::interaction::Pull;
use souple_simulation::session::{self, Change, Sample, Session};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Most frames per second.
const RATE: f64 = 60.0;
/// Steps are counted over this time.
const WINDOW: Duration = Duration::from_secs(1);

/// What happens to the hub.
#[derive(Debug)]
pub(crate) enum Event {
    /// There is a new snapshot.
    Woken,
    /// Somebody begins to look.
    Joined(u32),
    /// Somebody went away.
    Left(u32),
    /// A client wants something.
    Asked(u32, Command),
    /// The end.
    Stop,
}

/// What the hub knows of a client.
#[derive(Debug, Default)]
struct Client {
    pull: Option<Pull>,
    /// The spring has moved since the session was told.
    moved: bool,
    watches: Option<ElementField>,
}

/// The newest frame of each client, by its number; those that watch the same have the same bytes.
pub(crate) type Frames = BTreeMap<u32, Bytes>;

/// The hub.
pub(crate) struct Hub {
    pub(crate) session: Session,
    pub(crate) surface: Arc<Surface>,
    pub(crate) events: Receiver<Event>,
    pub(crate) frames: watch::Sender<Frames>,
    pub(crate) speed: Option<f64>,
}

impl Hub {
    /// Runs until [`Event::Stop`], or until nobody can send events any more.
    pub(crate) fn run(self) {
        let mut work = Work {
            hub: self,
            clients: BTreeMap::new(),
            watched: Vec::new(),
            fresh: false,
            told: false,
            framed: None,
            steps: VecDeque::new(),
            sample: None,
        };
        while work.go_on() {}
    }
}

struct Work {
    hub: Hub,
    clients: BTreeMap<u32, Client>,
    /// Fields that the session was asked for.
    watched: Vec<ElementField>,
    /// There is a snapshot that no frame shows.
    fresh: bool,
    /// The session was told of a moved spring, and no snapshot has come since.
    told: bool,
    framed: Option<Instant>,
    /// When steps were counted, and how many.
    steps: VecDeque<(Instant, usize)>,
    sample: Option<Sample>,
}

impl Work {
    fn go_on(&mut self) -> bool {
        let wait = match self.framed {
            Some(last) if self.fresh && !self.clients.is_empty() => {
                Duration::from_secs_f64(1.0 / RATE).saturating_sub(last.elapsed())
            }
            None if self.fresh && !self.clients.is_empty() => Duration::ZERO,
            _ => Duration::MAX,
        };
        let event = match wait {
            Duration::ZERO => match self.hub.events.try_recv() {
                Ok(event) => Ok(event),
                Err(std::sync::mpsc::TryRecvError::Empty) => Err(RecvTimeoutError::Timeout),
                Err(std::sync::mpsc::TryRecvError::Disconnected) => Err(RecvTimeoutError::Disconnected),
            },
            Duration::MAX => self.hub.events.recv().map_err(|_| RecvTimeoutError::Disconnected),
            wait => self.hub.events.recv_timeout(wait),
        };
        match event {
            Ok(Event::Stop) | Err(RecvTimeoutError::Disconnected) => return false,
            Err(RecvTimeoutError::Timeout) => {}
            Ok(Event::Woken) => {
                self.fresh = true;
                self.told = false;
                // Also while nobody looks: what is not taken would heap up.
                self.count_steps(Instant::now());
                self.pass_on_pulls();
            }
            Ok(Event::Joined(client)) => {
                self.clients.insert(client, Client::default());
                // Whoever joins sees the present at once, even if nothing moves.
                (self.fresh, self.framed) = (true, None);
            }
            Ok(Event::Left(client)) => self.leave(client),
            Ok(Event::Asked(client, command)) => self.obey(client, command),
        }
        let due = self.framed.is_none_or(|last| last.elapsed().as_secs_f64() >= 1.0 / RATE);
        if self.fresh && due && !self.clients.is_empty() {
            self.frame();
        }
        true
    }

    fn leave(&mut self, client: u32) {
        if self.clients.remove(&client).is_some_and(|c| c.pull.is_some()) {
            self.change(Change::Release { number: client });
        }
        self.watch();
        // The others are told how many are left.
        self.fresh = true;
    }

    fn change(&self, change: Change) {
        self.hub.session.send(session::Command::Change(change));
    }

    fn obey(&mut self, number: u32, command: Command) {
        let send = |command| self.hub.session.send(command);
        match command {
            Command::Play {} => send(session::Command::Play),
            Command::Pause {} => send(session::Command::Pause),
            Command::Step { count } => send(session::Command::Step(count)),
            Command::Reset {} => send(session::Command::Reset),
            Command::Speed { factor } => {
                send(session::Command::Speed(factor));
                self.hub.speed = factor;
            }
            Command::Gravity { value } => self.change(Change::Gravity(value)),
            Command::Damping { value } => self.change(Change::VelocityDamping(value)),
            Command::TimeStep { value } => self.change(Change::TimeStep(value)),
            Command::Colour { by } => {
                if let Some(client) = self.clients.get_mut(&number) {
                    client.watches = crate::command::choice(&by).and_then(|choice| choice.field);
                }
                self.watch();
                // What is wanted may be there already.
                self.fresh = true;
            }
            Command::PullBegin { nodes, weights, target, stiffness } => {
                let nodes = nodes.iter().map(|&n| self.hub.surface.nodes[n as usize]);
                let pull = Pull { anchor: nodes.zip(weights).collect(), target, stiffness };
                self.change(Change::Pull { number, pull: pull.clone() });
                if let Some(client) = self.clients.get_mut(&number) {
                    (client.pull, client.moved) = (Some(pull), false);
                }
            }
            Command::PullMove { target } => {
                if let Some(client) = self.clients.get_mut(&number)
                    && let Some(pull) = &mut client.pull
                {
                    pull.target = target;
                    client.moved = true;
                    self.pass_on_pulls();
                }
            }
            Command::PullEnd {} => {
                if self.clients.get_mut(&number).is_some_and(|client| client.pull.take().is_some()) {
                    self.change(Change::Release { number });
                }
            }
            // Clients count their frames themselves.
            Command::More {} => {}
        }
    }

    /// Tells the session of springs that moved, unless it has not even shown the last move.
    fn pass_on_pulls(&mut self) {
        if self.told {
            return;
        }
        for (&number, client) in &mut self.clients {
            if let (true, Some(pull)) = (client.moved, &client.pull) {
                let change = Change::Pull { number, pull: pull.clone() };
                self.hub.session.send(session::Command::Change(change));
                client.moved = false;
                self.told = true;
            }
        }
    }

    /// Asks the session for the fields that clients watch, each once.
    fn watch(&mut self) {
        let anybody = |field: &ElementField| self.clients.values().any(|client| client.watches == Some(*field));
        let wanted: Vec<ElementField> = ElementField::ALL.into_iter().filter(anybody).collect();
        if wanted != self.watched {
            self.watched.clone_from(&wanted);
            self.hub.session.send(session::Command::Watch(wanted));
        }
    }

    /// Takes note of the steps since this was last called.
    fn count_steps(&mut self, now: Instant) {
        let mut count = 0;
        for sample in self.hub.session.samples() {
            count += 1;
            self.sample = Some(sample);
        }
        self.steps.push_back((now, count));
        while self.steps.front().is_some_and(|(then, _)| now - *then > WINDOW) {
            self.steps.pop_front();
        }
    }

    fn frame(&mut self) {
        let now = Instant::now();
        self.count_steps(now);
        let snapshot = self.hub.session.snapshot();
        if snapshot.positions.is_empty() {
            // The session has not begun; it wakes us when it has.
            self.fresh = false;
            return;
        }
        // What the first entry counted happened before the window.
        let steps: usize = self.steps.iter().skip(1).map(|s| s.1).sum();
        let span = self.steps.front().map_or(0.0, |(then, _)| (now - *then).as_secs_f64());
        if snapshot.step == 0 {
            self.sample = None;
        }
        let beside = Beside {
            steps_per_second: if span > 0.0 && snapshot.playing { steps as f64 / span } else { 0.0 },
            sample: self.sample,
            clients: self.clients.len(),
            speed: self.hub.speed,
        };
        let mut made: Vec<(Option<ElementField>, Bytes)> = Vec::new();
        let mut frames = Frames::new();
        for (&number, client) in &self.clients {
            let known = made.iter().find(|(field, _)| *field == client.watches).map(|(_, bytes)| bytes.clone());
            let bytes = known.unwrap_or_else(|| {
                let bytes = Bytes::from(frame_message(&self.hub.surface, snapshot, client.watches, &beside));
                made.push((client.watches, bytes.clone()));
                bytes
            });
            frames.insert(number, bytes);
        }
        self.hub.frames.send_replace(frames);
        (self.fresh, self.framed) = (false, Some(now));
    }
}
