//! St.Venant–Kirchhoff with fibres in one direction a₀ of the rest shape.
//!
//! a₀·E a₀ is the Green–Lagrange strain along the fibres. Pulled along a₀ with free sides, the isotropic part gives
//! the stress E ε and the fibres (E_f − E) ε: the small-strain modulus along the fibres is E_f exactly, and that
//! across is E in the limit of free fibres. Every E_f > 0 is stable at rest: of all strains with a given strain along
//! the fibres, free sides store the least energy, which is E_f/2 times its square.
//! The given direction need not have length one. As StVK, it softens and collapses under strong compression.

use crate::{Bound, Kinematics, Law, POISSON, Parameter, YOUNG};
use souple_symbols::{Expr, Number};

const DIRECTION: Parameter = Parameter {
    name: "direction_x",
    unit: "1",
    minimum: Bound::None,
    maximum: Bound::None,
    default: None,
    about: "x component of the fibres' direction in the rest shape, of any length but zero",
};

/// The law.
pub const LAW: Law = Law {
    id: "transverse-stvk",
    name: "Transversely isotropic St.Venant–Kirchhoff",
    about: "Tissue with one family of fibres (muscle, liver along its vessels) at small strains and large rotations.",
    formula: "λ/2 tr(E)² + μ tr(E²) + (E_f − young)/2 (a₀·E a₀)²,  E = (FᵀF − I)/2",
    references: &[
        "Picinbono, Delingette and Ayache, Non-linear anisotropic elasticity for real-time surgery simulation (2003)",
    ],
    parameters: &[
        YOUNG,
        POISSON,
        Parameter {
            name: "young_fibre",
            unit: "Pa",
            minimum: Bound::Open(0.0),
            maximum: Bound::None,
            default: None,
            about: "Young's modulus along the fibres E_f",
        },
        DIRECTION,
        Parameter {
            name: "direction_y",
            about: "y component of the fibres' direction in the rest shape, of any length but zero",
            ..DIRECTION
        },
        Parameter {
            name: "direction_z",
            about: "z component of the fibres' direction in the rest shape, of any length but zero",
            ..DIRECTION
        },
    ],
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: E is the Green–Lagrange strain")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu, E) = (k.lambda(), k.mu(), k.E());
    let (young, young_fibre) = (k.parameter("young"), k.parameter("young_fibre"));
    let fibre = k.unit_vector("direction");
    let g = &mut *k.graph;
    let trace = E.trace(g);
    let volumetric = g.scaled_powers(Number::rational(1, 2), &[(lambda, 1), (trace, 2)]);
    let squares = E.dot(g, &E);
    let shear = g.mul(mu, squares);
    let along = Kinematics::quadratic_form(g, &E, &fibre);
    let excess = g.sub(young_fibre, young);
    let fibres = g.scaled_powers(Number::rational(1, 2), &[(excess, 1), (along, 2)]);
    g.sum(&[volumetric, shear, fibres])
}
