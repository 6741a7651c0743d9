//! Criteria by which a cheaper law is left for a better one, or a mesh is refined, one number per element (X. Faure,
//! *Approche formelle pour la simulation interactive de modèles mixtes*, 2014, sections 6.4.2 and 6.4.3).
//!
//! ```text
//! R_L = max over edges |l / l₀ − 1|                     lengths between the ends of edges
//! R_A = |A / A₀ − 1|                                    areas of surfaces, volumes of solids
//! R_S = Σ_i w_i Σ_j |Λ_j(G_i)| ‖F_j‖ / Σ_i w_i          equation 6.3: G_i, w_i quadrature, F_j nodal forces, in N
//! ```
//!
//! Equation 6.3 divides an integral over the element by its size. Here both are taken on the reference cell, which is the
//! same where the element's map is affine. R_A is a case of [`ElementField`](crate::ElementField)'s volume ratio.

use crate::run::Simulation;
use souple_elements::{Element, Family, Rule};
use souple_symbols::{Graph, Time};

impl Simulation {
    /// R_L of every element.
    pub(crate) fn length_changes(&self) -> Vec<f64> {
        let (now, rest) = (self.positions(), &self.prepared.nodes);
        let distance = |points: &[[f64; 3]], [a, b]: [u32; 2]| -> f64 {
            let (a, b) = (points[a as usize], points[b as usize]);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
        };
        let mut values = vec![0.0; self.element_count()];
        for block in &self.prepared.blocks {
            let edges = ends_of_edges(block.element);
            let nodes = block.connectivity.chunks(block.element.node_count());
            for (&id, nodes) in block.ids.iter().zip(nodes) {
                let changes = edges.iter().map(|edge| {
                    let edge = edge.map(|n| nodes[n as usize]);
                    (distance(&now, edge) / distance(rest, edge) - 1.0).abs()
                });
                values[id as usize] = changes.fold(0.0, f64::max);
            }
        }
        values
    }

    /// R_S of every element, in N.
    pub(crate) fn mean_forces(&mut self) -> Vec<f64> {
        let mut values = vec![0.0; self.element_count()];
        let mut weights: Vec<Vec<f64>> = Vec::new();
        let mut weights_of = vec![0u32; values.len()];
        for (number, block) in (0u32..).zip(&self.prepared.blocks) {
            weights.push(mean_shapes(block.element, block.rule));
            block.ids.iter().for_each(|&id| weights_of[id as usize] = number);
        }
        let u = self.present().u.clone();
        self.system.elements.each_nodal_force(&u, |id, forces| {
            let size = |f: &[f64; 3]| f.iter().map(|x| x * x).sum::<f64>().sqrt();
            let weights = &weights[weights_of[id as usize] as usize];
            values[id as usize] = weights.iter().zip(forces).map(|(w, f)| w * size(f)).sum();
        });
        values
    }
}

/// Local nodes at the ends of an element's edges.
fn ends_of_edges(element: &Element) -> Vec<[u8; 2]> {
    match element.family {
        Family::Edge => vec![[0, 1]],
        _ => element.edges.iter().map(|side| [side.nodes[0], side.nodes[1]]).collect(),
    }
}

/// Σ_i w_i |Λ_j(G_i)| / Σ_i w_i of each node j.
fn mean_shapes(element: &Element, rule: &Rule) -> Vec<f64> {
    let mut graph = Graph::new();
    let xi = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Derive));
    let shape = (element.shape)(&mut graph, xi);
    let mut means = vec![0.0; shape.len()];
    for (point, weight) in rule.points.iter().zip(&rule.weights) {
        let values = graph.evaluate(&shape, &xi.into_iter().zip(*point).collect::<Vec<_>>());
        means.iter_mut().zip(values).for_each(|(m, v)| *m += weight * v.abs());
    }
    let all: f64 = rule.weights.iter().sum();
    means.iter_mut().for_each(|m| *m /= all);
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use souple_elements::all;

    /// The ends of every element's edges are corners, and every corner is the end of some edge.
    #[test]
    fn edges_join_corners() {
        for element in all() {
            let mut ends: Vec<u8> = ends_of_edges(element).into_iter().flatten().collect();
            ends.sort_unstable();
            ends.dedup();
            assert_eq!(ends.len(), element.family.corner_count(), "{}", element.id);
            assert!(ends.iter().all(|&e| (e as usize) < element.family.corner_count()), "{}", element.id);
        }
    }

    /// Where no shape function is negative at the points, a mean of equal forces is that force.
    #[test]
    fn equal_forces_have_their_own_mean() {
        for element in all() {
            let sum: f64 = mean_shapes(element, element.default_rule()).iter().sum();
            assert!(sum > 1.0 - 1e-12, "{}: {sum}", element.id);
            if element.degree == 1 {
                assert!((sum - 1.0).abs() < 1e-12, "{}: {sum}", element.id);
            }
        }
    }
}
