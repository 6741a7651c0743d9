//! Tangents from moduli that somebody else has changed.
//!
//! ```text
//! A = ∂²ψ/∂H²                                         moduli at a point, symmetric, d² × d²
//! df = −Σ_q w_q det(∂X/∂ξ) (∂H/∂u)ᵀ A (∂H/∂u) v       tangent product for any A
//! ```
//!
//! With A as the law gives it this is the tangent of the [`Definition`]. It need not be positive: a compressed or sheared
//! element can soften so much that the linear system of an implicit step has negative curvature. Made positive at every
//! point, it gives a positive tangent, whose Newton steps always lead downhill (Teran, Sifakis, Irving and Fedkiw, "Robust
//! quasistatic finite elements and flesh simulation", 2005). How A is made positive is not said here: it takes an
//! eigendecomposition, which is no expression.

use crate::Definition;
use crate::definition::{block_terms, complete_blocks};
use souple_symbols::{Expr, Graph, Time};

/// Moduli of an association, and its tangent for given ones, as expressions of the leaves of its definition.
#[derive(Clone, Debug)]
pub struct Moduli {
    /// The graph of the definition, and these expressions; its leaves are those of the definition, and:
    pub graph: Graph,
    /// Moduli in Pa as symbols, the rows of the lower triangle one after the other (s(s + 1)/2 values for the s entries of H, varying over the
    /// points); components are [row, column] of H. Time Apply.
    pub given: Vec<Expr>,
    /// The law's own moduli, in the same order.
    pub own: Vec<Expr>,
    /// Tangent product with the given moduli, [node, axis].
    pub tangent_apply: Vec<Expr>,
    /// Tangent blocks with the given moduli, as [`Definition::tangent_blocks`].
    pub tangent_blocks: Vec<Expr>,
}

/// Writes the moduli that belong to a definition.
///
/// # Panics
/// When the loops of the definition are written out: moduli are an array over the points.
pub fn moduli(definition: &Definition) -> Moduli {
    let mut graph = definition.graph.clone();
    let g = &mut graph;
    let d = definition.dimension;
    let rolled = g.points() > 1;
    let ([plane], [volume], [slopes]) =
        (&definition.point_gradients[..], &definition.point_volumes[..], &definition.point_slopes[..])
    else {
        panic!("moduli are an array over the points of a rolled loop");
    };
    // Columns of H: tangents of the element where it does not fill its space.
    let e = slopes[0].len();
    let size = d * e;
    let gradient = &definition.displacement_gradient;
    let variables: Vec<Expr> = (0..size).map(|k| gradient.at(k / e, k % e)).collect();
    let here: Vec<Expr> = plane.entries.iter().flatten().copied().collect();
    let lower: Vec<(usize, usize)> = (0..size).flat_map(|p| (0..=p).map(move |q| (p, q))).collect();

    let one = g.int(1);
    let second: Vec<Vec<Expr>> = variables.iter().map(|&v| g.directional(&definition.stress, &[(v, one)])).collect();
    let own: Vec<Expr> = lower.iter().map(|&(p, q)| second[p][q]).collect();
    let mut replaced: Vec<(Expr, Expr)> = variables.iter().copied().zip(here.iter().copied()).collect();
    if let Some(embedding) = &definition.embedding {
        let tangents = embedding.point_tangents[0].entries.iter().flatten().copied();
        replaced.extend(embedding.tangents.entries.iter().flatten().copied().zip(tangents));
    }
    let own = g.substitute(&own, &replaced);

    let given: Vec<Expr> = lower
        .iter()
        .map(|(p, q)| {
            let name = format!("A_{p}{q}");
            if rolled { g.varying_symbol(name, Time::Apply) } else { g.symbol(name, Time::Apply) }
        })
        .collect();
    let entry = |p: usize, q: usize| given[p.max(q) * (p.max(q) + 1) / 2 + p.min(q)];
    let seeds: Vec<(Expr, Expr)> =
        definition.displacement.iter().copied().zip(definition.direction.iter().copied()).collect();
    let rates = g.directional(&here, &seeds);
    let stress_rates: Vec<Expr> = (0..size)
        .map(|p| {
            let terms: Vec<Expr> = (0..size).map(|q| g.mul(entry(p, q), rates[q])).collect();
            g.sum(&terms)
        })
        .collect();
    let weighted: Vec<Expr> = stress_rates.iter().map(|&s| g.mul(*volume, s)).collect();
    let blocks_weighted: Vec<Expr> =
        (0..size * size).map(|k| (k / size, k % size)).map(|(p, q)| g.mul(*volume, entry(p, q))).collect();
    let total = |g: &mut Graph, term: Expr| if rolled { g.point_sum(term) } else { term };
    let n = definition.node_count;
    // Row of node a: Σ_j s_ij ∇N_a,j; the first node takes what balances the others where slopes sum to zero.
    let first = usize::from(definition.rows_sum_to_zero);
    let mut rows: Vec<Vec<Expr>> = vec![Vec::new(); n];
    for a in first..n {
        for i in 0..d {
            let terms: Vec<Expr> = (0..e).map(|j| g.mul(weighted[i * e + j], slopes[a][j])).collect();
            let sum = g.sum(&terms);
            let sum = total(g, sum);
            rows[a].push(g.neg(sum));
        }
    }
    if first == 1 {
        rows[0] = (0..d)
            .map(|i| {
                let others: Vec<Expr> = (1..n).map(|a| rows[a][i]).collect();
                let sum = g.sum(&others);
                g.neg(sum)
            })
            .collect();
    }
    let terms = block_terms(g, &blocks_weighted, d, slopes, definition.rows_sum_to_zero);
    let summed: Vec<Expr> = terms.into_iter().map(|t| total(g, t)).collect();
    let tangent_blocks = complete_blocks(g, summed, n, d, definition.rows_sum_to_zero);
    Moduli { graph, given, own, tangent_apply: rows.concat(), tangent_blocks }
}
