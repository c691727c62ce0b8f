//! Blocks whose vertices move on straight lines.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::lattice::Lattice;
use rockproof_model::{Block, Number, Vec3};

/// A block before and after a step: the same block with other coordinates.
#[derive(Clone, Copy, Debug)]
pub struct StraightMotion<'b> {
    before: &'b Block,
    after: &'b Block,
}

impl<'b> StraightMotion<'b> {
    /// The motion from one set of places to another.
    ///
    /// # Panics
    /// When the blocks have different numbers of vertices.
    pub fn new(before: &'b Block, after: &'b Block) -> StraightMotion<'b> {
        assert_eq!(before.vertices().len(), after.vertices().len(), "a moved block keeps its vertices");
        StraightMotion { before, after }
    }

    /// The block before and after.
    pub(super) fn ends(&self) -> [&'b Block; 2] {
        [self.before, self.after]
    }

    /// The block at a time, 0 before and 1 after.
    pub fn block_at(&self, time: &BigRational) -> Block {
        let time = Number::from_rational(time.clone());
        let place = |p: &Number, q: &Number| p.plus(&q.plus(&p.negated()).times(&time));
        let vertices = self.before.vertices().iter().zip(self.after.vertices());
        let at =
            |(p, q): (&Vec3<Number>, &Vec3<Number>)| Vec3::new(place(&p.x, &q.x), place(&p.y, &q.y), place(&p.z, &q.z));
        self.before.with_vertices(vertices.map(at).collect())
    }
}

/// Two moving blocks on one lattice.
pub(super) struct MovingPair<'b> {
    pub(super) blocks: [&'b Block; 2],
    /// The places of each block's vertices before and after, in lattice units.
    places: [[Vec<Vec3<BigInt>>; 2]; 2],
    /// g in lattice units.
    pub(super) limit: BigInt,
}

impl<'b> MovingPair<'b> {
    pub(super) fn new(a: &StraightMotion<'b>, b: &StraightMotion<'b>, limit: &Number) -> MovingPair<'b> {
        let all = [a.before, a.after, b.before, b.after];
        let lattice = Lattice::covering(all.iter().flat_map(|block| block.coordinates()).chain([limit]));
        let units = |block: &Block| block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect();
        MovingPair {
            blocks: [a.before, b.before],
            places: [a, b].map(|motion| [units(motion.before), units(motion.after)]),
            limit: lattice.units(limit),
        }
    }

    /// The places of both blocks' vertices at the time `number / 2^halvings`, in units finer by 2^halvings.
    pub(super) fn at(&self, number: &BigInt, halvings: u32) -> [Vec<Vec3<BigInt>>; 2] {
        let rest = (BigInt::from(1) << halvings) - number;
        [0, 1].map(|side| {
            let [before, after] = &self.places[side];
            before.iter().zip(after).map(|(p, q)| p.scaled(&rest).plus(&q.scaled(number))).collect()
        })
    }
}
