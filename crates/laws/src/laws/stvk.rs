//! St.Venant–Kirchhoff: Hooke's energy with the Green–Lagrange strain.

use crate::{ISOTROPIC, Kinematics, Law};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "stvk",
    name: "St.Venant–Kirchhoff",
    about: "Large displacements and rotations with small strains; it softens and collapses under strong compression.",
    formula: "λ/2 tr(E)² + μ tr(E²),  E = (FᵀF − I)/2",
    references: &["Faure, Approche formelle pour la simulation interactive de modèles mixtes (2014), section 2.2"],
    parameters: &ISOTROPIC,
    objective: true,
    energy: &energy,
};

#[expect(non_snake_case, reason = "docs/notation.md: E is the Green–Lagrange strain")]
fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu, E) = (k.lambda(), k.mu(), k.E());
    let g = &mut *k.graph;
    let trace = E.trace(g);
    let volumetric = g.scaled_powers(Number::rational(1, 2), &[(lambda, 1), (trace, 2)]);
    let squares = E.dot(g, &E);
    let shear = g.mul(mu, squares);
    g.add(volumetric, shear)
}
