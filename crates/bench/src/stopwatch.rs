//! Rounds of short runs, and their median.
//!
//! On a machine that others use as well, a long run is interrupted and a mean belongs to nobody. So a *sample* is short
//! (a few hundred microseconds, less than a scheduler's slice), there are many of them, and what is reported is their
//! median with the quartiles. Contenders take turns in every round, so that a slow minute is slow for all of them, and
//! ratios are formed within a round.

use serde::Serialize;
use std::time::{Duration, Instant};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Number of rounds; at least 1.
    pub rounds: usize,
    /// Length of one sample.
    pub sample: Duration,
}

impl Default for Effort {
    fn default() -> Effort {
        Effort { rounds: 41, sample: Duration::from_micros(300) }
    }
}

/// The middle of many samples, and how far they spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the samples are below.
    pub median: f64,
    /// The least sample: what the work takes when nothing else wants the processor.
    pub least: f64,
    /// A quarter of the samples is below.
    pub lower_quartile: f64,
    /// A quarter of the samples is above.
    pub upper_quartile: f64,
    /// Number of samples.
    pub rounds: usize,
}

impl Spread {
    /// Of these samples, in any order.
    ///
    /// # Panics
    /// When there is none.
    pub fn of(samples: &[f64]) -> Spread {
        let at = |fraction| quantile(samples, fraction);
        Spread {
            median: at(0.5),
            least: at(0.0),
            lower_quartile: at(0.25),
            upper_quartile: at(0.75),
            rounds: samples.len(),
        }
    }
}

/// The sample below which this fraction of the samples lies, without interpolation.
///
/// # Panics
/// When there is none.
pub fn quantile(samples: &[f64], fraction: f64) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[((sorted.len() - 1) as f64 * fraction).round() as usize]
}

/// Something that can be run again and again.
pub type Contender<'a> = &'a mut dyn FnMut();

/// Seconds per call of each contender, [contender][round]; contenders take turns within each round.
///
/// Each is called as often per sample as fits into it, found out before the rounds begin (which warms caches, and
/// compiles what compiles when first called).
pub fn race(effort: Effort, contenders: &mut [Contender<'_>]) -> Vec<Vec<f64>> {
    let calls: Vec<u32> = contenders.iter_mut().map(|c| calls_in(effort.sample, c)).collect();
    let mut samples = vec![Vec::with_capacity(effort.rounds); contenders.len()];
    for _ in 0..effort.rounds.max(1) {
        for ((contender, &calls), samples) in contenders.iter_mut().zip(&calls).zip(&mut samples) {
            samples.push(seconds(calls, contender) / f64::from(calls));
        }
    }
    samples
}

/// Seconds that this many calls take.
fn seconds(calls: u32, contender: &mut Contender<'_>) -> f64 {
    let start = Instant::now();
    for _ in 0..calls {
        contender();
    }
    start.elapsed().as_secs_f64()
}

/// How many calls fit into a sample; at least one.
fn calls_in(sample: Duration, contender: &mut Contender<'_>) -> u32 {
    seconds(1, contender);
    let mut calls = 1;
    loop {
        // The least of three, because an interruption only ever adds.
        let taken = (0..3).map(|_| seconds(calls, contender)).fold(f64::INFINITY, f64::min);
        if 2.0 * taken > sample.as_secs_f64() || calls > u32::MAX / 4 {
            return calls;
        }
        calls *= 2;
    }
}

/// Ratios `numerator / denominator`, round by round.
pub fn ratio(numerator: &[f64], denominator: &[f64]) -> Spread {
    let ratios: Vec<f64> = numerator.iter().zip(denominator).map(|(n, d)| n / d).collect();
    Spread::of(&ratios)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Median and quartiles are samples themselves, whatever the order of the samples.
    #[test]
    fn quartiles_are_samples() {
        let spread = Spread::of(&[5.0, 1.0, 4.0, 2.0, 3.0]);
        let found = [spread.least, spread.lower_quartile, spread.median, spread.upper_quartile];
        assert_eq!(found, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(spread.rounds, 5);
    }

    /// Every contender is called in every round, and one sample per round is kept.
    #[test]
    fn contenders_take_turns() {
        let (mut first, mut second) = (0u64, 0u64);
        let effort = Effort { rounds: 4, sample: Duration::ZERO };
        let samples = race(effort, &mut [&mut || first += 1, &mut || second += 1]);
        assert_eq!(samples.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
        assert!(first >= 4 && second >= 4);
    }
}
