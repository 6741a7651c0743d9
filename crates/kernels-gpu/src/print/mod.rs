//! Programs as the text of another language: one walk over the statements, one folder per language.
//!
//! ```text
//! Program + Layout ── walk ──► Dialect: declarations, loads, operations, loops ──► Printed
//! ```
//!
//! One invocation runs the program for one item.
//! Items stand in groups of [`Layout::lanes`] side by side, so that neighbours read neighbours:
//!
//! ```text
//! place p of item i of a lane buffer        [i / lanes][p][i mod lanes]
//! place p of a gathered one                 values[width · row + p mod width], row at [i / lanes][p / width][i mod lanes]
//! place p of a uniform one                  uniforms[its offset + p]
//! value of table t at point q               uniforms[tables + t · points + q]
//! ```
//!
//! What it is not: a compiler. Statements are printed in their order; whoever reads the text schedules them.

pub mod cuda;
mod walk;
pub mod wgsl;

pub use walk::{Dialect, print};

use souple_program::{Counts, Program};
use thiserror::Error;

/// How an input buffer arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// In lane order, one array per item.
    Lanes,
    /// From rows of a shared array.
    Gathered {
        /// Length of a row.
        width: usize,
        /// Number of the table of row numbers, from 0: inputs with the same number share it.
        table: usize,
    },
    /// The same for every item.
    Uniform,
}

/// How the buffers of a program lie in memory.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Layout {
    /// Items side by side in a group.
    pub lanes: usize,
    /// Invocations of a workgroup.
    pub workgroup: usize,
    /// How each input arrives, in the program's order.
    pub inputs: Vec<Access>,
    /// Whether loops over points are written out.
    pub loops: Loops,
}

/// How loops over points are printed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Loops {
    /// As loops: short text, quick to compile.
    #[default]
    Rolled,
    /// Written out, point after point, the tables' values as constants.
    Unrolled,
}

/// What stands behind a binding of a printed program, in the order of the bindings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Values of all uniform inputs in the order of the inputs, then the tables, [table][point].
    Uniforms,
    /// Row numbers, [group][row place][lane].
    Rows(usize),
    /// Values of input number k.
    Input(usize),
    /// Values of output number k.
    Output(usize),
}

/// A printed program.
#[derive(Clone, Debug, PartialEq)]
pub struct Printed {
    /// The text.
    pub source: String,
    /// What it is given, in order.
    pub bindings: Vec<Binding>,
    /// Statements of its longest part, as printed.
    pub longest: usize,
    /// What it costs per item.
    pub counts: Counts,
}

/// Why a program cannot be printed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PrintError {
    /// A constant is too large for single precision.
    #[error("the program `{program}` has the constant {value:e}, which single precision does not hold")]
    Constant {
        /// The program.
        program: String,
        /// The constant.
        value: f64,
    },
    /// The layout does not fit the program.
    #[error("the program `{program}` has {expected} inputs and the layout describes {found}")]
    Layout {
        /// The program.
        program: String,
        /// Inputs of the program.
        expected: usize,
        /// Inputs of the layout.
        found: usize,
    },
}

impl Layout {
    /// Row tables that the inputs name.
    pub fn tables(&self) -> usize {
        let table = |a: &Access| if let Access::Gathered { table, .. } = a { table + 1 } else { 0 };
        self.inputs.iter().map(table).max().unwrap_or(0)
    }

    /// Row numbers that an item has in a table; zero for a table that nobody reads.
    pub fn rows_per_item(&self, program: &Program, table: usize) -> usize {
        let rows = |(k, a): (usize, &Access)| match *a {
            Access::Gathered { width, table: t } if t == table => program.inputs[k].total(program.points) / width,
            _ => 0,
        };
        self.inputs.iter().enumerate().map(rows).max().unwrap_or(0)
    }

    /// The bindings of a program with this layout.
    pub fn bindings(&self, program: &Program) -> Vec<Binding> {
        let mut bindings = Vec::new();
        if self.inputs.contains(&Access::Uniform) || !program.tables.is_empty() {
            bindings.push(Binding::Uniforms);
        }
        bindings.extend((0..self.tables()).map(Binding::Rows));
        let own = |k: &usize| self.inputs[*k] != Access::Uniform;
        bindings.extend((0..self.inputs.len()).filter(own).map(Binding::Input));
        bindings.extend((0..program.outputs.len()).map(Binding::Output));
        bindings
    }

    /// Where the values of uniform input `k` begin in the uniforms.
    pub fn uniform_offset(&self, program: &Program, k: usize) -> usize {
        let uniform = |j: &usize| self.inputs[*j] == Access::Uniform;
        (0..k).filter(uniform).map(|j| program.inputs[j].total(program.points)).sum()
    }

    /// Where the tables begin in the uniforms.
    pub fn tables_offset(&self, program: &Program) -> usize {
        self.uniform_offset(program, self.inputs.len())
    }
}
