//! Chance that can be repeated: what a test draws follows from its seed.

use std::time::SystemTime;

/// A whole number from the environment.
pub(crate) fn variable(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|n| n.parse().ok())
}

/// The seed: `SOUPLE_SEED` repeats another test, otherwise the clock decides.
pub(crate) fn seed() -> u64 {
    let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_nanos() as u64;
    variable("SOUPLE_SEED").unwrap_or(clock)
}

/// The next of a sequence of numbers from 0 to 1 (splitmix64: Steele, Lea and Flood 2014).
pub(crate) fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / 2f64.powi(64)
}

/// The numbers below `count` in a random order, the first and about every third of the others a second time somewhere.
pub(crate) fn shuffled(count: usize, state: &mut u64) -> Vec<usize> {
    let again: Vec<usize> = (0..count).filter(|&n| n == 0 || uniform(state) < 0.33).collect();
    let mut all: Vec<usize> = (0..count).chain(again).collect();
    for last in (1..all.len()).rev() {
        all.swap(last, (uniform(state) * (last + 1) as f64) as usize);
    }
    all
}
