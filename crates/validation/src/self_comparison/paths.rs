//! The paths to an answer. A test replaces one of them by a mistaken one, to see that it is found.

use rockproof_model::{Block, Contact, ToleranceSet};
use rockproof_oracle::rational::Rational;
use rockproof_oracle::{LevelCounts, Pair, PreparedBlock, plain};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::engine::{EngineError, settled_contacts, wide_contacts};
use std::marker::PhantomData;

/// What every path is asked.
#[derive(Clone, Copy, Debug)]
pub struct Question<'q> {
    /// The first block.
    pub a: &'q Block,
    /// The second block.
    pub b: &'q Block,
    /// The tolerances.
    pub tolerances: &'q ToleranceSet,
}

/// A path, or a way to ask it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PathName {
    /// The oracle's fast path, which all others are held against.
    Fast,
    /// The stepper in 512 bits.
    Wide,
    /// The same, where it says whether every comparison is settled without counting them.
    Settled,
    /// The oracle's plain path in pure Rust rationals.
    Plain,
    /// The same in GMP's rationals.
    Gmp,
}

impl PathName {
    /// The name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            PathName::Fast => "fast",
            PathName::Wide => "wide",
            PathName::Settled => "settled",
            PathName::Plain => "plain",
            PathName::Gmp => "gmp",
        }
    }
}

/// The paths as they are; whoever implements this puts another in the place of one.
pub trait Paths: Sync {
    /// The oracle's fast path, and the signs that each of its levels decided.
    fn fast(&self, asked: Question<'_>) -> (Vec<Contact>, LevelCounts) {
        let (a, b) = (PreparedBlock::new(asked.a), PreparedBlock::new(asked.b));
        let answer = Pair::new(&a, &b).classify(asked.tolerances);
        (answer.contacts, answer.levels)
    }

    /// The stepper in 512 bits, and how many of its comparisons rounding left unsettled.
    ///
    /// # Errors
    /// When the blocks are none that a stepper can take.
    fn wide(&self, asked: Question<'_>) -> Result<(Vec<Contact>, u64), EngineError> {
        wide_contacts::<SpecRules>(asked.a, asked.b, asked.tolerances)
    }

    /// The stepper in 512 bits where every comparison is settled; `None` where one is not.
    ///
    /// # Errors
    /// As [`Paths::wide`].
    fn settled(&self, asked: Question<'_>) -> Result<Option<Vec<Contact>>, EngineError> {
        settled_contacts::<SpecRules>(asked.a, asked.b, asked.tolerances)
    }

    /// The oracle's plain path in pure Rust rationals.
    fn plain(&self, asked: Question<'_>) -> Vec<Contact> {
        plain_contacts::<num_rational::BigRational>(asked)
    }

    /// The same in GMP's rationals; `None` in a program that was built without.
    fn gmp(&self, _asked: Question<'_>) -> Option<Vec<Contact>> {
        None
    }
}

/// The paths of any build.
#[derive(Clone, Copy, Debug, Default)]
pub struct BuiltIn;

impl Paths for BuiltIn {}

/// The same with the plain path in the rationals `Q` for those of GMP, which only some builds have.
#[derive(Clone, Copy, Debug)]
pub struct WithGmp<Q>(PhantomData<fn() -> Q>);

impl<Q> WithGmp<Q> {
    /// The paths.
    #[must_use]
    pub const fn new() -> Self {
        WithGmp(PhantomData)
    }
}

impl<Q> Default for WithGmp<Q> {
    fn default() -> Self {
        WithGmp::new()
    }
}

impl<Q: Rational> Paths for WithGmp<Q> {
    fn gmp(&self, asked: Question<'_>) -> Option<Vec<Contact>> {
        Some(plain_contacts::<Q>(asked))
    }
}

fn plain_contacts<Q: Rational>(asked: Question<'_>) -> Vec<Contact> {
    let found = plain::classify::<Q>(asked.a, asked.b, asked.tolerances);
    found.into_iter().map(|found| found.contact).collect()
}
