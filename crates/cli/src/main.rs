//! The `souple` command: arguments in, texts and files out, and the only place that decides on exit codes.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done; with `--check`, the scene's expectations are met |
//! | 1 | the scene's expectations are not met |
//! | 2 | bad input: arguments, scene, mesh, or a file that cannot be read |
//! | 3 | the simulation failed; its last good state is on disk |
//! | 4 | what the command gives cannot be written: a full disk, a folder that may not be written |
//! | 130 | interrupted; the state of the last finished step is on disk |
//!
//! Each command is one module of `commands`: its arguments, and a function that runs it.

mod commands;
mod failure;
mod files;
mod terminal;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Simulate soft bodies with finite elements of any mixture of kinds.
#[derive(Debug, Parser)]
#[command(name = "souple", version, after_help = "Example: souple run scenes/mixed_bar.toml --out out/bar")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List what can be chosen: elements, laws, integrators, devices, scenes
    List(commands::list::Arguments),
    /// Derive an element with a law: operation counts, formulas, programs, LaTeX
    Derive(commands::derive::Arguments),
    /// Generate, inspect and convert meshes
    Mesh(commands::mesh::Arguments),
    /// Read a scene with its meshes and say what was found, without running it
    Check(commands::check::Arguments),
    /// Judge a law with its parameters: at rest, under rotations, its derivatives, its curves
    CheckLaw(commands::check_law::Arguments),
    /// Run a scene
    Run(commands::run::Arguments),
    /// See a scene in a window and touch it, or draw a picture of it
    View(commands::view::Arguments),
    /// Simulate here, see and touch it in browsers
    Serve(commands::serve::Arguments),
    /// Say what graphics devices this machine has, what they lack and what to do about it
    Doctor(commands::doctor::Arguments),
    /// Run groups of simulations and keep their results in a database
    Campaign(commands::campaign::Arguments),
    /// Measure what kernels, operators, steps and loading cost on this machine
    Bench(commands::bench::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::List(arguments) => commands::list::run(&arguments),
        Command::Derive(arguments) => commands::derive::run(&arguments),
        Command::Mesh(arguments) => commands::mesh::run(&arguments),
        Command::Check(arguments) => commands::check::run(&arguments),
        Command::CheckLaw(arguments) => commands::check_law::run(&arguments),
        Command::Run(arguments) => commands::run::run(&arguments),
        Command::View(arguments) => commands::view::run(&arguments),
        Command::Serve(arguments) => commands::serve::run(&arguments),
        Command::Doctor(arguments) => commands::doctor::run(&arguments),
        Command::Campaign(arguments) => commands::campaign::run(&arguments),
        Command::Bench(arguments) => commands::bench::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            terminal::complain(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Arguments;
    use clap::CommandFactory as _;

    /// The declaration of the arguments contradicts itself nowhere.
    #[test]
    fn arguments_are_consistent() {
        Arguments::command().debug_assert();
    }

    /// Every command and subcommand shows an example in its help.
    #[test]
    fn every_command_has_an_example() {
        fn check(command: &clap::Command) {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Example") && help.contains("souple "), "{}", command.get_name());
            command.get_subcommands().for_each(check);
        }
        check(&Arguments::command());
    }
}
