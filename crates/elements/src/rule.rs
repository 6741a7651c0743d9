//! Quadrature rules: points and weights read from the text files of `rules/`.
//!
//! A file is `# comment` lines, then `key value` lines (`family`, `degree`, `source`), then one line per point:
//! reference coordinates and weight, with full precision.
//! The weights sum to the measure of the reference cell.

use crate::{Family, RULE_TEXTS};
use std::sync::LazyLock;

/// A quadrature rule on a reference cell.
#[derive(Clone, Debug)]
pub struct Rule {
    /// File name without extension: family and number of points (`"hexahedron-8"`).
    pub id: &'static str,
    /// The cell that it integrates over.
    pub family: Family,
    /// Every polynomial up to this total degree is integrated exactly (in the reference coordinates).
    pub degree: u32,
    /// Where the digits come from.
    pub source: &'static str,
    /// Reference coordinates, [point, axis]; unused axes are 0.
    pub points: Vec<[f64; 3]>,
    /// Weights, [point]; their sum is the measure of the reference cell.
    pub weights: Vec<f64>,
}

impl Rule {
    /// The rule with this id.
    pub fn by_id(id: &str) -> Option<&'static Rule> {
        rules().iter().find(|r| r.id == id)
    }
}

/// Every rule, sorted by id.
pub fn rules() -> &'static [Rule] {
    static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| {
        RULE_TEXTS.iter().map(|(id, text)| parse(id, text).unwrap_or_else(|e| panic!("rules/{id}.rule: {e}"))).collect()
    });
    &RULES
}

fn parse(id: &'static str, text: &'static str) -> Result<Rule, String> {
    let (mut family, mut degree, mut source) = (None, None, "");
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for line in text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#')) {
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match key {
            "family" => family = Family::ALL.into_iter().find(|f| f.name() == rest.trim()),
            "degree" => degree = rest.trim().parse().ok(),
            "source" => source = rest.trim(),
            _ => {
                let family = family.ok_or("`family` must come before the points")?;
                let numbers: Vec<f64> = line
                    .split_whitespace()
                    .map(|w| w.parse::<f64>().map_err(|e| format!("`{w}`: {e}")))
                    .collect::<Result<_, _>>()?;
                let d = family.dimension();
                if numbers.len() != d + 1 {
                    return Err(format!("`{line}`: expected {d} coordinates and a weight"));
                }
                let mut point = [0.0; 3];
                point[..d].copy_from_slice(&numbers[..d]);
                points.push(point);
                weights.push(numbers[d]);
            }
        }
    }
    Ok(Rule { id, family: family.ok_or("no `family`")?, degree: degree.ok_or("no `degree`")?, source, points, weights })
}
