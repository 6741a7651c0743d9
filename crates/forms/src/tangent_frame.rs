//! Lines and surfaces in a space of more dimensions: their measure, their tangents and the slopes along these.
//!
//! ```text
//! J = ∂X/∂ξ = Σ_a X_a ⊗ ∂N_a/∂ξ = T R        T: orthonormal tangents, R: upper triangular (Gram and Schmidt)
//! dA = det R dξ = √det(JᵀJ) dξ
//! ∂N_a/∂s = R⁻ᵀ ∂N_a/∂ξ                       slopes along the tangents; J⁺ = (JᵀJ)⁻¹Jᵀ = R⁻¹Tᵀ
//! ```
//!
//! Why not the pseudo-inverse itself? Slopes in space would have as many entries as space has axes, of which the tangents
//! determine all: with slopes along the tangents the deformation is described by D × d numbers instead of D × D.
//!
//! Everything here is known at rest.

use souple_symbols::{Expr, Graph, Matrix};

/// The tangents at a point, and what is measured along them.
pub(crate) struct TangentFrame {
    /// Unit tangents T in the rest shape, [space axis][tangent].
    pub(crate) tangents: Matrix,
    /// Length or area per length or area of the reference cell.
    pub(crate) measure: Expr,
    /// Slopes of the shape functions along the tangents in 1/m, [node][tangent].
    pub(crate) slopes: Vec<Vec<Expr>>,
}

/// The frame where the rest positions have the slopes `jacobian` ([space axis][reference axis]) and the shape functions
/// `slopes` ([node][reference axis]).
pub(crate) fn tangent_frame(g: &mut Graph, jacobian: &Matrix, slopes: &[Vec<Expr>]) -> TangentFrame {
    let columns: Vec<Vec<Expr>> =
        (0..slopes[0].len()).map(|k| jacobian.entries.iter().map(|row| row[k]).collect()).collect();
    let along = length(g, &columns[0]);
    let first = unit(g, &columns[0], along);
    // ∂N/∂s₁ = ∂N/∂ξ / R₁₁.
    let by_first: Vec<Expr> = slopes.iter().map(|s| g.div(s[0], along)).collect();
    let Some(second) = columns.get(1) else {
        let tangents = Matrix { entries: first.into_iter().map(|t| vec![t]).collect() };
        return TangentFrame { tangents, measure: along, slopes: by_first.into_iter().map(|s| vec![s]).collect() };
    };
    let shear = dot(g, &first, second);
    let rest: Vec<Expr> = second
        .iter()
        .zip(&first)
        .map(|(&x, &t)| {
            let part = g.mul(shear, t);
            g.sub(x, part)
        })
        .collect();
    let across = length(g, &rest);
    let other = unit(g, &rest, across);
    // ∂N/∂s₂ = (∂N/∂η − R₁₂ ∂N/∂s₁) / R₂₂.
    let slopes = slopes
        .iter()
        .zip(by_first)
        .map(|(s, by_first)| {
            let part = g.mul(shear, by_first);
            let left = g.sub(s[1], part);
            vec![by_first, g.div(left, across)]
        })
        .collect();
    let tangents = Matrix { entries: first.into_iter().zip(other).map(|(t, s)| vec![t, s]).collect() };
    TangentFrame { tangents, measure: g.mul(along, across), slopes }
}

fn dot(g: &mut Graph, a: &[Expr], b: &[Expr]) -> Expr {
    let products: Vec<Expr> = a.iter().zip(b).map(|(&x, &y)| g.mul(x, y)).collect();
    g.sum(&products)
}

fn length(g: &mut Graph, a: &[Expr]) -> Expr {
    let squared = dot(g, a, a);
    let length = g.sqrt(squared);
    g.named("L", length)
}

fn unit(g: &mut Graph, a: &[Expr], length: Expr) -> Vec<Expr> {
    a.iter()
        .map(|&x| {
            let t = g.div(x, length);
            g.named("T", t)
        })
        .collect()
}
