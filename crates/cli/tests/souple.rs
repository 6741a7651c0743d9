//! The `souple` command as a person or a script meets it: arguments in; texts, JSON, files and exit codes out.
//!
//! Each file of this folder's `souple/` is about one command.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

#[path = "souple/bad_input.rs"]
mod bad_input;
#[path = "souple/bench.rs"]
mod bench;
#[path = "souple/command.rs"]
mod command;
#[path = "souple/derive.rs"]
mod derive;
#[cfg(feature = "gpu")]
#[path = "souple/graphics.rs"]
mod graphics;
#[path = "souple/list.rs"]
mod list;
#[path = "souple/mesh.rs"]
mod mesh;
#[cfg(unix)]
#[path = "souple/neighbour.rs"]
mod neighbour;
#[path = "souple/run.rs"]
mod run;
