//! Mooney–Rivlin: linear in the isochoric invariants Ī₁ = J^(−2/3) I₁ and Ī₂ = J^(−4/3) I₂.
//!
//! At small strain the shear modulus is μ = 2 (c10 + c01), which must be positive, and the bulk modulus is κ.
//! The isochoric part is blind to pure changes of volume, which κ alone resists; near incompressibility
//! (κ above about 100 μ) linear elements lock. The energy exists for J > 0 only, and stays finite as J → 0.
//! A negative c01 fits some data and makes the law unstable at large stretches: check the curves.

use crate::{BULK, Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "mooney-rivlin",
    name: "Mooney–Rivlin",
    about: "Rubber at moderate strains (up to stretches of about 2); elements must not invert (J > 0).",
    formula: "c10 (Ī₁ − 3) + c01 (Ī₂ − 3) + κ/2 (J − 1)²",
    references: &[
        "Mooney, A theory of large elastic deformation (1940)",
        "Rivlin, Large elastic deformations of isotropic materials IV (1948)",
        "Holzapfel, Nonlinear solid mechanics (2000), section 6.5",
    ],
    parameters: &[
        Parameter {
            name: "c10",
            unit: "Pa",
            minimum: Bound::None,
            maximum: Bound::None,
            default: None,
            about: "factor of the first invariant; c10 + c01 is half the shear modulus and must be positive",
        },
        Parameter {
            name: "c01",
            unit: "Pa",
            minimum: Bound::None,
            maximum: Bound::None,
            default: None,
            about: "factor of the second invariant; 0 gives a neo-Hookean law",
        },
        BULK,
    ],
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: the invariants keep their names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (c10, c01, I1bar, I2bar) = (k.parameter("c10"), k.parameter("c01"), k.I1bar(), k.I2bar());
    let volumetric = k.volumetric();
    let g = &mut *k.graph;
    let minus_three = g.int(-3);
    let first = g.add(I1bar, minus_three);
    let first = g.mul(c10, first);
    let second = g.add(I2bar, minus_three);
    let second = g.mul(c01, second);
    g.linear(&[(Number::ONE, first), (Number::ONE, second), (Number::ONE, volumetric)])
}
