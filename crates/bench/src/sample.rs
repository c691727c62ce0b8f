//! The pairs that are timed.

use rockproof_campaign::generic::Generic;
use rockproof_campaign::pairs::{self, Form, PairCase, PairConfig};
use rockproof_campaign::sets::NamedSet;
use rockproof_campaign::source::{self, SourceError};
use rockproof_model::{Block, ToleranceSet};
use rockproof_oracle::{self, LevelCounts, Pair};
use rockproof_stepper::contact::{Solid, Tolerances};
use std::sync::Arc;

/// Which pairs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// The pairs of [`Generic`], as generated and moved at random.
    Generic,
    /// Pairs that the campaign moved, or whose tolerances it chose, to be at or near the boundary of a decision.
    Directed,
}

impl Sort {
    /// Both.
    pub const ALL: [Sort; 2] = [Sort::Generic, Sort::Directed];

    /// `generic` or `directed`.
    pub fn name(self) -> &'static str {
        match self {
            Sort::Generic => "generic",
            Sort::Directed => "directed",
        }
    }

    /// What the campaign's generator is told in order to make such pairs, under the sets of a default campaign.
    ///
    /// # Errors
    /// When a default set does not exist.
    pub fn config(self) -> Result<PairConfig, SourceError> {
        let sets =
            rockproof_campaign::sets::NAMES.into_iter().map(source::set_source).collect::<Result<Vec<_>, _>>()?;
        let sets_per_batch = sets.len().min(3);
        let config = PairConfig { sets, sets_per_batch, ..PairConfig::default() };
        Ok(match self {
            Sort::Generic => PairConfig {
                families: vec![Arc::new(Generic::default())],
                directed_percent: 0,
                ladder_percent: 0,
                // These have their last bits moved already; shaking would make their coordinates longer than f64 holds.
                shaken_percent: 0,
                ..config
            },
            // Onto the boundary itself as well as beside it.
            Sort::Directed => PairConfig { directed_percent: 67, ladder_percent: 33, shaken_percent: 0, ..config },
        })
    }

    fn takes(self, form: &Form) -> bool {
        match self {
            Sort::Generic => matches!(form, Form::Base | Form::Moved),
            Sort::Directed => matches!(form, Form::Directed { .. } | Form::Ladder { .. }),
        }
    }
}

/// A pair with everything the contestants need.
pub struct Ready {
    /// The first block.
    pub a: Block,
    /// The second block.
    pub b: Block,
    /// The tolerances, exact.
    pub tolerances: ToleranceSet,
    /// The tolerances for f32, exact.
    pub tolerances_f32: ToleranceSet,
    /// The blocks in the stepper in f32, and the tolerances rounded.
    pub f32: ([Solid<f32>; 2], Tolerances<f32>),
    /// The blocks in the stepper in f64, and the tolerances rounded.
    pub f64: ([Solid<f64>; 2], Tolerances<f64>),
    /// The blocks in the oracle.
    pub exact: [rockproof_oracle::Solid; 2],
}

impl Ready {
    /// `None` where rounding destroys a block, or where the boxes are out of reach, so that there is nothing to classify.
    fn new(case: PairCase) -> Option<Ready> {
        let NamedSet { f32: tolerances_f32, f64: tolerances, .. } =
            case.sets.get(case.index as usize % case.sets.len())?.clone();
        let exact = [rockproof_oracle::Solid::new(&case.a), rockproof_oracle::Solid::new(&case.b)];
        if !Pair::new(&exact[0], &exact[1]).are_neighbours(&tolerances) {
            return None;
        }
        let f32 = [Solid::new(&case.a).ok()?, Solid::new(&case.b).ok()?];
        let f64 = [Solid::new(&case.a).ok()?, Solid::new(&case.b).ok()?];
        Some(Ready {
            f32: (f32, Tolerances::new(&tolerances_f32).ok()?),
            f64: (f64, Tolerances::new(&tolerances).ok()?),
            a: case.a,
            b: case.b,
            tolerances,
            tolerances_f32,
            exact,
        })
    }
}

/// Pairs of one sort, and what the oracle says of them.
pub struct Sample {
    /// Which pairs.
    pub sort: Sort,
    /// The pairs.
    pub pairs: Vec<Ready>,
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
    /// The first `count` pairs of a sort whose boxes are within reach.
    ///
    /// # Errors
    /// As [`Sort::config`].
    pub fn new(sort: Sort, seed: u64, count: usize) -> Result<Sample, SourceError> {
        let config = sort.config()?;
        let cases = (0..).flat_map(|number| pairs::batch(seed, number, &config));
        let ready: Vec<Ready> =
            cases.filter(|case| sort.takes(&case.form)).filter_map(Ready::new).take(count).collect();
        let mut sample =
            Sample { sort, pairs: ready, contacts: 0, touching: 0, ties: 0, levels: LevelCounts::default() };
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
