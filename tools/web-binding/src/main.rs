//! `web-binding PROGRAM.wasm FOLDER`: what a browser needs to start a program that rustc compiled for wasm32.
//!
//! rustc leaves descriptions of the JavaScript functions that the program calls in its file. They are read here, removed,
//! and replaced by `FOLDER/NAME.js`, which loads `FOLDER/NAME_bg.wasm`.

use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [program, folder] = arguments.as_slice() else {
        eprintln!("error: expected two arguments, a .wasm file and a folder to write to, found {}", arguments.len());
        return ExitCode::from(2);
    };
    let bound = Bindgen::new()
        .input_path(program)
        .web(true)
        .and_then(|binding| binding.typescript(false).remove_name_section(true).generate(folder));
    match bound {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {program} cannot be bound: {error:?}");
            ExitCode::FAILURE
        }
    }
}
