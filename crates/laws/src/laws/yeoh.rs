//! Yeoh: a cubic polynomial of the isochoric invariant Ī₁ = J^(−2/3) I₁.
//!
//! At small strain the shear modulus is μ = 2 c1 and the bulk modulus is κ. A negative c2 softens at moderate and a
//! positive c3 stiffens at large stretches: the S-shaped curve of filled rubber from three numbers.
//! The energy exists for J > 0 only, and stays finite as J → 0. With c3 = 0 and c2 < 0 it is unstable at large stretches.

use crate::{BULK, Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "yeoh",
    name: "Yeoh",
    about: "Filled rubber up to large stretches, fitted to one kind of test; elements must not invert (J > 0).",
    formula: "c1 (Ī₁ − 3) + c2 (Ī₁ − 3)² + c3 (Ī₁ − 3)³ + κ/2 (J − 1)²",
    references: &["Yeoh, Some forms of the strain energy function for rubber (1993)"],
    parameters: &[
        Parameter {
            name: "c1",
            unit: "Pa",
            minimum: Bound::Open(0.0),
            maximum: Bound::None,
            default: None,
            about: "half the shear modulus at small strain",
        },
        Parameter {
            name: "c2",
            unit: "Pa",
            minimum: Bound::None,
            maximum: Bound::None,
            default: None,
            about: "factor of (Ī₁ − 3)², often negative",
        },
        Parameter {
            name: "c3",
            unit: "Pa",
            minimum: Bound::None,
            maximum: Bound::None,
            default: None,
            about: "factor of (Ī₁ − 3)³",
        },
        BULK,
    ],
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: the invariants keep their names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let coefficients = ["c1", "c2", "c3"].map(|name| k.parameter(name));
    let (I1bar, volumetric) = (k.I1bar(), k.volumetric());
    let g = &mut *k.graph;
    let minus_three = g.int(-3);
    let excess = g.add(I1bar, minus_three);
    let mut terms = vec![volumetric];
    for (power, coefficient) in (1..).zip(coefficients) {
        terms.push(g.scaled_powers(Number::ONE, &[(coefficient, 1), (excess, power)]));
    }
    g.sum(&terms)
}
