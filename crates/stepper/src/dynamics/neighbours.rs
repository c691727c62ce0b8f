//! Rough phase over all blocks: pairs that may be neighbours, found by a tree of boxes and found again only when blocks could have
//! moved into reach.

use crate::contact::{PreparedBlock, Tolerances};
use crate::dynamics::neighbour_list::NeighbourList;
use crate::real::Real;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Pairs of blocks whose boxes are closer than the reach and a margin.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    pairs: Vec<[u32; 2]>,
    /// What is known of each of the pairs.
    watched: Vec<NeighbourList>,
    /// How far a vertex may still move before a pair could be missing (m).
    margin_left: f64,
    known: bool,
}

impl Neighbours {
    /// All pairs, ascending, that can be neighbours by SPEC section 4, but pairs of fixed blocks. May hold more.
    pub(super) fn pairs<R: Real>(
        &mut self,
        prepared: &[PreparedBlock<R>],
        fixed: &[bool],
        t: &Tolerances<R>,
    ) -> (&[[u32; 2]], &mut [NeighbourList]) {
        if !self.known {
            self.find(prepared, fixed, t.reach.to_f64());
        }
        (&self.pairs, &mut self.watched)
    }

    /// Takes note that vertices moved by up to `distance` (m).
    pub(super) fn moved(&mut self, distance: f64) {
        self.margin_left -= distance;
        // A NaN leaves no margin either.
        self.known &= self.margin_left >= 0.0;
    }

    /// Forgets everything: the blocks stand somewhere else.
    pub(super) fn forget(&mut self) {
        self.known = false;
        self.forget_features();
    }

    /// Of how many pairs the nearby features are known.
    pub(super) fn pairs_with_known_features(&self) -> usize {
        self.watched.iter().filter(|watched| watched.is_known()).count()
    }

    /// Forgets which features of each pair are near.
    pub(super) fn forget_features(&mut self) {
        self.watched.fill(NeighbourList::default());
    }

    fn find<R: Real>(&mut self, prepared: &[PreparedBlock<R>], fixed: &[bool], reach: f64) {
        // Each block of a pair may move by the margin. Rounding of the coordinates is far below the sixteenth that `reach` holds.
        let margin = reach;
        let grown = |block: &PreparedBlock<R>| {
            let by = (reach + 2.0 * margin) / 2.0;
            let side = |x: R, by: f64| x.to_f64() + by;
            let bounds = block.bounds();
            let low = bounds.low.components().map(|x| side(x, -by));
            let high = bounds.high.components().map(|x| side(x, by));
            // What cancellation far from the origin could take.
            let slack = low.iter().chain(&high).fold(0.0, |most: f64, x| most.max(x.abs())) * 1e-7;
            Rectangle::from_corners(low.map(|x| x - slack), high.map(|x| x + slack))
        };
        let boxes = prepared.iter().enumerate().map(|(k, block)| GeomWithData::new(grown(block), k as u32));
        let tree: RTree<GeomWithData<Rectangle<[f64; 3]>, u32>> = RTree::bulk_load(boxes.collect());
        let before = std::mem::take(&mut self.pairs);
        for one in &tree {
            let around = AABB::from_corners(one.geom().lower(), one.geom().upper());
            let later = tree.locate_in_envelope_intersecting(around).map(|other| other.data);
            let moving = later.filter(|&j| one.data < j && !(fixed[one.data as usize] && fixed[j as usize]));
            self.pairs.extend(moving.map(|j| [one.data, j]));
        }
        self.pairs.sort_unstable();
        let mut known = before.into_iter().zip(std::mem::take(&mut self.watched)).peekable();
        let watched = |pair: &[u32; 2]| {
            while known.next_if(|(other, _)| other < pair).is_some() {}
            known.next_if(|(other, _)| other == pair).map_or_else(NeighbourList::default, |(_, watched)| watched)
        };
        self.watched = self.pairs.iter().map(watched).collect();
        self.margin_left = margin;
        self.known = true;
    }
}
