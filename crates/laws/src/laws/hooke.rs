//! Hooke's law: the linear theory.

use crate::{ISOTROPIC, Kinematics, Law};
use souple_symbols::{Expr, Number};

/// The law.
pub const LAW: Law = Law {
    id: "hooke",
    name: "Hooke",
    about: "Linear elasticity: for small displacements only; a rotation of the body strains it.",
    formula: "λ/2 tr(ε)² + μ tr(ε²),  ε = (∇u + ∇uᵀ)/2",
    references: &["Faure, Approche formelle pour la simulation interactive de modèles mixtes (2014), section 2.2"],
    parameters: &ISOTROPIC,
    objective: false,
    energy: &energy,
};

fn energy(k: &mut Kinematics<'_>) -> Expr {
    let (lambda, mu, epsilon) = (k.lambda(), k.mu(), k.epsilon());
    let g = &mut *k.graph;
    let trace = epsilon.trace(g);
    let volumetric = g.scaled_powers(Number::rational(1, 2), &[(lambda, 1), (trace, 2)]);
    let squares = epsilon.dot(g, &epsilon);
    let shear = g.mul(mu, squares);
    g.add(volumetric, shear)
}
