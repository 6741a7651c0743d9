//! What there is to say of a law with its parameters: verdicts, moduli, curves.

use serde::Serialize;
use souple_laws::check::{Outcome, Ranges, Verdict, curves, judge, svg};
use souple_laws::response::Response;

/// A law, judged.
#[derive(Clone, Debug, Serialize)]
pub struct LawReport {
    /// Which law, in words.
    pub law: String,
    /// Whether it can be simulated.
    pub passed: bool,
    /// One for each check.
    pub checks: Vec<CheckReport>,
    /// Closed-form-like tests.
    pub curves: Vec<CurveReport>,
}

/// One check.
#[derive(Clone, Debug, Serialize)]
pub struct CheckReport {
    /// What was judged.
    pub check: &'static str,
    /// `passed`, `limited`, `failed` or `not judged`.
    pub outcome: &'static str,
    /// The number that decided; `null` where there is none.
    pub value: Option<f64>,
    /// The result in words.
    pub sentence: String,
}

/// A stress curve.
#[derive(Clone, Debug, Serialize)]
pub struct CurveReport {
    /// Which test.
    pub title: &'static str,
    /// [point][abscissa, ordinate].
    pub points: Vec<[f64; 2]>,
    /// The same as a table.
    #[serde(skip)]
    pub table: String,
    /// The same as a drawing.
    #[serde(skip)]
    pub svg: String,
}

/// Judges a law and draws its curves.
pub fn report(law: String, response: &Response) -> LawReport {
    let verdict: Verdict = judge(response);
    let checks = verdict
        .findings
        .iter()
        .map(|f| CheckReport {
            check: f.check.name(),
            outcome: match f.outcome {
                Outcome::Passed => "passed",
                Outcome::Limited => "limited",
                Outcome::Failed => "failed",
                Outcome::NotJudged => "not judged",
            },
            value: f.value.is_finite().then_some(f.value),
            sentence: f.sentence.clone(),
        })
        .collect();
    let curves = curves(response, &Ranges::default())
        .iter()
        .map(|curve| CurveReport {
            title: curve.kind.title(),
            points: curve.points.iter().map(|p| [p.abscissa, p.ordinate]).collect(),
            table: curve.table(),
            svg: svg(curve),
        })
        .collect();
    LawReport { law, passed: verdict.passed(), checks, curves }
}
