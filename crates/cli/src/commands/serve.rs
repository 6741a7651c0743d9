//! `souple serve`: hands its arguments to `souple-serve`, a program of its own.
//!
//! HTTP and WebSockets are most of what serving costs to build, and `souple` is built without them; so it looks for the
//! program beside itself, then along the search path.

use crate::failure::{Failure, input};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// Name of the program.
const PROGRAM: &str = "souple-serve";

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
    let beside = std::env::current_exe().ok();
    let beside = beside.map(|here| here.with_file_name(format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX)));
    let program = beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(PROGRAM));
    // Ctrl-C reaches the program too, which is how it ends; we wait for it.
    let _ = ctrlc::set_handler(|| {});
    let status = Command::new(&program).args(&arguments.arguments).status().map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => input(format!(
            "{PROGRAM} is neither beside souple nor on the search path; build it with\n    \
             cargo build --release -p souple-serve"
        )),
        _ => input(format!("cannot start {}: {e}", program.display())),
    })?;
    // What went wrong has been said by the program itself.
    match status.code() {
        Some(0) => Ok(()),
        Some(_) => Err(Failure::Input(anyhow::Error::msg(String::new()))),
        None => Err(input(format!("{PROGRAM} was ended from outside"))),
    }
}
