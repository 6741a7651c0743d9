//! Ogden: sums of powers of the isochoric principal stretches λ̄ᵢ = J^(−1/3) λᵢ.
//!
//! Up to three terms, each with a modulus μₚ and an exponent αₚ ≠ 0, of any sign. The exponents need not be whole: they
//! are what fits rubber from small stretches to the steep end.
//! At small strain the shear modulus is Σ μₚ, and the bulk modulus is κ. (With Ogden's own moduli, of the energy
//! Σ μₚ/αₚ (…), it is ½ Σ μₚαₚ: multiply them by αₚ/2.)
//!
//! One term with α = 2 is neo-Hooke, two terms with α = 2 and −2 are Mooney and Rivlin: c10 = μ₁/2, c01 = μ₂/2.
//!
//! With C̄ = J^(−2/3) C, Σᵢ λ̄ᵢ^α = tr C̄^(α/2): a power of a matrix, which has all derivatives wherever two stretches
//! are equal, at rest first of all. The principal stretches themselves have none there, and are not written.
//! The energy exists for J > 0 only, and stays finite as J → 0.

use crate::{BULK, Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

const fn modulus(name: &'static str, default: Option<f64>, about: &'static str) -> Parameter {
    Parameter { name, unit: "Pa", minimum: Bound::None, maximum: Bound::None, default, about }
}

const fn exponent(name: &'static str, default: Option<f64>, about: &'static str) -> Parameter {
    Parameter { name, unit: "1", minimum: Bound::NonZero, maximum: Bound::None, default, about }
}

/// The law.
pub const LAW: Law = Law {
    id: "ogden",
    name: "Ogden",
    about: "Rubber at large strains (stretches up to about 7), from fitted exponents; elements must not invert (J > 0).",
    formula: "Σₚ 2μₚ/αₚ² (λ̄₁^αₚ + λ̄₂^αₚ + λ̄₃^αₚ − 3) + κ/2 (J − 1)²,  p = 1, 2, 3",
    references: &[
        "Ogden, Large deformation isotropic elasticity: on the correlation of theory and experiment for incompressible \
         rubberlike solids (1972)",
        "Holzapfel, Nonlinear solid mechanics (2000), section 6.5",
        "Simo and Taylor, Quasi-incompressible finite elasticity in principal stretches (1991)",
    ],
    parameters: &[
        modulus("mu1", None, "modulus of the first term; the sum of the moduli is the shear modulus at small strain"),
        modulus("mu2", Some(0.0), "modulus of the second term"),
        modulus("mu3", Some(0.0), "modulus of the third term"),
        exponent("alpha1", None, "exponent of the first term: 2 for neo-Hooke"),
        exponent("alpha2", Some(-2.0), "exponent of the second term: with 2 before it, −2 for Mooney and Rivlin"),
        exponent("alpha3", Some(5.0), "exponent of the third term"),
        BULK,
    ],
    objective: true,
    energy: &energy,
};

fn energy(k: &mut Kinematics<'_>) -> Expr {
    let isochoric = k.Cbar();
    let volumetric = k.volumetric();
    let terms = [("mu1", "alpha1"), ("mu2", "alpha2"), ("mu3", "alpha3")].map(|(mu, alpha)| {
        let (mu, alpha) = (k.parameter(mu), k.parameter(alpha));
        let weight = k.graph.scaled_powers(Number::Rational(2, 1), &[(mu, 1), (alpha, -2)]);
        (weight, k.graph.scale(Number::rational(1, 2), alpha))
    });
    let g = &mut *k.graph;
    let entries = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].map(|(i, j)| isochoric.at(i, j));
    let powers = g.power_trace(&entries, &terms);
    let mut parts = vec![(Number::ONE, powers), (Number::ONE, volumetric)];
    parts.extend(terms.iter().map(|term| (Number::Rational(-3, 1), term.0)));
    g.linear(&parts)
}
