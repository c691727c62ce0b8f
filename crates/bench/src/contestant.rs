//! What is timed: each way to classify a pair, with and without the preparation of its blocks.

use crate::sample::Ready;
use num_rational::BigRational;
use rockproof_model::Block;
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{self, Pair, plain};
use rockproof_stepper::Real;
use rockproof_stepper::contact::{Solid, Spec, Tolerances, classify};
use std::hint::black_box;

/// How much of the work is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Classification alone, of blocks made ready before.
    Prepared,
    /// Making both blocks ready, then classification.
    Whole,
    /// Making both blocks ready, no more.
    Preparation,
}

impl Mode {
    /// `classify`, `prepare+classify` or `prepare`.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Prepared => "classify",
            Mode::Whole => "prepare+classify",
            Mode::Preparation => "prepare",
        }
    }
}

/// One way to do one part of the work.
#[derive(Clone, Copy, Debug)]
pub struct Contestant {
    /// `f32`, `f64`, `certified`, `plain num-rational` or `plain rug`.
    pub engine: &'static str,
    /// How much of the work.
    pub mode: Mode,
    /// Whether it is so slow that it gets a part of the pairs and of the rounds.
    pub slow: bool,
    /// Whether its contacts must be those of every other exact contestant.
    pub exact: bool,
    /// Does the work and says how many contacts there are; 0 if the work is not to find them.
    pub run: fn(&Ready) -> usize,
}

/// The contestant that times are compared with.
pub const FLOAT: &str = "f64";

/// The oracle's fast path.
pub const CERTIFIED: &str = "certified";

/// Every contestant; with the feature `gmp`, plain rationals of GMP as well.
pub fn contestants() -> Vec<Contestant> {
    let fast = |engine, mode, run| Contestant { engine, mode, slow: false, exact: engine == CERTIFIED, run };
    let slow = |engine, run| Contestant { engine, mode: Mode::Whole, slow: true, exact: true, run };
    let mut all: Vec<Contestant> = vec![
        fast("f32", Mode::Prepared, |pair| stepper(&pair.f32)),
        fast(FLOAT, Mode::Prepared, |pair| stepper(&pair.f64)),
        fast(CERTIFIED, Mode::Prepared, |pair| certified(&pair.exact, pair)),
        fast("f32", Mode::Whole, |pair| from_blocks::<f32>(pair).map_or(0, |ready| stepper(&ready))),
        fast(FLOAT, Mode::Whole, |pair| from_blocks::<f64>(pair).map_or(0, |ready| stepper(&ready))),
        fast(CERTIFIED, Mode::Whole, |pair| certified(&solids(pair), pair)),
        fast("f32", Mode::Preparation, |pair| usize::from(black_box(from_blocks::<f32>(pair)).is_none())),
        fast(FLOAT, Mode::Preparation, |pair| usize::from(black_box(from_blocks::<f64>(pair)).is_none())),
        fast(CERTIFIED, Mode::Preparation, |pair| {
            usize::from(black_box(solids(pair))[0].block().vertices().is_empty())
        }),
        slow("plain num-rational", plainly::<BigRational>),
    ];
    #[cfg(feature = "gmp")]
    all.push(slow("plain rug", plainly::<rug::Rational>));
    all.shrink_to_fit();
    all
}

type InStepper<R> = ([Solid<R>; 2], Tolerances<R>);

fn stepper<R: Real>(([a, b], tolerances): &InStepper<R>) -> usize {
    black_box(classify::<R, Spec>(a, b, tolerances)).len()
}

fn from_blocks<R: Real>(pair: &Ready) -> Option<InStepper<R>> {
    let set = if size_of::<R>() == size_of::<f32>() { &pair.tolerances_f32 } else { &pair.tolerances };
    let solid = |block: &Block| Solid::new(block).ok();
    Some(([solid(&pair.a)?, solid(&pair.b)?], Tolerances::new(set).ok()?))
}

fn solids(pair: &Ready) -> [rockproof_oracle::Solid; 2] {
    [rockproof_oracle::Solid::new(&pair.a), rockproof_oracle::Solid::new(&pair.b)]
}

fn certified([a, b]: &[rockproof_oracle::Solid; 2], pair: &Ready) -> usize {
    black_box(Pair::new(a, b).classify(&pair.tolerances)).contacts.len()
}

fn plainly<Q: Rational>(pair: &Ready) -> usize {
    black_box(plain::classify::<Q>(&pair.a, &pair.b, &pair.tolerances)).len()
}
