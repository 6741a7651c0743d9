//! A window that ends itself: so many pictures of a turning model, a pull in between, then what was measured.
//!
//! ```text
//! opened ── first picture ── 1 … N/2: pointer pulls … N ── report, end
//!                             the model turns once around
//! ```
//!
//! The pointer's events enter where those of the desktop do, so that what is measured is what a hand would feel. Nothing
//! here decides what is drawn or computed.

use crate::app::{App, Stage, point_on_body};
use crate::draw::device::Pixels;
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, vec2};
use serde_json::{Value, json};
use souple_simulation::session::Change;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// What is wanted of a window that ends itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TrialOptions {
    /// Pictures of the scene until the end; more, when the pull has not come through a step by then.
    pub frames: usize,
    /// Where the report is written, as JSON.
    pub report: Option<PathBuf>,
    /// Where a picture of the whole window is written at the end, as PNG.
    pub picture: Option<PathBuf>,
    /// When the program started.
    pub started: Instant,
}

/// A pass: when it began, and the step that it showed.
#[derive(Clone, Copy, Debug)]
struct Pass {
    at: Instant,
    step: u64,
}

/// The measurements so far.
pub struct Trial {
    options: TrialOptions,
    device: String,
    opened: Option<Instant>,
    passes: Vec<Pass>,
    draw_ms: Vec<f64>,
    /// Where the pointer pulls.
    grip: Option<Pos2>,
    /// The pass in which the pull was sent.
    pulled: Option<usize>,
    /// Whether the pointer let go.
    released: bool,
    /// The picture of the window, once it was asked for.
    image: Option<Receiver<Arc<egui::ColorImage>>>,
    report: Option<Value>,
    outcome: Sender<Result<(), String>>,
}

impl Trial {
    /// Nothing measured yet; the second result gets how it ended.
    pub fn new(options: TrialOptions, device: String) -> (Trial, Receiver<Result<(), String>>) {
        let (outcome, ended) = channel();
        let trial = Trial {
            options,
            device,
            opened: None,
            passes: Vec::new(),
            draw_ms: Vec::new(),
            grip: None,
            pulled: None,
            released: false,
            image: None,
            report: None,
            outcome,
        };
        (trial, ended)
    }

    /// Adds what the pointer does.
    pub fn before(&mut self, app: &App, input: &mut RawInput) {
        let (now, pull_at) = (self.passes.len(), self.options.frames / 2);
        let Some(after) = now.checked_sub(pull_at).filter(|_| app.running().is_some()) else { return };
        if after == 0 {
            self.grip = app.running().and_then(point_on_body);
        }
        let Some(grip) = self.grip else { return };
        let button = |pos: Pos2, pressed: bool| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        match after {
            0 => input.events.push(Event::PointerMoved(grip)),
            1 => input.events.push(button(grip, true)),
            2..10 => input.events.push(Event::PointerMoved(grip - vec2(0.0, 12.0 * (after - 1) as f32))),
            20.. if !self.released && !self.waits() => {
                self.released = true;
                input.events.push(button(grip - vec2(0.0, 96.0), false));
            }
            _ => {}
        }
    }

    /// Takes note of a pass, and ends the window after the last one.
    pub fn after(&mut self, app: &mut App, context: &egui::Context) {
        let opened = *self.opened.get_or_insert_with(Instant::now);
        app.pace.next(context);
        if let Stage::Failed { path, message } = &app.stage {
            self.end(Err(format!("{}: {message}", path.display())), context);
            return;
        }
        if matches!(app.stage, Stage::Loading { .. }) {
            return;
        }
        if self.passes.len() <= self.options.frames || self.waits() {
            self.measure(app);
            return;
        }
        if self.report.is_none() {
            self.report = Some(self.conclude(app, opened));
        }
        if self.options.picture.is_some() && self.image.is_none() {
            let (sender, receiver) = channel();
            self.image = Some(receiver);
            context.request_screenshot(move |image| {
                // The window may be gone by now.
                let _ = sender.send(image);
            });
            return;
        }
        match self.image.as_ref().map(Receiver::try_recv) {
            Some(Err(_)) => {}
            Some(Ok(image)) => self.end(self.write(Some(&image)), context),
            None => self.end(self.write(None), context),
        }
    }

    /// Whether the pull has not come through a step yet: steps may take longer than many pictures.
    fn waits(&self) -> bool {
        let pulled = self.pulled.and_then(|pass| self.passes.get(pass));
        let now = self.passes.last().map_or(0, |pass| pass.step);
        self.passes.len() < 100 * self.options.frames && pulled.is_some_and(|pass| now <= pass.step + 1)
    }

    fn measure(&mut self, app: &mut App) {
        let frames = self.options.frames.max(1);
        let Some(running) = app.running_mut() else {
            self.passes.push(Pass { at: Instant::now(), step: 0 });
            return;
        };
        if running.snapshot.controls.is_none() {
            return;
        }
        // A hand that holds something wants it where it is.
        if running.grip.is_none() {
            running.camera.turn(360.0 / frames as f32, 0.0);
        } else {
            self.pulled.get_or_insert(self.passes.len());
        }
        self.draw_ms.push(running.draw_ms);
        self.passes.push(Pass { at: Instant::now(), step: running.snapshot.step });
    }

    /// What was measured.
    fn conclude(&mut self, app: &mut App, opened: Instant) -> Value {
        let (Some(first), Some(last)) = (self.passes.first().copied(), self.passes.last().copied()) else {
            return json!({});
        };
        let seconds = (last.at - first.at).as_secs_f64().max(1e-9);
        let mut frame_ms: Vec<f64> = self.passes.windows(2).map(|w| (w[1].at - w[0].at).as_secs_f64() * 1e3).collect();
        let ms = |duration: Duration| duration.as_secs_f64() * 1e3;
        let mut report = json!({
            "device": self.device,
            "opened_ms": ms(opened - self.options.started),
            "first_picture_ms": ms(first.at - opened),
            "frames": self.passes.len() - 1,
            "seconds": seconds,
            "frames_per_second": (self.passes.len() - 1) as f64 / seconds,
            "frame_ms": quantiles(&mut frame_ms),
            "draw_ms": quantiles(&mut self.draw_ms),
        });
        if let Some(running) = app.running_mut() {
            let script = running.session.state().map(|s| s.1).unwrap_or_default();
            let step = script.iter().find(|s| matches!(s.change, Change::Pull { .. })).map(|s| s.step);
            let moved = step.and_then(|step| self.passes.iter().position(|p| p.step > step));
            report["steps_per_second"] = json!((last.step - first.step) as f64 / seconds);
            report["frames_from_pull_to_motion"] = json!(self.pulled.zip(moved).map(|(p, m)| m.saturating_sub(p)));
        }
        report["peak_memory_mb"] = json!(peak_memory());
        report
    }

    fn write(&self, image: Option<&egui::ColorImage>) -> Result<(), String> {
        let save = |path: &PathBuf, bytes: &[u8]| {
            std::fs::write(path, bytes).map_err(|e| format!("cannot write {}: {e}", path.display()))
        };
        if let (Some(path), Some(image)) = (&self.options.picture, image) {
            let size = image.size.map(|s| s as u32);
            let bytes = image.pixels.iter().flat_map(|p| p.to_array()).collect();
            save(path, &Pixels { size, bytes }.png()?)?;
        }
        let text = self.report.as_ref().map_or(Ok(String::new()), serde_json::to_string_pretty);
        let text = text.map_err(|e| e.to_string())?;
        match &self.options.report {
            Some(path) => save(path, text.as_bytes()),
            None => {
                println!("{text}");
                Ok(())
            }
        }
    }

    fn end(&self, how: Result<(), String>, context: &egui::Context) {
        // Whoever opened the window waits for this.
        let _ = self.outcome.send(how);
        context.send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

/// Median, and what one in a hundred exceeds.
fn quantiles(values: &mut [f64]) -> Value {
    values.sort_by(f64::total_cmp);
    let at = |q: f64| values.get((q * values.len().saturating_sub(1) as f64).round() as usize);
    json!({ "median": at(0.5), "p99": at(0.99) })
}

/// Most memory that this process ever had, in MB; nothing where the system does not tell it as Linux does.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes / 1e3)
}
