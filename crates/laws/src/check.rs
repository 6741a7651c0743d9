//! Whether a law makes sense: what it does at rest, under rotations, and whether its derivatives are right, in numbers
//! and sentences; and what it looks like: its [`curves`], as tables and drawings.
//!
//! A law that passes can still be a bad model; one that fails at rest cannot be simulated.

mod curves;
mod dense;
mod inversion;
mod plot;
mod random;
mod rest;

pub use curves::{Curve, CurveKind, CurvePoint, Ranges, curves};
pub use inversion::{Inversion, inversion};
pub use plot::svg;
pub use rest::{AtRest, SmallStrain, at_rest};

use crate::Law;
use crate::response::{IDENTITY, Response, Tensor, WrongParameterCount, product, tensor_from_fn};
use random::Random;

/// Largest relative error under rotations of an objective law.
pub const OBJECTIVE: f64 = 1e-10;
/// Largest relative error of derivatives against differences.
pub const DERIVATIVES: f64 = 1e-6;
/// Number of random deformations of each check.
const SAMPLES: usize = 12;
const SEED: u64 = 2014;

/// What is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Energy, stress and tangent are numbers at rest.
    FiniteAtRest,
    /// Nothing pulls at rest.
    StressFreeAtRest,
    /// Every small strain from rest costs energy.
    StableAtRest,
    /// A rotation changes nothing.
    Objective,
    /// Stress and tangent are the derivatives of the energy.
    Derivatives,
}

impl Check {
    /// All of them, in the order in which they are judged.
    pub const ALL: [Check; 5] =
        [Check::FiniteAtRest, Check::StressFreeAtRest, Check::StableAtRest, Check::Objective, Check::Derivatives];

    /// In a few words.
    pub fn name(self) -> &'static str {
        match self {
            Check::FiniteAtRest => "finite at rest",
            Check::StressFreeAtRest => "stress-free at rest",
            Check::StableAtRest => "stable at rest",
            Check::Objective => "objective",
            Check::Derivatives => "derivatives",
        }
    }
}

/// How a check ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As it should be.
    Passed,
    /// The law can be used, within the limit that the sentence states.
    Limited,
    /// The law cannot be used.
    Failed,
    /// An earlier check failed and this one has nothing to go by.
    NotJudged,
}

/// One check.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was judged.
    pub check: Check,
    /// How it ended.
    pub outcome: Outcome,
    /// The number that decided; NaN where there is none.
    pub value: f64,
    /// What it was compared with.
    pub limit: f64,
    /// The result in words.
    pub sentence: String,
}

/// All checks of a law with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// One for each of [`Check::ALL`], in that order.
    pub findings: Vec<Finding>,
    /// Moduli at small strain, where the law is finite and stable at rest.
    pub small_strain: Option<SmallStrain>,
}

impl Verdict {
    /// Whether no check failed.
    pub fn passed(&self) -> bool {
        self.findings.iter().all(|f| matches!(f.outcome, Outcome::Passed | Outcome::Limited))
    }
}

/// Judges a law with parameters in its declared order, SI units.
pub fn verdict(law: &Law, parameters: &[f64]) -> Result<Verdict, WrongParameterCount> {
    Ok(judge(&Response::new(law, parameters)?))
}

/// Judges a law that has its parameters already.
pub fn judge(response: &Response) -> Verdict {
    let rest = rest::findings(response);
    let mut findings = rest.findings;
    if findings[0].outcome == Outcome::Passed {
        findings.push(objective(response));
        findings.push(derivatives(response));
    }
    for &check in &Check::ALL[findings.len()..] {
        let sentence = "not judged: the law is not finite at rest".to_owned();
        findings.push(Finding { check, outcome: Outcome::NotJudged, value: f64::NAN, limit: f64::NAN, sentence });
    }
    Verdict { findings, small_strain: rest.small_strain }
}

/// Largest change of the energy and of the stress (but for turning it) under random rotations of random deformations,
/// relative to the largest modulus at rest; infinite where the law is not finite.
pub fn rotation_error(response: &Response) -> f64 {
    let size = deformation_size(response);
    let mut random = Random(SEED);
    let scale = largest(&response.tangent(&IDENTITY).concat());
    let mut worst = 0f64;
    for _ in 0..SAMPLES {
        let (f, rotation) = (random.deformation(size), random.rotation());
        let turned = product(&rotation, &f);
        let energies = [response.energy(&turned) - response.energy(&f)];
        let (expected, found) = (product(&rotation, &response.stress(&f)), response.stress(&turned));
        let stresses = tensor_from_fn(|i, j| found[i][j] - expected[i][j]);
        worst = worst.max(largest(&energies)).max(largest(&stresses.concat()));
    }
    let error = worst / scale;
    if error.is_finite() { error } else { f64::INFINITY }
}

fn objective(response: &Response) -> Finding {
    let value = rotation_error(response);
    let (outcome, sentence) = if value <= OBJECTIVE {
        (Outcome::Passed, format!("rotations change nothing: {value:.1e} of the stiffness at most"))
    } else {
        let sentence = format!(
            "rotations change the energy or the stress by up to {value:.1e} of the stiffness: for small rotations only"
        );
        (Outcome::Limited, sentence)
    };
    Finding { check: Check::Objective, outcome, value, limit: OBJECTIVE, sentence }
}

/// Derivatives against central differences of fourth order, relative to the largest derivative met.
fn derivatives(response: &Response) -> Finding {
    const STEP: f64 = 1e-3;
    let size = deformation_size(response);
    let mut random = Random(SEED + 1);
    let (mut worst, mut scale) = (0f64, largest(&response.tangent(&IDENTITY).concat()));
    for _ in 0..3 {
        let f = random.deformation(size);
        let (stress, tangent) = (response.stress(&f), response.tangent(&f));
        scale = scale.max(largest(&stress.concat())).max(largest(&tangent.concat()));
        for k in 0..9 {
            let moved = |steps: f64| -> Tensor {
                let mut moved = f;
                moved[k / 3][k % 3] += steps * STEP;
                moved
            };
            // f' = (8 (f₁ − f₋₁) − (f₂ − f₋₂)) / 12 h + O(h⁴)
            let slope = |of: &dyn Fn(&Tensor) -> f64| {
                let difference = |steps: f64| of(&moved(steps)) - of(&moved(-steps));
                (8.0 * difference(1.0) - difference(2.0)) / (12.0 * STEP)
            };
            let mut errors = vec![slope(&|f| response.energy(f)) - stress[k / 3][k % 3]];
            let stresses = [1.0, -1.0, 2.0, -2.0].map(|steps| response.stress(&moved(steps)).concat());
            for l in 0..9 {
                let [plus, minus, plus_two, minus_two] = [0, 1, 2, 3].map(|s: usize| stresses[s][l]);
                let slope = (8.0 * (plus - minus) - (plus_two - minus_two)) / (12.0 * STEP);
                errors.push(slope - tangent[l][k]);
            }
            worst = worst.max(largest(&errors));
        }
    }
    let value = worst / scale;
    let passed = value <= DERIVATIVES;
    let (outcome, sentence) = if passed {
        (Outcome::Passed, format!("stress and tangent agree with differences to {value:.1e}"))
    } else {
        let sentence = format!(
            "stress or tangent differ from differences by {value:.1e}: the energy has a kink or a pole near rest, or \
             changes too fast for differences"
        );
        (Outcome::Failed, sentence)
    };
    Finding { check: Check::Derivatives, outcome, value, limit: DERIVATIVES, sentence }
}

/// How far random deformations may go: as far as the law is finite, 0.2 at most.
fn deformation_size(response: &Response) -> f64 {
    let finite = |size: f64| {
        let mut random = Random(SEED);
        (0..SAMPLES).all(|_| {
            let f = random.deformation(size);
            // Laws that grow exponentially have numbers there, but none that differences can be taken of.
            largest(&response.tangent(&f).concat()) < 1e6 * largest(&response.tangent(&IDENTITY).concat())
        })
    };
    [0.2, 0.05, 0.01].into_iter().find(|&size| finite(size)).unwrap_or(0.002)
}

/// Largest absolute value; infinite if there is one that is no number.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| if v.is_nan() { f64::INFINITY } else { m.max(v.abs()) })
}
