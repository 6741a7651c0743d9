//! How long the parts of implicit steps take, for whoever asks; a look at the clock per call, nothing when nobody does.
//!
//! ```text
//! step = contact + force + linearise (assembly included) + products of the linear solver + the rest of the solver + other
//! ```
//!
//! The integrators and the linear solver see the same system through [`Watched`] and the same matrix through
//! [`WatchedOperator`]: what is computed does not change.

use crate::system::System;
use souple_solver::{Combination, Failure, LinearOperator, LinearReport, Projector, SecondOrder};
use std::sync::atomic::{AtomicU64, Ordering};
use web_time::Instant;

/// Time spent since it was last asked for, in ms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhaseTimes {
    /// Finding what hands and tools touch, and their forces.
    pub contact: f64,
    /// Forces.
    pub force: f64,
    /// Linearisation, with assembly where there is a matrix; zero on a graphics device, where forces contain it.
    pub linearise: f64,
    /// Products of the linear solver with its matrix.
    pub product: f64,
    /// Linear solves without these products: preconditioner, vectors.
    pub rest_of_solve: f64,
}

/// Sums of time, in ns. Atomic, because an operator is shared while it is applied.
#[derive(Debug, Default)]
pub(crate) struct Phases {
    contact: AtomicU64,
    force: AtomicU64,
    linearise: AtomicU64,
    product: AtomicU64,
    solve: AtomicU64,
}

impl Phases {
    /// Gives what was summed up, and begins again at zero.
    pub(crate) fn take(&self) -> PhaseTimes {
        let ms = |sum: &AtomicU64| sum.swap(0, Ordering::Relaxed) as f64 * 1e-6;
        let product = ms(&self.product);
        let rest_of_solve = (ms(&self.solve) - product).max(0.0);
        PhaseTimes {
            contact: ms(&self.contact),
            force: ms(&self.force),
            linearise: ms(&self.linearise),
            product,
            rest_of_solve,
        }
    }
}

/// What happens at the beginning of a step, timed where somebody watches.
pub(crate) fn timed_contact(phases: Option<&Phases>, work: impl FnOnce()) {
    match phases {
        Some(phases) => timed(&phases.contact, work),
        None => work(),
    }
}

/// Does the work and adds its time.
fn timed<R>(sum: &AtomicU64, work: impl FnOnce() -> R) -> R {
    let start = Instant::now();
    let result = work();
    sum.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    result
}

/// A system whose forces, linearisations and solves are timed.
pub(crate) struct Watched<'a> {
    pub(crate) system: &'a mut System,
    pub(crate) phases: &'a Phases,
}

impl SecondOrder for Watched<'_> {
    fn len(&self) -> usize {
        SecondOrder::len(self.system)
    }

    fn force(&mut self, t: f64, u: &[f64], v: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        timed(&self.phases.force, || self.system.force(t, u, v, out))
    }

    fn mass_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.system.mass_apply(x, y);
    }

    fn mass_solve(&mut self, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        self.system.mass_solve(rhs, x)
    }

    fn linearise(&mut self, t: f64, u: &[f64], v: &[f64]) -> Result<(), Failure> {
        timed(&self.phases.linearise, || SecondOrder::linearise(self.system, t, u, v))
    }

    fn stiffness_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.system.stiffness_apply(x, y);
    }

    fn damping_apply(&mut self, x: &[f64], y: &mut [f64]) {
        self.system.damping_apply(x, y);
    }

    fn solve(&mut self, combination: Combination, rhs: &[f64], x: &mut [f64]) -> LinearReport {
        timed(&self.phases.solve, || self.system.solve(combination, rhs, x))
    }

    fn project(&self, v: &mut [f64]) {
        self.system.project(v);
    }

    fn prescribe(&self, t: f64, u: &mut [f64], v: &mut [f64]) {
        self.system.prescribe(t, u, v);
    }

    fn admissible(&mut self, t: f64, u: &[f64], v: &[f64]) -> Result<(), Failure> {
        self.system.admissible(t, u, v)
    }
}

/// A matrix whose products are timed when somebody watches.
pub(crate) struct WatchedOperator<'a> {
    pub(crate) operator: &'a dyn LinearOperator,
    pub(crate) phases: Option<&'a Phases>,
}

impl WatchedOperator<'_> {
    fn timed<R>(&self, work: impl FnOnce() -> R) -> R {
        match self.phases {
            Some(phases) => timed(&phases.product, work),
            None => work(),
        }
    }
}

impl LinearOperator for WatchedOperator<'_> {
    fn len(&self) -> usize {
        self.operator.len()
    }

    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.timed(|| self.operator.apply(x, y));
    }

    fn apply_and_dot(&self, projector: &dyn Projector, p: &[f64], q: &mut [f64]) -> f64 {
        self.timed(|| self.operator.apply_and_dot(projector, p, q))
    }
}
