//! Judges all mutants that cargo-mutants lists without building the project once for each.
//!
//! ```text
//! cargo mutants --list --json -p rockproof-oracle -p rockproof-stepper > list.json
//! cargo run --release --manifest-path examples/mutants/Cargo.toml -- list.json --work work --results results.tsv
//! ```
//!
//! All mutants are put into one copy of the project, each as a branch that an environment variable chooses; those that do not compile are left out. Each test
//! is run once to see which mutants it reaches, and then each mutant is held against the tests that reach it, shortest first. A run that was
//! stopped goes on with the mutants that the results do not name. docs/mutants.md tells what came of it.

mod judging;
mod list;
mod rewrite;
mod tree;

use anyhow::{Context, Result};
use clap::Parser;
use judging::Test;
use list::Mutant;
use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tree::Absent;

/// Hold the mutants of a list against the tests of the oracle and the stepper
#[derive(Parser)]
struct Arguments {
    /// What `cargo mutants --list --json` printed
    list: PathBuf,
    /// The project
    #[arg(long, default_value = ".")]
    project: PathBuf,
    /// Directory of the copy, of what is built and of what was measured
    #[arg(long)]
    work: PathBuf,
    /// Table of the verdicts; lines are added
    #[arg(long)]
    results: PathBuf,
    /// About how many seconds of tests a mutant gets
    #[arg(long, default_value_t = 4.0)]
    limit: f64,
    /// Mutants at once
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Further tests: arguments of `cargo test` that name a package and a test program
    #[arg(long, value_name = "ARGUMENTS")]
    also: Vec<String>,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let mutants = list::read(&arguments.list)?;
    std::fs::create_dir_all(&arguments.work)?;
    let work = arguments.work.canonicalize()?;
    let tree = work.join("tree");
    let (absent_file, measured) = (work.join("absent.json"), work.join("measured.json"));
    let mut absent: Absent = match std::fs::read_to_string(&absent_file) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(_) => Absent::default(),
    };
    if !measured.exists() {
        tree::copy(&arguments.project, &tree)?;
        tree::make(&arguments.project, &tree, &mutants, &mut absent, &absent_file)?;
        let crates = ["-p", "rockproof-oracle", "-p", "rockproof-stepper"].map(str::to_owned).to_vec();
        let also = arguments.also.iter().map(|text| text.split_whitespace().map(str::to_owned).collect());
        let packages: Vec<Vec<String>> = std::iter::once(crates).chain(also).collect();
        let programs = tree::test_programs(&tree, &packages)?;
        eprintln!("{} test programs", programs.len());
        let found = judging::measure(&tree, &programs, arguments.threads, Duration::from_secs(120))?;
        std::fs::write(&measured, serde_json::to_string(&found)?)?;
    }
    let tests: Vec<Test> = serde_json::from_str(&std::fs::read_to_string(&measured)?)?;
    eprintln!("{} tests, {:.0} s", tests.len(), tests.iter().map(|test| test.seconds).sum::<f64>());
    judge(&arguments, &mutants, &absent, &tests)
}

/// Adds a line for each mutant that the table does not name.
fn judge(arguments: &Arguments, mutants: &[Mutant], absent: &Absent, tests: &[Test]) -> Result<()> {
    let known = known(&arguments.results)?;
    let file = std::fs::OpenOptions::new().create(true).append(true).open(&arguments.results)?;
    let file = Mutex::new(file);
    let (next, begin) = (AtomicUsize::new(0), Instant::now());
    let line = |mutant: &Mutant, outcome: &str, counts: &str, by: &str| -> Result<()> {
        let mut file = file.lock().unwrap();
        writeln!(file, "{outcome}\t{counts}\t{}\t{by}", mutant.name).context("the table cannot be written")
    };
    let work = || -> Result<()> {
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(mutant) = mutants.get(at) else {
                return Ok(());
            };
            if known.contains(&mutant.name) {
                continue;
            }
            let id = at + 1;
            if absent.uncompilable.contains(&id) {
                line(mutant, "does not compile", "", "")?;
            } else if absent.unchoosable.contains(&id) {
                line(mutant, "no branch", "", "")?;
            } else {
                let verdict = judging::judge(tests, id, arguments.limit)?;
                let counts = format!("{} of {}", verdict.run, verdict.of);
                let by: String = verdict.by.chars().take(60).collect();
                line(mutant, verdict.outcome.name(), &counts, &by)?;
            }
            if at.is_multiple_of(100) {
                eprintln!("{at} of {}, {:.0} s", mutants.len(), begin.elapsed().as_secs_f64());
            }
        }
    };
    std::thread::scope(|scope| -> Result<()> {
        let handles: Vec<_> = (0..arguments.threads).map(|_| scope.spawn(work)).collect();
        handles.into_iter().try_for_each(|handle| handle.join().expect("no thread panics"))
    })
}

/// Mutants that a table names.
fn known(path: &Path) -> Result<HashSet<String>> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(_) => return Ok(HashSet::new()),
    };
    Ok(text.lines().filter_map(|line| line.split('\t').nth(2).map(str::to_owned)).collect())
}
