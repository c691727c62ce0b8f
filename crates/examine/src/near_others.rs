//! Which blocks of a model are near others: of a block that is not, nothing was tried.

use rockproof_model::Number;
use rockproof_oracle::audit::{Audit, Auditor};

/// Of each block whether it may be near another: whether it overlaps one, or no face shows that it is further from a neighbour than `search`.
pub(crate) fn near_others(
    blocks: usize,
    audit: &Audit,
    (auditor, search): (&Auditor<'_>, &Number),
    neighbours: &[[usize; 2]],
) -> Vec<bool> {
    let mut is_near = vec![false; blocks];
    let overlapping = audit.overlaps.iter().map(|overlap| overlap.blocks);
    let overlapping = overlapping.chain(audit.bounded.iter().map(|overlap| overlap.blocks));
    overlapping.flatten().for_each(|block| is_near[block] = true);
    for pair in neighbours {
        let is_known = pair.iter().all(|&block| is_near[block]);
        if !is_known && !auditor.is_surely_apart(*pair, search) {
            pair.iter().for_each(|&block| is_near[block] = true);
        }
    }
    is_near
}
