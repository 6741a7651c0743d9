//! What a backend is, the interpreter, the oracle, and the suite that every backend must pass.
//!
//! A [`Backend`] compiles a verified program into a [`Kernel`], which runs it for many items at once.
//! Items come in *groups* of [`LANES`]; buffers are arrays of structures of arrays: [group][place][lane], and
//! [group][point][place][lane] for per-point buffers. So every operation works on [`LANES`] neighbours in memory.
//!
//! Numbers are doubles; a backend may offer singles too.
//!
//! Backends see programs and buffers only.

mod aligned;
pub mod conformance;
mod contract;
mod interpreter;
mod number;
pub mod oracle;
pub mod plan;

pub use aligned::Aligned;
pub use contract::{About, Backend, CompileError, Input, Kernel, LANES, Scratch};
pub use interpreter::{Interpreter, execute};
pub use number::Number;
