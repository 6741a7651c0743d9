//! Neo-Hookean law that stays finite when elements flatten or invert.
//!
//! The published energy is m/2 (I₁ − 3) + l/2 (J − α)² − m/2 ln(I₁ + 1) with α = 1 + 3m/(4l). Its square, opened around
//! J = 1, is the form below up to a constant, which is chosen so that the energy is zero at rest:
//!
//! l/2 (J − α)² = l/2 (J − 1)² − 3m/4 (J − 1) + constant.
//!
//! Its small-strain tangent is that of Hooke's law with shear modulus 3m/4 and Lamé constant l − 5m/8; the law is
//! written in m = 4μ/3 and l = λ + 5μ/6, so that λ and μ have their usual meaning. l is positive for every ν > −1.
//! No logarithm or power of J occurs: energy, stress and tangent are finite for every F.

use crate::{ISOTROPIC, Kinematics, Law};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "stable-neo-hookean",
    name: "Stable neo-Hookean",
    about: "Soft tissue and flesh in robust simulations: finite for flattened and inverted elements, which it turns back.",
    formula: "m/2 (I₁ − 3) − m/2 ln((I₁ + 1)/4) + l/2 (J − 1)² − 3m/4 (J − 1),  m = 4μ/3,  l = λ + 5μ/6",
    references: &["Smith, de Goes and Kim, Stable neo-Hookean flesh simulation (2018), equations 13 to 16"],
    parameters: &ISOTROPIC,
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: J and I₁ keep their names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu, I1, J) = (k.lambda(), k.mu(), k.I1(), k.J());
    let g = &mut *k.graph;
    let half = Number::rational(1, 2);
    let (one, three) = (g.int(1), g.int(3));
    let m = g.scale(Number::rational(4, 3), mu);
    let l = g.linear(&[(Number::ONE, lambda), (Number::rational(5, 6), mu)]);
    let l = g.named("l", l);
    let volume_change = g.sub(J, one);
    let beyond = g.add(I1, one);
    let quarter = g.scale(Number::rational(1, 4), beyond);
    let barrier = g.ln(quarter);
    let terms = [(half, I1), (-half, three), (-half, barrier), (Number::rational(-3, 4), volume_change)];
    let stretch = g.linear(&terms);
    let shear = g.mul(m, stretch);
    let volumetric = g.scaled_powers(half, &[(l, 1), (volume_change, 2)]);
    g.add(shear, volumetric)
}
