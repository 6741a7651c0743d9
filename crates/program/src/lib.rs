//! The kernel language and its compiler: from a graph of expressions to straight-line programs for each binding time.
//!
//! | stage | in | out | function |
//! |---|---|---|---|
//! | 1 associate | n-ary sums and products | two-operand nodes, common pairs shared | [`associate`] |
//! | 2 cut | nodes with binding times | the values carried from one time to the next | [`carried`] |
//! | 3 lower | roots of one time | a [`Program`]: straight sections and loops over points | [`lower`] |
//! | 4 verify | a program | the same, or what is wrong with it | [`verify`] |
//! | – text | a program | its text, and back | [`print`], [`parse`] |
//! | – count | a program | operations, loads, stores | [`Counts`] |
//!
//! [`stage`] drives 1 to 3 for a family of programs that share carried values.
//! Nothing here knows what the expressions mean.

mod associate;
mod counts;
mod cut;
mod dag;
mod eigenvectors;
mod language;
mod lower;
mod stage;
mod text;
mod verify;

pub use associate::associate;
pub use counts::Counts;
pub use cut::{Costs, carried};
pub use dag::{Dag, DagNode, Operation, Ref};
pub use language::{Buffer, Op, Program, Section, Statement, Value};
pub use lower::{Source, Target, lower};
pub use stage::{BufferRequest, LINEARISE, OutputRequest, SETUP, Staged, StagedProgram, stage};
pub use text::{ParseError, parse, print};
pub use verify::{VerifyError, verify};
