//! `souple view`: hands its arguments to `souple-view`, a program of its own.
//!
//! Windows and graphics devices are most of what the viewer costs to build, and `souple` is built without them; so it
//! looks for the program beside itself, then along the search path.

use crate::failure::{Failure, input};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// Name of the program.
const PROGRAM: &str = "souple-view";

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
    let program = beside().unwrap_or_else(|| PathBuf::from(PROGRAM));
    let status = Command::new(&program).args(&arguments.arguments).status().map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => input(format!(
            "{PROGRAM} is neither beside souple nor on the search path; build it with\n    \
             cargo build --release -p souple-viewer --features window\n\
             (without `--features window` it draws pictures only)"
        )),
        _ => input(format!("cannot start {}: {e}", program.display())),
    })?;
    // What went wrong has been said by the program itself.
    match status.code() {
        Some(0) => Ok(()),
        Some(3) => Err(Failure::Simulation(String::new())),
        Some(_) => Err(Failure::Input(anyhow::Error::msg(String::new()))),
        None => Err(input(format!("{PROGRAM} was ended from outside"))),
    }
}

/// The program in the folder of this one.
fn beside() -> Option<PathBuf> {
    let here = std::env::current_exe().ok()?;
    let program = here.with_file_name(format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX));
    program.is_file().then_some(program)
}
