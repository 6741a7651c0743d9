//! `souple campaign`: hands its arguments to `souple-campaign`, a program of its own.
//!
//! The database is most of what campaigns cost to build, and `souple` is built without it.

use super::neighbour::hand_over;
use crate::failure::Failure;
use clap::Args;
use std::ffi::OsString;

/// How the program is built.
const BUILD: &str = "cargo build --release -p souple-campaign";

#[derive(Debug, Args)]
#[command(
    disable_help_flag = true,
    after_help = "Example: souple campaign run DIR\n\n\
        souple-campaign is built with: cargo build --release -p souple-campaign"
)]
pub(crate) struct Arguments {
    /// Arguments of souple-campaign; --help explains them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    hand_over("souple-campaign", BUILD, &arguments.arguments)
}
