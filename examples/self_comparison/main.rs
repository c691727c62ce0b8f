//! Compares the exact side with itself, for as long as one likes: fast path, stepper in 512 bits and plain path on the pairs of a campaign.
//!
//! ```text
//! cargo run --release --example self_comparison -- run --pairs 1600000 --seed 7 --out comparison
//! cargo run --release --example self_comparison -- run --pairs 1600000 --seed 7 --out comparison --resume
//! cargo run --release --example self_comparison -- run --pairs 1600000000 --seed 8 --part 3/100 --out parts/3
//! cargo run --release --example self_comparison -- total comparison parts/*
//! cargo run --release --example self_comparison -- check comparison/cases/*.toml
//! ```
//!
//! It goes on after a disagreement: the pair is kept as a case file, and the run ends with 1. Ctrl-C commits what is done and ends with 130. With the
//! feature `gmp` the plain path joins in GMP's rationals as well. docs/validation.md says what was compared.

mod check;
mod run;
#[path = "../../src/terminal.rs"]
mod terminal;
mod total;

use clap::{Parser, Subcommand};
use rockproof_validation::self_comparison::paths::{self, Paths};
use std::process::ExitCode;
use terminal::{INTERRUPTED, check_environment, to_stdout};

/// Compare the exact side with itself: the oracle's fast path, the stepper in 512 bits, the oracle's plain path
#[derive(Parser)]
#[command(
    name = "self_comparison",
    after_help = "Exit status: 0 no disagreement, 1 disagreements, 2 wrong arguments or files or nothing compared, 130 interrupted."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Run(run::Run),
    Total(total::TotalArgs),
    Check(check::Check),
}

/// How a command ends.
enum Verdict {
    Agreed,
    Disagreed,
    Interrupted,
}

#[cfg(feature = "gmp")]
static PATHS: &dyn Paths = &paths::WithGmp::<rug::Rational>::new();
#[cfg(not(feature = "gmp"))]
static PATHS: &dyn Paths = &paths::BuiltIn;

fn main() -> ExitCode {
    let command = Arguments::parse().command;
    let outcome = check_environment().map_err(anyhow::Error::msg).and_then(|()| match command {
        Command::Run(run) => run.run(),
        Command::Total(total) => total.run(),
        Command::Check(check) => check.run(),
    });
    match outcome {
        Ok(Verdict::Agreed) => ExitCode::SUCCESS,
        Ok(Verdict::Disagreed) => ExitCode::from(1),
        Ok(Verdict::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Prints to stdout.
fn print(text: &str) -> anyhow::Result<()> {
    Ok(to_stdout(|out| out.write_all(text.as_bytes()))?)
}
