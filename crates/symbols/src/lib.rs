//! A shared graph of scalar expressions: build it, differentiate it, ask when each value is known.
//!
//! Everything that Souple computes starts here as a graph of sums, products and a few functions.
//! Two rules keep it small, and they replace the expanded polynomials of a classic computer algebra system:
//!
//! * **never expand**: a product of sums stays a product of sums;
//! * **always share**: nodes are hash-consed and their operands are ordered, so that two equal sub-expressions are the
//!   same node, whatever the order in which they were written.
//!
//! What enters and what leaves:
//!
//! | step | in | out | function |
//! |---|---|---|---|
//! | write | formulas in Rust or text | [`Expr`] in a [`Graph`] | [`Graph::sum`], [`Graph::product`], … |
//! | differentiate backwards | one expression | its gradient, at a small multiple of its cost | [`Graph::gradient`] |
//! | differentiate forwards | many expressions, a direction | directional derivatives | [`Graph::directional`] |
//! | powers of matrices | a symmetric matrix, exponents | traces and entries | [`Graph::power_trace`], [`Graph::power_entry`] |
//! | evaluate | values of the symbols | values of the expressions | [`Graph::evaluate`] |
//! | solve | an equation, a start | its root, differentiated implicitly | [`Graph::root`] |
//! | show | an expression | text or LaTeX | [`print`] |
//!
//! Every node knows its binding [`Time`] (the latest of its leaves) and whether it varies over the *points* of a sum
//! ([`Graph::point_sum`]); nothing here knows what the points are.

mod differentiate;
mod evaluate;
mod graph;
mod number;
pub mod print;
mod root;
mod spectral;
mod tensor;

pub use graph::{Expr, Function, Graph, Node, Time};
pub use number::Number;
pub use root::{Equation, RootId};
pub use tensor::Matrix;
