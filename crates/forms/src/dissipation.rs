//! Kelvin–Voigt viscosity: a quadratic form of the velocities, added to whatever the elastic law is.
//!
//! ```text
//! D(u, v) = Σ_q w_q det(∂X/∂ξ) [ η dev(Ė):dev(Ė) + ζ/2 (tr Ė)² ],   Ė = sym(Fᵀ ∂v/∂X)
//! f = −∂D/∂v,   C = ∂²D/∂v²
//! ```
//!
//! So the second Piola–Kirchhoff stress is 2η dev(Ė) + ζ tr(Ė) I; for small strains this is the Cauchy stress
//! 2η dev(ε̇) + ζ tr(ε̇) I. The rate of the Green–Lagrange strain vanishes in every rigid motion, so rotations are not
//! damped, also beside a law for small strains. 2D is the rate of working: it is never negative.
//!
//! Not here: how C depends on u. Forces are exact; matrices of implicit steps leave ∂C/∂u out, which keeps them
//! symmetric and lets Newton's method converge, a little slower.

use crate::Definition;
use crate::definition::{block_terms, complete_blocks};
use souple_symbols::{Expr, Graph, Matrix, Number, Time};

/// The viscous part of an association as expressions of the leaves of its definition.
#[derive(Clone, Debug)]
pub struct Dissipation {
    /// The graph of the definition, and these expressions; its leaves are those of the definition, and:
    pub graph: Graph,
    /// Shear viscosity η and bulk viscosity ζ in Pa s; time Setup.
    pub viscosity: [Expr; 2],
    /// C(u) v in N for the direction v in m/s, [node, axis].
    pub product: Vec<Expr>,
    /// Blocks of C in N s/m, as [`Definition::tangent_blocks`].
    pub blocks: Vec<Expr>,
}

/// Writes the viscous part that belongs to a definition.
///
/// # Panics
/// When the element does not fill its space: what is viscous across it is not said.
pub fn dissipation(definition: &Definition) -> Dissipation {
    let mut graph = definition.graph.clone();
    let g = &mut graph;
    let d = definition.dimension;
    assert!(definition.embedding.is_none(), "viscosity is for elements that fill their space");
    let rolled = g.points() > 1;
    let viscosity = ["eta", "zeta"].map(|name| g.symbol(name, Time::Setup));
    let names = ["x", "y", "z"];
    let zero = g.int(0);
    let gradient = &definition.displacement_gradient;
    let variables: Vec<Expr> = (0..d * d).map(|k| gradient.at(k / d, k % d)).collect();
    let rates: Vec<Expr> = (0..d * d)
        .map(|k| {
            let name = format!("dH_{}{}", names[k / d], names[k % d]);
            if rolled { g.varying_symbol(name, Time::Apply) } else { g.symbol(name, Time::Apply) }
        })
        .collect();
    let rate_gradient = Matrix::from_fn(3, |i, j| if i < d && j < d { rates[i * d + j] } else { zero });
    let identity = Matrix::identity(g, 3);
    let full = Matrix::from_fn(3, |i, j| if i < d && j < d { gradient.at(i, j) } else { zero });
    let position_gradient = identity.add(g, &full);
    let product = position_gradient.transpose().matmul(g, &rate_gradient);
    let strain_rate = product.add(g, &product.transpose()).scale(g, Number::rational(1, 2));
    let density = density(g, &strain_rate, viscosity);
    let stress = g.gradient(density, &rates);
    let one = g.int(1);
    let second: Vec<Expr> = rates.iter().flat_map(|&r| g.directional(&stress, &[(r, one)])).collect();

    let seeds: Vec<(Expr, Expr)> =
        definition.displacement.iter().copied().zip(definition.direction.iter().copied()).collect();
    let mut densities = Vec::new();
    let mut blocks: Vec<Vec<Expr>> = Vec::new();
    for (point, &volume) in definition.point_volumes.iter().enumerate() {
        let here: Vec<Expr> = definition.point_gradients[point].entries.iter().flatten().copied().collect();
        let here_rates = g.directional(&here, &seeds);
        let pairs = |from: &[Expr], to: &[Expr]| -> Vec<(Expr, Expr)> {
            from.iter().copied().zip(to.iter().copied()).collect()
        };
        let mut replaced = pairs(&variables, &here);
        let weighted: Vec<Expr> = g.substitute(&second, &replaced).into_iter().map(|s| g.mul(volume, s)).collect();
        blocks.push(block_terms(g, &weighted, d, &definition.point_slopes[point], definition.rows_sum_to_zero));
        replaced.extend(pairs(&rates, &here_rates));
        let value = g.substitute(&[density], &replaced)[0];
        densities.push(g.multiply_through(volume, value));
    }
    let total = |g: &mut Graph, terms: &[Expr]| {
        let sum = g.sum(terms);
        if rolled { g.point_sum(sum) } else { sum }
    };
    let dissipated = total(g, &densities);
    let product = g.gradient(dissipated, &definition.direction);
    let summed: Vec<Expr> = (0..blocks[0].len())
        .map(|k| {
            let terms: Vec<Expr> = blocks.iter().map(|p| p[k]).collect();
            total(g, &terms)
        })
        .collect();
    let blocks = complete_blocks(g, summed, definition.node_count, d, definition.rows_sum_to_zero);
    Dissipation { graph, viscosity, product, blocks }
}

/// η dev(Ė):dev(Ė) + ζ/2 (tr Ė)², in J/(m³ s), with dev(Ė):dev(Ė) = Ė:Ė − (tr Ė)²/3.
fn density(g: &mut Graph, rate: &Matrix, [eta, zeta]: [Expr; 2]) -> Expr {
    let trace = rate.trace(g);
    let squares = rate.dot(g, rate);
    let traced = g.powi(trace, 2);
    let deviator = g.linear(&[(Number::ONE, squares), (Number::rational(-1, 3), traced)]);
    let shear = g.mul(eta, deviator);
    let bulk = g.scaled_powers(Number::rational(1, 2), &[(zeta, 1), (traced, 1)]);
    g.add(shear, bulk)
}
