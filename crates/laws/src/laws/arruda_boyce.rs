//! Arruda–Boyce: eight polymer chains along the diagonals of a cube, each of which locks at the stretch λ_m.
//!
//! The inverse Langevin function of the chains is replaced by the first five terms of its series in Ī₁ = J^(−2/3) I₁,
//! as is usual: the locking is a steep rise, not a wall. At small strain the shear modulus is
//! μ₀ = 2 μ Σᵢ i Cᵢ 3^(i−1) / λ_m^(2i−2) (just above μ: 1 + 3/(5λ_m²) + …), and the bulk modulus is κ.
//! The energy exists for J > 0 only, and stays finite as J → 0.

use crate::{BULK, Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "arruda-boyce",
    name: "Arruda–Boyce",
    about: "Rubber up to the stretch at which its chains lock, from two numbers; elements must not invert (J > 0).",
    formula: "μ Σᵢ Cᵢ/λ_m^(2i−2) (Ī₁ⁱ − 3ⁱ) + κ/2 (J − 1)²,  C = 1/2, 1/20, 11/1050, 19/7000, 519/673750",
    references: &[
        "Arruda and Boyce, A three-dimensional constitutive model for the large stretch behavior of rubber elastic \
         materials (1993), equation 21",
    ],
    parameters: &[
        Parameter {
            name: "mu",
            unit: "Pa",
            minimum: Bound::Open(0.0),
            maximum: Bound::None,
            default: None,
            about: "rubber modulus of the chains: the shear modulus at small strain when they are long",
        },
        Parameter {
            name: "lambda_m",
            unit: "1",
            minimum: Bound::Open(1.0),
            maximum: Bound::None,
            default: None,
            about: "stretch at which the chains lock",
        },
        BULK,
    ],
    objective: true,
    energy: &energy,
};

/// Cᵢ, as fractions.
const SERIES: [(i64, i64); 5] = [(1, 2), (1, 20), (11, 1050), (19, 7000), (519, 673_750)];

#[expect(non_snake_case, reason = "docs/notation.md: the invariants keep their names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (mu, lambda_m, I1bar) = (k.parameter("mu"), k.parameter("lambda_m"), k.I1bar());
    let volumetric = k.volumetric();
    let g = &mut *k.graph;
    let mut terms = vec![volumetric];
    let mut at_rest: i64 = 1;
    for (i, (numerator, denominator)) in (1..).zip(SERIES) {
        at_rest *= 3;
        let (power, rest) = (g.powi(I1bar, i), g.int(-at_rest));
        let excess = g.add(power, rest);
        let factors = [(mu, 1), (lambda_m, 2 - 2 * i), (excess, 1)];
        terms.push(g.scaled_powers(Number::rational(numerator, denominator), &factors));
    }
    g.sum(&terms)
}
