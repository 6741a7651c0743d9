//! Numbers as people read them: three digits, and the prefix that fits.

/// Prefixes of SI units, largest first.
const PREFIXES: [(f64, &str); 9] =
    [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p")];

/// A number with its SI unit and a prefix: "20 kPa", "1.5 mm"; without unit, plain or with an exponent.
pub fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() {
        return plain(value);
    }
    // Kilograms and squares do not take the prefix that their number would suggest.
    let prefixable = !unit.starts_with("kg") && !unit.contains('²');
    match PREFIXES.iter().find(|(size, _)| value.abs() >= *size * 0.9995).filter(|_| prefixable) {
        Some((size, prefix)) => format!("{} {prefix}{unit}", plain(value / size)),
        None => format!("{} {unit}", plain(value)),
    }
}

/// Three digits: "0.0123", "456", "1.2e9".
pub fn plain(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !size.is_finite() {
        return value.to_string();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let before = size.log10().floor() as i32;
    let text = format!("{value:.*}", (2 - before).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The largest of 1, 2, 5 times a power of ten that is not larger.
pub fn round_below(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let digits = value / power;
    power * [5.0, 2.0].into_iter().find(|d| digits >= *d).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three digits and the prefix that fits; nothing for what has none.
    #[test]
    fn numbers_are_short() {
        for (value, unit, text) in [
            (2e4, "Pa", "20 kPa"),
            (-0.0015, "m", "-1.5 mm"),
            (1e8, "Pa", "100 MPa"),
            (999.9, "N", "1 kN"),
            (0.45, "", "0.45"),
            (0.0, "N", "0 N"),
            (1060.0, "kg/m³", "1060 kg/m³"),
            (1.234e-7, "", "1.23e-7"),
        ] {
            assert_eq!(with_unit(value, unit), text);
        }
    }

    /// Scale bars have round lengths.
    #[test]
    fn round_lengths() {
        for (value, round) in [(0.7, 0.5), (9.9, 5.0), (1.0, 1.0), (0.024, 0.02)] {
            assert!((round_below(value) - round).abs() < 1e-12 * round);
        }
    }
}
