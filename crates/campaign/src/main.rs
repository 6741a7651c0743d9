//! The `souple-campaign` program: what `souple campaign` starts.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | every simulation is done and recorded, however it ended |
//! | 1 | with `--check`: something did not end or measure as the description says |
//! | 2 | bad input, or something cannot be read, written or started |
//! | 130 | interrupted; the same command goes on |
//!
//! Each command is one module of `commands`: its arguments, and a function that runs it.

mod commands;
mod output;

use clap::{Parser, Subcommand};
use output::note;
use std::process::ExitCode;

/// Run groups of simulations and keep their results in a database.
#[derive(Debug, Parser)]
#[command(name = "souple campaign", version, after_help = "Example: souple campaign run DIR && souple campaign show")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run what is not done yet of the group described in a folder
    #[command(visible_alias = "resume")]
    Run(commands::run::Arguments),
    /// Take into the database what tasks of a scheduler gave
    Collect(commands::collect::Arguments),
    /// Do one task of a spool
    #[command(hide = true)]
    Task(commands::task::Arguments),
    /// Write a page with graphs and a table of a group, which opens in a browser without a network
    Report(commands::report::Arguments),
    /// Show such pages in a browser while the database is being filled
    Serve(commands::serve::Arguments),
    /// Write a group as CSV or Parquet
    Export(commands::export::Arguments),
    /// Compare two groups, or one group in two databases
    Compare(commands::compare::Arguments),
    /// List the groups of a database
    List(commands::list::Arguments),
    /// Show the simulations of a group
    Show(commands::show::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => commands::run::run(&arguments),
        Command::Collect(arguments) => commands::collect::run(&arguments),
        Command::Task(arguments) => commands::task::run(&arguments),
        Command::Report(arguments) => commands::report::run(&arguments),
        Command::Serve(arguments) => commands::serve::run(&arguments),
        Command::Export(arguments) => commands::export::run(&arguments),
        Command::Compare(arguments) => commands::compare::run(&arguments),
        Command::List(arguments) => commands::list::run(&arguments),
        Command::Show(arguments) => commands::show::run(&arguments),
    };
    match done {
        Ok(code) => code,
        Err(message) => {
            note(&format!("error: {message}"));
            ExitCode::from(2)
        }
    }
}
