//! `souple serve`: hands its arguments to `souple-serve`, a program of its own.
//!
//! HTTP and WebSockets are most of what serving costs to build, and `souple` is built without them.

use super::neighbour::hand_over;
use crate::failure::Failure;
use clap::Args;
use std::ffi::OsString;

/// How the program is built.
const BUILD: &str = "cargo build --release -p souple-serve";

#[derive(Debug, Args)]
#[command(
    disable_help_flag = true,
    after_help = "Example: souple serve scenes/organ.toml --open\n\n\
        souple-serve is built with: cargo build --release -p souple-serve"
)]
pub(crate) struct Arguments {
    /// Arguments of souple-serve; --help explains them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    hand_over("souple-serve", BUILD, &arguments.arguments)
}
