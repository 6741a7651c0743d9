//! Ranges of numbers, with ends that belong to them or not.

use std::fmt;

/// An end of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// The value itself is not allowed.
    Open(f64),
    /// The value itself is allowed.
    Closed(f64),
    /// No limit, but zero is not allowed.
    NonZero,
}

/// A range of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least value; `None` for no limit.
    pub minimum: Option<Bound>,
    /// Largest value; `None` for no limit.
    pub maximum: Option<Bound>,
}

impl Range {
    /// Every finite number.
    pub const ANY: Range = Range { minimum: None, maximum: None };
    /// x > 0.
    pub const POSITIVE: Range = Range { minimum: Some(Bound::Open(0.0)), maximum: None };
    /// x ≥ 0.
    pub const NOT_NEGATIVE: Range = Range { minimum: Some(Bound::Closed(0.0)), maximum: None };
    /// 0 < x < 1.
    pub const INSIDE_UNIT: Range = Range { minimum: Some(Bound::Open(0.0)), maximum: Some(Bound::Open(1.0)) };
    /// 0 < x ≤ 1.
    pub const FRACTION: Range = Range { minimum: Some(Bound::Open(0.0)), maximum: Some(Bound::Closed(1.0)) };

    /// From `least` to `most`, both allowed.
    pub const fn closed(least: f64, most: f64) -> Range {
        Range { minimum: Some(Bound::Closed(least)), maximum: Some(Bound::Closed(most)) }
    }

    /// From `least` on.
    pub const fn at_least(least: f64) -> Range {
        Range { minimum: Some(Bound::Closed(least)), maximum: None }
    }

    /// Whether the value lies in the range; NaN never does.
    pub fn contains(&self, x: f64) -> bool {
        let above = match self.minimum {
            None => !x.is_nan(),
            Some(Bound::Open(least)) => x > least,
            Some(Bound::Closed(least)) => x >= least,
            Some(Bound::NonZero) => x != 0.0 && !x.is_nan(),
        };
        let below = match self.maximum {
            None => !x.is_nan(),
            Some(Bound::Open(most)) => x < most,
            Some(Bound::Closed(most)) => x <= most,
            Some(Bound::NonZero) => x != 0.0 && !x.is_nan(),
        };
        above && below
    }

    /// "greater than 0 Pa and less than 5 Pa".
    pub fn in_words(&self, unit: &str) -> String {
        let with_unit = |x: f64| if unit.is_empty() { format!("{x}") } else { format!("{x} {unit}") };
        let least = self.minimum.map(|bound| match bound {
            Bound::Open(x) => format!("greater than {}", with_unit(x)),
            Bound::Closed(x) => format!("at least {}", with_unit(x)),
            Bound::NonZero => "other than 0".to_owned(),
        });
        let most = self.maximum.map(|bound| match bound {
            Bound::Open(x) => format!("less than {}", with_unit(x)),
            Bound::Closed(x) => format!("at most {}", with_unit(x)),
            Bound::NonZero => "other than 0".to_owned(),
        });
        match (least, most) {
            (Some(least), Some(most)) => format!("{least} and {most}"),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => "finite".to_owned(),
        }
    }
}

/// `> 0`, `≥ 0, ≤ 1`, or nothing.
impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let least = self.minimum.map(|bound| match bound {
            Bound::Open(x) => format!("> {x}"),
            Bound::Closed(x) => format!("≥ {x}"),
            Bound::NonZero => "≠ 0".to_owned(),
        });
        let most = self.maximum.map(|bound| match bound {
            Bound::Open(x) => format!("< {x}"),
            Bound::Closed(x) => format!("≤ {x}"),
            Bound::NonZero => "≠ 0".to_owned(),
        });
        f.write_str(&least.into_iter().chain(most).collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_ends_are_excluded_and_closed_ends_included() {
        let range = Range { minimum: Some(Bound::Open(-1.0)), maximum: Some(Bound::Closed(0.5)) };
        assert!(!range.contains(-1.0) && range.contains(-0.999) && range.contains(0.5) && !range.contains(0.501));
        assert!(!range.contains(f64::NAN) && !Range::ANY.contains(f64::NAN));
        assert_eq!(range.in_words("Pa"), "greater than -1 Pa and at most 0.5 Pa");
        assert_eq!(range.to_string(), "> -1, ≤ 0.5");
    }

    #[test]
    fn zero_alone_can_be_excluded() {
        let range = Range { minimum: Some(Bound::NonZero), maximum: None };
        assert!(range.contains(-1e-300) && range.contains(2.0) && !range.contains(0.0) && !range.contains(-0.0));
        assert!(!range.contains(f64::NAN));
        assert_eq!((range.in_words(""), range.to_string()), ("other than 0".to_owned(), "≠ 0".to_owned()));
    }
}
