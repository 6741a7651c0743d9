//! The energy density of a line or a surface in space: any law, with the stretch across it eliminated.
//!
//! ```text
//! H = Σ_a u_a ⊗ ∂N_a/∂s                         displacement gradient along the tangents T, D × d
//! E = ½ (TᵀH + HᵀT + HᵀH),  ε = ½ (TᵀH + HᵀT)     strain in the frame of the tangents, d × d
//! E₃ = diag(E, n, …)                             the strain across is one number n: thickness, or both sides of a cable
//! ∂ψ/∂n = 0                                     no stress across: plane stress of a membrane, uniaxial stress of a cable
//! ∂ψ*/∂H = ∂ψ/∂H at that n                       (envelope theorem)
//! ```
//!
//! The strain is written without C, so that a small one loses no digits.
//!
//! Where ψ is quadratic in the strain across (Hooke, St.Venant–Kirchhoff), the condition is linear and n comes out in
//! closed form. Elsewhere the unknown is the logarithm y = ln(1 + 2n), which every real number is fit for; Newton's
//! method starts from the y of a Poisson's ratio of 1/3 and makes [`STEPS`] steps.

use souple_laws::{Kinematics, Law, TangentStrain};
use souple_symbols::{Equation, Expr, Graph, Matrix, Number, Time};

/// Newton's steps for the stretch across: ten leave a stress across below 10⁻⁹ of that along for all laws of the registry
/// while tangents are stretched by factors between 0.7 and 1.8. Exponential laws are the slowest: at twice the length both
/// ways, Fung's is not there yet.
pub(crate) const STEPS: usize = 10;

/// ψ at one point, and what belongs to it, as functions of H, T and an unknown that stands for the strain across.
pub(crate) struct PlaneStress {
    /// Energy density in J/m³ in H, T and the unknown.
    pub(crate) energy: Expr,
    /// The unknown: a symbol.
    pub(crate) unknown: Expr,
    /// Its value where there is no stress across, in H and T.
    pub(crate) root: Expr,
    /// Volume ratio in H, T and the unknown.
    pub(crate) ratio: Expr,
    /// Green–Lagrange strain in the frame, 3 × 3, in H, T and the unknown.
    pub(crate) strain: Matrix,
}

/// What the unknown is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Across {
    /// The strain itself, of the kind that the law is written in.
    Strain,
    /// The logarithm of the squared stretch.
    Logarithm,
}

/// Symbols of one kind: varying where points are summed in a loop.
pub(crate) fn leaf(g: &mut Graph, name: String, time: Time) -> Expr {
    if g.points() > 1 { g.varying_symbol(name, time) } else { g.symbol(name, time) }
}

/// Writes ψ for the displacement gradient `h` and the tangents `t`, both [space axis][tangent] and made of symbols.
pub(crate) fn plane_stress(
    g: &mut Graph,
    law: &Law,
    parameters: &[(String, Expr)],
    h: &Matrix,
    t: &Matrix,
) -> PlaneStress {
    let d = h.entries[0].len();
    let (small, green_lagrange) = strains(g, h, t);
    // The density in symbols of its own for the strain and the tangents: what the equation is written in.
    let pairs: Vec<(usize, usize)> = (0..d).flat_map(|i| (i..d).map(move |j| (i, j))).collect();
    let symbols = |g: &mut Graph, name: &str| -> Vec<Expr> {
        pairs.iter().map(|(i, j)| leaf(g, format!("{name}_{}{}", i + 1, j + 1), Time::Step)).collect()
    };
    let (large_symbols, small_symbols) = (symbols(g, "E"), symbols(g, "eps"));
    let given: Vec<(Expr, Expr)> = large_symbols
        .iter()
        .zip(&pairs)
        .map(|(&s, &(i, j))| (s, green_lagrange.at(i, j)))
        .chain(small_symbols.iter().zip(&pairs).map(|(&s, &(i, j))| (s, small.at(i, j))))
        .collect();
    let written = |g: &mut Graph, unknown: Expr, across: Across| {
        let strain = strain_with(g, d, &large_symbols, &small_symbols, unknown, across, law.objective, t);
        let (ratio, large) = (strain.J, strain.E.clone());
        let mut kinematics = Kinematics::in_tangent_frame(g, strain, parameters.to_vec());
        let energy = (law.energy)(&mut kinematics);
        assert!(!kinematics.gradient_missed(), "the caller asks `Law::embeddable` before");
        (energy, ratio, large)
    };
    let mut unknown = leaf(g, "n".into(), Time::Step);
    let (mut energy, mut ratio, mut strain) = written(g, unknown, Across::Strain);
    let slope = g.derivative(energy, unknown);
    let curve = g.derivative(slope, unknown);
    let mut residual = slope;
    if g.reachable(&[curve]).contains(&unknown) {
        unknown = leaf(g, "y".into(), Time::Step);
        (energy, ratio, strain) = written(g, unknown, Across::Logarithm);
        residual = g.derivative(energy, unknown);
    }
    // The tangents are arguments as well: they differ from point to point, and a law with a direction knows them.
    let present = g.reachable(&[residual]);
    let all = given.iter().copied().chain(t.entries.iter().flatten().map(|&e| (e, e)));
    let (arguments, operands) = all.filter(|(symbol, _)| present.contains(symbol)).unzip::<_, _, Vec<_>, Vec<_>>();
    // From det C of the tangents: −ν/(1 − ν) ln det C on a surface, −ν ln C on a line. Volume kept (ν = 1/2) would be a
    // worse start: exponential laws are too steep there.
    let squared = metric(g, d, &green_lagrange);
    let logarithm = g.ln(squared);
    let start = g.scale(if d == 2 { Number::rational(-1, 2) } else { Number::rational(-1, 3) }, logarithm);
    let root = g.root(&Equation { unknown, arguments, residual }, &operands, start, STEPS);
    let mut values = vec![energy, ratio];
    values.extend(strain.entries.iter().flatten());
    let values = g.substitute(&values, &given);
    let strain = Matrix::from_fn(3, |i, j| values[2 + 3 * i + j]);
    PlaneStress { energy: values[0], unknown, root, ratio: values[1], strain }
}

/// ε and E along the tangents, d × d.
fn strains(g: &mut Graph, h: &Matrix, t: &Matrix) -> (Matrix, Matrix) {
    let d = h.entries[0].len();
    let product = |g: &mut Graph, a: &Matrix, i: usize, b: &Matrix, j: usize| {
        let terms: Vec<Expr> = a.entries.iter().zip(&b.entries).map(|(x, y)| g.mul(x[i], y[j])).collect();
        g.sum(&terms)
    };
    let half = Number::rational(1, 2);
    let mut small = Vec::new();
    let mut large = Vec::new();
    for i in 0..d {
        for j in 0..d {
            // Entry (j, i) is the same node as entry (i, j).
            let (i, j) = (i.min(j), i.max(j));
            let (left, right) = (product(g, t, i, h, j), product(g, h, i, t, j));
            let linear = g.linear(&[(half, left), (half, right)]);
            let linear = g.named(format!("eps_{}{}", i + 1, j + 1), linear);
            let square = product(g, h, i, h, j);
            let sum = g.linear(&[(Number::ONE, linear), (half, square)]);
            small.push(linear);
            large.push(g.named(format!("E_{}{}", i + 1, j + 1), sum));
        }
    }
    (Matrix::from_fn(d, |i, j| small[i * d + j]), Matrix::from_fn(d, |i, j| large[i * d + j]))
}

/// det(I + 2E) of the strain along the tangents: the squared ratio of lengths or areas.
fn metric(g: &mut Graph, d: usize, strain: &Matrix) -> Expr {
    let doubled = Matrix::from_fn(d, |i, j| strain.at(i, j)).scale(g, Number::Rational(2, 1));
    let identity = Matrix::identity(g, d);
    let metric = identity.add(g, &doubled).determinant(g);
    g.named("C_det", metric)
}

/// The 3 × 3 measures of a strain along the tangents (upper triangles) and the unknown across them.
#[expect(clippy::too_many_arguments, reason = "one place, and each is what it says")]
#[expect(non_snake_case, reason = "docs/notation.md: E and J keep their usual names")]
fn strain_with(
    g: &mut Graph,
    d: usize,
    large: &[Expr],
    small: &[Expr],
    unknown: Expr,
    across: Across,
    objective: bool,
    t: &Matrix,
) -> TangentStrain {
    let one = g.int(1);
    let two = Number::Rational(2, 1);
    // Squared stretch c, stretch s, and the strains (c − 1)/2 and s − 1.
    let (squared, stretch) = match (across, objective) {
        (Across::Logarithm, _) => {
            let squared = g.exp(unknown);
            (squared, g.sqrt(squared))
        }
        (Across::Strain, true) => {
            let squared = g.linear(&[(two, unknown), (Number::ONE, one)]);
            (squared, g.sqrt(squared))
        }
        (Across::Strain, false) => {
            let stretch = g.add(one, unknown);
            (g.powi(stretch, 2), stretch)
        }
    };
    let (green, linear) = if across == Across::Strain && objective {
        (unknown, g.sub(stretch, one))
    } else if across == Across::Strain {
        let half = g.linear(&[(Number::rational(1, 2), squared), (Number::rational(-1, 2), one)]);
        (half, unknown)
    } else {
        let half = g.linear(&[(Number::rational(1, 2), squared), (Number::rational(-1, 2), one)]);
        (half, g.sub(stretch, one))
    };
    let zero = g.int(0);
    let fill = |along: &[Expr], normal: Expr| {
        Matrix::from_fn(3, |i, j| match (i.min(j), i.max(j)) {
            (0, 0) => along[0],
            (0, 1) if d == 2 => along[1],
            (1, 1) if d == 2 => along[2],
            (i, j) if i == j => normal,
            _ => zero,
        })
    };
    let E = fill(large, green);
    let along = metric(g, d, &E);
    let J = if d == 2 {
        let cubed = g.mul(along, squared);
        g.sqrt(cubed)
    } else {
        let length = g.sqrt(along);
        g.mul(length, squared)
    };
    let axes = t.entries.len();
    let tangents = (0..d).map(|k| std::array::from_fn(|i| if i < axes { t.entries[i][k] } else { zero })).collect();
    TangentStrain { E, epsilon: fill(small, linear), J, tangents }
}
