//! When the next picture is due.
//!
//! A graphics card draws whenever there is something new. The processor that draws is the one that simulates, so there
//! pictures come at a pace that the eye takes for motion, and the rest of the time is the simulation's:
//!
//! ```text
//! picture begins ── drawing ──┤ simulation has all of the processor ├── at least PERIOD later: the next one
//! ```
//!
//! What a person does with pointer or keys is answered at once.
//!
//! Where there are no threads, the simulation has the time between two pictures for its steps ([`Pace::budget`]).

use egui_wgpu::wgpu;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use web_time::Instant;

/// From one picture to the next where the processor draws: 18 per second.
const PERIOD: Duration = Duration::from_millis(55);
/// Steps between two pictures may take this long at least: with what drawing takes, less than the 16.7 ms from one picture
/// of a screen to the next.
const BUDGET: Duration = Duration::from_millis(10);

/// Shared by the window and the simulation's thread, which wakes it.
#[derive(Clone, Debug)]
pub struct Pace {
    period: Duration,
    began: Arc<Mutex<Instant>>,
}

impl Pace {
    /// For what draws; `most` pictures per second, if a person has chosen.
    pub fn of(adapter: &wgpu::Adapter, most: Option<f64>) -> Pace {
        let slow = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let chosen = most.and_then(|rate| Duration::try_from_secs_f64(1.0 / rate).ok());
        let period = chosen.unwrap_or(if slow { PERIOD } else { Duration::ZERO });
        Pace { period, began: Arc::new(Mutex::new(Instant::now())) }
    }

    /// A picture begins.
    pub(super) fn begin(&self) {
        *self.began.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// Asks for another picture, when it is due.
    pub fn next(&self, context: &egui::Context) {
        self.after(context, Duration::ZERO);
    }

    /// The same, but not before this has passed.
    pub(super) fn after(&self, context: &egui::Context, wait: Duration) {
        context.request_repaint_after(self.left().max(wait));
    }

    /// For how long steps may be made before the next picture, where they are made on the thread that draws.
    pub(super) fn budget(&self) -> Duration {
        self.left().max(BUDGET)
    }

    /// How long it is until the next picture may begin.
    fn left(&self) -> Duration {
        let began = *self.began.lock().unwrap_or_else(PoisonError::into_inner);
        self.period.saturating_sub(began.elapsed())
    }
}
