//! Steps one after the other, on several threads, until the time is over.

use crate::attacks::Attack;
use crate::clock::build_clock;
use crate::counts::{Counts, Total};
use crate::inputs::{keep_panics, last_panic};
use crate::program::{Program, Told, peak_memory};
use clap::Parser;
use rockproof_fuzz::Dice;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Attack the built program, and count what was tried.
#[derive(Parser)]
struct Arguments {
    /// How long, in minutes
    #[arg(long, default_value_t = 2.0)]
    minutes: f64,
    /// Chooses the attacks
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Do one step alone, that of this number
    #[arg(long)]
    step: Option<u64>,
    /// Attacks at the same time
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

/// How often the counts are shown.
const SHOWN_EVERY: Duration = Duration::from_secs(60);
/// Failures after which nothing more is tried.
const MAX_FAILURES: u64 = 10;
/// A step that takes longer than this has met a reader that does not end.
const LONGEST_STEP: Duration = Duration::from_secs(900);

type StepOf = fn(&mut Attack) -> Told<()>;

/// The attacks, each with its share of a hundred.
const ATTACKS: [(&str, usize, StepOf); 11] = [
    ("kills", 22, Attack::kills),
    ("clock", 4, Attack::clock),
    ("interruptions", 8, Attack::interruptions),
    ("limited files", 7, Attack::limited_files),
    ("full disk", 8, Attack::full_disk),
    ("read-only directory", 4, Attack::read_only),
    ("environment", 5, Attack::environment),
    ("damage", 16, Attack::damage),
    ("faulty engine", 5, Attack::faulty_engine),
    ("inputs to the program", 9, Attack::program_inputs),
    ("inputs to readers", 12, Attack::reader_inputs),
];

pub(crate) fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // For what is built for the soak alone. Disks in memory often let no library be loaded.
    let built = tempfile::tempdir().map_err(|error| format!("no folder for temporary files: {error}"));
    match built.as_ref().map_err(String::clone).and_then(|folder| program(folder.path())) {
        Ok(program) => soak(&arguments, &program),
        Err(what) => {
            eprintln!("error: {what}");
            ExitCode::from(2)
        }
    }
}

/// The program that ROCKPROOF names, or the one that is built now; with it the example engine, and in a folder the library that shifts the clock.
fn program(folder_of_clock: &Path) -> Told<Program> {
    let here = std::env::current_exe().map_err(|error| error.to_string())?;
    let examples = here.parent().unwrap_or(Path::new("."));
    let folder = examples.parent().unwrap_or(Path::new("."));
    let path = std::env::var_os("ROCKPROOF").map(PathBuf::from);
    let engine_client = examples.join("engine_client");
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["build", "--quiet", "--example", "engine_client"]).current_dir(env!("CARGO_MANIFEST_DIR"));
    if path.is_none() {
        cargo.args(["--bin", "rockproof"]);
    }
    if folder.ends_with("release") {
        cargo.arg("--release");
    }
    let is_built = path.is_some() && engine_client.exists();
    if !is_built && !cargo.status().is_ok_and(|status| status.success()) {
        return Err("the program cannot be built".to_owned());
    }
    let path = path.unwrap_or_else(|| folder.join("rockproof"));
    let path = path.canonicalize().map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(Program { path, engine_client, clock: build_clock(folder_of_clock)? })
}

fn soak(arguments: &Arguments, program: &Program) -> ExitCode {
    keep_panics();
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    // Without a handler Ctrl-C ends the soak at once, and nothing is counted.
    drop(ctrlc::set_handler(move || flag.store(true, Ordering::SeqCst)));
    let (total, next, begin) = (Total::default(), AtomicU64::new(0), Instant::now());
    total.add(&clock_is_seen(program));
    let end = Duration::from_secs_f64(arguments.minutes.clamp(0.0, 1e6) * 60.0);
    let done = AtomicU64::new(0);
    let threads = if arguments.step.is_some() { 1 } else { arguments.threads.clamp(1, 64) as u64 };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while begin.elapsed() < end && !stop.load(Ordering::SeqCst) && total.now().failures < MAX_FAILURES {
                    let number = arguments.step.unwrap_or_else(|| next.fetch_add(1, Ordering::Relaxed));
                    let overdue = Overdue::watch(arguments.seed, number);
                    total.add(&step(program, arguments.seed, number));
                    drop(overdue);
                    if arguments.step.is_some() {
                        break;
                    }
                }
                done.fetch_add(1, Ordering::SeqCst);
            });
        }
        let mut shown = Instant::now();
        while done.load(Ordering::SeqCst) < threads {
            std::thread::sleep(Duration::from_millis(50));
            if shown.elapsed() > SHOWN_EVERY {
                shown = Instant::now();
                eprintln!("{:.0} min: {}", begin.elapsed().as_secs_f64() / 60.0, total.now());
            }
        }
    });
    let mut counts = total.now();
    counts.memory = counts.memory.max(peak_memory(Path::new("/proc/self")));
    println!("seed {}, {:.1} min, {counts}", arguments.seed, begin.elapsed().as_secs_f64() / 60.0);
    if counts.failures == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Shows that a shifted clock reaches the program: without that, what is done with clocks shows nothing.
fn clock_is_seen(program: &Program) -> Counts {
    let mut at = Attack::new(program, Dice::new(0));
    if let Err(what) = at.clock_is_seen() {
        at.counts.failures += 1;
        println!("FAILED: the shifted clock does not reach the program: {what}");
    }
    at.counts
}

/// Does the step of a number, and tells what went wrong.
fn step(program: &Program, seed: u64, number: u64) -> Counts {
    let mut dice = Dice::new(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95));
    let mut place = dice.below(ATTACKS.iter().map(|(_, share, _)| share).sum());
    let chosen = ATTACKS.iter().find(|(_, share, _)| {
        let is_here = place < *share;
        place = place.saturating_sub(*share);
        is_here
    });
    let (name, _, attack) = chosen.unwrap_or(&ATTACKS[0]);
    let mut at = Attack::new(program, dice);
    // Whatever panics in this process ends the step, not the thread that takes the next.
    let outcome = catch_unwind(AssertUnwindSafe(|| attack(&mut at)))
        .unwrap_or_else(|_| Err(format!("a panic in the soak's own process: {}", last_panic())));
    at.counts.steps += 1;
    if let Err(what) = outcome {
        at.counts.failures += 1;
        println!("FAILED: {name}: {what}");
        println!("  again: cargo run --release --example soak -- --seed {seed} --step {number}");
    }
    at.counts
}

/// Ends the whole soak when a step in this process does not end.
struct Overdue(Arc<AtomicBool>);

impl Overdue {
    fn watch(seed: u64, number: u64) -> Overdue {
        let ended = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&ended);
        std::thread::spawn(move || {
            let begin = Instant::now();
            while !flag.load(Ordering::SeqCst) {
                if begin.elapsed() > LONGEST_STEP {
                    println!("FAILED: step {number} of seed {seed} does not end");
                    std::process::exit(1);
                }
                std::thread::sleep(Duration::from_millis(200));
            }
        });
        Overdue(ended)
    }
}

impl Drop for Overdue {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}
