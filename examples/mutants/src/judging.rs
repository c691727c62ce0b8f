//! Tests of the tree: how long each takes, which mutants each reaches, and whether they find one.

use crate::rewrite::Id;
use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use wait_timeout::ChildExt;

/// A test.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Test {
    pub program: PathBuf,
    /// Where its package is: tests read files from there.
    pub folder: PathBuf,
    pub name: String,
    pub seconds: f64,
    pub reaches: BTreeSet<Id>,
}

/// Tests that take no longer than this are run in one process, as many as one program has.
const SHORT: f64 = 0.05;

/// How a process ended.
enum Ended {
    Passed,
    Failed,
    Hung,
}

fn run(program: &Path, folder: &Path, names: &[&str], setting: (&str, &str), limit: Duration) -> Result<Ended> {
    let mut child = Command::new(program)
        .args(names)
        .args(["--exact", "--test-threads", "1", "--quiet"])
        .current_dir(folder)
        .env(setting.0, setting.1)
        .env("CARGO_MANIFEST_DIR", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .with_context(|| program.display().to_string())?;
    match child.wait_timeout(limit)? {
        Some(status) if status.success() => Ok(Ended::Passed),
        Some(_) => Ok(Ended::Failed),
        None => {
            child.kill()?;
            child.wait()?;
            Ok(Ended::Hung)
        }
    }
}

/// Where the package of a test program is, by the name of the program.
fn folder_of(tree: &Path, program: &Path) -> PathBuf {
    let name = program.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.rsplit_once('-').map_or(&*name, |(stem, _)| stem);
    for folder in ["oracle", "crates/stepper"] {
        let root = tree.join(folder);
        let is_test = root.join("tests").join(format!("{stem}.rs")).exists() || root.join("tests").join(stem).is_dir();
        let package = if folder == "oracle" { "rockproof_oracle" } else { "rockproof_stepper" };
        if is_test || stem == package {
            return root;
        }
    }
    tree.to_owned()
}

/// Runs every test once with no mutant chosen.
pub fn measure(tree: &Path, programs: &[PathBuf], threads: usize, longest: Duration) -> Result<Vec<Test>> {
    let mut all = Vec::new();
    for program in programs {
        let folder = folder_of(tree, program);
        let output = Command::new(program).args(["--list", "--format", "terse"]).current_dir(&folder).output()?;
        for line in String::from_utf8(output.stdout)?.lines() {
            if let Some(name) = line.strip_suffix(": test") {
                all.push((program.clone(), folder.clone(), name.to_owned()));
            }
        }
    }
    let (next, found) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = |thread: usize| -> Result<()> {
        let trace = std::env::temp_dir().join(format!("mutants-{}-{thread}", std::process::id()));
        while let Some((program, folder, name)) = all.get(next.fetch_add(1, Ordering::Relaxed)) {
            let _ = std::fs::remove_file(&trace);
            let begin = Instant::now();
            let plain = run(program, folder, &[name], ("MUTANTS", ""), longest)?;
            let seconds = begin.elapsed().as_secs_f64();
            let traced = run(program, folder, &[name], ("MUTANT_TRACE", &trace.to_string_lossy()), 4 * longest)?;
            if !matches!((plain, traced), (Ended::Passed, Ended::Passed)) {
                eprintln!("left out, for it fails or takes more than {longest:?} without a mutant: {name}");
                continue;
            }
            let reached = std::fs::read_to_string(&trace).unwrap_or_default();
            let reaches = reached.lines().map(str::parse).collect::<Result<_, _>>()?;
            let test = Test { program: program.clone(), folder: folder.clone(), name: name.clone(), seconds, reaches };
            found.lock().unwrap().push(test);
        }
        Ok(())
    };
    std::thread::scope(|scope| -> Result<()> {
        let handles: Vec<_> = (0..threads).map(|thread| scope.spawn(move || work(thread))).collect();
        handles.into_iter().try_for_each(|handle| handle.join().expect("no thread panics"))
    })?;
    let found = found.into_inner().unwrap();
    ensure!(!found.is_empty(), "no test passes without a mutant");
    Ok(found)
}

/// What became of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// A test failed.
    Found,
    /// A test did not end.
    Hung,
    /// All tests that reach it passed.
    Survived,
    /// Those passed that were run within the limit.
    SurvivedSome,
    /// No test reaches it.
    Unreached,
}

impl Outcome {
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Found => "found",
            Outcome::Hung => "not ending",
            Outcome::Survived => "survived",
            Outcome::SurvivedSome => "survived some",
            Outcome::Unreached => "not reached",
        }
    }
}

/// Tests that are run in one process.
pub struct Round<'a> {
    tests: Vec<&'a Test>,
    /// How long they take without a mutant.
    pub seconds: f64,
}

impl<'a> Round<'a> {
    /// All tests, the quickest first: the short ones of a program in one round, each of the others in one of its own.
    pub fn all(tests: &'a [Test]) -> Vec<Round<'a>> {
        let mut short: BTreeMap<&Path, Round> = BTreeMap::new();
        let mut rounds = Vec::new();
        for test in tests {
            if test.seconds <= SHORT {
                let round = short.entry(&test.program).or_insert(Round { tests: Vec::new(), seconds: 0.0 });
                round.tests.push(test);
                round.seconds += test.seconds;
            } else {
                rounds.push(Round { tests: vec![test], seconds: test.seconds });
            }
        }
        rounds.extend(short.into_values());
        rounds.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        rounds
    }

    /// The tests that reach a mutant.
    pub fn reaching(&self, id: Id) -> usize {
        self.tests.iter().filter(|test| test.reaches.contains(&id)).count()
    }

    /// Names of the tests.
    pub fn name(&self) -> String {
        self.tests.iter().map(|test| test.name.as_str()).collect::<Vec<_>>().join(" ")
    }

    /// Those of the mutants that the tests find, each of them by itself.
    ///
    /// Tests that pass with all of them chosen at once find none of them; otherwise the mutants are halved. So one that is found
    /// only while another is not chosen is not found.
    pub fn find(&self, mutants: &[Id]) -> Result<Vec<(Id, Outcome)>> {
        let mut found = Vec::new();
        self.find_among(mutants, false, &mut found)?;
        Ok(found)
    }

    /// Adds what is found, and tells whether there was something; if `surely`, then there is.
    fn find_among(&self, mutants: &[Id], surely: bool, found: &mut Vec<(Id, Outcome)>) -> Result<bool> {
        if mutants.is_empty() {
            return Ok(false);
        }
        if mutants.len() == 1 || !surely {
            let outcome = match self.run_with(mutants)? {
                Ended::Passed => return Ok(false),
                Ended::Failed => Outcome::Found,
                Ended::Hung => Outcome::Hung,
            };
            if let [one] = mutants {
                found.push((*one, outcome));
                return Ok(true);
            }
        }
        let (first, second) = mutants.split_at(mutants.len() / 2);
        let in_first = self.find_among(first, false, found)?;
        self.find_among(second, !in_first, found)?;
        Ok(true)
    }

    fn run_with(&self, mutants: &[Id]) -> Result<Ended> {
        let reached = |test: &&&Test| mutants.iter().any(|id| test.reaches.contains(id));
        let tests: Vec<&&Test> = self.tests.iter().filter(reached).collect();
        let names: Vec<&str> = tests.iter().map(|test| test.name.as_str()).collect();
        let expected: f64 = tests.iter().map(|test| test.seconds).sum();
        let ids = mutants.iter().map(usize::to_string).collect::<Vec<_>>().join(" ");
        let patience = Duration::from_secs_f64(5.0 + 10.0 * expected);
        run(&self.tests[0].program, &self.tests[0].folder, &names, ("MUTANTS", &ids), patience)
    }
}
