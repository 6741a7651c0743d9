//! The progress of a run on a terminal: simulated time, steps per second, ratio to real time, iterations, energy.
//!
//! It is drawn on standard error, and only where that is a terminal; files and pipes get none of it.

use crate::terminal::note;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use souple_simulation::Progress;
use std::time::{Duration, Instant};

/// Positions of the bar from start to end.
const POSITIONS: f64 = 1000.0;
/// Warnings of steps that are shown; the rest is counted.
const SHOWN: usize = 5;

pub(super) struct Watch {
    bar: ProgressBar,
    end_time: f64,
    started: Instant,
    start_time: f64,
    steps: u64,
    drawn: Option<Instant>,
    warnings: usize,
}

impl Watch {
    /// Starts the clock; `silent` draws nothing.
    pub(super) fn start(end_time: f64, start_time: f64, silent: bool) -> Watch {
        let target = if silent { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(POSITIONS as u64), target);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  (left: {eta})");
        bar.set_style(style.expect("the template is a constant that a test draws"));
        Watch { bar, end_time, started: Instant::now(), start_time, steps: 0, drawn: None, warnings: 0 }
    }

    /// Notes a step, and draws where the last picture is old enough.
    pub(super) fn step(&mut self, progress: &Progress) {
        self.steps += 1;
        let recent = self.drawn.is_some_and(|at| at.elapsed() < Duration::from_millis(100));
        if self.bar.is_hidden() || (recent && progress.finished.is_none()) {
            return;
        }
        self.drawn = Some(Instant::now());
        self.bar.set_position((POSITIONS * (progress.time / self.end_time).clamp(0.0, 1.0)) as u64);
        self.bar.set_message(message(progress, self.end_time, self.start_time, self.steps, self.started.elapsed()));
    }

    /// Shows the first warnings of steps and counts the others: a step that warns is seldom the only one.
    pub(super) fn warn(&mut self, warnings: &[String]) {
        for warning in warnings {
            self.warnings += 1;
            if self.warnings <= SHOWN {
                self.bar.suspend(|| note(&format!("warning: {warning}")));
            }
        }
    }

    /// Leaves the terminal as it was.
    pub(super) fn end(self, quiet: bool) {
        self.bar.finish_and_clear();
        if self.warnings > SHOWN && !quiet {
            note(&format!("warning: and {} more like these", self.warnings - SHOWN));
        }
    }
}

fn message(progress: &Progress, end_time: f64, start_time: f64, steps: u64, elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64().max(1e-9);
    format!(
        "t {:.4} of {end_time} s, {:.1} steps/s, {:.3} × real time, {} CG iterations, kinetic energy {:.3e} J",
        progress.time,
        steps as f64 / seconds,
        (progress.time - start_time) / seconds,
        progress.cg_iterations,
        progress.kinetic_energy
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The template of the bar is valid, and a step's message tells time, speed and iterations.
    #[test]
    fn the_bar_is_drawn() {
        let progress = Progress {
            residual: 0.0,
            step: 10,
            time: 1.5,
            cg_iterations: 7,
            kinetic_energy: 0.25,
            finished: None,
            output_due: false,
            warnings: Vec::new(),
        };
        let mut watch = Watch::start(2.0, 1.0, true);
        watch.step(&progress);
        watch.end(true);
        let text = message(&progress, 2.0, 1.0, 10, Duration::from_secs(2));
        assert_eq!(text, "t 1.5000 of 2 s, 5.0 steps/s, 0.250 × real time, 7 CG iterations, kinetic energy 2.500e-1 J");
    }
}
