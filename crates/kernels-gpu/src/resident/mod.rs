//! A whole time step on the device: state, forces, products, conjugate gradients, end of the step.
//!
//! ```text
//! host:    numbers of the step, moved unknowns, factors of loads          record of the solve, energy
//!             │                                                                      ▲
//! device:  force → product of the known part → right-hand side → solve → end of the step → checks
//!                                                                  ↑  │
//!                                                       4 kernels per iteration
//! ```
//!
//! The solve is the preconditioned conjugate gradient written for a device: the tolerance, the end and every sum are decided
//! there, and the host sends as many iterations at once as the last solve took; those beyond the end do nothing.
//! So it waits once per step, or a few times when a solve takes longer than the last.
//!
//! u is kept in two numbers per unknown, sums over vectors too: increments of a step are small against what they
//! are added to. Everything else is single.
//!
//! What it is not: a choice of methods. One linearised stage per step; whoever wants more computes on the processor.
//!

mod chunks;
mod kernels;
mod model;
mod rows;
mod segments;
mod solve;
mod step;
mod sums;
mod times;
mod traffic;
mod vectors;

pub use model::{Batch, Model, Preconditioner, Source};
pub use rows::{Form, Rows};
pub use step::{Ending, Outcome, Resident, Stage, Start, State, Step};
pub use sums::row_sums;
pub use times::Times;
pub use traffic::Traffic;
