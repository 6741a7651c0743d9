//! The definition of an association as expressions, before any staging.

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
    /// Number of space dimensions: those of the element.
    pub dimension: usize,
    /// Number of nodes.
    pub node_count: usize,
    /// Rest positions X in m, [node, axis]; time Setup.
    pub rest: Vec<Expr>,
    /// The law's parameters in their declared order; time Setup.
    pub parameters: Vec<Expr>,
    /// Density ρ in kg/m³; time Setup.
    pub density: Expr,
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
    /// A displacement gradient as independent symbols, 3 × 3 (zeros in the missing directions).
    pub displacement_gradient: Matrix,
    /// Energy density ψ in J/m³ as a function of these symbols.
    pub energy_density: Expr,
    /// First Piola–Kirchhoff stress ∂ψ/∂H in Pa as a function of them, [row, column] of the present directions.
    pub stress: Vec<Expr>,
    /// Displacement gradients H at the quadrature points, [row, column] of the present directions: one matrix that varies
    /// over them, or one per point.
    pub point_gradients: Vec<Matrix>,
    /// Weights times volume elements in m³ at the quadrature points, likewise.
    pub point_volumes: Vec<Expr>,
    /// Gradients ∇N_a in 1/m at the quadrature points, [point][node][axis], likewise.
    pub point_slopes: Vec<Vec<Vec<Expr>>>,
    /// Whether gradients sum to zero over the nodes, so that the first node's forces balance those of the others.
    pub rows_sum_to_zero: bool,
}

/// One quadrature point, or all of them at once when loops are rolled.
struct Point {
    /// Shape functions, [node].
    shape: Vec<Expr>,
    /// Their derivatives by the reference coordinates, [node][axis].
    slopes: Vec<Vec<Expr>>,
    weight: Expr,
}

/// Writes the definition of element × law × quadrature.
///
/// # Panics
/// When the rule is not on the element's family.
pub fn define(element: &Element, law: &Law, rule: &Rule, loops: Loops) -> Definition {
    assert_eq!(element.family, rule.family, "the rule belongs to the element's family");
    let (n, d) = (element.node_count(), element.dimension());
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
    let displacement = leaves(g, "u", Time::Step);
    let direction = leaves(g, "v", Time::Apply);

    // The energy density as a function of the displacement gradient alone, and its derivatives by it.
    let zero = g.int(0);
    let variables: Vec<Expr> = (0..d * d)
        .map(|k| {
            let name = format!("H_{}{}", names[k / d], names[k % d]);
            if rolled { g.varying_symbol(name, Time::Step) } else { g.symbol(name, Time::Step) }
        })
        .collect();
    let displacement_gradient = Matrix::from_fn(3, |i, j| if i < d && j < d { variables[i * d + j] } else { zero });
    let named = law.parameters.iter().map(|p| p.name.to_string()).zip(parameters.iter().copied()).collect();
    let energy_density = (law.energy)(&mut Kinematics::new(g, displacement_gradient.clone(), named));
    let stress = g.gradient(energy_density, &variables);
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
    let identity = Matrix::identity(g, 3);
    let ratio = identity.add(g, &displacement_gradient).determinant(g);
    for point in &points {
        // Position gradient ∂X_i/∂ξ_k.
        let jacobian = interpolate_gradient(g, &rest, &point.slopes, d, constant_sum);
        let determinant = jacobian.determinant(g);
        let inverse = jacobian.inverse(g);
        // ∇N_a = (∂N_a/∂ξ) (∂ξ/∂X), [node][axis].
        let mut gradients: Vec<Vec<Expr>> = point.slopes.iter().map(|s| inverse.transpose().apply(g, s)).collect();
        for (a, gradient) in gradients.iter_mut().enumerate() {
            for (j, component) in gradient.iter_mut().enumerate() {
                *component = g.named(format!("G_{a}{}", names[j]), *component);
            }
        }
        let plane = interpolate_gradient(g, &displacement, &gradients, d, constant_sum);
        let volume = g.mul(point.weight, determinant);
        let volume = g.named("dV", volume);
        let replaced: Vec<(Expr, Expr)> =
            variables.iter().copied().zip(plane.entries.iter().flatten().copied()).collect();
        let here = g.substitute(&[energy_density, ratio], &replaced);
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
    Definition {
        dimension: d,
        node_count: n,
        rest,
        parameters,
        density,
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

/// `M_ij = Σ_a x_a,i s_a,j` for nodal vectors x and slopes s, d × d.
fn interpolate_gradient(g: &mut Graph, x: &[Expr], slopes: &[Vec<Expr>], d: usize, differences: bool) -> Matrix {
    let first = usize::from(differences);
    Matrix::from_fn(d, |i, j| {
        let terms: Vec<Expr> = (first..slopes.len())
            .map(|a| {
                let value = if differences { g.sub(x[a * d + i], x[i]) } else { x[a * d + i] };
                g.mul(value, slopes[a][j])
            })
            .collect();
        g.sum(&terms)
    })
}

/// The contributions of one point to the blocks (a, b), a ≤ b, of the nodes after the first (of all nodes when slopes
/// do not sum to zero): `K_ab,im = Σ_jl ∇N_a,j ∂²W/∂H_ij∂H_ml ∇N_b,l`.
pub(crate) fn block_terms(
    g: &mut Graph,
    second_derivatives: &[Expr],
    d: usize,
    gradients: &[Vec<Expr>],
    differences: bool,
) -> Vec<Expr> {
    let second = |p: usize, q: usize| second_derivatives[p.max(q) * d * d + p.min(q)];
    let first = usize::from(differences);
    let mut terms = Vec::new();
    for a in first..gradients.len() {
        // Σ_j ∇N_a,j ∂²W/∂H_ij∂H_ml, [i][m][l]: shared by all b.
        let left: Vec<Expr> = (0..d * d * d)
            .map(|k| {
                let (i, m, l) = (k / (d * d), (k / d) % d, k % d);
                let products: Vec<Expr> =
                    (0..d).map(|j| g.mul(gradients[a][j], second(i * d + j, m * d + l))).collect();
                g.sum(&products)
            })
            .collect();
        for b in a..gradients.len() {
            for i in 0..d {
                for m in 0..d {
                    // A block on the diagonal is symmetric.
                    let (i, m) = if a == b { (i.min(m), i.max(m)) } else { (i, m) };
                    let products: Vec<Expr> =
                        (0..d).map(|l| g.mul(left[(i * d + m) * d + l], gradients[b][l])).collect();
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
