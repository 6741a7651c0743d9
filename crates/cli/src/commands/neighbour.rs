//! Commands that are programs of their own, because what they need costs more to build than `souple` itself: they are
//! looked for beside `souple`, then along the search path, and get the arguments as they are.

use crate::failure::{Failure, input};
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

/// Runs `program` and ends as it ends; where it is missing, says how it is built.
pub(crate) fn hand_over(program: &str, build: &str, arguments: &[OsString]) -> Result<(), Failure> {
    let beside = std::env::current_exe().ok();
    let beside = beside.map(|here| here.with_file_name(format!("{program}{}", std::env::consts::EXE_SUFFIX)));
    let path = beside.filter(|path| path.is_file()).unwrap_or_else(|| PathBuf::from(program));
    // Ctrl-C reaches the program too, which stops in good order; we wait for it.
    let _ = ctrlc::set_handler(|| {});
    let status = Command::new(&path).args(arguments).status().map_err(|e| match e.kind() {
        ErrorKind::NotFound => {
            input(format!("{program} is neither beside souple nor on the search path; build it with\n    {build}"))
        }
        _ => input(format!("cannot start {}: {e}", path.display())),
    })?;
    match status.code() {
        Some(0) => Ok(()),
        Some(code) => Err(Failure::Said(u8::try_from(code).unwrap_or(2))),
        None => Err(input(format!("{program} was ended from outside"))),
    }
}
