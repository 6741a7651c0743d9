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
//! A line or a surface in space has P = ∂ψ/∂H and F = T + H along its tangents T, [space axis][tangent], so that P Fᵀ is
//! the stress in space already, without any across; its strain is turned into space, with the part across:
//! E = T E_in Tᵀ + E_n (I − T Tᵀ).
//!
//! Not here: stresses at points or nodes. Nothing of this is used to compute forces, so it is written apart from the
//! [`Definition`], into a graph of its own, when somebody asks for it.

use crate::{Definition, Embedding};
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
    let Local { variables, weighted_stress, strain, ratio } = match &definition.embedding {
        None => solid(g, definition, law),
        Some(embedding) => embedded(g, definition, embedding, law),
    };
    let mut values = symmetric_part(g, &weighted_stress);
    values.extend(symmetric_part(g, &strain));
    values.push(ratio);

    let rolled = g.points() > 1;
    let zero = g.int(0);
    let mut terms: Vec<Vec<Expr>> = vec![Vec::new(); values.len()];
    for (point, &volume) in definition.point_volumes.iter().enumerate() {
        let gradient = &definition.point_gradients[point];
        let mut replaced: Vec<(Expr, Expr)> =
            variables.iter().map(|v| (v.symbol, v.at.map_or(zero, |(i, j)| gradient.at(i, j)))).collect();
        if let Some(embedding) = &definition.embedding {
            let tangents = embedding.point_tangents[point].entries.iter().flatten().copied();
            replaced.extend(embedding.tangents.entries.iter().flatten().copied().zip(tangents));
        }
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

/// What is averaged, at one point, as a function of a displacement gradient in symbols (and of tangents).
struct Local {
    variables: Vec<Variable>,
    /// Stress times the volume ratio, which an average over the deformed volume multiplies it by; 3 × 3.
    weighted_stress: Matrix,
    /// Green–Lagrange strain, 3 × 3.
    strain: Matrix,
    ratio: Expr,
}

/// A symbol for an entry of the displacement gradient.
struct Variable {
    symbol: Expr,
    /// Row and column; `None` for a direction that the element does not have, where it is zero.
    at: Option<(usize, usize)>,
}

fn solid(g: &mut Graph, definition: &Definition, law: &Law) -> Local {
    let d = definition.dimension;
    let names = ["x", "y", "z"];
    let rolled = g.points() > 1;
    // All nine entries of ∇u: those of the definition, and symbols for the directions that it lacks.
    let gradient = Matrix::from_fn(3, |i, j| {
        if i < d && j < d {
            return definition.displacement_gradient.at(i, j);
        }
        let name = format!("H_{}{}", names[i], names[j]);
        if rolled { g.varying_symbol(name, Time::Step) } else { g.symbol(name, Time::Step) }
    });
    let named = law.parameters.iter().map(|p| p.name.to_string()).zip(definition.parameters.iter().copied()).collect();
    let energy = (law.energy)(&mut Kinematics::new(g, gradient.clone(), named));
    let flat: Vec<Expr> = gradient.entries.iter().flatten().copied().collect();
    let piola = g.gradient(energy, &flat);
    let piola = Matrix::from_fn(3, |i, j| piola[3 * i + j]);
    let identity = Matrix::identity(g, 3);
    let position_gradient = identity.add(g, &gradient);
    let ratio = position_gradient.determinant(g);
    let weighted_stress = if law.objective { piola.matmul(g, &position_gradient.transpose()) } else { piola };
    let cauchy_green = position_gradient.transpose().matmul(g, &position_gradient);
    let strain = cauchy_green.sub(g, &identity).scale(g, Number::rational(1, 2));
    let variables = (0..9)
        .map(|k| (k / 3, k % 3))
        .map(|(i, j)| Variable { symbol: gradient.at(i, j), at: (i < d && j < d).then_some((i, j)) })
        .collect();
    Local { variables, weighted_stress, strain, ratio }
}

fn embedded(g: &mut Graph, definition: &Definition, embedding: &Embedding, law: &Law) -> Local {
    let (gradient, tangents) = (&definition.displacement_gradient, &embedding.tangents);
    let (d, e) = (definition.dimension, gradient.entries[0].len());
    let zero = g.int(0);
    // Zeros in the missing rows and columns make everything 3 × 3.
    let padded = |m: &Matrix| Matrix::from_fn(3, |i, j| if i < d && j < e { m.at(i, j) } else { zero });
    let (full, frame) = (padded(gradient), padded(tangents));
    let piola = Matrix::from_fn(3, |i, j| if i < d && j < e { definition.stress[i * e + j] } else { zero });
    let position_gradient = if law.objective { frame.add(g, &full) } else { frame.clone() };
    let weighted_stress = piola.matmul(g, &position_gradient.transpose());
    // The strain across multiplies the identity, that along less the strain across the tangents.
    let across = embedding.strain.at(2, 2);
    let identity = Matrix::identity(g, 3);
    let across = identity.times(g, across);
    let excess = embedding.strain.sub(g, &across);
    let along = Matrix::from_fn(3, |i, j| if i < e && j < e { excess.at(i, j) } else { zero });
    let along = frame.matmul(g, &along).matmul(g, &frame.transpose());
    let strain = across.add(g, &along);
    let variables = (0..d * e)
        .map(|k| (k / e, k % e))
        .map(|(i, j)| Variable { symbol: gradient.at(i, j), at: Some((i, j)) })
        .collect();
    Local { variables, weighted_stress, strain, ratio: embedding.volume_ratio }
}

/// Entries of the symmetric part (A + Aᵀ)/2 as in [`SYMMETRIC`]: of a symmetric tensor, free of its roundings.
fn symmetric_part(g: &mut Graph, a: &Matrix) -> Vec<Expr> {
    let half = Number::rational(1, 2);
    SYMMETRIC.iter().map(|&(i, j)| g.linear(&[(half, a.at(i, j)), (half, a.at(j, i))])).collect()
}
