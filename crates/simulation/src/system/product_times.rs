//! What both kinds of products with the stiffness cost on this machine: for explaining a choice, never for making one,
//! or results would depend on the clock.

use super::{Assembled, System};
use souple_solver::LinearOperator as _;
use web_time::Instant;

/// What products with the stiffness cost on this machine, in ms.
pub(crate) struct ProductTimes {
    /// Preparing products without a matrix.
    pub(crate) linearise: f64,
    /// One of them.
    pub(crate) product: f64,
    /// The same with a matrix, where there is one.
    pub(crate) matrix: Option<Matrix>,
}

/// What a matrix costs.
pub(crate) struct Matrix {
    /// Number of blocks.
    pub(crate) blocks: usize,
    /// Memory that one product reads of it.
    pub(crate) bytes: usize,
    /// Making it, in ms.
    pub(crate) assemble: f64,
    /// One product, in ms.
    pub(crate) product: f64,
}

/// Rounds of which the best counts: the machine has other work now and then.
const ROUNDS: usize = 9;

impl System {
    /// Times products and what prepares them, at the state at rest, each the best of some rounds.
    ///
    /// The next step linearises anew, so nothing of it is left in a simulation.
    pub(crate) fn measure_products(&mut self) -> ProductTimes {
        let len = self.mass.len();
        // Not zero: denormal numbers and skipped work would flatter.
        let x: Vec<f64> = (0..len).map(|k| 1.0 + (k % 7) as f64).collect();
        let (rest, mut y) = (vec![0.0; len], vec![0.0; len]);
        let mut best = |act: &mut dyn FnMut(&mut System, &mut [f64])| {
            let mut least = f64::INFINITY;
            for _ in 0..ROUNDS {
                let before = Instant::now();
                act(self, &mut y);
                least = least.min(before.elapsed().as_secs_f64() * 1e3);
            }
            least
        };
        let linearise = best(&mut |system, _| system.elements.linearise(&rest));
        let matrix_free = best(&mut |system, y| {
            y.fill(0.0);
            system.elements.add_tangent(-1.0, &x, y);
        });
        let assemble = best(&mut |system, _| system.linearise_at(&rest));
        let assembled = best(&mut |system, y| {
            if let Some(m) = &system.matrices {
                Assembled::new(&m.stiffness, &m.buffers, &system.threads).apply(&x, y);
            }
        });
        self.stale = true;
        let matrix = self.matrices.as_ref().map(|m| Matrix {
            blocks: m.stiffness.slot_count(),
            bytes: size_of_val(m.stiffness.values()) + size_of_val(m.stiffness.columns()),
            assemble,
            product: assembled,
        });
        ProductTimes { linearise, product: matrix_free, matrix }
    }
}
