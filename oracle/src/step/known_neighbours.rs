//! What is known of neighbouring blocks from one step to the next: which pairs of features can touch while they have hardly moved.

use crate::{NearbyFeatures, Pair, PreparedBlock};
use rockproof_model::{Contact, ContactKey, ToleranceSet};
use std::collections::BTreeMap;

/// Pairs of features are found for coordinates within this share of s of where they are: few pairs more than touch, and many steps before a block that
/// settles has moved so far.
const MARGIN_SHARE: f64 = 1.0 / 32.0;
/// They are found after so many looks at all pairs, which cost more than to find them.
const LOOKS_BEFORE_LISTING: u16 = 8;
/// What was found pays if it holds for so many looks.
const WORTH: u16 = 32;
/// Where it held for fewer, it is found again after twice the looks, up to this many.
const MOST_LOOKS: u16 = 512;
/// The most pairs of blocks of which pairs of features are kept: some 3 kB each.
const MOST_LISTED: usize = 4096;
/// The most pairs of features that are kept of a pair of blocks.
const MOST_FEATURES: usize = 256;
/// To find them takes a look at each feature of one block beside each of the other: worth it up to so many.
const MOST_COMPARED: usize = 10_000;

/// The contacts of pairs of blocks in one step after another, under one tolerance set: where two blocks have hardly moved for some steps, only pairs of
/// features that can touch are looked at, as long as it is proved that no other can. The contacts are those that [`Pair::classify_with_kept`] finds.
#[derive(Clone, Debug, Default)]
pub struct KnownNeighbours {
    pairs: BTreeMap<[usize; 2], Neighbours>,
    /// Of how many pairs of blocks pairs of features are kept.
    listed: usize,
    spared: u64,
}

/// What is known of two blocks.
#[derive(Clone, Debug)]
struct Neighbours {
    /// Their boxes when the pairs of features were found, or the looks began to be counted.
    since: [[f64; 3]; 4],
    looks: u16,
    /// After how many looks pairs of features are found.
    patience: u16,
    nearby: Option<Box<NearbyFeatures>>,
    /// Looked at since [`KnownNeighbours::begin_step`].
    seen: bool,
}

impl KnownNeighbours {
    /// How many answers came of nearby pairs of features alone.
    pub fn spared(&self) -> u64 {
        self.spared
    }

    /// Forgets what is no neighbour any more: pairs that were not asked for since the last time.
    pub fn begin_step(&mut self) {
        let listed = &mut self.listed;
        self.pairs.retain(|_, pair| {
            *listed -= usize::from(!pair.seen && pair.nearby.is_some());
            std::mem::replace(&mut pair.seen, false)
        });
    }

    /// The contacts of the pair of these blocks, where the step before left the contacts `kept` of it closed. The tolerance set must be the same every time.
    pub fn contacts(
        &mut self,
        blocks: [usize; 2],
        pair: &Pair<'_>,
        tolerances: &ToleranceSet,
        kept: &[ContactKey],
    ) -> Vec<Contact> {
        let now = boxes([pair.a, pair.b]);
        let known = self.pairs.entry(blocks).or_insert_with(|| Neighbours {
            since: now,
            looks: 0,
            patience: LOOKS_BEFORE_LISTING,
            nearby: None,
            seen: true,
        });
        known.seen = true;
        known.looks = known.looks.saturating_add(1);
        if let Some(nearby) = &known.nearby {
            if let Some(answer) = pair.classify_if_near(tolerances, nearby, kept) {
                self.spared += 1;
                return answer.contacts;
            }
            known.patience =
                if known.looks < WORTH { (2 * known.patience).min(MOST_LOOKS) } else { LOOKS_BEFORE_LISTING };
            self.listed -= 1;
            (known.nearby, known.since, known.looks) = (None, now, 0);
        } else if known.looks >= known.patience && self.listed < MOST_LISTED && are_small([pair.a, pair.b]) {
            let margin = tolerances.search.approximate() * MARGIN_SHARE;
            if moved(&known.since, &now) * f64::from(WORTH) <= margin * f64::from(known.looks) {
                let nearby = pair.nearby_features(tolerances, margin).filter(|found| found.len() <= MOST_FEATURES);
                known.patience = if nearby.is_some() { known.patience } else { u16::MAX };
                known.nearby = nearby.map(Box::new);
                self.listed += usize::from(known.nearby.is_some());
            }
            (known.since, known.looks) = (now, 0);
        }
        pair.classify_with_kept(tolerances, kept).contacts
    }
}

fn boxes([a, b]: [&PreparedBlock; 2]) -> [[f64; 3]; 4] {
    [a.box_min, a.box_max, b.box_min, b.box_max]
}

/// About how far (m) two blocks have moved, but for what they have moved alike.
fn moved(since: &[[f64; 3]; 4], now: &[[f64; 3]; 4]) -> f64 {
    let by = |corner: usize, k: usize| now[corner][k] - since[corner][k];
    (0..12).map(|part| (by(part / 3, part % 3) - by(0, part % 3)).abs()).fold(0.0, f64::max)
}

/// Whether two blocks have few features.
fn are_small(blocks: [&PreparedBlock; 2]) -> bool {
    let [a, b] = blocks.map(|block| block.vertices.len() + block.edges.len() + block.faces.len());
    a.saturating_mul(b) <= MOST_COMPARED
}

#[cfg(test)]
mod tests;
