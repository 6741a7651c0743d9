//! Fung's exponential law, in its isotropic form, with the Green–Lagrange strain E = (FᵀF − I)/2.
//!
//! Q = b1 tr(E²) + b2 (tr E)² is the general isotropic quadratic form of E. At small strain this is Hooke's law with
//! μ = c b1 / 2 and λ = c b2 + κ. Collagen stiffens exponentially under tension; so does this law under compression,
//! up to where E ends (−1/2 per direction): there the energy stays finite, also for J ≤ 0, and does not prevent
//! inversion. Large strains make exp Q overflow: Q above some hundreds is outside of what the law describes.

use crate::{BULK, Bound, Kinematics, Law, Parameter};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "fung",
    name: "Fung",
    about: "Collagenous tissue that stiffens exponentially (skin, vessels, ligaments); it hardly resists being crushed.",
    formula: "c/2 (exp Q − 1) + κ/2 (J − 1)²,  Q = b1 tr(E²) + b2 (tr E)²",
    references: &[
        "Fung, Elasticity of soft tissues in simple elongation (1967)",
        "Fung, Biomechanics: mechanical properties of living tissues, 2nd edition (1993), chapter 8",
    ],
    parameters: &[
        Parameter {
            name: "c",
            unit: "Pa",
            minimum: Bound::Open(0.0),
            maximum: Bound::None,
            default: None,
            about: "scale of the stress",
        },
        Parameter {
            name: "b1",
            unit: "1",
            minimum: Bound::Open(0.0),
            maximum: Bound::None,
            default: None,
            about: "stiffening with tr(E²); c b1 / 2 is the shear modulus at small strain",
        },
        Parameter {
            name: "b2",
            unit: "1",
            minimum: Bound::Closed(0.0),
            maximum: Bound::None,
            default: None,
            about: "stiffening with (tr E)²; c b2 + κ is Lamé's first constant at small strain",
        },
        Parameter {
            about: "modulus κ of the volumetric term; the bulk modulus at small strain is κ + c (b2 + b1/3)",
            ..BULK
        },
    ],
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: E is the Green–Lagrange strain")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (c, b1, b2, E) = (k.parameter("c"), k.parameter("b1"), k.parameter("b2"), k.E());
    let volumetric = k.volumetric();
    let g = &mut *k.graph;
    let squares = E.dot(g, &E);
    let squares = g.mul(b1, squares);
    let trace = E.trace(g);
    let traces = g.scaled_powers(Number::ONE, &[(b2, 1), (trace, 2)]);
    let exponent = g.add(squares, traces);
    let exponential = g.exp(exponent);
    let one = g.int(1);
    let growth = g.sub(exponential, one);
    let tissue = g.scaled_powers(Number::rational(1, 2), &[(c, 1), (growth, 1)]);
    g.add(tissue, volumetric)
}
