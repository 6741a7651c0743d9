//! Compressible neo-Hookean law with logarithms of the volume ratio.
//!
//! P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ: stress-free at rest, Hooke's law with the same λ and μ at small strain, and infinite
//! energy as an element is crushed to nothing. The energy exists for J > 0 only: an inverted element has none, so
//! solvers must shorten their steps before that (`stable-neo-hookean` needs no such care).
//! The logarithm resists expansion ever less: under large tension in all directions (J above e ≈ 2.7) the bulk softens.

use crate::{ISOTROPIC, Kinematics, Law};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "neo-hookean",
    name: "Neo-Hookean",
    about: "Rubber and soft tissue at moderate strains, also in strong compression; elements must not invert (J > 0).",
    formula: "μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)²",
    references: &[
        "Bonet and Wood, Nonlinear continuum mechanics for finite element analysis, 2nd edition (2008), section 6.4.3",
        "Simo and Pister, Remarks on rate constitutive equations for finite deformation problems (1984)",
    ],
    parameters: &ISOTROPIC,
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: J and I₁ keep their names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu, I1, J) = (k.lambda(), k.mu(), k.I1(), k.J());
    let g = &mut *k.graph;
    let ln_j = g.ln(J);
    let three = g.int(3);
    let (half, minus) = (Number::rational(1, 2), Number::MINUS_ONE);
    let stretch = g.linear(&[(half, I1), (-half, three), (minus, ln_j)]);
    let shear = g.mul(mu, stretch);
    let volumetric = g.scaled_powers(half, &[(lambda, 1), (ln_j, 2)]);
    g.add(shear, volumetric)
}
