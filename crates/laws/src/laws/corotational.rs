//! Corotational elasticity: Hooke's law in a frame that turns with the material.
//!
//! With the polar decomposition F = RS, the strain is ε = S − I. Its traces need no rotation and no decomposition:
//!
//! ```text
//! tr ε = s − 3,   tr ε² = tr C − 2s + 3,   s = tr S = tr √C
//! ```
//!
//! and s follows from the invariants of C (see [`souple_symbols::Function::RootSum`]). So the law is the same for every
//! element, and its tangent is exact: it includes the change of the rotation that many implementations leave out.

use crate::{ISOTROPIC, Kinematics, Law};
use souple_symbols::{Expr, Function, Number};

/// The law.
pub const LAW: Law = Law {
    id: "corotational",
    name: "Corotational",
    about: "Hooke's law free of rotations: large rotations with small strains; stiff where a linear law would be.",
    formula: "λ/2 tr(ε)² + μ tr(ε²),  ε = S − I,  F = RS",
    references: &[
        "Müller and Gross, Interactive virtual materials (2004)",
        "Hoger and Carlson, Determination of the stretch and rotation in the polar decomposition (1984)",
    ],
    parameters: &ISOTROPIC,
    objective: true,
    energy: &energy,
};

fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu) = (k.lambda(), k.mu());
    let (i1, i2, j) = (k.I1(), k.I2(), k.J());
    let g = &mut *k.graph;
    let stretch = g.function(Function::RootSum, &[i1, i2, j]);
    let three = g.int(3);
    let trace = g.sub(stretch, three);
    let squares = g.linear(&[(Number::ONE, i1), (Number::Rational(-2, 1), stretch), (Number::ONE, three)]);
    let volumetric = g.scaled_powers(Number::rational(1, 2), &[(lambda, 1), (trace, 2)]);
    let shear = g.mul(mu, squares);
    g.add(volumetric, shear)
}
