//! The command line: one file a command, and one place where an outcome becomes an exit code.

mod check;
mod convert;
mod exit;
mod input;

use clap::{Parser, Subcommand};
use exit::Outcome;
use std::process::ExitCode;

/// Tells whether contact analysis of polyhedral blocks can be trusted.
///
/// Exit codes: 0 done; 1 a rule is violated or something denied was found; 2 usage or input error.
#[derive(Parser)]
#[command(name = "rockproof", version, max_term_width = 120)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Check(check::Check),
    Convert(convert::Convert),
}

impl Command {
    fn run(&self) -> Outcome {
        match self {
            Command::Check(command) => command.run(),
            Command::Convert(command) => command.run(),
        }
    }
}

/// Runs the command that the arguments ask for.
pub(crate) fn run() -> ExitCode {
    exit::code(Cli::parse().command.run())
}
