//! Judges all mutants that cargo-mutants lists without building the project once for each.
//!
//! ```text
//! cargo mutants --list --json -p rockproof-oracle -p rockproof-stepper > list.json
//! cargo run --release --manifest-path examples/mutants/Cargo.toml -- list.json --work work --results results.tsv
//! ```
//!
//! All mutants are put into one copy of the project, each as a branch that an environment variable chooses; those that do not compile are left out. Each test
//! is run once to see which mutants it reaches, and then against the mutants that it reaches and that no shorter one found: with many of them at once, and
//! where it fails, with half of these, until one is left. A run that was stopped goes on. docs/mutants.md tells what came of it.

mod judging;
mod list;
mod rewrite;
mod tree;

use anyhow::{Context, Result};
use clap::Parser;
use judging::{Outcome, Round, Test};
use list::Mutant;
use rewrite::Id;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeSet, HashSet};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
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
    /// About how many seconds of tests a mutant gets; without it, all that reach it
    #[arg(long)]
    limit: Option<f64>,
    /// Mutants chosen at once
    #[arg(long, default_value_t = 12)]
    together: usize,
    /// Tests at once
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
        let crates = ["rockproof-oracle", "rockproof-oracle-tests", "rockproof-stepper-tests"];
        let crates = crates.into_iter().flat_map(|name| ["-p".to_owned(), name.to_owned()]).collect();
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

/// A mutant that no test has found yet.
struct Alive<'a> {
    id: Id,
    mutant: &'a Mutant,
    /// Tests that were run and that reach it, all that reach it, and the seconds that those run took.
    run: usize,
    of: usize,
    seconds: f64,
}

/// What tests were run with which mutants, so that a run that was stopped goes on.
#[derive(Default, Serialize, Deserialize)]
struct Progress {
    mutants: BTreeSet<Id>,
    rounds: BTreeSet<String>,
}

/// Adds a line for each mutant that the table does not name.
fn judge(arguments: &Arguments, mutants: &[Mutant], absent: &Absent, tests: &[Test]) -> Result<()> {
    let known = known(&arguments.results)?;
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&arguments.results)?;
    let mut line = |mutant: &Mutant, outcome: &str, counts: &str, by: &str| -> Result<()> {
        let by: String = by.chars().take(60).collect();
        writeln!(file, "{outcome}\t{counts}\t{}\t{by}", mutant.name).context("the table cannot be written")
    };
    let rounds = Round::all(tests);
    let mut alive = Vec::new();
    for (at, mutant) in mutants.iter().enumerate().filter(|(_, mutant)| !known.contains(&mutant.name)) {
        let id = at + 1;
        if absent.uncompilable.contains(&id) {
            line(mutant, "does not compile", "", "")?;
        } else if absent.unchoosable.contains(&id) {
            line(mutant, "no branch", "", "")?;
        } else {
            let of = rounds.iter().map(|round| round.reaching(id)).sum();
            alive.push(Alive { id, mutant, run: 0, of, seconds: 0.0 });
        }
    }
    let progress_file = arguments.work.join("progress.json");
    let mut progress: Progress = match std::fs::read_to_string(&progress_file) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(_) => Progress::default(),
    };
    let ids: BTreeSet<Id> = alive.iter().map(|mutant| mutant.id).collect();
    if !ids.is_subset(&progress.mutants) {
        progress = Progress { mutants: ids, rounds: BTreeSet::new() };
    }
    let limit = arguments.limit.unwrap_or(f64::INFINITY);
    for (at, round) in rounds.iter().enumerate() {
        let reached = |mutant: &Alive| round.reaching(mutant.id) > 0 && mutant.seconds + round.seconds <= limit;
        let asked: Vec<Id> = alive.iter().filter(|mutant| reached(mutant)).map(|mutant| mutant.id).collect();
        if !progress.rounds.contains(&round.name()) {
            for (id, outcome) in find(arguments, round, at, &asked)? {
                let place = alive.iter().position(|mutant| mutant.id == id).context("found twice")?;
                let mutant = alive.remove(place);
                let counts = format!("{} of {}", mutant.run + round.reaching(id), mutant.of);
                line(mutant.mutant, outcome.name(), &counts, &round.name())?;
            }
            progress.rounds.insert(round.name());
            std::fs::write(&progress_file, serde_json::to_string(&progress)?)?;
        }
        for mutant in alive.iter_mut().filter(|mutant| asked.contains(&mutant.id)) {
            mutant.run += round.reaching(mutant.id);
            mutant.seconds += round.seconds;
        }
        let short: String = round.name().chars().take(60).collect();
        eprintln!("{} of {}: {} mutants alive; {:.1} s, {short}", at + 1, rounds.len(), alive.len(), round.seconds);
    }
    for mutant in alive {
        let outcome = match (mutant.run, mutant.of) {
            (_, 0) => Outcome::Unreached,
            (run, of) if run == of => Outcome::Survived,
            _ => Outcome::SurvivedSome,
        };
        line(mutant.mutant, outcome.name(), &format!("{} of {}", mutant.run, mutant.of), "")?;
    }
    Ok(())
}

/// What the tests of a round find among the mutants that they reach.
///
/// Those chosen at once are far from one another in the list, and others in each round: where one takes a path that
/// leads past another, it does so once.
fn find(arguments: &Arguments, round: &Round, at: usize, asked: &[Id]) -> Result<Vec<(Id, Outcome)>> {
    let groups = asked.len().div_ceil(arguments.together);
    let group = |which: usize| -> Vec<Id> {
        let shifted = |(place, _): &(usize, &Id)| (place + at * (place / groups)) % groups == which;
        asked.iter().enumerate().filter(shifted).map(|(_, id)| *id).collect()
    };
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<()> {
        loop {
            let which = next.fetch_add(1, Ordering::Relaxed);
            if which >= groups {
                return Ok(());
            }
            let here = round.find(&group(which))?;
            found.lock().unwrap().extend(here);
        }
    };
    std::thread::scope(|scope| -> Result<()> {
        let handles: Vec<_> = (0..arguments.threads).map(|_| scope.spawn(work)).collect();
        handles.into_iter().try_for_each(|handle| handle.join().expect("no thread panics"))
    })?;
    Ok(found.into_inner().unwrap())
}

/// Mutants that a table names.
fn known(path: &Path) -> Result<HashSet<String>> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(_) => return Ok(HashSet::new()),
    };
    Ok(text.lines().filter_map(|line| line.split('\t').nth(2).map(str::to_owned)).collect())
}
