//! The command line: one file a command, and one place where an outcome becomes an exit code.

mod bench;
mod campaign;
mod campaign_end;
mod check;
mod classify;
mod compare;
mod completions;
mod convert;
mod deny;
mod doubts;
mod engine_decisions;
mod examine;
mod exit;
mod gate;
mod gate_baseline;
mod gate_diagnosis;
mod gate_settings;
mod input;
mod input_file;
mod merge;
#[cfg(feature = "mpi")]
mod mpi;
mod output_file;
mod progress;
mod reading;
mod replay;
mod replay_step;
mod report;
mod shrink;
mod simulate;
mod simulate_causes;
mod simulate_exact;
mod stop;
mod stress;
mod table;
mod terminal;
mod tune;

use clap::{Parser, Subcommand};
use exit::Outcome;
use std::process::ExitCode;
use std::time::Instant;

/// Tells whether contact analysis of polyhedral blocks can be trusted.
///
/// Exit codes: 0 done; 1 a rule is violated or something denied was found; 2 usage or input error; 130 interrupted.
#[derive(Parser)]
#[command(name = "rockproof", version, max_term_width = 120)]
struct Cli {
    #[command(flatten)]
    talk: exit::VerbosityArgs,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Examine(examine::Examine),
    Classify(classify::Classify),
    Simulate(simulate::Simulate),
    Check(check::Check),
    Campaign(campaign::Campaign),
    Merge(merge::Merge),
    Replay(replay::Replay),
    Report(report::Report),
    Compare(compare::Compare),
    Shrink(shrink::Shrink),
    Convert(convert::Convert),
    Gate(gate::Gate),
    Bench(bench::Bench),
    Tune(tune::Tune),
    Completions(completions::Completions),
    Man(completions::Man),
}

impl Command {
    fn run(&self) -> Outcome {
        match self {
            Command::Examine(command) => command.run(),
            Command::Classify(command) => command.run(),
            Command::Simulate(command) => command.run(),
            Command::Check(command) => command.run(),
            Command::Campaign(command) => command.run(),
            Command::Merge(command) => command.run(),
            Command::Replay(command) => command.run(),
            Command::Report(command) => command.run(),
            Command::Compare(command) => command.run(),
            Command::Shrink(command) => command.run(),
            Command::Convert(command) => command.run(),
            Command::Gate(command) => command.run(),
            Command::Bench(command) => command.run(),
            Command::Tune(command) => command.run(),
            Command::Completions(command) => command.run(),
            Command::Man(command) => command.run(),
        }
    }
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return exit::refuse(&error),
    };
    let begun = Instant::now();
    cli.talk.apply();
    rockproof_results::on_unprotected(|dir| exit::print_note(&terminal::unprotected(dir)));
    let code = exit::code(terminal::check_environment().map_err(anyhow::Error::msg).and_then(|()| cli.command.run()));
    cli.talk.tell_cost(begun);
    code
}
