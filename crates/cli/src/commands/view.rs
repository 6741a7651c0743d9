//! `souple view`: hands its arguments to `souple-view`, a program of its own.
//!
//! Windows and graphics devices are most of what the viewer costs to build, and `souple` is built without them.

use super::neighbour::hand_over;
use crate::failure::Failure;
use clap::Args;
use std::ffi::OsString;

/// How the program is built.
const BUILD: &str = "cargo build --release -p souple-viewer --features window\n    (without `--features window` it draws pictures only)";

#[derive(Debug, Args)]
#[command(
    disable_help_flag = true,
    after_help = "Example: souple view scenes/organ.toml\n\n\
        souple-view is built with: cargo build --release -p souple-viewer --features window"
)]
pub(crate) struct Arguments {
    /// Arguments of souple-view; --help explains them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    hand_over("souple-view", BUILD, &arguments.arguments)
}
