//! The diagonal blocks of the tangent alone, for preconditioners where no matrix is assembled.

use crate::derive::{Derived, leaves};
use souple_program::{Costs, OutputRequest, Program, stage};
use souple_symbols::Time;

/// Derives the program `tangent_diagonal`: the blocks −∂f_a/∂u_a in N/m, [node a, row axis, column axis], at any
/// displacement. It reads `rest` and `parameters`, and nothing that a set-up carried.
///
/// Of n (n + 1)/2 blocks these are n: the program is several times shorter than `tangent_blocks`.
pub fn derive_diagonal(derived: &Derived, costs: Costs) -> Program {
    let definition = &derived.definition;
    let (n, d) = (definition.node_count, definition.dimension);
    // Rows of the upper triangle: block (a, a) comes after n + (n − 1) + … blocks of the rows before it.
    let first = |a: usize| (0..a).map(|row| n - row).sum::<usize>() * d * d;
    let values = (0..n).flat_map(|a| definition.tangent_blocks[first(a)..first(a) + d * d].to_vec()).collect();
    let name = "tangent_diagonal".to_owned();
    let output = OutputRequest { program: name.clone(), time: Time::Step, name: name.clone(), values, cached: false };
    let staged = stage(&definition.graph, &leaves(definition), &[output], costs);
    staged.program(&name).expect("it was asked for").clone()
}
