//! Numerics on anything that can multiply: linear solvers, Newton, time integrators.
//!
//! This crate knows vectors of unknowns and products with them, and nothing of where they come from.
//! A vector is a flat `[f64]`; a matrix is whatever implements [`LinearOperator`]; a nonlinear problem is whatever
//! implements [`NewtonProblem`]; a system that moves is whatever implements [`SecondOrder`].
//!
//! | question | function | what it asks for |
//! |---|---|---|
//! | `A x = b`, A symmetric | [`cg()`] with a [`Preconditioner`] and a [`Projector`]; [`SkylineLdlt`] | products; stored entries |
//! | `r(x) = 0` | [`newton()`] | [`NewtonProblem`] |
//! | `r(x, λ) = 0`, λ from 0 to 1 | [`quasi_static()`] | [`LoadProblem`] |
//! | `M ü = F(t, u, u̇)` | [`step()`] with a [`Method`] and a [`State`] | [`SecondOrder`] |
//! | the same with unknowns that follow others, u = T û | [`Elimination`] | weights |
//! | the largest step that is stable | [`critical_step()`] | [`SecondOrder`] |
//! | has it come to rest? | [`RestMonitor`] | a kinetic energy |
//!
//! Everything that can go wrong with numbers (no convergence, negative curvature, a state that the system refuses, a
//! value that is not finite) comes back as a value that says so.
//! What panics is a caller's mistake in the length of a slice, and nothing else.
//!
//! Nothing here starts a thread.
//! Sums are taken in fixed blocks (see [`vector`]), so that an implementation of [`VectorOps`] on several threads gives
//! the same bits.

pub mod block_jacobi;
pub mod cg;
pub mod critical_step;
pub mod csr;
pub mod direct;
pub mod elimination;
mod explicit;
pub mod failure;
mod implicit;
pub mod incomplete_cholesky;
pub mod lanczos;
pub mod method;
pub mod newton;
pub mod operator;
pub mod ordering;
pub mod quasi_static;
pub mod refinement;
pub mod rest;
pub mod second_order;
pub mod small_dense;
mod stage;
pub mod step;
#[cfg(feature = "direct")]
pub mod supernodal;
pub mod symmetric_blocks;
pub mod symmetric_products;
pub mod vector;
mod vectors;

pub use block_jacobi::BlockJacobi;
pub use cg::{CgOptions, CgWorkspace, LinearReport, LinearStatus, cg};
pub use critical_step::{CriticalStep, StepBound, critical_step, stable_step};
pub use csr::Csr;
pub use direct::{DirectError, DirectSolver, SkylineLdlt, solve_directly};
pub use elimination::{CondensationMap, Elimination};
pub use failure::{Failure, FailureKind};
pub use incomplete_cholesky::{IncompleteCholesky, IncompleteCholeskyError};
pub use lanczos::LanczosOptions;
pub use method::{Method, MethodError};
pub use newton::{
    LineSearch, NewtonIteration, NewtonOptions, NewtonOutcome, NewtonProblem, NewtonStatus, NewtonWorkspace, newton,
};
pub use operator::{
    DiagonalOperator, FixedUnknowns, Identity, Jacobi, LinearOperator, NoProjection, OperatorFromFn, Preconditioner,
    Projector, product_in_parts,
};
pub use quasi_static::{
    LoadProblem, LoadStep, Predictor, QuasiStaticOptions, QuasiStaticOutcome, QuasiStaticStatus, quasi_static,
};
pub use rest::{Rest, RestMonitor, kinetic_energy};
pub use second_order::{Combination, SecondOrder};
pub use step::{Previous, State, StepOptions, StepReport, StepStatus, StepWorkspace, WarmStart, step};
#[cfg(feature = "direct")]
pub use supernodal::SupernodalCholesky;
pub use symmetric_blocks::{PatternError, SymmetricBlocks};
pub use symmetric_products::{Part, ProductBuffers, Shift};
pub use vector::{PairwiseSum, Serial, VectorOps};
