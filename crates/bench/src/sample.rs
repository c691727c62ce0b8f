//! The pairs that are timed.

use rockproof_campaign::source::{self, SourceError};
use rockproof_differential::subject::NamedSet;
use rockproof_model::{Block, ToleranceSet};
use rockproof_oracle::{self, LevelCounts, Pair};
use rockproof_pairs::batch::{self, PairCase, PairConfig, PairForm};
use rockproof_pairs::generic::Generic;
use rockproof_stepper::contact::{ClassificationRequest, NearbyFeatures, PreparedBlock, Tolerances};
use rockproof_stepper::dynamics::skin;
use std::sync::Arc;

rockproof_model::named_enum! {
    /// Which pairs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SampleKind {
        /// The pairs of [`Generic`], as generated and moved at random.
        Generic = "generic",
        /// Pairs that the campaign moved, or whose tolerances it chose, to be at or near the boundary of a decision.
        Directed = "directed",
    }
}

impl SampleKind {
    /// What the campaign's generator is told in order to make such pairs, under the sets of a default campaign.
    ///
    /// # Errors
    /// When a default set does not exist.
    pub fn config(self) -> Result<PairConfig, SourceError> {
        let sets = rockproof_pairs::tolerance_sets::NAMES
            .into_iter()
            .map(source::set_source)
            .collect::<Result<Vec<_>, _>>()?;
        let sets_per_batch = sets.len().min(3);
        let config = PairConfig { sets, sets_per_batch, ..PairConfig::default() };
        Ok(match self {
            SampleKind::Generic => PairConfig {
                families: vec![Arc::new(Generic::default())],
                directed_percent: 0,
                ladder_percent: 0,
                // These have their last bits moved already; shaking would make their coordinates longer than f64 holds.
                perturbed_percent: 0,
                ..config
            },
            // Onto the boundary itself as well as beside it.
            SampleKind::Directed => {
                PairConfig { directed_percent: 67, ladder_percent: 33, perturbed_percent: 0, ..config }
            }
        })
    }

    fn takes(self, form: &PairForm) -> bool {
        match self {
            SampleKind::Generic => matches!(form, PairForm::Base | PairForm::Moved),
            SampleKind::Directed => matches!(form, PairForm::Directed { .. } | PairForm::Ladder { .. }),
        }
    }
}

/// A pair with everything the entries need.
pub struct PreparedPair {
    /// The first block.
    pub a: Block,
    /// The second block.
    pub b: Block,
    /// The tolerances, exact.
    pub tolerances: ToleranceSet,
    /// The tolerances for f32, exact.
    pub tolerances_f32: ToleranceSet,
    /// The blocks in the stepper in f32, and the tolerances rounded.
    pub f32: ([PreparedBlock<f32>; 2], Tolerances<f32>),
    /// The blocks in the stepper in f64, and the tolerances rounded.
    pub f64: ([PreparedBlock<f64>; 2], Tolerances<f64>),
    /// The pairs of features that alone can be in a contact in f64 while the blocks move by no more than [`skin`]; none where that is not known.
    pub nearby: Option<NearbyFeatures>,
    /// The blocks in the oracle.
    pub exact: [rockproof_oracle::PreparedBlock; 2],
    /// The pairs of features that alone can be in a contact, exactly, while the blocks move by no more than [`skin`]; none where that is zero.
    pub exact_nearby: Option<rockproof_oracle::NearbyFeatures>,
}

impl PreparedPair {
    /// `None` where rounding destroys a block, or where the boxes are out of reach, so that there is nothing to classify.
    fn new(case: PairCase) -> Option<PreparedPair> {
        let NamedSet { f32: tolerances_f32, f64: tolerances, .. } =
            case.sets.get(case.index as usize % case.sets.len())?.clone();
        let exact = [rockproof_oracle::PreparedBlock::new(&case.a), rockproof_oracle::PreparedBlock::new(&case.b)];
        if !Pair::new(&exact[0], &exact[1]).are_neighbours(&tolerances) {
            return None;
        }
        let f32 = [PreparedBlock::new(&case.a).ok()?, PreparedBlock::new(&case.b).ok()?];
        let f64 = [PreparedBlock::new(&case.a).ok()?, PreparedBlock::new(&case.b).ok()?];
        let rounded = Tolerances::<f64>::new(&tolerances).ok()?;
        let [a, b] = &f64;
        let all = ClassificationRequest { a, b, tolerances: &rounded, kept: &[], among: None };
        let nearby = NearbyFeatures::of(all, skin(rounded.search));
        let exact_nearby = Pair::new(&exact[0], &exact[1]).nearby_features(&tolerances, skin(rounded.search));
        Some(PreparedPair {
            exact_nearby,
            f32: (f32, Tolerances::new(&tolerances_f32).ok()?),
            f64: (f64, rounded),
            nearby,
            a: case.a,
            b: case.b,
            tolerances,
            tolerances_f32,
            exact,
        })
    }
}

/// Pairs of one kind, and what the oracle says of them.
pub struct Sample {
    /// Which pairs.
    pub kind: SampleKind,
    /// The pairs.
    pub pairs: Vec<PreparedPair>,
    /// Exact contacts.
    pub contacts: u64,
    /// Pairs with at least one contact.
    pub touching: u64,
    /// Pairs with at least one decision that hangs on an exact zero.
    pub ties: u64,
    /// How the oracle's fast path decided its signs, over all pairs.
    pub levels: LevelCounts,
}

impl Sample {
    /// The first `count` pairs of a kind whose boxes are within reach.
    ///
    /// # Errors
    /// As [`SampleKind::config`].
    pub fn new(kind: SampleKind, seed: u64, count: usize) -> Result<Sample, SourceError> {
        let config = kind.config()?;
        let cases = (0..).flat_map(|number| batch::batch(seed, number, &config));
        let ready: Vec<PreparedPair> =
            cases.filter(|case| kind.takes(&case.form)).filter_map(PreparedPair::new).take(count).collect();
        let mut sample =
            Sample { kind, pairs: ready, contacts: 0, touching: 0, ties: 0, levels: LevelCounts::default() };
        for ready in &sample.pairs {
            let pair = Pair::new(&ready.exact[0], &ready.exact[1]);
            let answer = pair.classify(&ready.tolerances);
            sample.contacts += answer.contacts.len() as u64;
            sample.touching += u64::from(!answer.contacts.is_empty());
            sample.levels += answer.levels;
            sample.ties += u64::from(pair.trace(&ready.tolerances).iter().any(|entry| entry.tie));
        }
        Ok(sample)
    }
}
