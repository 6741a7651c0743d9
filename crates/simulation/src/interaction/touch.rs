//! Forces of hands and tools as the solver sees them: affine in the displacement of single nodes, renewed every step.
//!
//! ```text
//! F_a(u) = f̂_a − B_a u_a        B_a symmetric, positive semidefinite, one per touched node
//! ```
//!
//! Implicit methods take B into their matrix (its diagonal blocks only), so that a stiff spring in a hand is as stable as
//! the body itself. Where one spring holds several nodes (a point inside a face, weights w, Σ w = 1), its stiffness couples
//! them: k w wᵀ; here stands its lumped form k diag(w), which bounds it from above and is exact at rest, because the force
//! is renewed from the true positions at every step.

use souple_solver::SymmetricBlocks;

/// The force on one node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NodalForce {
    /// The node; never one that follows others.
    pub(crate) node: u32,
    /// f̂ in N: the force at zero displacement.
    pub(crate) at_zero: [f64; 3],
    /// B in N/m, [row][column].
    pub(crate) stiffness: [[f64; 3]; 3],
}

/// Everything that touches a system in a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Touch {
    /// Forces.
    pub(crate) forces: Vec<NodalForce>,
    /// Unknowns that are held where they were taken, with their displacements in m.
    pub(crate) held: Vec<(usize, f64)>,
}

impl Touch {
    /// out ← out + F(u)
    pub(crate) fn add_force(&self, d: usize, u: &[f64], out: &mut [f64]) {
        for force in &self.forces {
            let first = force.node as usize * d;
            for row in 0..d {
                let pull: f64 = (0..d).map(|column| force.stiffness[row][column] * u[first + column]).sum();
                out[first + row] += force.at_zero[row] - pull;
            }
        }
    }

    /// y ← y + B x
    pub(crate) fn add_product(&self, d: usize, x: &[f64], y: &mut [f64]) {
        for force in &self.forces {
            let first = force.node as usize * d;
            for row in 0..d {
                y[first + row] += (0..d).map(|column| force.stiffness[row][column] * x[first + column]).sum::<f64>();
            }
        }
    }

    /// Adds B to the diagonal blocks of a matrix of d × d blocks.
    pub(crate) fn add_blocks(&self, d: usize, matrix: &mut SymmetricBlocks) {
        for force in &self.forces {
            let mut block = [0.0; 9];
            for row in 0..d {
                block[row * d..(row + 1) * d].copy_from_slice(&force.stiffness[row][..d]);
            }
            matrix.add_block(force.node as usize, force.node as usize, &block[..d * d]);
        }
    }

    /// ½ uᵀ B u − f̂ᵀ u in J: the potential of the forces.
    pub(crate) fn energy(&self, d: usize, u: &[f64]) -> f64 {
        let of = |force: &NodalForce| -> f64 {
            let u = &u[force.node as usize * d..(force.node as usize + 1) * d];
            let product = |row: usize| (0..d).map(|column| force.stiffness[row][column] * u[column]).sum::<f64>();
            (0..d).map(|row| u[row] * (0.5 * product(row) - force.at_zero[row])).sum()
        };
        self.forces.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The force is minus the slope of the potential, and the product minus that of the force.
    #[test]
    fn force_and_product_follow_from_the_potential() {
        let touch = Touch {
            forces: vec![NodalForce {
                node: 1,
                at_zero: [1.0, -2.0, 0.5],
                stiffness: [[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]],
            }],
            held: Vec::new(),
        };
        let u = [9.0, 9.0, 9.0, 0.3, -0.2, 0.7];
        let mut force = [0.0; 6];
        touch.add_force(3, &u, &mut force);
        for k in 0..6 {
            let h = 1e-6;
            let at = |sign: f64| {
                let mut moved = u;
                moved[k] += sign * h;
                moved
            };
            let slope = (touch.energy(3, &at(1.0)) - touch.energy(3, &at(-1.0))) / (2.0 * h);
            assert!((slope + force[k]).abs() < 1e-8, "unknown {k}");
            let mut moved = [0.0; 6];
            touch.add_force(3, &at(1.0), &mut moved);
            let mut product = [0.0; 6];
            let mut direction = [0.0; 6];
            direction[k] = h;
            touch.add_product(3, &direction, &mut product);
            assert!((0..6).all(|j| (moved[j] - force[j] + product[j]).abs() < 1e-12));
        }
    }
}
