//! Manufactured solutions: with the body force that a chosen displacement needs, the computed displacement converges to
//! it, on distorted meshes and at the order that the element's degree p promises: p + 1 in L², p in energy.
//!
//! A displacement u is chosen ([`field`]), its body force b = −Div P(∇u) derived from the law's energy, loads ∫ b · N
//! integrated on distorted meshes of one element each ([`cube`]) with a rule of the test's own ([`quadrature`]), and
//! K(u_h) balanced against them with the exact values on the boundary ([`problem`]). Halving the cells then divides the
//! errors by 2^order.
//!
//! Internal forces are integrated with the element's listed rule of the highest degree: what is measured is the element.
//!
//! What it is not: a judgement on which element is best; errors of different elements belong to different numbers of
//! unknowns.
//!
//! `cargo test -p souple-operators --test convergence -- --nocapture` prints the tables of docs/validation.md, and fails
//! where a row there is not what comes out.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]
#![allow(clippy::disallowed_macros, reason = "the tables are printed for docs/validation.md")]

mod cube;
mod field;
mod orders;
mod problem;
mod quadrature;
