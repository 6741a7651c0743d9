//! The chosen displacement, and the body force that it needs: b = −Div P(∇u), derived from the law's energy.

use souple_laws::response::tensor_from_fn;
use souple_laws::{Kinematics, Law, Response};
use souple_symbols::{Expr, Graph, Matrix, Number, Time};

/// Points that are evaluated at once.
const BATCH: usize = 1024;

/// Young's modulus and Poisson's ratio.
pub(crate) const YOUNG_POISSON: [f64; 2] = [1.0, 0.3];

/// A smooth displacement of the unit interval, square or cube with its body force.
pub(crate) struct Field {
    pub(crate) dimension: usize,
    graph: Graph,
    position: [Expr; 3],
    /// u, ∇u [row, column], b.
    roots: Vec<Expr>,
}

/// What there is at a point, without the axes beyond the dimension.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exact {
    /// u in m.
    pub(crate) displacement: [f64; 3],
    /// ∂u_i/∂X_j, [i][j].
    pub(crate) gradient: [[f64; 3]; 3],
    /// b in N/m³.
    pub(crate) body_force: [f64; 3],
}

impl Field {
    /// u_i = 0.1 exp(sᵢ) + 0.05 sᵢ₊₁² with sᵢ = Σ cᵢⱼ Xⱼ: no polynomial, and all of its derivatives are of order one.
    /// F stays within ±0.4 of the identity.
    pub(crate) fn new(law: &Law, dimension: usize) -> Field {
        let slopes = [[8, -5, 3], [4, 7, -6], [-3, 6, 9]];
        let mut graph = Graph::with_points(BATCH);
        let g = &mut graph;
        let position = ["X", "Y", "Z"].map(|name| g.varying_symbol(name, Time::Step));
        let s: Vec<Expr> = slopes
            .iter()
            .map(|row| {
                let terms: Vec<_> = (0..dimension).map(|j| (Number::rational(row[j], 10), position[j])).collect();
                g.linear(&terms)
            })
            .collect();
        let displacement: Vec<Expr> = (0..dimension)
            .map(|i| {
                let (wave, square) = (g.exp(s[i]), g.powi(s[(i + 1) % dimension], 2));
                g.linear(&[(Number::rational(1, 10), wave), (Number::rational(1, 20), square)])
            })
            .collect();

        // The stress as a function of nine symbols, then at the gradient.
        let symbols: Vec<Expr> = (0..9).map(|k| g.varying_symbol(format!("H{k}"), Time::Step)).collect();
        assert_eq!(law.parameters.len(), 2, "{}: a law with Young's modulus and Poisson's ratio", law.id);
        let parameters = law.parameters.iter().zip(YOUNG_POISSON).map(|(p, v)| (p.name.to_owned(), g.real(v)));
        let parameters: Vec<(String, Expr)> = parameters.collect();
        let energy = (law.energy)(&mut Kinematics::new(g, Matrix::from_fn(3, |i, j| symbols[3 * i + j]), parameters));
        let stress = g.gradient(energy, &symbols);
        let zero = g.int(0);
        let mut gradient = [zero; 9];
        for i in 0..dimension {
            for j in 0..dimension {
                gradient[3 * i + j] = g.derivative(displacement[i], position[j]);
            }
        }
        let replaced: Vec<(Expr, Expr)> = symbols.iter().copied().zip(gradient.iter().copied()).collect();
        let stress = g.substitute(&stress, &replaced);
        let body_force: Vec<Expr> = (0..dimension)
            .map(|i| {
                let slopes: Vec<Expr> = (0..dimension).map(|j| g.derivative(stress[3 * i + j], position[j])).collect();
                let divergence = g.sum(&slopes);
                g.neg(divergence)
            })
            .collect();
        let of = |i: usize, j: usize| gradient[3 * i + j];
        let roots = displacement
            .iter()
            .copied()
            .chain((0..dimension).flat_map(|i| (0..dimension).map(move |j| (i, j))).map(|(i, j)| of(i, j)))
            .chain(body_force)
            .collect();
        Field { dimension, graph, position, roots }
    }

    /// The field at each position.
    pub(crate) fn at(&self, positions: &[[f64; 3]]) -> Vec<Exact> {
        let d = self.dimension;
        let mut found = Vec::with_capacity(positions.len());
        for batch in positions.chunks(BATCH) {
            let symbols: Vec<(Expr, Vec<f64>)> = (0..3)
                .map(|axis| {
                    let mut values: Vec<f64> = batch.iter().map(|x| x[axis]).collect();
                    values.resize(BATCH, 0.0);
                    (self.position[axis], values)
                })
                .collect();
            let values = self.graph.evaluate_at_points(&self.roots, &symbols);
            for q in 0..batch.len() {
                // A root that happens to be the same everywhere has one value.
                let root = |k: usize| values[k][if values[k].len() == 1 { 0 } else { q }];
                let mut exact = Exact::default();
                for i in 0..d {
                    exact.displacement[i] = root(i);
                    exact.body_force[i] = root(d + d * d + i);
                    for j in 0..d {
                        exact.gradient[i][j] = root(d + d * i + j);
                    }
                }
                found.push(exact);
            }
        }
        found
    }
}

/// The derived gradient and body force are those of differences: ∇u of u, and −Div P of the stresses at ∇u, which other
/// tests compare with numbers from outside; and the body moves by as much as F = I + ∇u says, right side out.
#[test]
fn body_forces_are_minus_the_divergence_of_the_stress() {
    for law in ["hooke", "stvk", "neo-hookean"].map(|id| souple_laws::by_id(id).unwrap()) {
        let response = Response::new(law, &YOUNG_POISSON).unwrap();
        for d in 1..=3 {
            let field = Field::new(law, d);
            for centre in [[0.3, 0.6, 0.2], [0.9, 0.1, 0.7], [0.0, 1.0, 1.0]] {
                let step = 1e-3;
                let exact = &field.at(&[centre])[0];
                let mut divergence = [0.0; 3];
                for j in 0..d {
                    // Central differences of order four.
                    for (k, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                        let mut x = centre;
                        x[j] += k * step;
                        let near = &field.at(&[x])[0];
                        let f = tensor_from_fn(|i, j| near.gradient[i][j] + f64::from(u8::from(i == j)));
                        assert!(souple_laws::response::determinant(&f) > 0.3, "{} at {x:?}", law.id);
                        let stress = response.stress(&f);
                        for i in 0..d {
                            divergence[i] += weight * stress[i][j] / (12.0 * step);
                        }
                    }
                }
                let mut size = 0.0_f64;
                for i in 0..d {
                    let error = divergence[i] + exact.body_force[i];
                    assert!(error.abs() < 1e-8, "{} in {d}D at {centre:?}: {divergence:?} {exact:?}", law.id);
                    size = size.max(divergence[i].abs());
                }
                assert!(size > 1e-2, "{} in {d}D at {centre:?}: no body force to speak of", law.id);
            }
        }
    }
}
