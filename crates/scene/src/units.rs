//! Numbers with units: `"4 kPa"`, `"1 g/cm^3"`, `"9.81 m/s^2"`, `"30 deg"`.
//!
//! ```text
//! quantity = number unit
//! unit     = power (('*' | '·' | ' ' | '/') power)*      each '/' divides by the one power that follows it
//! power    = (prefix? name | '1' | '(' unit ')') (('^' | '**') integer | superscript)?
//! ```
//!
//! A name is looked up as it stands before a prefix is split off: `min` is a minute, never a milli-inch.
//! Not a unit converter for everything: only units of mechanics, no offsets (temperatures).

use crate::dimension::{Dimension, Exponents};
use crate::suggestion::nearest;

/// Why a text is not a quantity of the expected dimension.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("`{text}` does not start with a number; write for example \"{example}\"")]
    NoNumber {
        /// The text.
        text: String,
        /// A value of the expected dimension.
        example: &'static str,
    },
    /// A number in quotes without a unit.
    #[error("`{text}` has no unit; write the number without quotes for {unit}, or with its unit as in \"{example}\"")]
    NoUnit {
        /// The text.
        text: String,
        /// Unit of plain numbers here.
        unit: String,
        /// A value of the expected dimension.
        example: &'static str,
    },
    /// A name that is no unit.
    #[error("unknown unit `{unit}`{}", crate::error::did_you_mean(.nearest.as_deref()))]
    UnknownUnit {
        /// The name.
        unit: String,
        /// The most similar unit.
        nearest: Option<String>,
    },
    /// The unit is not written as products of powers.
    #[error("cannot read the unit `{unit}`: {reason}; write for example \"{example}\"")]
    Malformed {
        /// The unit's text.
        unit: String,
        /// What is wrong with it.
        reason: &'static str,
        /// A value of the expected dimension.
        example: &'static str,
    },
    /// Another dimension than expected.
    #[error("expected {} such as \"{}\", found `{text}`, which is {found}", .expected.with_article(), .expected.example)]
    WrongDimension {
        /// The text.
        text: String,
        /// What was expected.
        expected: Dimension,
        /// What was found: "a length".
        found: String,
    },
}

/// A unit as a multiple, `mantissa · 10^tens`, of the scene's unit (SI, degrees), and its dimension.
///
/// Why not one factor? 5 mm is then 5/1000 m, the double nearest to 0.005; 5 · 0.001 need not be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The factor without its power of ten.
    pub mantissa: f64,
    /// The power of ten.
    pub tens: i32,
    /// Exponents of kg, m, s and degree.
    pub exponents: Exponents,
}

impl Unit {
    /// A number in this unit, in kg, m, s and degrees.
    pub fn value(&self, number: f64) -> f64 {
        let number = number * self.mantissa;
        if self.tens < 0 { number / 10f64.powi(-self.tens) } else { number * 10f64.powi(self.tens) }
    }
}

/// Units that take an SI prefix: name, factor, exponents.
const PREFIXED: &[(&str, f64, i32, Exponents)] = &[
    ("m", 1.0, 0, [0, 1, 0, 0]),
    ("g", 1.0, -3, [1, 0, 0, 0]),
    ("s", 1.0, 0, [0, 0, 1, 0]),
    ("N", 1.0, 0, [1, 1, -2, 0]),
    ("Pa", 1.0, 0, [1, -1, -2, 0]),
    ("J", 1.0, 0, [1, 2, -2, 0]),
    ("W", 1.0, 0, [1, 2, -3, 0]),
    ("Hz", 1.0, 0, [0, 0, -1, 0]),
    ("rad", 180.0 / std::f64::consts::PI, 0, [0, 0, 0, 1]),
    ("bar", 1.0, 5, [1, -1, -2, 0]),
    ("l", 1.0, -3, [0, 3, 0, 0]),
    ("L", 1.0, -3, [0, 3, 0, 0]),
];

/// Units that stand alone.
const PLAIN: &[(&str, f64, i32, Exponents)] = &[
    ("deg", 1.0, 0, [0, 0, 0, 1]),
    ("°", 1.0, 0, [0, 0, 0, 1]),
    ("min", 60.0, 0, [0, 0, 1, 0]),
    ("h", 3600.0, 0, [0, 0, 1, 0]),
    ("t", 1.0, 3, [1, 0, 0, 0]),
    // Millimetre of mercury: 13 595.1 kg/m³ × 9.806 65 m/s² × 1 mm.
    ("mmHg", 133.322387415, 0, [1, -1, -2, 0]),
    ("atm", 101325.0, 0, [1, -1, -2, 0]),
    ("in", 254.0, -4, [0, 1, 0, 0]),
    ("%", 1.0, -2, [0, 0, 0, 0]),
];

const PREFIXES: &[(&str, i32)] = &[
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

/// The names of units, without prefixes, for documentation.
pub fn unit_names() -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    let names = |table: &[(&'static str, f64, i32, Exponents)]| table.iter().map(|u| u.0).collect();
    (names(PREFIXED), names(PLAIN), PREFIXES.iter().map(|p| p.0).collect())
}

/// Reads `"4 kPa"` as a value in the unit of `expected` (SI, degrees for angles).
///
/// # Errors
///
/// No number, no or an unknown unit, or a unit of another dimension.
/// The result may be infinite when the digits overflow; the caller checks for that together with plain numbers.
pub fn quantity(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let (number, unit) = split(text, expected)?;
    if unit.is_empty() && expected.exponents == [0; 4] {
        return Ok(number);
    }
    if unit.is_empty() {
        let unit = expected.unit.to_owned();
        return Err(UnitError::NoUnit { text: text.trim().to_owned(), unit, example: expected.example });
    }
    let found = unit_named(unit, expected)?;
    if found.exponents != expected.exponents {
        return Err(UnitError::WrongDimension {
            text: text.trim().to_owned(),
            expected,
            found: Dimension::describe(found.exponents),
        });
    }
    Ok(found.value(number))
}

/// Reads a quantity of any dimension, converted to SI units (degrees for angles).
///
/// # Errors
///
/// No number, or a unit that cannot be read.
pub fn quantity_of_any_dimension(text: &str) -> Result<f64, UnitError> {
    let (number, unit) = split(text, Dimension::PRESSURE)?;
    if unit.is_empty() { Ok(number) } else { Ok(unit_named(unit, Dimension::PRESSURE)?.value(number)) }
}

/// Reads a unit such as `"kg/m^3"`; the empty text and `"1"` are the unit of pure numbers.
///
/// # Errors
///
/// An unknown name or a text that is not a product of powers.
pub fn unit(text: &str) -> Result<Unit, UnitError> {
    if text.trim().is_empty() {
        return Ok(Unit { mantissa: 1.0, tens: 0, exponents: [0; 4] });
    }
    unit_named(text.trim(), Dimension::PRESSURE)
}

fn split(text: &str, expected: Dimension) -> Result<(f64, &str), UnitError> {
    let text = text.trim();
    let digits = number_length(text);
    match text[..digits].parse() {
        Ok(number) => Ok((number, text[digits..].trim())),
        Err(_) => Err(UnitError::NoNumber { text: text.to_owned(), example: expected.example }),
    }
}

/// Length of the longest prefix that is a decimal number with optional sign, fraction and exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut i: usize| {
        while bytes.get(i).is_some_and(u8::is_ascii_digit) {
            i += 1;
        }
        i
    };
    let mut end = digits(usize::from(matches!(bytes.first(), Some(b'+' | b'-'))));
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let start = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let stop = digits(start);
        // "2 e" without digits is a number followed by some word.
        if stop > start {
            end = stop;
        }
    }
    end
}

fn unit_named(text: &str, expected: Dimension) -> Result<Unit, UnitError> {
    let mut parser = UnitParser { text, chars: text.chars().collect(), at: 0, depth: 0, example: expected.example };
    let unit = parser.product()?;
    if parser.at < parser.chars.len() {
        return Err(parser.malformed("there is something after its end"));
    }
    if !unit.mantissa.is_normal() || unit.tens.abs() > 300 {
        return Err(parser.malformed("its powers are too large"));
    }
    Ok(unit)
}

struct UnitParser<'t> {
    text: &'t str,
    chars: Vec<char>,
    at: usize,
    depth: u32,
    example: &'static str,
}

impl UnitParser<'_> {
    fn malformed(&self, reason: &'static str) -> UnitError {
        UnitError::Malformed { unit: self.text.to_owned(), reason, example: self.example }
    }

    fn peek(&self) -> Option<char> {
        self.chars.get(self.at).copied()
    }

    fn skip_spaces(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
    }

    fn product(&mut self) -> Result<Unit, UnitError> {
        let mut result = self.power()?;
        loop {
            self.skip_spaces();
            let sign = match self.peek() {
                None | Some(')') => return Ok(result),
                Some('*' | '·' | '⋅') => {
                    self.at += 1;
                    1
                }
                Some('/') => {
                    self.at += 1;
                    -1
                }
                Some(_) => 1,
            };
            let factor = self.power()?;
            result.mantissa *= factor.mantissa.powi(sign);
            result.tens = result.tens.saturating_add(factor.tens * sign);
            for (total, exponent) in result.exponents.iter_mut().zip(factor.exponents) {
                *total = total.saturating_add(exponent * sign as i16);
            }
        }
    }

    fn power(&mut self) -> Result<Unit, UnitError> {
        self.skip_spaces();
        let base = match self.peek() {
            Some('(') => {
                if self.depth == 8 {
                    return Err(self.malformed("its parentheses are nested too deeply"));
                }
                self.at += 1;
                self.depth += 1;
                let inner = self.product()?;
                self.depth -= 1;
                if self.peek() != Some(')') {
                    return Err(self.malformed("a parenthesis is not closed"));
                }
                self.at += 1;
                inner
            }
            Some('1') => {
                self.at += 1;
                Unit { mantissa: 1.0, tens: 0, exponents: [0; 4] }
            }
            Some(c) if c.is_alphabetic() || c == '%' || c == '°' => self.name()?,
            _ => return Err(self.malformed("a unit is missing")),
        };
        let exponent = self.exponent()?;
        let exponents = base.exponents.map(|e| e.saturating_mul(exponent).clamp(-99, 99));
        let tens = base.tens.saturating_mul(i32::from(exponent)).clamp(-999, 999);
        Ok(Unit { mantissa: base.mantissa.powi(i32::from(exponent)), tens, exponents })
    }

    fn name(&mut self) -> Result<Unit, UnitError> {
        let start = self.at;
        while self.peek().is_some_and(|c| c.is_alphabetic() || c == '%' || c == '°') {
            self.at += 1;
        }
        let name: String = self.chars[start..self.at].iter().collect();
        named(&name).ok_or_else(|| {
            let known: Vec<String> = PREFIXED.iter().chain(PLAIN).map(|u| u.0.to_owned()).collect();
            let usual = ["mm", "cm", "km", "kg", "ms", "kN", "mN", "kPa", "MPa", "GPa", "mJ", "kJ"];
            let candidates = usual.into_iter().chain(known.iter().map(String::as_str));
            // Letters are few here, so the rule for words ("a third of the letters") is too strict: ignore case first.
            let same_letters = candidates.clone().find(|c| c.eq_ignore_ascii_case(&name)).map(str::to_owned);
            let nearest = same_letters.or_else(|| nearest(&name, candidates).map(str::to_owned));
            UnitError::UnknownUnit { unit: name, nearest }
        })
    }

    fn exponent(&mut self) -> Result<i16, UnitError> {
        const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹";
        let superscript = |c: char| SUPERSCRIPTS.chars().position(|s| s == c);
        let start = self.at;
        self.skip_spaces();
        let caret = match (self.peek(), self.chars.get(self.at + 1)) {
            (Some('^'), _) => 1,
            (Some('*'), Some('*')) => 2,
            _ => 0,
        };
        if caret > 0 {
            self.at += caret;
            self.skip_spaces();
            let negative = matches!(self.peek(), Some('-' | '−'));
            self.at += usize::from(negative);
            let digit =
                self.peek().and_then(|c| c.to_digit(10)).ok_or_else(|| self.malformed("an exponent is missing"))?;
            self.at += 1;
            if self.peek().is_some_and(|c| c.is_ascii_digit()) {
                return Err(self.malformed("an exponent has more than one digit"));
            }
            return Ok(if negative { -(digit as i16) } else { digit as i16 });
        }
        self.at = start;
        let negative = self.peek() == Some('⁻');
        match self.chars.get(self.at + usize::from(negative)).copied().and_then(superscript) {
            Some(digit) => {
                self.at += 1 + usize::from(negative);
                Ok(if negative { -(digit as i16) } else { digit as i16 })
            }
            None if negative => Err(self.malformed("an exponent is missing")),
            None => Ok(1),
        }
    }
}

/// A single name with its prefix: exact names first.
fn named(name: &str) -> Option<Unit> {
    let exact = PREFIXED.iter().chain(PLAIN).find(|u| u.0 == name);
    if let Some(&(_, mantissa, tens, exponents)) = exact {
        return Some(Unit { mantissa, tens, exponents });
    }
    PREFIXES.iter().find_map(|&(prefix, scale)| {
        let rest = name.strip_prefix(prefix)?;
        let &(_, mantissa, tens, exponents) = PREFIXED.iter().find(|u| u.0 == rest)?;
        Some(Unit { mantissa, tens: tens + scale, exponents })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_convert_to_si_to_the_last_bit() {
        let cases: &[(&str, Dimension, f64)] = &[
            ("4 kPa", Dimension::PRESSURE, 4000.0),
            ("4kPa", Dimension::PRESSURE, 4000.0),
            ("-9.81 m/s^2", Dimension::ACCELERATION, -9.81),
            ("9.81 m s⁻²", Dimension::ACCELERATION, 9.81),
            ("9.81 m·s^-2", Dimension::ACCELERATION, 9.81),
            ("5 mm", Dimension::LENGTH, 0.005),
            ("3 mm", Dimension::LENGTH, 0.003),
            ("1 kg/m^3", Dimension::DENSITY, 1.0),
            ("1 g/cm^3", Dimension::DENSITY, 1000.0),
            ("2 cm³", Dimension::VOLUME, 2e-6),
            ("1.1 N/mm^2", Dimension::PRESSURE, 1.1e6),
            ("30 deg", Dimension::ANGLE, 30.0),
            ("1 min", Dimension::TIME, 60.0),
            ("10 ms", Dimension::TIME, 0.01),
            ("1e-3 s", Dimension::TIME, 0.001),
            (".5 s", Dimension::TIME, 0.5),
            ("10 Pa s", Dimension::VISCOSITY, 10.0),
            ("10 Pa*s", Dimension::VISCOSITY, 10.0),
            ("3 1/s", Dimension::RATE, 3.0),
            ("2 kN", Dimension::FORCE, 2000.0),
            ("1 kg/(m s**2)", Dimension::PRESSURE, 1.0),
            ("50 %", Dimension::NUMBER, 0.5),
            ("0.5", Dimension::NUMBER, 0.5),
        ];
        for &(text, dimension, value) in cases {
            assert_eq!(quantity(text, dimension), Ok(value), "{text}");
        }
    }

    #[test]
    fn inexact_conversions_are_right_to_rounding() {
        for (text, dimension, value) in [
            ("1 rad", Dimension::ANGLE, 180.0 / std::f64::consts::PI),
            ("120 mmHg", Dimension::PRESSURE, 15998.686),
            ("1 t/mm^3", Dimension::DENSITY, 1e12),
        ] {
            let found = quantity(text, dimension).unwrap();
            assert!((found / value - 1.0).abs() < 1e-7, "{text}: {found}");
        }
    }

    #[test]
    fn every_named_dimension_reads_its_own_unit_and_example() {
        for &dimension in Dimension::ALL {
            let unit = unit(dimension.unit).unwrap();
            assert_eq!(unit.exponents, dimension.exponents, "{dimension}");
            assert_eq!(unit.value(1.0), 1.0, "{dimension}");
            quantity(dimension.example, dimension).unwrap();
        }
    }

    #[test]
    fn a_wrong_dimension_says_what_was_expected_and_what_was_found() {
        let message = quantity("5 mm", Dimension::TIME).unwrap_err().to_string();
        assert_eq!(message, "expected a time such as \"10 ms\", found `5 mm`, which is a length");
        let message = quantity("5 mm", Dimension::ANGLE).unwrap_err().to_string();
        assert!(message.starts_with("expected an angle"), "{message}");
        let message = quantity("5 kg m^2 deg", Dimension::TIME).unwrap_err().to_string();
        assert!(message.ends_with("which is a quantity in kg m^2 deg"), "{message}");
    }

    #[test]
    fn unreadable_quantities_say_why() {
        for (text, part) in [
            ("kPa", "does not start with a number"),
            ("", "does not start with a number"),
            ("4", "has no unit"),
            ("4 kpa", "did you mean `kPa`?"),
            ("4 furlong", "unknown unit `furlong`"),
            ("4 Pa^", "an exponent is missing"),
            ("4 Pa^12", "more than one digit"),
            ("4 (Pa", "a parenthesis is not closed"),
            ("4 Pa)", "something after its end"),
            ("4 Pa//s", "a unit is missing"),
            ("4 ((((((((((Pa", "nested too deeply"),
            ("4 T T", "unknown unit `T`"),
            ("4 TPa^9 TPa^9 TPa^9", "powers are too large"),
        ] {
            let message = quantity(text, Dimension::PRESSURE).unwrap_err().to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
