//! Averages over an element: what it shows of its stress and strain.
//!
//! ```text
//! σ = (1/v) ∫ σ dv = (1/v) Σ_q w_q det(∂X/∂ξ) P Fᵀ,   v = Σ_q w_q det(∂X/∂ξ) J,   P = ∂ψ/∂F
//! E = (1/V) ∫ E dV = (1/V) Σ_q w_q det(∂X/∂ξ) (FᵀF − I)/2,   V = Σ_q w_q det(∂X/∂ξ)
//! ```
//!
//! The Cauchy stress σ = P Fᵀ/J lives in the deformed shape and is averaged there: the volume ratio of the average cancels
//! that of the stress, so that no point divides by J. The Green–Lagrange strain lives at rest and is averaged there.
//! A small-strain law knows one shape only: its stress is the symmetric part of P itself, averaged at rest.
//!
//! In fewer dimensions than three the missing rows of H are zero (plane strain), the stresses across are not: P is
//! differentiated by all nine entries of H before those are set to zero.
//!
//! Not here: stresses at points or nodes. Nothing of this is used to compute forces, so it is written apart from the
//! [`Definition`], into a graph of its own, when somebody asks for it.

use crate::Definition;
use souple_laws::{Kinematics, Law};
use souple_symbols::{Expr, Graph, Matrix, Number, Time};

/// Entries of a symmetric tensor in the order in which they are given: xx, yy, zz, xy, yz, zx.
pub const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// Averages of an association as expressions of the leaves of its definition.
#[derive(Clone, Debug)]
pub struct Averages {
    /// The graph of the definition, and these expressions; its leaves are those of the definition.
    pub graph: Graph,
    /// Mean stress in Pa as in [`SYMMETRIC`], then the volume in m³ that it is the mean of: deformed for objective laws,
    /// at rest for others.
    pub stress: Vec<Expr>,
    /// Mean Green–Lagrange strain as in [`SYMMETRIC`], then the volume at rest in m³.
    pub strain: Vec<Expr>,
}

/// Writes the averages of a definition; `law` is the law that it was defined with.
pub fn averages(definition: &Definition, law: &Law) -> Averages {
    let mut graph = definition.graph.clone();
    let g = &mut graph;
    let d = definition.dimension;
    let names = ["x", "y", "z"];
    let rolled = g.points() > 1;
    // All nine entries of ∇u: those of the definition, and symbols for the directions that it lacks.
    let variables = Matrix::from_fn(3, |i, j| {
        if i < d && j < d {
            return definition.displacement_gradient.at(i, j);
        }
        let name = format!("H_{}{}", names[i], names[j]);
        if rolled { g.varying_symbol(name, Time::Step) } else { g.symbol(name, Time::Step) }
    });
    let named = law.parameters.iter().map(|p| p.name.to_string()).zip(definition.parameters.iter().copied()).collect();
    let energy = (law.energy)(&mut Kinematics::new(g, variables.clone(), named));
    let flat: Vec<Expr> = variables.entries.iter().flatten().copied().collect();
    let piola = g.gradient(energy, &flat);
    let piola = Matrix::from_fn(3, |i, j| piola[3 * i + j]);
    let identity = Matrix::identity(g, 3);
    let position_gradient = identity.add(g, &variables);
    let ratio = position_gradient.determinant(g);
    // Stress times the volume ratio, which an average over the deformed volume multiplies it by.
    let weighted_stress = if law.objective { piola.matmul(g, &position_gradient.transpose()) } else { piola };
    let cauchy_green = position_gradient.transpose().matmul(g, &position_gradient);
    let strain = cauchy_green.sub(g, &identity).scale(g, Number::rational(1, 2));
    let mut values = symmetric_part(g, &weighted_stress);
    values.extend(symmetric_part(g, &strain));
    values.push(ratio);

    let zero = g.int(0);
    let mut terms: Vec<Vec<Expr>> = vec![Vec::new(); values.len()];
    for (gradient, &volume) in definition.point_gradients.iter().zip(&definition.point_volumes) {
        let replaced: Vec<(Expr, Expr)> = (0..9)
            .map(|k| (k / 3, k % 3))
            .map(|(i, j)| (variables.at(i, j), if i < d && j < d { gradient.at(i, j) } else { zero }))
            .collect();
        for (terms, value) in terms.iter_mut().zip(g.substitute(&values, &replaced)) {
            terms.push(g.mul(volume, value));
        }
    }
    let mut integral = |terms: &[Expr]| {
        let sum = g.sum(terms);
        if rolled { g.point_sum(sum) } else { sum }
    };
    let rest_volume = integral(&definition.point_volumes);
    let integrals: Vec<Expr> = terms.iter().map(|terms| integral(terms)).collect();
    let volume = if law.objective { integrals[12] } else { rest_volume };
    let mean = |g: &mut Graph, integrals: &[Expr], volume: Expr| -> Vec<Expr> {
        let mut means: Vec<Expr> = integrals.iter().map(|&i| g.div(i, volume)).collect();
        means.push(volume);
        means
    };
    let stress = mean(g, &integrals[..6], volume);
    let strain = mean(g, &integrals[6..12], rest_volume);
    Averages { graph, stress, strain }
}

/// Entries of the symmetric part (A + Aᵀ)/2 as in [`SYMMETRIC`]: of a symmetric tensor, free of its roundings.
fn symmetric_part(g: &mut Graph, a: &Matrix) -> Vec<Expr> {
    let half = Number::rational(1, 2);
    SYMMETRIC.iter().map(|&(i, j)| g.linear(&[(half, a.at(i, j)), (half, a.at(j, i))])).collect()
}
