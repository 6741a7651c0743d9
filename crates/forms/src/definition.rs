//! The definition of an association as expressions, before any staging.

use crate::plane_stress::{leaf, plane_stress};
use crate::tangent_frame::tangent_frame;
use souple_elements::{Element, Rule};
use souple_laws::{Kinematics, Law};
use souple_symbols::{Expr, Graph, Matrix, Number, Time};

/// How the sum over quadrature points is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Loops {
    /// A loop over the points with tables of constants: short programs.
    #[default]
    Rolled,
    /// Every point written out with its own constants: long programs that share between points.
    Unrolled,
}

/// Everything known of an association, as expressions of one graph.
///
/// Arrays over nodes and axes are flat, [node, axis], with `dimension` axes.
#[derive(Clone, Debug)]
pub struct Definition {
    /// The graph that all expressions belong to.
    pub graph: Graph,
    /// Number of space dimensions: those of the element, or more.
    pub dimension: usize,
    /// Number of nodes.
    pub node_count: usize,
    /// Rest positions X in m, [node, axis]; time Setup.
    pub rest: Vec<Expr>,
    /// The law's parameters in their declared order; time Setup.
    pub parameters: Vec<Expr>,
    /// Density ρ in kg/m³; time Setup.
    pub density: Expr,
    /// What an embedded element is multiplied by to fill space: thickness in m of a surface, cross-section in m² of a
    /// line; time Setup. Elements that fill their space do not depend on it.
    pub section: Expr,
    /// Displacements u in m, [node, axis]; time Step.
    pub displacement: Vec<Expr>,
    /// A direction v, [node, axis]; time Apply.
    pub direction: Vec<Expr>,
    /// Energy W in J.
    pub energy: Expr,
    /// Forces −∂W/∂u in N, [node, axis].
    pub force: Vec<Expr>,
    /// Tangent product (∂f/∂u) v, [node, axis].
    pub tangent_apply: Vec<Expr>,
    /// Blocks −∂f_a/∂u_b in N/m for a ≤ b: [pair (a, b) in rows of the upper triangle, row axis, column axis].
    pub tangent_blocks: Vec<Expr>,
    /// Volume ratio J = det(I + H) at the quadrature points: one expression that varies over them, or one per point.
    pub volume_ratio: Vec<Expr>,
    /// Volume in the deformed shape, in m³.
    pub deformed_volume: Expr,
    /// ∫ρ N_a in kg, [node]: the load of a unit acceleration.
    pub shape_mass: Vec<Expr>,
    /// Lumped masses in kg, [node], positive and summing to the element's mass.
    pub lumped_mass: Vec<Expr>,
    /// A displacement gradient as independent symbols, [space axis][element axis].
    pub displacement_gradient: Matrix,
    /// Energy density ψ in J/m³ as a function of these symbols.
    pub energy_density: Expr,
    /// First Piola–Kirchhoff stress ∂ψ/∂H in Pa as a function of them, [space axis, element axis].
    pub stress: Vec<Expr>,
    /// Displacement gradients H at the quadrature points, [space axis][element axis]: one matrix that varies over them, or
    /// one per point.
    pub point_gradients: Vec<Matrix>,
    /// Weights times volume elements in m³ at the quadrature points, likewise.
    pub point_volumes: Vec<Expr>,
    /// Gradients ∇N_a in 1/m at the quadrature points, [point][node][axis], likewise.
    pub point_slopes: Vec<Vec<Vec<Expr>>>,
    /// Whether gradients sum to zero over the nodes, so that the first node's forces balance those of the others.
    pub rows_sum_to_zero: bool,
    /// What a line or a surface in space has besides; `None` for elements that fill their space.
    pub embedding: Option<Embedding>,
}

/// Tangents and strain of an element that does not fill its space.
#[derive(Clone, Debug)]
pub struct Embedding {
    /// Unit tangents as independent symbols, [space axis][tangent]; time Setup.
    pub tangents: Matrix,
    /// The tangents at the quadrature points: one matrix that varies over them, or one per point.
    pub point_tangents: Vec<Matrix>,
    /// Green–Lagrange strain in the frame of the tangents, 3 × 3, as a function of the displacement gradient and the
    /// tangents.
    pub strain: Matrix,
    /// Volume ratio likewise.
    pub volume_ratio: Expr,
}

/// Expressions with symbols replaced; as they are when there is nothing to replace.
fn put_in(g: &mut Graph, expressions: &[Expr], replaced: &[(Expr, Expr)]) -> Vec<Expr> {
    if replaced.is_empty() { expressions.to_vec() } else { g.substitute(expressions, replaced) }
}

/// One quadrature point, or all of them at once when loops are rolled.
struct Point {
    /// Shape functions, [node].
    shape: Vec<Expr>,
    /// Their derivatives by the reference coordinates, [node][axis].
    slopes: Vec<Vec<Expr>>,
    weight: Expr,
}

/// Writes the definition of element × law × quadrature in a space of `dimension` axes.
///
/// In a space of more dimensions than its own, an element is a cable or a membrane: its gradients are along its tangents
/// and the stress across them vanishes.
///
/// # Panics
/// When the rule is not on the element's family, the element has more dimensions than space, or the law cannot be
/// embedded ([`Law::embeddable`]) and would have to be.
pub fn define(element: &Element, law: &Law, rule: &Rule, loops: Loops, dimension: usize) -> Definition {
    assert_eq!(element.family, rule.family, "the rule belongs to the element's family");
    // Axes of space, and of the element: rows and columns of a displacement gradient.
    let (n, d, e) = (element.node_count(), dimension, element.dimension());
    assert!(e <= d && d <= 3, "an element of dimension {e} does not fit into {d}");
    let embedded = e < d;
    let count = rule.points.len();
    let rolled = loops == Loops::Rolled && count > 1;
    let mut graph = Graph::with_points(if rolled { count } else { 1 });
    let g = &mut graph;
    let names = ["x", "y", "z"];
    let leaves = |g: &mut Graph, prefix: &str, time| -> Vec<Expr> {
        (0..n * d).map(|k| g.symbol(format!("{prefix}_{}{}", k / d, names[k % d]), time)).collect()
    };
    let rest = leaves(g, "X", Time::Setup);
    let parameters: Vec<Expr> = law.parameters.iter().map(|p| g.symbol(p.name, Time::Setup)).collect();
    let density = g.symbol("rho", Time::Setup);
    let section = g.symbol(if e == 1 { "A" } else { "h" }, Time::Setup);
    let displacement = leaves(g, "u", Time::Step);
    let direction = leaves(g, "v", Time::Apply);

    // The energy density as a function of the displacement gradient alone, and its derivatives by it.
    let zero = g.int(0);
    let symbols = |g: &mut Graph, prefix: &str, time| Matrix {
        entries: (0..d)
            .map(|i| (0..e).map(|j| leaf(g, format!("{prefix}_{}{}", names[i], names[j]), time)).collect())
            .collect(),
    };
    let displacement_gradient = symbols(g, "H", Time::Step);
    let variables: Vec<Expr> = displacement_gradient.entries.iter().flatten().copied().collect();
    let full = Matrix::from_fn(3, |i, j| if i < d && j < e { displacement_gradient.at(i, j) } else { zero });
    let named: Vec<(String, Expr)> =
        law.parameters.iter().map(|p| p.name.to_string()).zip(parameters.iter().copied()).collect();
    let across = embedded.then(|| {
        let tangents = symbols(g, "T", Time::Setup);
        let found = plane_stress(g, law, &named, &displacement_gradient, &tangents);
        (found, tangents)
    });
    let held_density = match &across {
        Some((found, _)) => found.energy,
        None => (law.energy)(&mut Kinematics::new(g, full.clone(), named)),
    };
    // By the envelope theorem the stress is the derivative with the strain across held; only then is it put in.
    let held_stress = g.gradient(held_density, &variables);
    let stress = put_in(g, &held_stress, across.as_ref().map(|(found, _)| (found.unknown, found.root)).as_slice());
    let one = g.int(1);
    let second_derivatives: Vec<Expr> = variables.iter().flat_map(|&v| g.directional(&stress, &[(v, one)])).collect();

    let points = tabulate(g, element, rule, rolled);
    let constant_sum = slopes_sum_to_zero(g, &points);
    let mut energies = Vec::new();
    let mut masses: Vec<Vec<Expr>> = Vec::new();
    let mut squares: Vec<Vec<Expr>> = Vec::new();
    let mut blocks: Vec<Vec<Expr>> = Vec::new();
    let mut volumes = Vec::new();
    let mut volume_ratio = Vec::new();
    let mut point_gradients = Vec::new();
    let mut point_slopes = Vec::new();
    let ratio = match &across {
        Some((found, _)) => found.ratio,
        None => {
            let identity = Matrix::identity(g, 3);
            identity.add(g, &full).determinant(g)
        }
    };
    let mut point_tangents = Vec::new();
    // Symbols of the strain across at the points, with what they stand for.
    let mut across_at_points: Vec<(Expr, Expr)> = Vec::new();
    for point in &points {
        // Position gradient ∂X_i/∂ξ_k.
        let jacobian = interpolate_gradient(g, &rest, &point.slopes, d, constant_sum);
        let (measure, mut gradients) = if embedded {
            let frame = tangent_frame(g, &jacobian, &point.slopes);
            point_tangents.push(frame.tangents);
            (g.mul(frame.measure, section), frame.slopes)
        } else {
            let determinant = jacobian.determinant(g);
            let inverse = jacobian.inverse(g);
            // ∇N_a = (∂N_a/∂ξ) (∂ξ/∂X), [node][axis].
            (determinant, point.slopes.iter().map(|s| inverse.transpose().apply(g, s)).collect::<Vec<_>>())
        };
        for (a, gradient) in gradients.iter_mut().enumerate() {
            for (j, component) in gradient.iter_mut().enumerate() {
                *component = g.named(format!("G_{a}{}", names[j]), *component);
            }
        }
        let plane = interpolate_gradient(g, &displacement, &gradients, d, constant_sum);
        let volume = g.mul(point.weight, measure);
        let volume = g.named("dV", volume);
        let mut replaced: Vec<(Expr, Expr)> =
            variables.iter().copied().zip(plane.entries.iter().flatten().copied()).collect();
        if let (Some((found, symbols)), Some(values)) = (&across, point_tangents.last()) {
            let values: &Matrix = values;
            replaced.extend(symbols.entries.iter().flatten().copied().zip(values.entries.iter().flatten().copied()));
            let symbol = leaf(g, "n".into(), Time::Step);
            let value = g.substitute(&[found.root], &replaced)[0];
            across_at_points.push((symbol, value));
            replaced.push((found.unknown, symbol));
        }
        let here = g.substitute(&[held_density, ratio], &replaced);
        volume_ratio.push(here[1]);
        energies.push(g.multiply_through(volume, here[0]));
        let mass: Vec<Expr> = point.shape.iter().map(|&s| g.product(&[volume, density, s])).collect();
        squares.push(mass.iter().zip(&point.shape).map(|(&m, &s)| g.mul(m, s)).collect());
        masses.push(mass);
        let second = g.substitute(&second_derivatives, &replaced);
        let weighted: Vec<Expr> = second.into_iter().map(|s| g.mul(volume, s)).collect();
        blocks.push(block_terms(g, &weighted, d, &gradients, constant_sum));
        point_slopes.push(gradients);
        volumes.push(volume);
        point_gradients.push(plane);
    }
    let total = |g: &mut Graph, terms: &[Expr]| {
        let sum = g.sum(terms);
        if rolled { g.point_sum(sum) } else { sum }
    };
    let energy = total(g, &energies);
    // The force is the gradient of −W: the minus reaches the earliest factor, where it costs nothing.
    let negative: Vec<Expr> = energies.iter().map(|&e| g.neg(e)).collect();
    let negative = total(g, &negative);
    let force = g.gradient(negative, &displacement);
    // With the strain across held so far, all of this is put in place of its symbol.
    let energy = put_in(g, &[energy], &across_at_points)[0];
    let force = put_in(g, &force, &across_at_points);
    let volume_ratio = put_in(g, &volume_ratio, &across_at_points);
    let seeds: Vec<(Expr, Expr)> = displacement.iter().copied().zip(direction.iter().copied()).collect();
    let tangent_apply = g.directional(&force, &seeds);
    let transpose = |g: &mut Graph, per_point: &[Vec<Expr>]| -> Vec<Expr> {
        (0..per_point[0].len())
            .map(|k| {
                let terms: Vec<Expr> = per_point.iter().map(|p| p[k]).collect();
                total(g, &terms)
            })
            .collect()
    };
    let summed = transpose(g, &blocks);
    let tangent_blocks = complete_blocks(g, summed, n, d, constant_sum);
    let shape_mass = transpose(g, &masses);
    let square_mass = transpose(g, &squares);
    let deformed: Vec<Expr> = volumes.iter().zip(&volume_ratio).map(|(&v, &j)| g.mul(v, j)).collect();
    let deformed_volume = total(g, &deformed);
    let lumped_mass = lump(g, element, rule, &shape_mass, &square_mass);
    let mut energy_density = held_density;
    let embedding = across.map(|(found, tangents)| {
        let mut values = vec![found.energy, found.ratio];
        values.extend(found.strain.entries.iter().flatten());
        let values = put_in(g, &values, &[(found.unknown, found.root)]);
        energy_density = values[0];
        let strain = Matrix::from_fn(3, |i, j| values[2 + 3 * i + j]);
        Embedding { tangents, point_tangents, strain, volume_ratio: values[1] }
    });
    Definition {
        dimension: d,
        node_count: n,
        rest,
        parameters,
        density,
        section,
        displacement,
        direction,
        energy,
        force,
        tangent_apply,
        tangent_blocks,
        volume_ratio,
        deformed_volume,
        shape_mass,
        lumped_mass,
        displacement_gradient,
        energy_density,
        stress,
        point_gradients,
        point_volumes: volumes,
        point_slopes,
        rows_sum_to_zero: constant_sum,
        embedding,
        graph,
    }
}

/// Shape functions, their derivatives and the weights at the points: tables when rolled, constants when not.
fn tabulate(g: &mut Graph, element: &Element, rule: &Rule, rolled: bool) -> Vec<Point> {
    let d = element.dimension();
    let mut reference = Graph::new();
    let xi = ["xi", "eta", "zeta"].map(|name| reference.symbol(name, Time::Derive));
    let shape = (element.shape)(&mut reference, xi);
    let slopes: Vec<Expr> =
        shape.iter().flat_map(|&s| (0..d).map(move |k| (s, k))).map(|(s, k)| reference.derivative(s, xi[k])).collect();
    let at = |q: usize, e: Expr| -> f64 {
        let symbols: Vec<(Expr, f64)> = xi.into_iter().zip(rule.points[q]).collect();
        reference.evaluate(&[e], &symbols)[0]
    };
    let count = rule.points.len();
    let point = |g: &mut Graph, points: &[usize]| -> Point {
        let value = |g: &mut Graph, of: &dyn Fn(usize) -> f64| -> Expr {
            if let [q] = points { g.real(of(*q)) } else { g.table(&points.iter().map(|&q| of(q)).collect::<Vec<_>>()) }
        };
        let shape_values = shape.iter().map(|&s| value(g, &|q| at(q, s))).collect();
        let slope_values: Vec<Expr> = slopes.iter().map(|&s| value(g, &|q| at(q, s))).collect();
        let slopes = slope_values.chunks(d).map(<[Expr]>::to_vec).collect();
        Point { shape: shape_values, slopes, weight: value(g, &|q| rule.weights[q]) }
    };
    if rolled {
        let all: Vec<usize> = (0..count).collect();
        vec![point(g, &all)]
    } else {
        (0..count).map(|q| point(g, &[q])).collect()
    }
}

/// Whether Σ_a ∂N_a/∂ξ = 0 at every point, as the partition of unity demands, up to rounding.
///
/// Gradients can then be written with differences to the first node: fewer operations, and a translation that gives
/// exactly no force.
fn slopes_sum_to_zero(g: &Graph, points: &[Point]) -> bool {
    points.iter().all(|p| {
        (0..p.slopes[0].len()).all(|k| {
            let columns: Vec<Expr> = p.slopes.iter().map(|s| s[k]).collect();
            let values = g.evaluate_at_points(&columns, &[]);
            (0..g.points()).all(|q| {
                let at = |v: &Vec<f64>| if v.len() == 1 { v[0] } else { v[q] };
                let size: f64 = values.iter().map(|v| at(v).abs()).sum();
                values.iter().map(at).sum::<f64>().abs() <= 1e-13 * size
            })
        })
    })
}

/// `M_ij = Σ_a x_a,i s_a,j` for nodal vectors x with d axes and slopes s, [row of d][column as the slopes have].
fn interpolate_gradient(g: &mut Graph, x: &[Expr], slopes: &[Vec<Expr>], d: usize, differences: bool) -> Matrix {
    let first = usize::from(differences);
    let mut entry = |i: usize, j: usize| {
        let terms: Vec<Expr> = (first..slopes.len())
            .map(|a| {
                let value = if differences { g.sub(x[a * d + i], x[i]) } else { x[a * d + i] };
                g.mul(value, slopes[a][j])
            })
            .collect();
        g.sum(&terms)
    };
    Matrix { entries: (0..d).map(|i| (0..slopes[0].len()).map(|j| entry(i, j)).collect()).collect() }
}

/// The contributions of one point to the blocks (a, b), a ≤ b, of the nodes after the first (of all nodes when slopes
/// do not sum to zero): `K_ab,im = Σ_jl ∇N_a,j ∂²W/∂H_ij∂H_ml ∇N_b,l`, with d rows i, m and as many j, l as gradients
/// have components.
pub(crate) fn block_terms(
    g: &mut Graph,
    second_derivatives: &[Expr],
    d: usize,
    gradients: &[Vec<Expr>],
    differences: bool,
) -> Vec<Expr> {
    let e = gradients[0].len();
    let second = |p: usize, q: usize| second_derivatives[p.max(q) * d * e + p.min(q)];
    let first = usize::from(differences);
    let mut terms = Vec::new();
    for a in first..gradients.len() {
        // Σ_j ∇N_a,j ∂²W/∂H_ij∂H_ml, [i][m][l]: shared by all b.
        let left: Vec<Expr> = (0..d * d * e)
            .map(|k| {
                let (i, m, l) = (k / (d * e), (k / e) % d, k % e);
                let products: Vec<Expr> =
                    (0..e).map(|j| g.mul(gradients[a][j], second(i * e + j, m * e + l))).collect();
                g.sum(&products)
            })
            .collect();
        for b in a..gradients.len() {
            for i in 0..d {
                for m in 0..d {
                    // A block on the diagonal is symmetric.
                    let (i, m) = if a == b { (i.min(m), i.max(m)) } else { (i, m) };
                    let products: Vec<Expr> =
                        (0..e).map(|l| g.mul(left[(i * d + m) * e + l], gradients[b][l])).collect();
                    terms.push(g.sum(&products));
                }
            }
        }
    }
    terms
}

/// All blocks of the upper triangle from those of the nodes after the first: rows of a tangent sum to zero.
pub(crate) fn complete_blocks(g: &mut Graph, terms: Vec<Expr>, n: usize, d: usize, differences: bool) -> Vec<Expr> {
    if !differences {
        return terms;
    }
    let size = d * d;
    let m = n - 1;
    let inner = |a: usize, b: usize, i: usize, j: usize| -> Expr {
        let (a, b, i, j) = if a <= b { (a, b, i, j) } else { (b, a, j, i) };
        let row = a * m - a * (a + 1) / 2 + a;
        terms[(row + b - a) * size + i * d + j]
    };
    let negative_sum = |g: &mut Graph, list: &[Expr]| {
        let list: Vec<(Number, Expr)> = list.iter().map(|&e| (Number::MINUS_ONE, e)).collect();
        g.linear(&list)
    };
    // K_0b = −Σ_a K_ab, K_00 = −Σ_b K_0b.
    let mut row = Vec::new();
    for b in 0..m {
        for k in 0..size {
            let list: Vec<Expr> = (0..m).map(|a| inner(a, b, k / d, k % d)).collect();
            row.push(negative_sum(g, &list));
        }
    }
    let mut blocks: Vec<Expr> = (0..size)
        .map(|k| {
            let k = (k / d).min(k % d) * d + (k / d).max(k % d);
            let list: Vec<Expr> = (0..m).map(|b| row[b * size + k]).collect();
            negative_sum(g, &list)
        })
        .collect();
    blocks.extend(row);
    blocks.extend(terms);
    blocks
}

/// Lumped masses: ∫ρN_a where these are positive on the reference element, else ∫ρN_a² scaled to the element's mass
/// (Hinton, Rock and Zienkiewicz 1976).
///
/// A rule without a point off some node's zeros (the one point in the middle of a quad9) sees no mass there at all: it
/// gives the element's mass, and the shares are then those of ∫N_a² on the reference element with the richest rule.
fn lump(g: &mut Graph, element: &Element, rule: &Rule, mass: &[Expr], squares: &[Expr]) -> Vec<Expr> {
    let mut reference = Graph::new();
    let xi = ["xi", "eta", "zeta"].map(|name| reference.symbol(name, Time::Derive));
    let shape = (element.shape)(&mut reference, xi);
    // ∫N_a^power on the reference element.
    let integrals = |rule: &Rule, power: i32| -> Vec<f64> {
        let mut sums = vec![0.0; shape.len()];
        for (p, w) in rule.points.iter().zip(&rule.weights) {
            let symbols: Vec<(Expr, f64)> = xi.into_iter().zip(*p).collect();
            let values = reference.evaluate(&shape, &symbols);
            sums.iter_mut().zip(values).for_each(|(s, v)| *s += w * v.powi(power));
        }
        sums
    };
    let positive = |values: &[f64]| values.iter().all(|&v| v > 1e-6 * element.family.reference_measure());
    if positive(&integrals(rule, 1)) {
        return mass.to_vec();
    }
    let total = g.sum(mass);
    if positive(&integrals(rule, 2)) {
        let scale = g.sum(squares);
        return squares.iter().map(|&s| g.scaled_powers(Number::ONE, &[(s, 1), (total, 1), (scale, -1)])).collect();
    }
    let listed = element.quadratures.iter().filter_map(|id| Rule::by_id(id));
    let richest = listed.max_by_key(|r| r.points.len()).unwrap_or(rule);
    let shares = integrals(richest, 2);
    let sum: f64 = shares.iter().sum();
    shares.iter().map(|s| g.scale(Number::from_f64(s / sum), total)).collect()
}
