//! The values of a variation.
//!
//! A range is `from, from ∘ step, …`, where ∘ adds or multiplies; value i is computed from `from` and not from value
//! i − 1, so that rounding does not add up: `from + i step`, `from factorⁱ`.
//!
//! A Latin hypercube (McKay, Beckman, Conover: A comparison of three methods for selecting values of input variables,
//! Technometrics 21, 1979) cuts the range of every parameter into as many strata as there are samples and takes one
//! value of each, in an order drawn for each parameter.

use crate::group::Variation;

/// More values of one parameter are taken for a mistake.
pub const VALUES_AT_MOST: usize = 10_000;

/// Part of a step by which a value may miss the bound through rounding.
const ROUNDING: f64 = 1e-9;

/// Where a range ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Its last value is the last one that does not pass the bound.
    Within,
    /// Its last value is the first one that reaches or passes the bound; there is always one.
    Reaching,
}

/// The values of a range.
///
/// # Errors
///
/// In words, when they would never end, when there is none, or when there are more than [`VALUES_AT_MOST`].
pub fn range(variation: Variation, end: End) -> Result<Vec<f64>, String> {
    let (from, to) = match variation {
        Variation::Adding { from, to, .. } | Variation::Multiplying { from, to, .. } => (from, to),
        Variation::List | Variation::LatinHypercube { .. } => return Ok(Vec::new()),
    };
    if to < from && end == End::Within {
        return Err(format!("the range ends at {to}, before its first value {from}; exchange them"));
    }
    if to <= from {
        return Ok(vec![from]);
    }
    let at = |i: usize| match variation {
        Variation::Adding { step, .. } => from + i as f64 * step,
        Variation::Multiplying { factor, .. } => from * factor.powi(i as i32),
        Variation::List | Variation::LatinHypercube { .. } => from,
    };
    if at(1) <= from {
        return Err(match variation {
            Variation::Adding { step, .. } => {
                format!("adding {step} never leads from {from} to {to}; give a step greater than 0")
            }
            _ => format!(
                "multiplying {from} never leads to {to} with this factor; start above 0 with a factor greater than 1"
            ),
        });
    }
    let mut values = Vec::new();
    for i in 0..=VALUES_AT_MOST {
        let value = at(i);
        let near = ROUNDING * (at(i + 1) - value);
        if end == End::Within && value > to + near {
            return Ok(values);
        }
        values.push(value);
        if value >= to - near {
            return Ok(values);
        }
    }
    Err(format!("the range has more than {VALUES_AT_MOST} values; take a larger step"))
}

/// `samples` values in [low, high], one of each stratum; parameter number `dimension` of the hypercube with this seed.
pub fn latin_hypercube(low: f64, high: f64, samples: usize, seed: u64, dimension: usize) -> Vec<f64> {
    let mut random = Random(seed ^ (dimension as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03));
    let mut strata: Vec<usize> = (0..samples).collect();
    for i in (1..samples).rev() {
        strata.swap(i, (random.next() % (i as u64 + 1)) as usize);
    }
    let within = |random: &mut Random| (random.next() >> 11) as f64 / (1u64 << 53) as f64;
    strata.iter().map(|&k| low + (high - low) * (k as f64 + within(&mut random)) / samples as f64).collect()
}

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014): the same numbers on
/// every machine and with every version of this program.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A range adds or multiplies, and ends within its bound or with the first value that reaches it.
    #[test]
    fn ranges_end_where_they_say() {
        let adding = |from, to, step| Variation::Adding { from, to, step };
        let multiplying = Variation::Multiplying { from: 40.0, to: 200.0, factor: 2.0 };
        assert_eq!(range(multiplying, End::Reaching), Ok(vec![40.0, 80.0, 160.0, 320.0]));
        assert_eq!(range(multiplying, End::Within), Ok(vec![40.0, 80.0, 160.0]));
        assert_eq!(range(adding(1.2, 0.0, 0.5), End::Reaching), Ok(vec![1.2]));
        let tenths = range(adding(0.0, 1.0, 0.1), End::Within).unwrap();
        assert_eq!((tenths.len(), range(adding(0.0, 1.0, 0.1), End::Reaching).unwrap()), (11, tenths));
        assert_eq!(range(adding(1.0, 10.0, 4.0), End::Within), Ok(vec![1.0, 5.0, 9.0]));
    }

    /// A range that would never end, or have no value, is refused.
    #[test]
    fn endless_ranges_are_refused() {
        for (variation, said) in [
            (Variation::Adding { from: 0.0, to: 1.0, step: 0.0 }, "greater than 0"),
            (Variation::Multiplying { from: 0.0, to: 1.0, factor: 2.0 }, "above 0"),
            (Variation::Multiplying { from: 1.0, to: 2.0, factor: 1.0 }, "above 0"),
            (Variation::Adding { from: 0.0, to: 1.0, step: 1e-9 }, "larger step"),
            (Variation::Adding { from: 2.0, to: 1.0, step: 1.0 }, "exchange"),
        ] {
            let refusal = range(variation, End::Within).unwrap_err();
            assert!(refusal.contains(said), "{refusal}");
        }
    }

    /// Every stratum of every parameter is met exactly once; another seed or parameter gives another order.
    #[test]
    fn a_hypercube_meets_every_stratum() {
        let column = |seed, dimension| latin_hypercube(10.0, 20.0, 10, seed, dimension);
        for (seed, dimension) in [(0, 0), (1, 0), (1, 1), (99, 5)] {
            let mut strata: Vec<i64> = column(seed, dimension).iter().map(|x| x.floor() as i64).collect();
            strata.sort_unstable();
            assert_eq!(strata, (10..20).collect::<Vec<_>>());
        }
        assert_eq!(column(1, 0), column(1, 0));
        assert_ne!(column(1, 0), column(2, 0));
        assert_ne!(column(1, 0), column(1, 1));
    }
}
