//! What a step need not do again, since the step before left it as it was, bit for bit.

use crate::dynamics::displacement::BlockVector;
use crate::dynamics::island::Island;
use crate::dynamics::state::{BlockState, ContactState};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::ContactKey;

/// What the last step left as it was. Empty lists where nothing is known.
#[derive(Clone, Debug)]
pub(super) struct Unchanged<R> {
    /// Whether the vertices of each block are where they were.
    pub(super) unmoved: Vec<bool>,
    /// Pairs of unmoved blocks of which the last classification kept other contacts than the next one will, ascending.
    pub(super) kept_others: Vec<[u32; 2]>,
    pub(super) islands: Option<UnchangedIslands<R>>,
}

/// Islands that a step gave back as they were.
#[derive(Clone, Debug)]
pub(super) struct UnchangedIslands<R> {
    /// The Δt at which they were solved (s).
    pub(super) time_step: R,
    pub(super) settling: bool,
    /// Whether each block belongs to such an island.
    pub(super) blocks: Vec<bool>,
    /// The displacement of each block.
    pub(super) d: Vec<BlockVector<R>>,
}

impl<R: Real> Unchanged<R> {
    /// Nothing is known.
    pub(super) const NONE: Self = Unchanged { unmoved: Vec::new(), kept_others: Vec::new(), islands: None };

    /// Whether classification of a pair would find what it found in the last step.
    pub(super) fn has(&self, pair: [u32; 2]) -> bool {
        let unmoved = |block: u32| self.unmoved.get(block as usize).is_some_and(|&unmoved| unmoved);
        pair.into_iter().all(unmoved) && self.kept_others.binary_search(&pair).is_err()
    }
}

impl<R: Real> UnchangedIslands<R> {
    /// Whether an island is one of them.
    pub(super) fn has(&self, island: &Island) -> bool {
        island.couplings.blocks.iter().all(|&block| self.blocks[block as usize])
    }
}

/// Whether points are the same, bit for bit.
pub(super) fn same_points<R: Real>(one: &[Vector<R>], other: &[Vector<R>]) -> bool {
    let same =
        |(a, b): (&Vector<R>, &Vector<R>)| a.components().into_iter().zip(b.components()).all(|(a, b)| a.is_same(b));
    one.iter().zip(other).all(same)
}

/// Whether velocity and stress are the same, bit for bit.
pub(super) fn same_motion<R: Real>(one: &BlockState<R>, other: &BlockState<R>) -> bool {
    let rates = one.velocity.iter().zip(&other.velocity);
    rates.chain(one.stress.iter().zip(&other.stress)).all(|(a, b)| a.is_same(*b))
}

/// Pairs of which different contacts are kept, ascending. Both lists are in the order of a state.
pub(super) fn different_pairs<R: Real>(
    one: &[ContactState<R>],
    other: &[ContactState<R>],
    keeps: impl Fn(&ContactState<R>) -> bool,
) -> Vec<[u32; 2]> {
    let keys = |contacts: &[ContactState<R>]| -> Vec<([u32; 2], ContactKey)> {
        contacts.iter().filter(|contact| keeps(contact)).map(|c| (c.blocks, c.contact.key)).collect()
    };
    let (one, other) = (keys(one), keys(other));
    let (mut i, mut j) = (0, 0);
    let mut pairs = Vec::new();
    while i < one.len() || j < other.len() {
        match (one.get(i), other.get(j)) {
            (Some(a), Some(b)) if a == b => (i, j) = (i + 1, j + 1),
            (Some((pair, _)), after) if after.is_none_or(|(later, _)| pair <= later) => {
                pairs.push(*pair);
                i += 1;
            }
            (_, Some((pair, _))) => {
                pairs.push(*pair);
                j += 1;
            }
            (_, None) => break,
        }
    }
    pairs.dedup();
    pairs
}
