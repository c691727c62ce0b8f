//! Neighbour lists (Verlet lists) of features: which pairs of features of two blocks a step looks at while the blocks have hardly moved.

#[cfg(test)]
mod tests;

use crate::contact::{ClassificationRequest, NearbyFeatures};
use crate::real::Real;
use crate::vector::Vector;

/// Pairs of features are found for coordinates within this share of `search` of where they are. A smaller share leaves out more pairs for a shorter
/// time (docs/performance_changes.md has what others gave).
const SKIN_SHARE: f64 = 1.0 / 128.0;
/// They are found after so many looks at all pairs: to find them costs about as much.
const LOOKS_BEFORE_LISTING: u8 = 6;
/// And if the blocks moved in these looks by at most this share of the margin.
const CALM_SHARE: u64 = 4;
/// Distances are counted in this part of the margin, rounded up: sums of integers do not round.
const UNITS: u64 = 1 << 20;
/// The most units counted for a step.
const MAX_UNITS: u64 = 1 << 40;
/// A margin that is used up: some units less than all, for the rounding of differences.
const USED_UP: u64 = UNITS - UNITS / 64;

/// How far coordinates of vertices may move (m) before a step finds the pairs of features that can touch anew.
pub fn skin<R: Real>(search: R) -> f64 {
    search.to_f64() * SKIN_SHARE
}

/// How far a coordinate of a vertex has moved at most (m), of vertices that are finite.
pub(super) fn farthest<R: Real>(before: &[Vector<R>], after: &[Vector<R>]) -> f64 {
    let moved = |(a, b): (&Vector<R>, &Vector<R>)| (*b - *a).components().map(|x| x.to_f64().abs());
    before.iter().zip(after).flat_map(moved).fold(0.0, f64::max)
}

/// How far each block has moved since the beginning, in units of the margin.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockTravel(Vec<u64>);

impl BlockTravel {
    pub(super) fn of(blocks: usize) -> BlockTravel {
        BlockTravel(vec![0; blocks])
    }

    /// Takes note of a step of a block by `distance` (m).
    pub(super) fn add(&mut self, block: usize, distance: f64, margin: f64) {
        let units = distance / margin * UNITS as f64;
        let units = if distance == 0.0 {
            0
        } else if units < MAX_UNITS as f64 {
            units.ceil() as u64
        } else {
            MAX_UNITS
        };
        self.0[block] = self.0[block].saturating_add(units);
    }
}

/// What is known of a pair of blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct NeighbourList {
    /// How far each had moved when its pairs of features were found, or the looks began to be counted.
    since: [u64; 2],
    looks: u8,
    nearby: Option<NearbyFeatures>,
}

impl NeighbourList {
    /// Whether the pairs of features are known.
    pub(super) fn is_known(&self) -> bool {
        self.nearby.is_some()
    }

    /// The pairs of features to look at. None where all are.
    pub(super) fn nearby<R: Real>(
        &mut self,
        pair: [u32; 2],
        travel: &BlockTravel,
        request: ClassificationRequest<'_, R>,
        margin: f64,
    ) -> Option<&NearbyFeatures> {
        if request.a.bounds().beyond(request.b.bounds(), request.tolerances.reach) {
            // Nothing to gain, as they are no neighbours.
            return None;
        }
        let now = pair.map(|block| travel.0[block as usize]);
        let moved = now[0].abs_diff(self.since[0]).max(now[1].abs_diff(self.since[1]));
        let most = if self.nearby.is_some() { USED_UP } else { UNITS / CALM_SHARE };
        if moved > most {
            *self = NeighbourList { since: now, looks: 0, nearby: None };
        }
        if self.nearby.is_none() {
            if self.looks == LOOKS_BEFORE_LISTING {
                self.nearby = NearbyFeatures::of(request, margin);
                self.since = now;
            }
            self.looks = self.looks.saturating_add(1);
        }
        self.nearby.as_ref()
    }
}
