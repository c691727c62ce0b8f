//! Which contact of this step continues which of the step before (SPEC section 5).

use crate::stepper::dynamics::state::{ContactState, Mode};
use crate::stepper::real::Real;
use crate::stepper::vector::Vector;
use std::ops::Range;

/// What a contact takes over: mode and the anchors of A and B.
pub(super) type Memory<R> = (Mode, [Vector<R>; 2]);

/// The old contacts of one pair of blocks: a part of all, which are sorted by pair.
pub(super) fn of_pair<R>(old: &[ContactState<R>], pair: [u32; 2]) -> Range<usize> {
    old.partition_point(|c| c.blocks < pair)..old.partition_point(|c| c.blocks <= pair)
}

/// For each new contact of a pair, given by features and entrance, the old one it continues: first by kind and features, then
/// by entrance, each old one at most once.
pub(super) fn continued<R: Real>(new: &[crate::model::Contact], old: &[ContactState<R>]) -> Vec<Option<Memory<R>>> {
    let memory = |place: usize| (old[place].mode, old[place].anchors);
    let mut taken = vec![false; old.len()];
    let mut found = vec![None; new.len()];
    for (contact, found) in new.iter().zip(&mut found) {
        let same = |c: &ContactState<R>| c.features() == (contact.kind, contact.a, contact.b);
        if let Some(place) = old.iter().position(same) {
            taken[place] = true;
            *found = Some(memory(place));
        }
    }
    for (contact, found) in new.iter().zip(&mut found).filter(|(_, found)| found.is_none()) {
        let free = old.iter().enumerate().position(|(k, c)| !taken[k] && c.entrance() == contact.entrance);
        if let Some(place) = free {
            taken[place] = true;
            *found = Some(memory(place));
        }
    }
    found
}
