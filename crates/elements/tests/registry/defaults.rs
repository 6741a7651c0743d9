//! The default quadrature of an element is the cheapest that passes the patch test and leaves no mode without energy.
//!
//! Patch test, element by element: the nodal forces of a constant stress are ∫ cof(J) ∇_ξ N_a dξ, which by the
//! divergence theorem is ∮ N_a n dS over the faces.
//! If the rule gets the right-hand side, forces of neighbours cancel on their common face and a mesh of any shape keeps
//! a constant stress in equilibrium.

use crate::evaluation::{Interpolation, Point, cofactors, combine, determinant, distorted, fine_rule, jacobian};
use crate::sides::normal;
use souple_elements::{Element, Rule, all, by_id, rules};

/// ∮ N_a n dS over the faces of an element, [node][axis].
fn face_forces(element: &Element, positions: &[Point]) -> Vec<Point> {
    let mut forces = vec![[0.0; 3]; element.node_count()];
    if element.dimension() == 1 {
        (forces[0][0], forces[1][0]) = (-1.0, 1.0);
    }
    for side in element.faces {
        let part = Interpolation::of_id(side.element);
        let family = by_id(side.element).expect("a side is an element").family;
        let x: Vec<Point> = side.nodes.iter().map(|&n| positions[usize::from(n)]).collect();
        for (point, weight) in fine_rule(family) {
            let n = normal(&part, point, &x);
            for (value, &node) in part.values(point).iter().zip(side.nodes) {
                for axis in 0..3 {
                    forces[usize::from(node)][axis] += weight * value * n[axis];
                }
            }
        }
    }
    forces
}

/// Largest error of the rule's nodal forces under a constant stress.
fn patch_error(element: &Element, interpolation: &Interpolation, rule: &Rule, positions: &[Point]) -> f64 {
    let mut forces = face_forces(element, positions);
    for (&point, weight) in rule.points.iter().zip(&rule.weights) {
        let gradients = interpolation.gradients(point);
        let cofactor = cofactors(&jacobian(element.dimension(), &gradients, positions));
        for (force, gradient) in forces.iter_mut().zip(&gradients) {
            for i in 0..element.dimension() {
                force[i] -= weight * (0..element.dimension()).map(|j| cofactor[i][j] * gradient[j]).sum::<f64>();
            }
        }
    }
    forces.iter().flatten().fold(0.0, |worst: f64, f| worst.max(f.abs()))
}

/// Number of motions that deform the element but not at any point of the rule: columns of the strains of all points
/// less their rank, less the rigid motions.
fn idle_modes(element: &Element, interpolation: &Interpolation, rule: &Rule, positions: &[Point]) -> usize {
    let (d, n) = (element.dimension(), element.node_count());
    let mut rows = Vec::new();
    for &point in &rule.points {
        let gradients = interpolation.gradients(point);
        let j = jacobian(d, &gradients, positions);
        let (cofactor, det) = (cofactors(&j), determinant(&j));
        assert!(det > 0.0, "{} with {}: det J = {det} at {point:?}", element.id, rule.id);
        let spatial: Vec<Point> = gradients
            .iter()
            .map(|g| [0, 1, 2].map(|i| (0..d).map(|j| cofactor[i][j] * g[j]).sum::<f64>() / det))
            .collect();
        for i in 0..d {
            for j in i..d {
                let mut row = vec![0.0; d * n];
                for (node, g) in spatial.iter().enumerate() {
                    row[d * node + i] += g[j];
                    row[d * node + j] += g[i];
                }
                rows.push(row);
            }
        }
    }
    let rigid = d * (d + 1) / 2;
    d * n - rank(rows) - rigid
}

/// Rank by elimination with full pivoting.
fn rank(mut rows: Vec<Vec<f64>>) -> usize {
    let columns = rows[0].len();
    let mut first = None;
    for step in 0..rows.len().min(columns) {
        let mut pivot = (step, step);
        for i in step..rows.len() {
            for j in step..columns {
                if rows[i][j].abs() > rows[pivot.0][pivot.1].abs() {
                    pivot = (i, j);
                }
            }
        }
        rows.swap(step, pivot.0);
        rows.iter_mut().for_each(|row| row.swap(step, pivot.1));
        let size = rows[step][step].abs();
        let largest = *first.get_or_insert(size);
        // Between round-off and the smallest true pivot lie many orders of magnitude; a value in between is doubtful.
        let ratio = size / largest;
        assert!(!(1e-12..1e-6).contains(&ratio), "doubtful pivot {ratio:e} at step {step}");
        if ratio < 1e-12 {
            return step;
        }
        let (above, below) = rows.split_at_mut(step + 1);
        let pivot_row = &above[step];
        for row in below {
            let factor = row[step] / pivot_row[step];
            for j in step..columns {
                row[j] -= factor * pivot_row[j];
            }
        }
    }
    rows.len().min(columns)
}

/// On a distorted element the default passes the patch test and stops every deforming motion, and no rule with fewer
/// points does both.
#[test]
fn default_is_the_cheapest_sound_rule() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        let positions = distorted(element);
        let default = element.default_rule();
        for rule in rules().iter().filter(|r| r.family == element.family) {
            let error = patch_error(element, &interpolation, rule, &positions);
            let idle = idle_modes(element, &interpolation, rule, &positions);
            let sound = error < 1e-13 && idle == 0;
            if rule.id == default.id {
                assert!(sound, "{} with {}: patch error {error:e}, {idle} idle modes", element.id, rule.id);
            }
            let cheaper = rule.points.len() < default.points.len();
            assert!(!(sound && cheaper), "{}: {} would do, at less cost than {}", element.id, rule.id, default.id);
        }
    }
}

/// The sum of forces and of moments of a constant stress vanishes for every rule that an element lists, sound or not.
#[test]
fn constant_stress_is_in_balance_under_every_listed_rule() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        let positions = distorted(element);
        for id in element.quadratures {
            let rule = element.rule(id).expect("a listed rule exists");
            for &point in &rule.points {
                let gradients = interpolation.gradients(point);
                let cofactor = cofactors(&jacobian(element.dimension(), &gradients, &positions));
                let forces: Vec<Point> = gradients
                    .iter()
                    .map(|g| [0, 1, 2].map(|i| (0..element.dimension()).map(|j| cofactor[i][j] * g[j]).sum()))
                    .collect();
                let total = combine(&vec![1.0; forces.len()], &forces);
                assert!(total.iter().all(|f| f.abs() < 1e-11), "{} with {id}: {total:?}", element.id);
            }
        }
    }
}

/// Among the rules that an element lists there is one for its consistent mass, ∫ N_a N_b, to 1e-13.
#[test]
fn some_listed_rule_integrates_the_mass() {
    for element in all() {
        let interpolation = Interpolation::of(element);
        let n = element.node_count();
        let mass = |points: &mut dyn Iterator<Item = (Point, f64)>| -> Vec<f64> {
            let mut mass = vec![0.0; n * n];
            for (point, weight) in points {
                let values = interpolation.values(point);
                for a in 0..n {
                    for b in 0..n {
                        mass[a * n + b] += weight * values[a] * values[b];
                    }
                }
            }
            mass
        };
        let exact = mass(&mut fine_rule(element.family).into_iter());
        let best = element.quadratures.iter().map(|id| {
            let rule = element.rule(id).expect("a listed rule exists");
            let found = mass(&mut rule.points.iter().copied().zip(rule.weights.iter().copied()));
            found.iter().zip(&exact).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max)
        });
        let best = best.fold(f64::INFINITY, f64::min);
        assert!(best < 1e-13, "{}: no listed rule integrates its mass (best error {best:e})", element.id);
    }
}
