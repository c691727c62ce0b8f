//! The overlaps of the model as it is given: under which sets contacts hold them (SPEC section 7).

use num_rational::BigRational;
use rayon::prelude::*;
use rockproof_model::{Block, Precision, ToleranceSet};
use rockproof_oracle::audit::{Auditor, rounding_depth};
use rockproof_oracle::{Pair, PreparedBlock};

/// The pairs of a model that overlap. Which they are, and how deep, depends on no tolerance.
pub(super) struct GivenOverlaps {
    solids: Vec<PreparedBlock>,
    overlaps: Vec<GivenOverlap>,
}

/// A pair of blocks that overlap.
struct GivenOverlap {
    blocks: [usize; 2],
    /// The square of the penetration (m²).
    depth_squared: BigRational,
    is_rounding: bool,
}

impl GivenOverlaps {
    /// Finds them; `set` says only how far apart pairs are looked at, and blocks that overlap always are.
    pub(super) fn of(blocks: &[&Block], set: &ToleranceSet) -> GivenOverlaps {
        let solids: Vec<PreparedBlock> = blocks.par_iter().map(|block| PreparedBlock::new(block)).collect();
        // As `check` has it: in f64 whatever the engine.
        let rounding = rounding_depth(blocks, Precision::F64);
        let auditor = Auditor::new(&solids, set);
        let overlap = |pair: [usize; 2]| {
            let found = auditor.pair(pair).overlap?;
            let (depth_squared, is_rounding) = (found.depth_squared(), found.is_rounding(&rounding));
            Some(GivenOverlap { blocks: pair, depth_squared, is_rounding })
        };
        let overlaps = auditor.neighbours().into_par_iter().filter_map(overlap).collect();
        GivenOverlaps { overlaps, solids }
    }

    /// Pairs of the model that overlap by more than rounding.
    pub(super) fn count(&self) -> u64 {
        self.overlaps.iter().filter(|overlap| !overlap.is_rounding).count() as u64
    }

    /// Pairs that overlap under a set deeper than g, or by more than rounding where no contact sees it: those that mean
    /// [`rockproof_oracle::audit::Meaning::Lost`].
    pub(super) fn lost(&self, set: &ToleranceSet) -> u64 {
        let g = set.penetration.to_rational();
        let limit = &g * &g;
        let is_seen = |[a, b]: [usize; 2]| {
            let contacts = Pair::new(&self.solids[a], &self.solids[b]).classify(set).contacts;
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
    use rockproof_oracle::audit::{Meaning, audit};

    #[test]
    fn a_set_loses_what_the_audit_calls_lost() {
        let scene = Scene::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/real/slope_joints.dda")).unwrap();
        let shapes = scene.shapes();
        let mut set = derive(Preset::Auto, &shapes, Precision::F64).unwrap();
        let given = GivenOverlaps::of(&shapes, &set);
        assert_eq!(given.count(), 19);
        let rounding = rounding_depth(&shapes, Precision::F64);
        // From all pairs lost to few, by depth and by sight.
        let mut seen = Vec::new();
        for penetration in [0.01, 0.5, 1.1, 2.0] {
            set.penetration = Number::from_f64(penetration).unwrap();
            let found = audit(&shapes, &set).overlaps;
            let lost = found.iter().filter(|overlap| overlap.meaning(&rounding) == Meaning::Lost).count() as u64;
            assert_eq!(given.lost(&set), lost, "{penetration}");
            seen.push(lost);
        }
        assert!(seen[0] == 19 && seen[3] < 19, "{seen:?}");
    }
}
