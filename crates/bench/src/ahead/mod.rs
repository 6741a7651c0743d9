//! Derived programs as Rust with explicit vectors, compiled with the library: what an ahead-of-time compiler makes of the
//! same programs that become machine code at run time.
//!
//! The sources in `generated` are printed by [`rust`] and checked in; a test prints them again and compares.
//! `SOUPLE_BLESS=1 cargo test -p souple-bench` writes what it finds.
//! They serve the comparison alone: no simulation runs them.

#[rustfmt::skip]
mod generated;
mod print;

pub use print::{PrintError, rust};

use crate::vectors::{Row, Vec3, Vectors, gather3};
use pulp::Simd;
use souple_kernels::{Input, LANES};

/// Programs that are printed: element, law, program.
pub const PRINTED: [[&str; 3]; 6] = [
    ["tet4", "stvk", "force"],
    ["tet4", "stvk", "linearise"],
    ["tet4", "stvk", "tangent_apply"],
    ["hex8", "stvk", "force"],
    ["hex8", "stvk", "linearise"],
    ["hex8", "stvk", "tangent_apply"],
];

/// The arguments of a kernel: number of groups, inputs and outputs in the program's order, as in
/// [`Kernel::run`](souple_kernels::Kernel::run).
#[derive(Debug)]
pub struct Call<'a, 'b> {
    /// Number of groups.
    pub groups: usize,
    /// One per input buffer.
    pub inputs: &'a [Input<'b>],
    /// One per output buffer.
    pub outputs: &'a mut [&'b mut [f64]],
}

/// A program compiled ahead.
#[derive(Clone, Copy, Debug)]
pub struct Ahead {
    /// Id of the element.
    pub element: &'static str,
    /// Id of the law.
    pub law: &'static str,
    /// Name of the program.
    pub program: &'static str,
    /// Runs it.
    pub run: fn(Vectors, Call<'_, '_>),
}

/// The program of this name, if it was compiled ahead.
pub fn ahead(element: &str, law: &str, program: &str) -> Option<&'static Ahead> {
    generated::AHEAD.iter().find(|a| (a.element, a.law, a.program) == (element, law, program))
}

/// A gathered input: rows of the shared array, and who reads which, [group][row place][lane].
fn gathered<'a, const N: usize>(input: &Input<'a>) -> (&'a [[f64; 3]], &'a [[[u32; LANES]; N]]) {
    match *input {
        Input::Gathered { values, rows, width: 3 } => {
            (values.as_chunks().0, rows.as_chunks::<LANES>().0.as_chunks::<N>().0)
        }
        _ => unreachable!("the batch gives rows of three for nodal vectors"),
    }
}

/// An input in lanes, [group][place].
fn lanes<'a, const N: usize>(input: &Input<'a>) -> &'a [[Row; N]] {
    match *input {
        Input::Lanes(values) => values.as_chunks::<LANES>().0.as_chunks::<N>().0,
        _ => unreachable!("the batch gives carried values in lanes"),
    }
}

/// An input in lanes per point, [group][point][place].
fn lanes_at_points<'a, const N: usize, const P: usize>(input: &Input<'a>) -> &'a [[[Row; N]; P]] {
    lanes::<N>(input).as_chunks::<P>().0
}

/// An output, [group][place].
fn places<const N: usize>(output: &mut [f64]) -> &mut [[Row; N]] {
    output.as_chunks_mut::<LANES>().0.as_chunks_mut::<N>().0
}

/// An output per point, [group][point][place].
fn places_at_points<const N: usize, const P: usize>(output: &mut [f64]) -> &mut [[[Row; N]; P]] {
    places::<N>(output).as_chunks_mut::<P>().0
}

/// All rows of a gathered input for one part of a group.
#[inline(always)]
fn gather<S: Simd, const N: usize>(values: &[[f64; 3]], rows: &[[u32; LANES]; N], part: usize) -> [Vec3<S>; N] {
    let mut out = [gather3::<S>(values, &rows[0], part); N];
    for a in 1..N {
        out[a] = gather3::<S>(values, &rows[a], part);
    }
    out
}
