//! One boundary value problem: loads, balance, errors.

use crate::cube::{self, Distortion};
use crate::field::{Exact, Field, YOUNG_POISSON};
use crate::quadrature::fine;
use souple_elements::Element;
use souple_kernels_cpu::Cpu;
use souple_laws::{Law, lame_from_young_poisson};
use souple_mesh::Mesh;
use souple_operators::{BlockSpec, Elements, Threads};
use souple_program::Costs;
use souple_solver::{CgOptions, CgWorkspace, FixedUnknowns, IncompleteCholesky, Projector, Serial, cg};
use souple_symbols::{Graph, Time};
use std::sync::Arc;

/// Errors of a computed displacement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// ‖u_h − u‖ in L², in units of ‖u‖.
    pub(crate) displacement: f64,
    /// ‖u_h − u‖ in the energy norm √∫ (λ tr²ε + 2μ ε:ε), in units of that of u.
    pub(crate) energy: f64,
}

/// Solves on a mesh of `cells` cells per axis with the listed rule of the highest degree.
pub(crate) fn solve(
    field: &Field,
    law: &'static Law,
    element: &'static Element,
    cells: usize,
    how: Distortion,
) -> Errors {
    let d = field.dimension;
    let mesh = cube::mesh(element, cells, how);
    let rules = element.quadratures.iter().map(|id| element.rule(id).unwrap());
    let rule = rules.max_by_key(|rule| rule.degree).unwrap();
    let spec = BlockSpec {
        element,
        law,
        rule,
        parameters: YOUNG_POISSON.to_vec(),
        density: 1.0,
        viscosity: None,
        section: 1.0,
        connectivity: mesh.blocks[0].connectivity.clone(),
        ids: (0..mesh.blocks[0].len() as u32).collect(),
    };
    let threads = Arc::new(Threads::new(1).unwrap());
    let (mut elements, _) =
        Elements::new(mesh.dimension(), &mesh.nodes, vec![spec], &Cpu::open(), threads, Costs::default()).unwrap();

    let points = Points::new(&mesh, field);
    let loads = points.loads(&mesh, d);
    let fixed = FixedUnknowns { indices: cube::boundary(&mesh, d) };
    // From rest, the moved boundary would turn elements inside out; so Newton's method starts near the exact values. They
    // are right on the boundary only: inside, a bump is added, or there might be nothing left to solve.
    let at_nodes = field.at(&mesh.nodes);
    let bump = |x: &[f64; 3]| 0.02 * x[..d].iter().map(|c| 4.0 * c * (1.0 - c)).product::<f64>();
    let mut u: Vec<f64> =
        (0..loads.len()).map(|k| at_nodes[k / d].displacement[k % d] + bump(&mesh.nodes[k / d])).collect();
    balance(&mut elements, &fixed, &loads, &mut u);
    points.errors(&mesh, d, &u)
}

/// Newton's method on f(u) + loads = 0 for the unknowns that are not fixed, to a billionth of the loads.
fn balance(elements: &mut Elements, fixed: &FixedUnknowns, loads: &[f64], u: &mut [f64]) {
    let (mut matrix, map) = elements.pattern();
    let mut workspace = CgWorkspace::new(u.len());
    let options = CgOptions { relative_tolerance: 1e-8, absolute_tolerance: 0.0, max_iterations: 5000 };
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    for iteration in 0..12 {
        let mut residual = loads.to_vec();
        elements.add_force(u, &mut residual);
        fixed.project(&mut residual);
        if norm(&residual) <= 1e-9 * norm(loads) {
            assert!(iteration > 0, "the start is the solution: nothing was solved");
            return;
        }
        elements.assemble(u, &map, &mut matrix);
        let mut scalar = matrix.to_csr();
        scalar.fix_unknowns(&fixed.indices);
        let preconditioner = IncompleteCholesky::new(&scalar).unwrap();
        let mut step = vec![0.0; u.len()];
        let report = cg(&scalar, &preconditioner, fixed, &Serial, &residual, &mut step, &options, &mut workspace);
        assert!(report.converged(), "{report:?}");
        u.iter_mut().zip(&step).for_each(|(u, s)| *u += s);
    }
    panic!("Newton's method did not converge in 12 iterations");
}

/// Points of the fine rule in all elements, with what is exact there.
struct Points {
    /// N_a and ∂N_a/∂ξ_j at the points of the reference cell, [point][node].
    shape: Vec<Vec<(f64, [f64; 3])>>,
    weights: Vec<f64>,
    /// [element, point].
    exact: Vec<Exact>,
}

impl Points {
    fn new(mesh: &Mesh, field: &Field) -> Points {
        let block = &mesh.blocks[0];
        let element = block.element;
        let rule = fine(element.family, element.degree as usize + 2);
        let mut g = Graph::new();
        let xi = ["xi", "eta", "zeta"].map(|name| g.symbol(name, Time::Apply));
        let values = (element.shape)(&mut g, xi);
        let mut roots = values.clone();
        for &value in &values {
            roots.extend(xi.map(|x| g.derivative(value, x)));
        }
        let n = values.len();
        let shape = rule.iter().map(|(point, _)| {
            let symbols: Vec<_> = xi.iter().copied().zip(*point).collect();
            let found = g.evaluate(&roots, &symbols);
            (0..n).map(|a| (found[a], std::array::from_fn(|j| found[n + 3 * a + j]))).collect()
        });
        let shape: Vec<Vec<(f64, [f64; 3])>> = shape.collect();
        let mut positions = Vec::with_capacity(block.len() * rule.len());
        for e in 0..block.len() {
            for at in &shape {
                let nodes = block.nodes(e).iter().map(|&node| mesh.nodes[node as usize]);
                positions.push(
                    nodes
                        .zip(at)
                        .fold([0.0; 3], |sum, (x, (value, _))| std::array::from_fn(|axis| sum[axis] + value * x[axis])),
                );
            }
        }
        let weights = rule.iter().map(|point| point.1).collect();
        Points { shape, weights, exact: field.at(&positions) }
    }

    /// Calls `visit` with each point: nodes of its element, N_a, ∂N_a/∂X_j, w det J and what is exact there.
    fn each(&self, mesh: &Mesh, d: usize, mut visit: impl FnMut(&[u32], &[(f64, [f64; 3])], f64, &Exact)) {
        let block = &mesh.blocks[0];
        let mut gradients = vec![(0.0, [0.0; 3]); block.element.node_count()];
        let mut exact = self.exact.iter();
        for e in 0..block.len() {
            let nodes = block.nodes(e);
            for (at, weight) in self.shape.iter().zip(&self.weights) {
                let mut jacobian = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                for i in 0..d {
                    for j in 0..d {
                        let terms = nodes.iter().zip(at).map(|(&n, (_, slope))| mesh.nodes[n as usize][i] * slope[j]);
                        jacobian[i][j] = terms.sum();
                    }
                }
                let (determinant, inverse) = inverse(&jacobian);
                assert!(determinant > 0.0, "element {e} is inside out");
                for (to, (value, slope)) in gradients.iter_mut().zip(at) {
                    let along = |j: usize| (0..d).map(|k| slope[k] * inverse[k][j]).sum();
                    *to = (*value, [along(0), along(1), along(2)]);
                }
                visit(nodes, &gradients, weight * determinant, exact.next().unwrap());
            }
        }
    }

    /// ∫ b · N, [node, axis].
    fn loads(&self, mesh: &Mesh, d: usize) -> Vec<f64> {
        let mut loads = vec![0.0; mesh.nodes.len() * d];
        self.each(mesh, d, |nodes, shape, weight, exact| {
            for (&node, (value, _)) in nodes.iter().zip(shape) {
                for axis in 0..d {
                    loads[node as usize * d + axis] += weight * value * exact.body_force[axis];
                }
            }
        });
        loads
    }

    fn errors(&self, mesh: &Mesh, d: usize, u: &[f64]) -> Errors {
        let (lambda, mu) = lame_from_young_poisson(YOUNG_POISSON[0], YOUNG_POISSON[1]);
        // Twice the energy density of Hooke's law.
        let density = |h: &[[f64; 3]; 3]| {
            let trace: f64 = (0..3).map(|i| h[i][i]).sum();
            let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
            lambda * trace * trace + 2.0 * mu * pairs.map(|(i, j)| (0.5 * (h[i][j] + h[j][i])).powi(2)).sum::<f64>()
        };
        let square = |v: &[f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        let mut sums = [0.0; 4];
        self.each(mesh, d, |nodes, shape, weight, exact| {
            let (mut v, mut h) = (exact.displacement.map(|x| -x), exact.gradient.map(|row| row.map(|x| -x)));
            for (&node, (value, slope)) in nodes.iter().zip(shape) {
                for i in 0..d {
                    let moved = u[node as usize * d + i];
                    v[i] += value * moved;
                    (0..d).for_each(|j| h[i][j] += slope[j] * moved);
                }
            }
            let parts = [square(&v), square(&exact.displacement), density(&h), density(&exact.gradient)];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += weight * part);
        });
        Errors { displacement: (sums[0] / sums[1]).sqrt(), energy: (sums[2] / sums[3]).sqrt() }
    }
}

/// Determinant and inverse.
fn inverse(m: &[[f64; 3]; 3]) -> (f64, [[f64; 3]; 3]) {
    let cofactor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant = (0..3).map(|j| m[0][j] * cofactor(0, j)).sum::<f64>();
    (determinant, std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant)))
}
