//! Starts the command line.

fn main() -> std::process::ExitCode {
    rockproof::cli::main()
}
