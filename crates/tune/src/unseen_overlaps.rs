//! Pairs that overlap after a step where no contact sees it (SPEC section 7): what `simulate --audit` and `examine` call passing through one another.

use rayon::prelude::*;
use rockproof_model::{Block, ContactKey, Precision, ToleranceSet};
use rockproof_oracle::audit::{Auditor, rounding_depth};
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::dynamics::{ClosedContacts, PressedBlocks, Solve, State, yielding_size};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// Unseen overlaps of all steps, settling too: by more than rounding, one block of the pair free to move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnseenOverlaps {
    /// Steps after which there is one.
    pub steps: u64,
    /// Pairs after the step with most of them.
    pub most_pairs: u64,
    /// The deepest (m).
    pub deepest: f64,
}

impl UnseenOverlaps {
    /// Adds the depths of those after a step.
    pub(super) fn add(&mut self, depths: &[f64]) {
        self.steps += u64::from(!depths.is_empty());
        self.most_pairs = self.most_pairs.max(depths.len() as u64);
        self.deepest = depths.iter().copied().fold(self.deepest, f64::max);
    }
}

/// The depths (m) of unseen overlaps after a step.
#[derive(Debug, Default)]
pub(super) struct UnseenDepths {
    /// Those that are more than springs of other contacts explain.
    pub(super) beyond: Vec<f64>,
    /// Those that these explain, which are no fault, as for `simulate`.
    pub(super) explained: Vec<f64>,
}

/// Those of the pairs of `overlaps`, each with its depth, of which no contact tells after a step; contacts that the step left closed are kept, as by the step
/// that follows.
pub(super) fn unseen_depths<R: Solve>(
    (blocks, is_fixed): (&[Block], &[bool]),
    state: &State<R>,
    overlaps: &[([usize; 2], f64)],
    (set, precision): (&ToleranceSet, Precision),
) -> UnseenDepths {
    let rounding = rounding_depth(&blocks.iter().collect::<Vec<_>>(), precision);
    // Blocks that overlap by no more are no concern of contacts; rounded down, so that "at most" is sure.
    let harmless = (&rounding).min(&set.penetration).approximate().next_down();
    let prepared: Vec<OnceLock<PreparedBlock>> = blocks.iter().map(|_| OnceLock::new()).collect();
    let deep = set.penetration.approximate().next_up();
    let (closed, pressed) = (ClosedContacts::of(state), OnceLock::new());
    let unseen = |&(pair, depth): &([usize; 2], f64)| {
        let kept: Vec<ContactKey> = closed.between(pair).iter().map(|(_, contact)| contact.key).collect();
        let [a, b] = pair.map(|k| prepared[k].get_or_init(|| PreparedBlock::new(&blocks[k])));
        // Nearly always a contact tells, and that is known before anything is asked about the blocks.
        if Pair::new(a, b).classify_with_kept(set, &kept).contacts.iter().any(|contact| contact.gap.is_negative()) {
            return None;
        }
        // Of convex blocks all is known then; the auditor would measure the depth once more.
        if depth > deep && pair.iter().all(|&k| blocks[k].is_convex()) {
            return Some((depth, false));
        }
        let both = pair.map(|k| PreparedBlock::new(&blocks[k]));
        let overlap =
            Auditor::new(&both, set).unseen_with_kept([0, 1], &kept).filter(|found| found.is_unseen(&rounding))?;
        let depth = overlap.penetration.depth_m().unwrap_or(f64::INFINITY);
        let pressed = pressed.get_or_init(|| PressedBlocks::of(state, is_fixed));
        let size = yielding_size(pair.map(|k| &blocks[k]), set.penetration.approximate());
        let yields = size.is_some_and(|size| pressed.explain(pair, depth, overlap.penetration.way_out(), size));
        Some((depth, yields))
    };
    let found: Vec<(f64, bool)> =
        overlaps.par_iter().filter(|(_, depth)| *depth > harmless).filter_map(unseen).collect();
    let of =
        |explained: bool| found.iter().filter(|(_, yields)| *yields == explained).map(|(depth, _)| *depth).collect();
    UnseenDepths { beyond: of(false), explained: of(true) }
}
