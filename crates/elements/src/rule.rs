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

/// Reads a rule file; an error names the line and what was expected there.
fn parse(id: &'static str, text: &'static str) -> Result<Rule, String> {
    let (mut family, mut degree, mut source) = (None, None, "");
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (at, line) in text.lines().map(str::trim).enumerate().filter(|(_, l)| !l.is_empty() && !l.starts_with('#')) {
        let here = |message: String| format!("line {}: {message}", at + 1);
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        match key {
            "family" => {
                let found = Family::ALL.into_iter().find(|f| f.name() == rest);
                let known = Family::ALL.map(Family::name).join(", ");
                family = Some(found.ok_or_else(|| here(format!("`{rest}` is no family; expected one of {known}")))?);
            }
            "degree" => {
                degree = Some(rest.parse().map_err(|_| here(format!("`{rest}` is no degree; expected a count")))?)
            }
            "source" => source = rest,
            _ => {
                let family = family.ok_or_else(|| here("`family` must come before the points".into()))?;
                let numbers: Vec<f64> = line
                    .split_whitespace()
                    .map(|w| w.parse::<f64>().map_err(|_| here(format!("`{w}` is neither a key nor a number"))))
                    .collect::<Result<_, _>>()?;
                let d = family.dimension();
                if numbers.len() != d + 1 {
                    return Err(here(format!("{} numbers; expected {d} coordinates and a weight", numbers.len())));
                }
                let mut point = [0.0; 3];
                point[..d].copy_from_slice(&numbers[..d]);
                points.push(point);
                weights.push(numbers[d]);
            }
        }
    }
    let family = family.ok_or("no line `family NAME`")?;
    let degree = degree.ok_or("no line `degree NUMBER`")?;
    let expected = format!("{}-{}", family.name(), points.len());
    if id != expected {
        return Err(format!("holds {} points on a {}: call it {expected}.rule", points.len(), family.name()));
    }
    Ok(Rule { id, family, degree, source, points, weights })
}

#[cfg(test)]
mod tests {
    use super::parse;

    /// A faulty rule file is refused with the line and what was expected.
    #[test]
    fn faults_are_named() {
        for (text, expected) in [
            ("family cube", "line 1: `cube` is no family"),
            ("family edge\ndegree one", "line 2: `one` is no degree"),
            ("0.0 2.0", "line 1: `family` must come before the points"),
            ("family edge\ndegree 1\n\n0.0", "line 4: 1 numbers; expected 1 coordinates and a weight"),
            ("family edge\ndegree 1\n0.0 x", "line 3: `x` is neither a key nor a number"),
            ("degree 1", "no line `family NAME`"),
            ("family edge\n0.0 2.0", "no line `degree NUMBER`"),
            ("family edge\ndegree 1\n-0.5 1.0\n0.5 1.0", "call it edge-2.rule"),
        ] {
            let error = parse("edge-1", text).expect_err(text);
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        assert!(parse("edge-1", "family edge\ndegree 1\n# middle\n0.0 2.0").is_ok());
    }
}
