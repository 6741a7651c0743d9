//! `souple campaign`: hands its arguments to `souple-campaign`, a program of its own.
//!
//! The database is most of what campaigns cost to build, and `souple` is built without it; so it looks for the program
//! beside itself, then along the search path.

use crate::failure::{Failure, input};
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// Name of the program.
const PROGRAM: &str = "souple-campaign";

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
    let beside = std::env::current_exe().ok();
    let beside = beside.map(|here| here.with_file_name(format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX)));
    let program = beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(PROGRAM));
    // Ctrl-C reaches the program too, which stops in good order; we wait for it.
    let _ = ctrlc::set_handler(|| {});
    let status = Command::new(&program).args(&arguments.arguments).status().map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => input(format!(
            "{PROGRAM} is neither beside souple nor on the search path; build it with\n    \
             cargo build --release -p souple-campaign"
        )),
        _ => input(format!("cannot start {}: {e}", program.display())),
    })?;
    // What went wrong has been said by the program itself.
    match status.code() {
        Some(0) => Ok(()),
        Some(130) => Err(Failure::Interrupted(String::new())),
        Some(_) => Err(Failure::Input(anyhow::Error::msg(String::new()))),
        None => Err(input(format!("{PROGRAM} was ended from outside"))),
    }
}
