//! Every path to an answer against every other on the campaign's pairs, boundary-directed ones included: the fast oracle,
//! the plain one in each backend, and the stepper with a scalar of several hundred bits.
//!
//! Caught so far: nothing in the oracle; it is here so that it stays that way. `ROCKPROOF_AGREEMENT_BATCHES` sets how
//! many batches of sixteen pairs the large run takes, `ROCKPROOF_AGREEMENT_PURE` on which share of them (1 in so many) the
//! pure Rust rationals join in: they take some fifty milliseconds a pair, ten times as long as GMP.

use rockproof::campaign::pairs::{PairConfig, batch};
use rockproof::model::{Block, Contact, Precision, ToleranceSet};
use rockproof::oracle::rational::Rational;
use rockproof::oracle::{LevelCounts, Pair, Solid, plain};
use rockproof::stepper::contact::Spec;
use rockproof::stepper::wide;

#[derive(Default)]
struct Tally {
    pairs: u64,
    with_contacts: u64,
    at_ties: u64,
    pure: u64,
    levels: LevelCounts,
}

impl Tally {
    fn add(&mut self, other: &Tally) {
        self.pairs += other.pairs;
        self.with_contacts += other.with_contacts;
        self.at_ties += other.at_ties;
        self.pure += other.pure;
        self.levels += other.levels;
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
    let Ok((wide, unsettled)) = wide::classify::<Spec>(a, b, t) else { return };
    let (solid_a, solid_b) = (Solid::new(a), Solid::new(b));
    let answer = Pair::new(&solid_a, &solid_b).classify(t);
    let fast = answer.contacts;
    if pure {
        tally.pure += 1;
        assert_eq!(fast, plain_contacts::<num_rational::BigRational>(a, b, t), "{name}: fast (left), plain (right)");
    }
    #[cfg(feature = "gmp")]
    assert_eq!(fast, plain_contacts::<rug::Rational>(a, b, t), "{name}: fast (left), plain in GMP (right)");
    assert_eq!(wide, fast, "{name}: wide stepper (left), oracle (right); {unsettled} comparisons at a tie");
    tally.pairs += 1;
    tally.with_contacts += u64::from(!fast.is_empty());
    tally.at_ties += u64::from(unsettled > 0);
    tally.levels += answer.levels;
}

fn report(tally: &Tally) {
    println!(
        "{} pairs, {} with contacts, {} at a tie of square roots",
        tally.pairs, tally.with_contacts, tally.at_ties
    );
    println!("  {} of them also in pure Rust rationals", tally.pure);
    for (level, count) in tally.levels.by_name() {
        println!("  decided by {level}: {count}");
    }
}

#[test]
fn all_paths_agree() {
    let config = PairConfig::default();
    let mut tally = Tally::default();
    let batches = if cfg!(debug_assertions) { 2 } else { 24 };
    for number in 0..batches {
        compare_batch(5, number * 7, &config, true, &mut tally);
    }
    report(&tally);
    assert!(tally.with_contacts * 3 > tally.pairs, "most pairs of the campaign touch");
    assert!(tally.at_ties > 0 && tally.levels.i128 > 0, "ties are reached");
}

#[test]
#[ignore = "the large run: --release -- --ignored --nocapture"]
fn all_paths_agree_on_many_pairs() {
    let setting = |name, otherwise| std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise);
    let batches: u64 = setting("ROCKPROOF_AGREEMENT_BATCHES", 6_300);
    let pure_every: u64 = setting("ROCKPROOF_AGREEMENT_PURE", 1);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
    let mut total = Tally::default();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|thread| {
                scope.spawn(move || {
                    let config = PairConfig::default();
                    let mut tally = Tally::default();
                    for number in (thread..batches).step_by(threads as usize) {
                        compare_batch(1, number, &config, (number / threads).is_multiple_of(pure_every), &mut tally);
                        if number % 100 == 0 {
                            println!("batch {number} of {batches}");
                        }
                    }
                    tally
                })
            })
            .collect();
        for worker in workers {
            match worker.join() {
                Ok(tally) => total.add(&tally),
                Err(failure) => std::panic::resume_unwind(failure),
            }
        }
    });
    report(&total);
}
