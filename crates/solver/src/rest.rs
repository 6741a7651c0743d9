//! Has it come to rest? Watches the mean kinetic energy of a moving system.
//!
//! ```text
//! Ē = ½ vᵀ M v / n     n: how many bodies, particles or other groups of unknowns share the energy
//! ```
//!
//! A drop has little kinetic energy when it begins to fall: energy that grows and was never above the threshold is no rest.
//! A swing has none at its turning points: where that matters, several checks in a row must find it below the threshold
//! ([`RestMonitor::required_checks`]).

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
    /// Whether a look found it above the threshold.
    pub moved: bool,
    /// The mean kinetic energy of the last look in joules.
    pub last: f64,
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
        Self {
            mean_kinetic_energy,
            check_every,
            required_checks: 1,
            next_check: check_every,
            quiet_checks: 0,
            moved: false,
            last: 0.0,
        }
    }

    /// Begins to watch at a time, in seconds, at which the mean kinetic energy is known, in joules: at the start, and
    /// where a run goes on. Checks fall on the times on which they would have fallen without it.
    pub fn begin(&mut self, t: f64, energy: f64) {
        self.next_check = self.after(t);
        (self.quiet_checks, self.moved, self.last) = (0, energy > self.mean_kinetic_energy, energy);
    }

    /// The first multiple of the interval after a time.
    fn after(&self, t: f64) -> f64 {
        // Times are sums of steps and miss multiples of the interval by rounding.
        let slack = 1e-9 * self.check_every;
        if self.check_every > 0.0 { (((t + slack) / self.check_every).floor() + 1.0) * self.check_every } else { t }
    }

    /// Checks if it is time to; `energy` computes the mean kinetic energy in joules and is called only then.
    pub fn check(&mut self, t: f64, energy: impl FnOnce() -> f64) -> Rest {
        let slack = 1e-9 * self.check_every;
        if t < self.next_check - slack {
            return Rest::NotDue;
        }
        self.next_check = self.after(t);
        let energy = energy();
        let begins_to_move = !self.moved && energy > self.last;
        self.moved |= energy > self.mean_kinetic_energy;
        self.last = energy;
        // Written so that a NaN counts as motion.
        if energy <= self.mean_kinetic_energy && !begins_to_move {
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

    /// What begins to move is not at rest, however little energy it has yet; what loses energy without ever having had
    /// much is, and so is what has none.
    #[test]
    fn beginning_to_move_is_not_rest() {
        let at_rest = |energies: &[f64]| {
            let mut monitor = RestMonitor::new(1.0, 0.1);
            let check = |(k, e): (usize, &f64)| matches!(monitor.check(0.1 * (k + 1) as f64, || *e), Rest::AtRest(_));
            energies.iter().enumerate().map(check).collect::<Vec<bool>>()
        };
        assert_eq!(at_rest(&[0.2, 0.8, 1.8, 0.6, 0.7]), [false, false, false, true, true]);
        assert_eq!(at_rest(&[0.2, 0.3, 0.1]), [false, false, true]);
        assert_eq!(at_rest(&[0.0, 0.0]), [true, true]);
    }

    /// A watch that begins again at some time checks when the first one would have, and knows what it begins with.
    #[test]
    fn going_on_keeps_the_times_of_checks() {
        let mut monitor = RestMonitor::new(1.0, 0.1);
        monitor.begin(0.57, 0.5);
        assert_eq!(monitor.check(0.58, || panic!("asked too early")), Rest::NotDue);
        assert_eq!(monitor.check(0.6, || 0.4), Rest::AtRest(0.4));
        monitor.begin(0.6, 3.0);
        assert_eq!(monitor.check(0.69, || panic!("asked too early")), Rest::NotDue);
        assert_eq!(monitor.check(0.7, || 0.9), Rest::AtRest(0.9));
    }

    /// An energy that is not a number is never rest.
    #[test]
    fn not_a_number_is_not_rest() {
        let mut monitor = RestMonitor::new(1.0, 0.1);
        assert!(matches!(monitor.check(0.1, || f64::NAN), Rest::Moving(_)));
    }
}
