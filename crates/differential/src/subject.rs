//! What a campaign looks at: pairs of blocks, each with the tolerance sets it is examined under.

use crate::motion::PairMotion;
use rockproof_model::{Block, Precision, ToleranceSet};
use std::sync::Arc;

/// One pair of a campaign.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its number in the campaign.
    pub index: u64,
    /// The family that made it.
    pub family: Arc<str>,
    /// How it was made: `base`, `moved`, `ladder`, or the boundary it was directed at.
    pub form: Arc<str>,
    /// The first block, exact.
    pub a: Block,
    /// The second block, exact.
    pub b: Block,
    /// The tolerance sets to examine it under.
    pub sets: Vec<NamedSet>,
}

/// A named tolerance set; its numbers may depend on the precision of the engine it is for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedSet {
    /// Of a campaign's the source's name, after a colon the tolerance that a ladder has changed: `auto`, `auto:territory`.
    pub name: Arc<str>,
    /// The set for f32 engines, exact.
    pub f32: ToleranceSet,
    /// The set for f64 engines, exact.
    pub f64: ToleranceSet,
}

impl NamedSet {
    /// The same set for every engine.
    pub fn same(name: impl Into<Arc<str>>, set: &ToleranceSet) -> NamedSet {
        NamedSet { name: name.into(), f32: set.clone(), f64: set.clone() }
    }

    /// The set for engines of the given precision.
    pub fn of(&self, precision: Precision) -> &ToleranceSet {
        match precision {
            Precision::F32 => &self.f32,
            Precision::F64 => &self.f64,
        }
    }
}

/// Where pairs come from: a function of the batch number alone, so that any thread can make any batch.
pub trait PairSource: Sync {
    /// Pairs a batch holds; pair `i` is in batch `i / batch_len`.
    fn batch_len(&self) -> u64;

    /// The pairs of one batch, in the order of their indices.
    fn batch(&self, number: u64) -> Vec<Subject>;

    /// How a pair moves, for those of the source that do: a function of the pair alone.
    fn motion(&self, _subject: &Subject) -> Option<PairMotion> {
        None
    }

    /// Pairs beside those of a batch that make steps and are not classified. Each has the index of a pair of the batch, and a family
    /// that no pair of the batch has.
    fn step_pairs(&self, _number: u64) -> Vec<(Subject, PairMotion)> {
        Vec::new()
    }

    /// The pair of an index and a family, and how it moves, if it does.
    fn moving(&self, index: u64, family: &str) -> Option<(Subject, PairMotion)> {
        let number = index / self.batch_len();
        let same = |subject: &Subject| subject.index == index && &*subject.family == family;
        let beside = self.step_pairs(number).into_iter().find(|(subject, _)| same(subject));
        beside.or_else(|| {
            let subject = self.batch(number).into_iter().find(same)?;
            let motion = self.motion(&subject)?;
            Some((subject, motion))
        })
    }
}
