//! Every path to an answer against every other on the campaign's pairs, boundary-directed ones included: the fast oracle,
//! the plain one in each backend, and the stepper with a scalar of several hundred bits.
//!
//! Caught so far: nothing in the oracle; it is here so that it stays that way. The large run takes
//! `ROCKPROOF_AGREEMENT_BATCHES` batches of sixteen pairs of `ROCKPROOF_AGREEMENT_SEED`; on one in `ROCKPROOF_AGREEMENT_PURE` of them the pure Rust
//! rationals join in, which take some fifty milliseconds a pair, ten times as long as GMP. With a file named by
//! `ROCKPROOF_AGREEMENT_PARTS` it can be done in pieces: what is done is written there, and a run that is killed, or ends
//! after `ROCKPROOF_AGREEMENT_SECONDS`, is gone on with by the same command. `ROCKPROOF_AGREEMENT_THREADS` is 1 for each core.

use rockproof_campaign::pairs::{PairConfig, batch};
use rockproof_model::{Block, Contact, Precision, ToleranceSet};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{LevelCounts, Pair, PreparedBlock, plain};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::{settled_contacts, wide_contacts};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::sync::Mutex;
use std::thread::available_parallelism;
use std::time::Instant;

#[derive(Default)]
struct Tally {
    pairs: u64,
    with_contacts: u64,
    at_ties: u64,
    pure: u64,
    gmp: u64,
    levels: LevelCounts,
}

impl Tally {
    /// Pairs, those with contacts, at ties, in pure Rust rationals, in GMP, and the signs by level.
    fn figures(&self) -> [u64; 12] {
        let mut figures = [self.pairs, self.with_contacts, self.at_ties, self.pure, self.gmp, 0, 0, 0, 0, 0, 0, 0];
        for (figure, (_, count)) in figures[5..].iter_mut().zip(self.levels.by_name()) {
            *figure = count;
        }
        figures
    }
}

fn compare_batch(seed: u64, number: u64, config: &PairConfig, pure: bool, tally: &mut Tally) {
    for case in batch(seed, number, config) {
        let name = format!("seed {seed}, pair {}, {} {}", case.index, case.family, case.form.name());
        let set = &case.sets[case.index as usize % case.sets.len()];
        compare(&case.a, &case.b, &set.f64, &name, pure, tally);
        // Every eighth as an f32 engine sees it, where coordinates collide and faces bend.
        if case.index % 8 == 3
            && let (Some(a), Some(b), Ok(t)) =
                (case.a.rounded(Precision::F32), case.b.rounded(Precision::F32), set.f32.rounded(Precision::F32))
        {
            compare(&a, &b, &t, &format!("{name} in f32"), pure, tally);
        }
    }
}

fn plain_contacts<Q: Rational>(a: &Block, b: &Block, t: &ToleranceSet) -> Vec<Contact> {
    plain::classify::<Q>(a, b, t).into_iter().map(|found| found.contact).collect()
}

fn compare(a: &Block, b: &Block, t: &ToleranceSet, name: &str, pure: bool, tally: &mut Tally) {
    // A block that rounding collapsed is no block; campaigns report it as such.
    let Ok((wide, unsettled)) = wide_contacts::<SpecRules>(a, b, t) else { return };
    let settled = settled_contacts::<SpecRules>(a, b, t).expect("a block that did not collapse before");
    assert_eq!(
        settled,
        (unsettled == 0).then(|| wide.clone()),
        "{name}: settled contacts, sooner (left) and by counting"
    );
    let (solid_a, solid_b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let answer = Pair::new(&solid_a, &solid_b).classify(t);
    let fast = answer.contacts;
    if pure {
        tally.pure += 1;
        assert_eq!(fast, plain_contacts::<num_rational::BigRational>(a, b, t), "{name}: fast (left), plain (right)");
    }
    #[cfg(feature = "gmp")]
    {
        tally.gmp += 1;
        assert_eq!(fast, plain_contacts::<rug::Rational>(a, b, t), "{name}: fast (left), plain in GMP (right)");
    }
    assert_eq!(wide, fast, "{name}: wide stepper (left), oracle (right); {unsettled} comparisons at a tie");
    tally.pairs += 1;
    tally.with_contacts += u64::from(!fast.is_empty());
    tally.at_ties += u64::from(unsettled > 0);
    tally.levels += answer.levels;
}

fn report([pairs, with_contacts, at_ties, pure, gmp, levels @ ..]: &[u64; 12]) {
    println!("{pairs} pairs, {with_contacts} with contacts, {at_ties} at a tie of square roots");
    println!("  plain path in pure Rust rationals: {pure}, in GMP: {gmp}");
    for ((level, _), count) in LevelCounts::default().by_name().into_iter().zip(levels) {
        println!("  decided by {level}: {count}");
    }
}

#[test]
fn all_paths_agree() {
    agree(if cfg!(debug_assertions) { 2 } else { 6 });
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn all_paths_agree_at_full_size() {
    agree(24);
}

fn agree(batches: u64) {
    let config = PairConfig::default();
    let mut tally = Tally::default();
    for number in 0..batches {
        compare_batch(5, number * 7, &config, true, &mut tally);
    }
    report(&tally.figures());
    assert!(tally.with_contacts * 3 > tally.pairs, "most pairs of the campaign touch");
    assert!(tally.at_ties > 0 && tally.levels.i128 > 0, "ties are reached");
}

/// Batches in a part: what an interruption of the large run can lose, for each thread.
const PART: u64 = 50;

fn setting(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().map_or(otherwise, |n| n.parse().unwrap_or_else(|_| panic!("{name} is \"{n}\"")))
}

/// The parts of the large run that are done, in a file, one a line: first batch, then the figures of [`Tally::figures`].
/// The first line says what was compared, so that parts of different comparisons are never added up.
struct Parts {
    file: Option<File>,
    done: BTreeMap<u64, [u64; 12]>,
}

impl Parts {
    fn open(about: &str) -> Parts {
        let Ok(path) = std::env::var("ROCKPROOF_AGREEMENT_PARTS") else {
            return Parts { file: None, done: BTreeMap::new() };
        };
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let mut done = BTreeMap::new();
        // What is not a whole line was being written when the run was killed.
        let whole = text.rfind('\n').map_or("", |end| &text[..end]);
        for (number, line) in whole.lines().enumerate() {
            if number == 0 {
                assert_eq!(line, about, "{path} is about another comparison");
                continue;
            }
            let mut figures = line.split(' ').map(|n| n.parse::<u64>().unwrap_or_else(|_| panic!("{path}: {line}")));
            let first = figures.next().unwrap_or_else(|| panic!("{path}: {line}"));
            let figures: Vec<u64> = figures.collect();
            done.insert(first, figures.try_into().unwrap_or_else(|_| panic!("{path}: {line}")));
        }
        let kept = if whole.is_empty() { format!("{about}\n") } else { format!("{whole}\n") };
        std::fs::write(&path, kept).unwrap();
        Parts { file: Some(File::options().append(true).open(&path).unwrap()), done }
    }

    fn add(&mut self, first: u64, tally: &Tally) {
        let figures = tally.figures();
        if let Some(file) = &mut self.file {
            let line = figures.iter().fold(first.to_string(), |line, n| format!("{line} {n}"));
            file.write_all(format!("{line}\n").as_bytes()).unwrap();
        }
        self.done.insert(first, figures);
    }
}

/// What is compared: how many batches, how often by whom, and which pairs (FNV-1a of the coordinates of some).
fn identity(seed: u64, batches: u64, pure_every: u64, config: &PairConfig) -> String {
    let mut hash: u64 = 0xcbf2_9ce4_8422_2325;
    for number in 0..2 * config.families.len() as u64 {
        for case in batch(seed, number, config) {
            let text = format!("{:?} {:?} {:?}", case.a.vertices(), case.b.vertices(), case.sets);
            text.bytes().for_each(|b| hash = (hash ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        }
    }
    let gmp = if cfg!(feature = "gmp") { "with" } else { "without" };
    format!("{batches} batches of seed {seed}, pure Rust rationals on 1 in {pure_every}, {gmp} GMP, pairs {hash:016x}")
}

#[test]
#[ignore = "the large run: --release -- --ignored --nocapture"]
fn all_paths_agree_on_many_pairs() {
    let seed = setting("ROCKPROOF_AGREEMENT_SEED", 1);
    let batches = setting("ROCKPROOF_AGREEMENT_BATCHES", 6_300);
    let pure_every = setting("ROCKPROOF_AGREEMENT_PURE", 1).max(1);
    let seconds = setting("ROCKPROOF_AGREEMENT_SECONDS", u64::MAX);
    let threads = setting("ROCKPROOF_AGREEMENT_THREADS", available_parallelism().map_or(1, |n| n.get() as u64));
    let config = PairConfig::default();
    let families = config.families.len() as u64;
    let parts = Parts::open(&identity(seed, batches, pure_every, &config));
    let left: Vec<u64> = (0..batches).step_by(PART as usize).filter(|first| !parts.done.contains_key(first)).collect();
    println!("{} parts of {PART} batches are done, {} are left", parts.done.len(), left.len());
    let (queue, parts, begun) = (Mutex::new(left.iter()), Mutex::new(parts), Instant::now());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while begun.elapsed().as_secs() < seconds {
                    let Some(&first) = queue.lock().unwrap().next() else { break };
                    let mut tally = Tally::default();
                    for number in first..(first + PART).min(batches) {
                        // By rounds of all families, so that each of them has its share.
                        let pure = (number / families).is_multiple_of(pure_every);
                        compare_batch(seed, number, &config, pure, &mut tally);
                    }
                    parts.lock().unwrap().add(first, &tally);
                    println!("batches from {first}: {} pairs agree", tally.pairs);
                }
            });
        }
    });
    let parts = parts.into_inner().unwrap();
    println!("{} of {} parts", parts.done.len(), batches.div_ceil(PART));
    report(&parts.done.values().fold([0; 12], |sum, part| std::array::from_fn(|k| sum[k] + part[k])));
}
