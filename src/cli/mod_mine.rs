//! The command line: one file a command.

mod campaign;
mod classify;
mod combinations;
mod replay;
mod shrink;
mod table;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Tells whether contact analysis of polyhedral blocks can be trusted.
#[derive(Parser, Debug)]
#[command(name = "rockproof", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Classify the contacts between the blocks of a file
    Classify(classify::ClassifyArgs),
    /// Compare engines with the oracle on generated pairs, and explain every difference
    Campaign(campaign::CampaignArgs),
    /// Show what each engine and the oracle say about a case, decision by decision where they part
    Replay(replay::ReplayArgs),
    /// Make a case smaller
    Shrink(shrink::ShrinkArgs),
}

/// Why a command failed; exit status 2.
#[derive(Debug, thiserror::Error)]
enum CliError {
    #[error("{file}: {source}")]
    Read { file: String, source: std::io::Error },
    #[error("{file}: {source}")]
    Toml { file: String, source: Box<toml::de::Error> },
    #[error("{what} \"{found}\" is not one of: {allowed}")]
    NotOne { what: &'static str, found: String, allowed: String },
    #[error(transparent)]
    Case(#[from] crate::campaign::case_file::CaseError),
    #[error(transparent)]
    Journal(#[from] crate::campaign::journal::JournalError),
    #[error(transparent)]
    Run(#[from] crate::campaign::run::RunError),
    #[error(transparent)]
    Scene(#[from] crate::model::SceneError),
    #[error("cannot write: {0}")]
    Print(std::io::Error),
    #[error("{0}")]
    Other(String),
}

/// Runs the program on the arguments it was started with.
pub fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Classify(args) => classify::run(args),
        Command::Campaign(args) => campaign::run(args),
        Command::Replay(args) => replay::run(args),
        Command::Shrink(args) => shrink::run(args),
    };
    match result {
        Ok(code) => code,
        // Whoever reads our output may close it early: `| head`.
        Err(CliError::Print(error)) if error.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
