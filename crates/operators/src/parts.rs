//! What a device needs of the blocks to compute for itself: programs, values that the set-up carries, rest positions.

use crate::BlockSpec;
use crate::derive::Derived;
use crate::elements::Elements;
use souple_laws::check::Inversion;

/// A block as it is, for whoever computes its forces elsewhere.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// What the block is made of.
    pub spec: &'a BlockSpec,
    /// Its programs.
    pub derived: &'a Derived,
    /// Rest positions of all nodes in m, [node, axis].
    pub rest: &'a [f64],
    /// `setup_values` and `setup_point_values` in lane order.
    pub setup: [&'a [f64]; 2],
    /// Whether a state with an element inside out has no meaning.
    pub inversion: Inversion,
}

impl Elements {
    /// The blocks.
    pub fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        self.blocks.iter().map(|b| Part {
            spec: &b.spec,
            derived: &b.derived,
            rest: &b.rest,
            setup: [&b.carried.setup[0], &b.carried.setup[1]],
            inversion: b.inversion,
        })
    }
}
