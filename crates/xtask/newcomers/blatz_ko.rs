//! Blatz–Ko: foamed rubber.

use crate::{Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "blatz-ko",
    name: "Blatz–Ko",
    about: "Foamed rubber at large stretch and compression; at small strain it is Hooke's law with Poisson's ratio 1/4.",
    formula: "μ/2 (I₂/J² + 2 J − 5)",
    references: &["Blatz and Ko, Trans. Soc. Rheology 6 (1962) 223–252"],
    parameters: &[Parameter {
        name: "shear",
        unit: "Pa",
        minimum: Bound::Open(0.0),
        maximum: Bound::None,
        default: None,
        about: "shear modulus at rest",
    }],
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: J and I2 keep their usual names")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (mu, I2, J) = (k.parameter("shear"), k.I2(), k.J());
    let g = &mut *k.graph;
    let ratio = g.scaled_powers(Number::ONE, &[(I2, 1), (J, -2)]);
    let one = g.int(1);
    let sum = g.linear(&[(Number::ONE, ratio), (Number::Rational(2, 1), J), (Number::Rational(-5, 1), one)]);
    let half = g.rational(1, 2);
    g.product(&[half, mu, sum])
}
