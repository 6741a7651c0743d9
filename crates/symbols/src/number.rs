//! Constants: exact fractions as long as they fit, floating point when they do not or when they started so.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

/// A constant of the graph.
///
/// Arithmetic on fractions is exact; a result whose numerator or denominator leaves 64 bits becomes a [`Number::Real`].
#[derive(Clone, Copy, Debug)]
pub enum Number {
    /// `numerator / denominator` in lowest terms with a positive denominator.
    Rational(i64, i64),
    /// A floating-point constant, never NaN.
    Real(f64),
}

impl Number {
    /// Zero.
    pub const ZERO: Number = Number::Rational(0, 1);
    /// One.
    pub const ONE: Number = Number::Rational(1, 1);
    /// Minus one.
    pub const MINUS_ONE: Number = Number::Rational(-1, 1);

    /// The fraction `n / d`; `d` must not be zero.
    pub fn rational(n: i64, d: i64) -> Number {
        assert!(d != 0, "a fraction has a denominator");
        reduced(n.into(), d.into())
    }

    /// A constant from its floating-point value. It becomes exact if it is the nearest value to a fraction with a
    /// denominator below 400, or a multiple of 2⁻²⁰.
    pub fn from_f64(value: f64) -> Number {
        const SCALE: f64 = 1_048_576.0;
        let scaled = value * SCALE;
        if scaled.fract() == 0.0 && scaled.abs() < 1e15 {
            return reduced(scaled as i128, SCALE as i128);
        }
        if value.abs() < 1e6 {
            for denominator in 3..400 {
                let numerator = (value * f64::from(denominator)).round();
                if numerator / f64::from(denominator) == value {
                    return reduced(numerator as i128, denominator.into());
                }
            }
        }
        Number::Real(value)
    }

    /// The result of floating-point arithmetic: exact only where it came out as a whole or dyadic number.
    fn rounded(value: f64) -> Number {
        const SCALE: f64 = 1_048_576.0;
        let scaled = value * SCALE;
        if scaled.fract() == 0.0 && scaled.abs() < 1e15 {
            reduced(scaled as i128, SCALE as i128)
        } else {
            Number::Real(value)
        }
    }

    /// The nearest floating-point value.
    pub fn to_f64(self) -> f64 {
        match self {
            Number::Rational(n, d) => n as f64 / d as f64,
            Number::Real(x) => x,
        }
    }

    /// Whether it is exactly zero.
    pub fn is_zero(self) -> bool {
        self == Number::ZERO || self.to_f64() == 0.0
    }

    /// Whether it is exactly one.
    pub fn is_one(self) -> bool {
        self == Number::ONE
    }

    /// Whether it is below zero.
    pub fn is_negative(self) -> bool {
        self.to_f64() < 0.0
    }

    /// The same without its sign.
    pub fn abs(self) -> Number {
        if self.is_negative() { -self } else { self }
    }

    /// `1 / self`; `None` for zero.
    pub fn recip(self) -> Option<Number> {
        match self {
            Number::Rational(0, _) => None,
            Number::Rational(n, d) => Some(reduced(d.into(), n.into())),
            Number::Real(x) => (x != 0.0).then(|| Number::rounded(1.0 / x)),
        }
    }

    /// `self` to an integer power; `None` for zero to a negative power.
    pub fn powi(self, exponent: i32) -> Option<Number> {
        let base = if exponent < 0 { self.recip()? } else { self };
        Some((0..exponent.unsigned_abs()).fold(Number::ONE, |product, _| product * base))
    }
}

fn reduced(n: i128, d: i128) -> Number {
    let divisor = gcd(n.unsigned_abs(), d.unsigned_abs()).max(1) as i128;
    let sign = if d < 0 { -1 } else { 1 };
    let (n, d) = (sign * n / divisor, sign * d / divisor);
    match (i64::try_from(n), i64::try_from(d)) {
        (Ok(n), Ok(d)) => Number::Rational(n, d),
        _ => Number::Real(n as f64 / d as f64),
    }
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl std::ops::Add for Number {
    type Output = Number;
    fn add(self, other: Number) -> Number {
        match (self, other) {
            (Number::Rational(a, b), Number::Rational(c, d)) => {
                let (a, b, c, d) = (i128::from(a), i128::from(b), i128::from(c), i128::from(d));
                match (a * d).checked_add(c * b) {
                    Some(n) => reduced(n, b * d),
                    None => Number::Real(self.to_f64() + other.to_f64()),
                }
            }
            _ => Number::rounded(self.to_f64() + other.to_f64()),
        }
    }
}

impl std::ops::Mul for Number {
    type Output = Number;
    fn mul(self, other: Number) -> Number {
        match (self, other) {
            (Number::Rational(a, b), Number::Rational(c, d)) => {
                reduced(i128::from(a) * i128::from(c), i128::from(b) * i128::from(d))
            }
            _ if self.is_zero() || other.is_zero() => Number::ZERO,
            _ => Number::rounded(self.to_f64() * other.to_f64()),
        }
    }
}

impl std::ops::Neg for Number {
    type Output = Number;
    fn neg(self) -> Number {
        match self {
            Number::Rational(n, d) => reduced(-i128::from(n), d.into()),
            Number::Real(x) => Number::Real(-x),
        }
    }
}

impl PartialEq for Number {
    fn eq(&self, other: &Number) -> bool {
        match (self, other) {
            (Number::Rational(a, b), Number::Rational(c, d)) => (a, b) == (c, d),
            (Number::Real(x), Number::Real(y)) => x.to_bits() == y.to_bits(),
            _ => false,
        }
    }
}

impl Eq for Number {}

impl Hash for Number {
    fn hash<H: Hasher>(&self, state: &mut H) {
        match self {
            Number::Rational(n, d) => (n, d).hash(state),
            Number::Real(x) => x.to_bits().hash(state),
        }
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Number) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Number {
    fn cmp(&self, other: &Number) -> Ordering {
        self.to_f64().total_cmp(&other.to_f64())
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::Rational(n, 1) => write!(f, "{n}"),
            Number::Rational(n, d) => write!(f, "{n}/{d}"),
            Number::Real(x) => write!(f, "{x:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fractions stay exact and reduced.
    #[test]
    fn fractions_are_exact() {
        let third = Number::rational(2, 6);
        assert_eq!(third, Number::Rational(1, 3));
        assert_eq!(third + third + third, Number::ONE);
        assert_eq!(Number::rational(1, -2), Number::Rational(-1, 2));
        assert_eq!(Number::rational(-2, 3).powi(-3), Some(Number::Rational(-27, 8)));
        assert_eq!(Number::ZERO.powi(-1), None);
    }

    /// Overflow degrades to floating point instead of wrapping.
    #[test]
    fn overflow_becomes_real() {
        let big = Number::Rational(i64::MAX, 1);
        assert_eq!((big * big).to_f64(), (i64::MAX as f64) * (i64::MAX as f64));
        assert_eq!((-Number::Rational(i64::MIN, 1)).to_f64(), -(i64::MIN as f64));
    }

    /// Floating-point values that stand for simple fractions are recognised, others are kept bit for bit.
    #[test]
    fn dyadic_values_are_exact() {
        assert_eq!(Number::from_f64(-0.375), Number::Rational(-3, 8));
        assert_eq!(Number::from_f64(1.0 / 6.0), Number::Rational(1, 6));
        let root = 1.0 / 3.0_f64.sqrt();
        assert_eq!(Number::from_f64(root), Number::Real(root));
    }
}
