//! Has it come to rest? Watches the mean kinetic energy of a moving system.
//!
//! ```text
//! Ē = ½ vᵀ M v / n     n: how many bodies, particles or other groups of unknowns share the energy
//! ```
//!
//! A swing has no kinetic energy at its turning points, and a drop has none before it falls: what counts is several
//! checks in a row below the threshold ([`RestMonitor::required_checks`]).

use crate::second_order::SecondOrder;
use crate::vector::{Serial, VectorOps};

/// The watch. Plain data: part of a snapshot where a run must resume with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct RestMonitor {
    /// At rest below this mean kinetic energy, in joules per group.
    pub mean_kinetic_energy: f64,
    /// Seconds between checks.
    pub check_every: f64,
    /// Checks in a row that must find it below the threshold.
    pub required_checks: u32,
    /// Time of the next check in seconds.
    pub next_check: f64,
    /// Checks in a row that found it below so far.
    pub quiet_checks: u32,
}

/// What a look at the watch says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rest {
    /// It is not yet time to check.
    NotDue,
    /// It moves, or has not been quiet for long enough; with the mean kinetic energy in joules.
    Moving(f64),
    /// It is at rest; with the mean kinetic energy in joules.
    AtRest(f64),
}

impl RestMonitor {
    /// A watch that checks first after one interval and is content with one quiet check.
    pub fn new(mean_kinetic_energy: f64, check_every: f64) -> Self {
        Self { mean_kinetic_energy, check_every, required_checks: 1, next_check: check_every, quiet_checks: 0 }
    }

    /// Checks if it is time to; `energy` computes the mean kinetic energy in joules and is called only then.
    pub fn check(&mut self, t: f64, energy: impl FnOnce() -> f64) -> Rest {
        // Times are sums of steps and miss multiples of the interval by rounding.
        let slack = 1e-9 * self.check_every;
        if t < self.next_check - slack {
            return Rest::NotDue;
        }
        self.next_check = if self.check_every > 0.0 {
            (((t + slack) / self.check_every).floor() + 1.0) * self.check_every
        } else {
            t
        };
        let energy = energy();
        // Written so that a NaN counts as motion.
        if energy <= self.mean_kinetic_energy {
            self.quiet_checks += 1;
        } else {
            self.quiet_checks = 0;
        }
        if self.quiet_checks >= self.required_checks.max(1) { Rest::AtRest(energy) } else { Rest::Moving(energy) }
    }
}

/// ½ vᵀ M v in joules; `scratch` has the length of v.
pub fn kinetic_energy(system: &mut dyn SecondOrder, v: &[f64], scratch: &mut [f64]) -> f64 {
    system.mass_apply(v, scratch);
    0.5 * Serial.dot(v, scratch)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Energy is asked for once per interval, however the steps fall, and a single fast check starts the count again.
    #[test]
    fn checks_every_so_often() {
        let mut monitor = RestMonitor { required_checks: 2, ..RestMonitor::new(1e-3, 0.05) };
        let (mut t, mut asked, mut rest_at) = (0.0, 0, None);
        for k in 1..=100 {
            t += 0.01;
            // Quiet at the first check and from 0.4 s on.
            let energy = if k <= 5 || t > 0.395 { 1e-4 } else { 1.0 };
            let answer = monitor.check(t, || {
                asked += 1;
                energy
            });
            if matches!(answer, Rest::AtRest(_)) && rest_at.is_none() {
                rest_at = Some(k);
            }
        }
        assert_eq!(asked, 20);
        assert_eq!(rest_at, Some(45), "quiet at 0.40 s and 0.45 s");
    }

    /// An energy that is not a number is never rest.
    #[test]
    fn not_a_number_is_not_rest() {
        let mut monitor = RestMonitor::new(1.0, 0.1);
        assert!(matches!(monitor.check(0.1, || f64::NAN), Rest::Moving(_)));
    }
}
