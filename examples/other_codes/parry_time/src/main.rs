//! The contacts of two blocks that have hardly moved since the last time: how long parry3d-f64 and Rockproof's stepper in f64 take, in turn and in one run.
//!
//!     cargo run --release --manifest-path examples/other_codes/parry_time/Cargo.toml -- cases/benchmark/pairs.jsonl
//!
//! Taken are the pairs of convex blocks in the benchmark set (docs/benchmark_set.md) whose contacts, as each of the two sees them, stay the same when B
//! moves. parry is asked for contact manifolds, `contact_manifold_convex_convex`, within the search distance of the pair's tolerances, of shapes that were
//! made before: *cold* with an empty manifold each time, *warm* with the manifold of the time before.

mod pairs;

use pairs::{PLACES, TimedPair};
use std::process::ExitCode;
use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

/// So many pairs are timed at once.
const CHUNK: usize = 16;
/// Each chunk is timed so often by every code in turn; the median counts.
const ROUNDS: usize = 31;

/// What is timed: a name, and the contacts or points that it finds of a pair at one of its places.
type Entry = (&'static str, fn(&mut TimedPair, usize) -> usize);

const ENTRIES: [Entry; 5] = [
    ("parry3d-f64, cold manifold", TimedPair::cold_manifold),
    ("parry3d-f64, warm manifold", TimedPair::warm_manifold),
    ("stepper-f64, all features", TimedPair::all_features),
    ("stepper-f64, known features", TimedPair::known_features),
    ("the same with preparation of B", TimedPair::prepared_again),
];

/// Microseconds a pair of each entry.
fn time(pairs: &mut [TimedPair]) -> [f64; ENTRIES.len()] {
    let mut total = [0.0; ENTRIES.len()];
    for chunk in pairs.chunks_mut(CHUNK) {
        let mut rounds = [const { Vec::new() }; ENTRIES.len()];
        for round in 0..ROUNDS {
            for ((_, run), times) in ENTRIES.iter().zip(&mut rounds) {
                // What the other entries pushed out of the caches comes back, and the manifold is that of the place before.
                for at in [round, round + 1] {
                    let begin = Instant::now();
                    for pair in &mut *chunk {
                        std::hint::black_box(run(pair, at % PLACES));
                    }
                    if at == round + 1 {
                        times.push(begin.elapsed().as_secs_f64() * 1e6);
                    }
                }
            }
        }
        for (sum, mut times) in total.iter_mut().zip(rounds) {
            times.sort_by(f64::total_cmp);
            *sum += times[times.len() / 2];
        }
    }
    total.map(|sum| sum / pairs.len() as f64)
}

fn run() -> Result<(), Failure> {
    let path = std::env::args().nth(1).ok_or("usage: rockproof-parry-time cases/benchmark/pairs.jsonl")?;
    let text = std::fs::read_to_string(&path).map_err(|error| format!("{path}: {error}"))?;
    let mut all = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let pair = TimedPair::read(line).map_err(|error| format!("{path}:{}: {error}", number + 1))?;
        all.extend(pair);
    }
    let (mut near, mut apart): (Vec<_>, Vec<_>) = all.into_iter().partition(TimedPair::has_contacts);
    println!("| microseconds a pair | {} pairs with contacts of both | {} others |", near.len(), apart.len());
    println!("| --- | ---: | ---: |");
    let [near_times, apart_times] = [time(&mut near), time(&mut apart)];
    for (((name, _), near), apart) in ENTRIES.iter().zip(near_times).zip(apart_times) {
        println!("| {name} | {near:.2} | {apart:.2} |");
    }
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
