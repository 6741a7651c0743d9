//! The law at rest, where every simulation begins: it must have numbers, no stress, and resist every strain.

use super::dense::{eigenvalues, solved};
use super::{Check, Finding, Outcome, largest};
use crate::response::{IDENTITY, Response};

/// Largest stress at rest, relative to the largest modulus.
const STRESS: f64 = 1e-9;
/// Least eigenvalue of the stiffness, relative to the largest: below it a strain costs nothing.
const STIFFNESS: f64 = 1e-10;

/// Why a law cannot be simulated: it fails before anything moves.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AtRest {
    /// A value at rest is infinite or no number.
    #[error(
        "the {what} is not finite at rest (F = I): logarithms and roots of zero, divisions by zero and powers below \
         2 of something that is zero at rest, such as (I1bar - 3)^1.5, have no value or no derivatives there"
    )]
    NotFinite {
        /// Energy, stress or tangent.
        what: &'static str,
    },
    /// The body would move by itself.
    #[error(
        "the stress at rest (F = I) is not zero: {largest:.6e} Pa, or {relative:.1e} of the stiffness; add a term \
         that balances it, such as -mu*ln(J) to mu/2*(I1 - 3)"
    )]
    Stressed {
        /// Largest entry of the stress in Pa.
        largest: f64,
        /// The same over the largest modulus.
        relative: f64,
    },
    /// Some strain costs nothing, or gains energy.
    #[error(
        "the law is not stable at rest (F = I): a strain has the stiffness {least:.6e} Pa, where the largest is \
         {largest:.6e} Pa; every strain must be resisted, changes of volume too"
    )]
    Unstable {
        /// Least eigenvalue of the stiffness in Pa.
        least: f64,
        /// Largest.
        largest: f64,
    },
}

/// A law at small strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallStrain {
    /// Young's moduli of bars along x, y and z in Pa.
    pub young: [f64; 3],
    /// Bulk modulus in Pa: mean stress over relative change of volume, under equal strains.
    pub bulk: f64,
    /// Shear moduli in the planes yz, zx and xy in Pa.
    pub shear: [f64; 3],
    /// Eigenvalues of the stiffness on symmetric strains in Pa, increasing; 2μ five times and 3κ when isotropic.
    pub eigenvalues: [f64; 6],
}

/// Whether the law is finite, free of stress and stable at rest: what a scene's law must be.
///
/// # Errors
/// The first of these that it is not.
pub fn at_rest(response: &Response) -> Result<SmallStrain, AtRest> {
    finite(response)?;
    stress_free(response)?;
    stable(response)
}

/// The three findings, and the moduli.
pub(super) struct Rest {
    pub(super) findings: Vec<Finding>,
    pub(super) small_strain: Option<SmallStrain>,
}

pub(super) fn findings(response: &Response) -> Rest {
    let mut findings = Vec::new();
    let mut push = |check, result: Result<(f64, String), (f64, AtRest)>, limit| {
        let (outcome, value, sentence) = match result {
            Ok((value, sentence)) => (Outcome::Passed, value, sentence),
            Err((value, error)) => (Outcome::Failed, value, error.to_string()),
        };
        findings.push(Finding { check, outcome, value, limit, sentence });
        outcome == Outcome::Passed
    };
    let is_finite = finite(response).map_err(|e| (f64::NAN, e));
    let energy = response.energy(&IDENTITY);
    let sentence = format!("energy, stress and tangent are numbers at rest; the energy is {energy:.3e} J/m³");
    if !push(Check::FiniteAtRest, is_finite.map(|()| (energy, sentence)), f64::INFINITY) {
        return Rest { findings, small_strain: None };
    }
    let relative = relative_stress(response);
    let free = stress_free(response).map_err(|e| (relative, e));
    push(
        Check::StressFreeAtRest,
        free.map(|()| (relative, format!("no stress at rest: {relative:.1e} of the stiffness"))),
        STRESS,
    );
    let least = eigenvalues(&stiffness(response))[0];
    let stable = stable(response);
    let small_strain = stable.as_ref().ok().copied();
    let result = stable.map_err(|e| (least, e)).map(|s| {
        let [low, .., high] = s.eigenvalues;
        (least, format!("every strain is resisted: stiffnesses from {low:.6e} to {high:.6e} Pa"))
    });
    push(Check::StableAtRest, result, 0.0);
    Rest { findings, small_strain }
}

fn finite(response: &Response) -> Result<(), AtRest> {
    let all = |values: &[f64]| values.iter().all(|v| v.is_finite());
    let what = if !response.energy(&IDENTITY).is_finite() {
        "energy"
    } else if !all(&response.stress(&IDENTITY).concat()) {
        "stress"
    } else if !all(&response.tangent(&IDENTITY).concat()) {
        "tangent"
    } else {
        return Ok(());
    };
    Err(AtRest::NotFinite { what })
}

/// Largest stress over largest modulus; zero when both are.
fn relative_stress(response: &Response) -> f64 {
    let stress = largest(&response.stress(&IDENTITY).concat());
    if stress == 0.0 { 0.0 } else { stress / largest(&response.tangent(&IDENTITY).concat()) }
}

fn stress_free(response: &Response) -> Result<(), AtRest> {
    let relative = relative_stress(response);
    if relative <= STRESS {
        return Ok(());
    }
    Err(AtRest::Stressed { largest: largest(&response.stress(&IDENTITY).concat()), relative })
}

fn stable(response: &Response) -> Result<SmallStrain, AtRest> {
    let stiffness = stiffness(response);
    let eigenvalues = eigenvalues(&stiffness);
    let [least, .., largest] = eigenvalues;
    // A zero stiffness is as bad as a negative one.
    if least <= STIFFNESS * largest {
        return Err(AtRest::Unstable { least, largest });
    }
    // A bar's modulus is the inverse of the compliance in its direction.
    let compliance = |axis: usize| {
        let unit = std::array::from_fn(|k| f64::from(u8::from(k == axis)));
        solved(stiffness, unit).map_or(f64::NAN, |strain| strain[axis])
    };
    let bulk = stiffness[..3].iter().flat_map(|row| &row[..3]).sum::<f64>() / 9.0;
    Ok(SmallStrain {
        young: [0, 1, 2].map(|axis| 1.0 / compliance(axis)),
        bulk,
        shear: [3, 4, 5].map(|k| stiffness[k][k] / 2.0),
        eigenvalues,
    })
}

/// The tangent at rest on symmetric strains, in the orthonormal basis xx, yy, zz, (yz + zy)/√2, (zx + xz)/√2,
/// (xy + yx)/√2.
fn stiffness(response: &Response) -> [[f64; 6]; 6] {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)];
    let tangent = response.tangent(&IDENTITY);
    let basis = |p: usize| -> [f64; 9] {
        let (i, j) = PAIRS[p];
        let mut strain = [0.0; 9];
        let size = if i == j { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
        strain[3 * i + j] = size;
        strain[3 * j + i] = size;
        strain
    };
    std::array::from_fn(|p| {
        let (left, image) =
            (basis(p), |k: usize, right: &[f64; 9]| -> f64 { tangent[k].iter().zip(right).map(|(a, b)| a * b).sum() });
        std::array::from_fn(|q| {
            let right = basis(q);
            (0..9).map(|k| left[k] * image(k, &right)).sum()
        })
    })
}
