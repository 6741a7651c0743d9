//! Whether a law survives being turned inside out.
//!
//! Some energies are undefined for J ≤ 0 or grow without bound as J → 0 (logarithms and negative powers of J): a state
//! beyond has no meaning, even where a formula such as ln J² gives a number there. Others are finite everywhere, and a
//! simulation can pass through an inverted state and come back.
//!
//! Nobody declares which: it is read off the energy itself, of built-in laws and of laws written by users alike.

use crate::{Kinematics, Law};
use souple_symbols::{Graph, Matrix, Time};

/// What an inverted element means to a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inversion {
    /// No state with J ≤ 0 has a meaning.
    Fatal,
    /// The energy is finite there.
    Survivable,
}

/// Stretches along one axis: two on the way to J = 0 and one beyond it.
const STRETCHES: [f64; 3] = [1e-6, 1e-12, -0.5];

/// Growth between the first two stretches that no bounded energy has: ln J doubles, ln² J grows four times.
const GROWTH: f64 = 1.5;

/// What an inverted element means to a law with `parameters` in its declared order.
///
/// # Panics
/// When there are fewer parameters than the law has.
pub fn inversion(law: &Law, parameters: &[f64]) -> Inversion {
    let mut graph = Graph::new();
    let g = &mut graph;
    let stretch = g.symbol("stretch", Time::Step);
    let one = g.int(1);
    let zero = g.int(0);
    let change = g.sub(stretch, one);
    // No coordinate axis: an energy that looks at one direction is not fooled by another.
    let axis = [0.48, 0.6, 0.64].map(|a| g.real(a));
    let gradient = Matrix::from_fn(3, |i, j| {
        let product = g.product(&[axis[i], axis[j], change]);
        g.add(zero, product)
    });
    let named: Vec<_> = law.parameters.iter().map(|p| (p.name.to_owned(), g.symbol(p.name, Time::Setup))).collect();
    let values: Vec<_> = named.iter().map(|n| n.1).zip(parameters.iter().copied()).collect();
    let energy = (law.energy)(&mut Kinematics::new(g, gradient, named));
    let at = |s: f64| {
        let mut symbols = values.clone();
        symbols.push((stretch, s));
        graph.evaluate(&[energy], &symbols)[0]
    };
    let [near, nearer, beyond] = STRETCHES.map(at);
    let bounded = near.is_finite() && nearer.is_finite() && nearer <= GROWTH * near.abs();
    if bounded && beyond.is_finite() { Inversion::Survivable } else { Inversion::Fatal }
}
