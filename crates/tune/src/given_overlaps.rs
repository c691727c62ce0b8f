//! The overlaps of the model as it is given: under which sets contacts hold them (SPEC section 7).

use num_rational::BigRational;
use rayon::prelude::*;
use rockproof_model::{Block, Precision, ToleranceSet};
use rockproof_oracle::audit::{Auditor, rounding_depth};
use rockproof_oracle::{Pair, PreparedBlock};
use serde::{Deserialize, Serialize};

/// A share of what several processes do together, one in `of`. Scattered: in a regular model every so-manieth pair may be one that takes long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Share {
    pub(super) number: usize,
    pub(super) of: usize,
}

impl Share {
    pub(super) const WHOLE: Share = Share { number: 0, of: 1 };

    fn has(self, index: usize) -> bool {
        let scattered = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
        scattered.checked_rem(self.of as u64) == Some(self.number as u64)
    }
}

/// The pairs of a model that overlap. Which they are, and how deep, depends on no tolerance.
pub(super) struct GivenOverlaps {
    prepared: Vec<PreparedBlock>,
    overlaps: Vec<GivenOverlap>,
}

/// A pair of blocks that overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct GivenOverlap {
    pub(super) blocks: [usize; 2],
    /// The square of the penetration (m²).
    pub(super) depth_squared: BigRational,
    pub(super) is_rounding: bool,
}

impl GivenOverlaps {
    /// Makes blocks ready, and knows of no overlap.
    pub(super) fn none_of(blocks: &[&Block]) -> GivenOverlaps {
        let prepared = blocks.par_iter().map(|block| PreparedBlock::new(block)).collect();
        GivenOverlaps { prepared, overlaps: Vec::new() }
    }

    /// Finds those of a share of the pairs; `set` says only how far apart pairs are looked at, and blocks that overlap always are.
    pub(super) fn found(&self, blocks: &[&Block], set: &ToleranceSet, share: Share) -> Vec<GivenOverlap> {
        // As `check` has it: in f64 whatever the engine.
        let rounding = rounding_depth(blocks, Precision::F64);
        let auditor = Auditor::new(&self.prepared, set);
        let overlap = |pair: [usize; 2]| {
            let found = auditor.pair(pair).overlap?;
            let (depth_squared, is_rounding) = (found.depth_squared(), found.is_rounding(&rounding));
            Some(GivenOverlap { blocks: pair, depth_squared, is_rounding })
        };
        let neighbours = auditor.neighbours().into_iter().enumerate();
        let meant: Vec<[usize; 2]> = neighbours.filter(|(at, _)| share.has(*at)).map(|(_, pair)| pair).collect();
        meant.into_par_iter().filter_map(overlap).collect()
    }

    /// Takes in what was found, in any order: of blocks that there are.
    pub(super) fn add(&mut self, overlaps: Vec<GivenOverlap>) {
        self.overlaps.extend(overlaps);
    }

    /// How many blocks the model has.
    pub(super) fn blocks(&self) -> usize {
        self.prepared.len()
    }

    /// Pairs of the model that overlap by more than rounding.
    pub(super) fn count(&self) -> u64 {
        self.overlaps.iter().filter(|overlap| !overlap.is_rounding).count() as u64
    }

    /// Pairs that overlap under a set deeper than g, or by more than rounding where no contact sees it: those that mean
    /// [`rockproof_oracle::audit::OverlapSeverity::Lost`].
    pub(super) fn lost(&self, set: &ToleranceSet) -> u64 {
        let g = set.penetration.to_rational();
        let limit = &g * &g;
        let is_seen = |[a, b]: [usize; 2]| {
            let contacts = Pair::new(&self.prepared[a], &self.prepared[b]).classify(set).contacts;
            contacts.iter().any(|contact| contact.gap.is_negative())
        };
        let is_lost = |overlap: &&GivenOverlap| {
            overlap.depth_squared > limit || (!overlap.is_rounding && !is_seen(overlap.blocks))
        };
        self.overlaps.par_iter().filter(is_lost).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::preset::{Preset, derive};
    use rockproof_model::{Number, Scene};
    use rockproof_oracle::audit::{OverlapSeverity, audit};

    #[test]
    fn a_set_loses_what_the_audit_calls_lost() {
        let scene = Scene::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/real/slope_joints.dda")).unwrap();
        let shapes = scene.shapes();
        let mut set = derive(Preset::Auto, &shapes, Precision::F64).unwrap();
        let mut given = GivenOverlaps::none_of(&shapes);
        let whole = given.found(&shapes, &set, Share::WHOLE);
        for number in [2, 0, 1] {
            let share = given.found(&shapes, &set, Share { number, of: 3 });
            assert!(
                share.len() > whole.len() / 5 && share.len() < whole.len() / 2,
                "{} of {}",
                share.len(),
                whole.len()
            );
            given.add(share);
        }
        assert_eq!(given.overlaps.len(), whole.len());
        assert!(given.found(&shapes, &set, Share { number: 0, of: 0 }).is_empty());
        assert_eq!(given.count(), 19);
        let rounding = rounding_depth(&shapes, Precision::F64);
        // From all pairs lost to few, by depth and by sight.
        let mut seen = Vec::new();
        for penetration in [0.01, 0.5, 1.1, 2.0] {
            set.penetration = Number::from_f64(penetration).unwrap();
            let found = audit(&shapes, &set).overlaps;
            let lost =
                found.iter().filter(|overlap| overlap.severity(&rounding) == OverlapSeverity::Lost).count() as u64;
            assert_eq!(given.lost(&set), lost, "{penetration}");
            seen.push(lost);
        }
        assert!(seen[0] == 19 && seen[3] < 19, "{seen:?}");
    }
}
