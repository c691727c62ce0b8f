//! What is timed: each way to classify a pair, with and without the preparation of its blocks.

use crate::sample::PreparedPair;
use num_rational::BigRational;
use rockproof_model::Block;
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{self, Pair, plain};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{ClassificationRequest, ContactRules, PreparedBlock, SpecRules, Tolerances, classify};
use std::hint::black_box;

/// How much of the work is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimedPart {
    /// Classification alone, of blocks made ready before.
    Prepared,
    /// Making both blocks ready, then classification.
    Whole,
    /// Making both blocks ready, no more.
    Preparation,
}

impl TimedPart {
    /// `classify`, `prepare+classify` or `prepare`.
    pub fn name(self) -> &'static str {
        match self {
            TimedPart::Prepared => "classify",
            TimedPart::Whole => "prepare+classify",
            TimedPart::Preparation => "prepare",
        }
    }
}

/// One way to do one part of the work.
#[derive(Clone, Copy, Debug)]
pub struct BenchEntry {
    /// `f32`, `f64`, `f64 nearby`, `certified`, `certified nearby`, `plain num-rational` or `plain rug`.
    pub engine: &'static str,
    /// How much of the work.
    pub mode: TimedPart,
    /// Whether it is so slow that it gets a part of the pairs and of the rounds.
    pub slow: bool,
    /// Whether its contacts must be those of every other exact entry.
    pub exact: bool,
    /// Does the work and says how many contacts there are; 0 if the work is not to find them.
    pub run: fn(&PreparedPair) -> usize,
}

/// The entry that times are compared with.
pub const FLOAT: &str = "f64";

/// The same of blocks that have hardly moved since the pairs of features to look at were found.
pub const NEARBY: &str = "f64 nearby";

/// The oracle's fast path.
pub const CERTIFIED: &str = "certified";

/// The same of blocks that have hardly moved since the pairs of features to look at were found; compared with [`NEARBY`].
pub const CERTIFIED_NEARBY: &str = "certified nearby";

/// Every entry; with the feature `gmp`, plain rationals of GMP as well.
pub fn bench_entries() -> Vec<BenchEntry> {
    let fast = |engine, mode, run| BenchEntry {
        engine,
        mode,
        slow: false,
        exact: engine == CERTIFIED || engine == CERTIFIED_NEARBY,
        run,
    };
    let slow = |engine, run| BenchEntry { engine, mode: TimedPart::Whole, slow: true, exact: true, run };
    let mut all: Vec<BenchEntry> = vec![
        fast("f32", TimedPart::Prepared, |pair| stepper(&pair.f32)),
        fast(FLOAT, TimedPart::Prepared, |pair| stepper(&pair.f64)),
        fast(NEARBY, TimedPart::Prepared, |pair| nearby(&pair.f64, pair)),
        fast(CERTIFIED, TimedPart::Prepared, |pair| certified(&pair.exact, pair)),
        fast(CERTIFIED_NEARBY, TimedPart::Prepared, |pair| certified_nearby(&pair.exact, pair)),
        fast("f32", TimedPart::Whole, |pair| from_blocks::<f32>(pair).map_or(0, |ready| stepper(&ready))),
        fast(FLOAT, TimedPart::Whole, |pair| from_blocks::<f64>(pair).map_or(0, |ready| stepper(&ready))),
        fast(NEARBY, TimedPart::Whole, |pair| from_blocks::<f64>(pair).map_or(0, |ready| nearby(&ready, pair))),
        fast(CERTIFIED, TimedPart::Whole, |pair| certified(&prepared(pair), pair)),
        fast(CERTIFIED_NEARBY, TimedPart::Whole, |pair| certified_nearby(&prepared(pair), pair)),
        fast("f32", TimedPart::Preparation, |pair| usize::from(black_box(from_blocks::<f32>(pair)).is_none())),
        fast(FLOAT, TimedPart::Preparation, |pair| usize::from(black_box(from_blocks::<f64>(pair)).is_none())),
        fast(CERTIFIED, TimedPart::Preparation, |pair| {
            usize::from(black_box(prepared(pair))[0].block().vertices().is_empty())
        }),
        slow("plain num-rational", plainly::<BigRational>),
    ];
    #[cfg(feature = "gmp")]
    all.push(slow("plain rug", plainly::<rug::Rational>));
    all.shrink_to_fit();
    all
}

type FloatPair<R> = ([PreparedBlock<R>; 2], Tolerances<R>);

fn stepper<R: Real>(([a, b], tolerances): &FloatPair<R>) -> usize {
    black_box(classify::<R, SpecRules>(a, b, tolerances)).len()
}

fn nearby(([a, b], tolerances): &FloatPair<f64>, pair: &PreparedPair) -> usize {
    let request = ClassificationRequest { a, b, tolerances, kept: &[], among: pair.nearby.as_ref() };
    black_box(SpecRules::contacts(request)).len()
}

fn from_blocks<R: Real>(pair: &PreparedPair) -> Option<FloatPair<R>> {
    let set = if size_of::<R>() == size_of::<f32>() { &pair.tolerances_f32 } else { &pair.tolerances };
    let prepare = |block: &Block| PreparedBlock::new(block).ok();
    Some(([prepare(&pair.a)?, prepare(&pair.b)?], Tolerances::new(set).ok()?))
}

fn prepared(pair: &PreparedPair) -> [rockproof_oracle::PreparedBlock; 2] {
    [rockproof_oracle::PreparedBlock::new(&pair.a), rockproof_oracle::PreparedBlock::new(&pair.b)]
}

fn certified([a, b]: &[rockproof_oracle::PreparedBlock; 2], pair: &PreparedPair) -> usize {
    black_box(Pair::new(a, b).classify(&pair.tolerances)).contacts.len()
}

fn certified_nearby([a, b]: &[rockproof_oracle::PreparedBlock; 2], pair: &PreparedPair) -> usize {
    let (blocks, tolerances) = (Pair::new(a, b), &pair.tolerances);
    let answer = match &pair.exact_nearby {
        Some(nearby) => blocks.classify_nearby(tolerances, nearby, &[]),
        None => blocks.classify(tolerances),
    };
    black_box(answer).contacts.len()
}

fn plainly<Q: Rational>(pair: &PreparedPair) -> usize {
    black_box(plain::classify::<Q>(&pair.a, &pair.b, &pair.tolerances)).len()
}
