//! `[time]`: step, end, and stopping at rest.

use serde::Serialize;

use crate::dimension::Dimension;
use crate::error::Problem;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

/// How long is simulated, and in which steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Time {
    /// Time step (s), positive.
    pub step: Spanned<f64>,
    /// End (s), at least one step.
    pub end: Spanned<f64>,
    /// When to stop earlier.
    pub stop: Option<Spanned<Stop>>,
}

/// Stop when at rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stop {
    /// Kinetic energy per node (J) under which the bodies are at rest.
    pub mean_kinetic_energy: f64,
    /// Time between two checks (s); `None` checks after every step.
    pub check_every: Option<f64>,
}

pub(crate) static TIME: Section = Section {
    header: "[time]",
    about: "how long is simulated, and in which steps",
    keys: &[
        Key {
            name: "step",
            kind: Kind::Number(Dimension::TIME, Range::POSITIVE),
            presence: Presence::Required,
            about: "time step",
        },
        Key {
            name: "end",
            kind: Kind::Number(Dimension::TIME, Range::POSITIVE),
            presence: Presence::Required,
            about: "when the simulation ends; at least one step",
        },
        Key {
            name: "stop",
            kind: Kind::Table(&STOP),
            presence: Presence::Optional("run to the end"),
            about: "when to stop earlier",
        },
    ],
    other_keys: None,
};

static STOP: Section = Section {
    header: "[time.stop]",
    about: "stop when at rest",
    keys: &[
        Key {
            name: "mean_kinetic_energy",
            kind: Kind::Number(Dimension::ENERGY, Range::POSITIVE),
            presence: Presence::Required,
            about: "at rest when the kinetic energy per node is below this, but not while it grows without ever having been above",
        },
        Key {
            name: "check_every",
            kind: Kind::Number(Dimension::TIME, Range::POSITIVE),
            presence: Presence::Optional("after every step"),
            about: "time between two checks",
        },
    ],
    other_keys: None,
};

impl Time {
    /// Number of steps: the whole number nearest to end / step, at least 1.
    pub fn step_count(&self) -> u64 {
        // `as` saturates; a scene with 2⁶⁴ steps never ends either way.
        ((self.end.value / self.step.value).round() as u64).max(1)
    }
}

impl Reader<'_> {
    pub(crate) fn time(&mut self, fields: &Fields<'_>) -> Option<Time> {
        let (step, end) = (self.number(fields, "step"), self.number(fields, "end"));
        let stop = self.table(fields, "stop").map(|stop| self.stop(&stop));
        let time = Time { step: step?, end: end?, stop: stop.flatten() };
        let (step, end) = (time.step.value, time.end.value);
        if end < step {
            let problem = Problem::OutOfRange {
                key: "end".to_owned(),
                expected: format!("at least one step of {step} s"),
                found: format!("{end} s"),
                hint: None,
            };
            self.error(time.end.at.clone(), problem);
            return None;
        }
        let steps = time.step_count();
        if ((steps as f64) * step / end - 1.0).abs() > 1e-9 {
            let reached = steps as f64 * step;
            let message = format!("`end` is not a whole number of steps; {steps} steps end at {reached} s");
            self.warn(time.end.at.clone(), message);
        }
        Some(time)
    }

    fn stop(&mut self, fields: &Fields<'_>) -> Option<Spanned<Stop>> {
        let (energy, every) = (self.number(fields, "mean_kinetic_energy"), self.number(fields, "check_every"));
        let stop = Stop { mean_kinetic_energy: energy?.value, check_every: every.map(|every| every.value) };
        Some(Spanned::new(stop, fields.at.clone()))
    }
}
