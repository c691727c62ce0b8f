//! Passing through within a step (SPEC section 7), exactly: whether two blocks, apart or overlapping by at most g at both
//! ends of a step, overlap deeper than g in between.
//!
//! Vertices move on straight lines from their places before to those after, t from 0 to 1. An interval of t is certified
//! free when one direction n does, at both its ends,
//!
//! `min n·a − max n·b ≥ −g·|n|` over the vertices a of A and b of B at that time.
//!
//! Both sides are made of terms `n·(a(t) − b(t))`, which are linear in t, so what holds at the ends holds between them. It
//! says that a translation of A by g along n parts the hulls, so neither block is deeper in the other than g: not by the
//! least translation, and no point of A that is inside B is farther than g from B's surface, as it leaves B's hull along n,
//! nor the other way round. **Exactly g is not deeper.** With g = 0 this is the plane that separates both hulls at both ends,
//! but one that may itself move along n with the blocks: two blocks that fall together are certified at once.
//!
//! A block that is not convex is, at every time, covered by tetrahedra: from one of its vertices to each triangle of its
//! surface. (A ray from that vertex through a point inside goes on to meet the surface behind the point.) No new vertices
//! are needed, and however vertices move the cover moves with them. An interval is free if every tetrahedron of the one block
//! can, moved by its own translation of length at most g, be parted from all of the other block's by a direction each, and
//! the other way round: then no point of either is deeper than g. The cover may hold more than the block where no
//! vertex sees the whole block, as in a U; such pairs can end undecided, never wrongly free.
//!
//! An interval that is not certified is halved, unless the depth ([`crate::penetration`]) in its middle is above g: that
//! is a passage. All intervals of one length are looked at before shorter ones.

mod certificate;
mod motion;

use crate::boxes::{Box3, meeting_pairs};
use crate::penetration::{Penetration, penetration};
use certificate::Certificate;
use motion::MovingPair;
pub use motion::StraightMotion;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::Number;

/// Whether blocks pass through one another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PassageAnswer {
    /// At no time are they deeper than g.
    NoPassage,
    /// They are deeper than g in between.
    Passage {
        /// A time at which they are, in shares of the step: a fraction between 0 and 1.
        time: BigRational,
        /// How deep they are then.
        depth: Box<Penetration>,
    },
    /// Neither was shown.
    Undecided,
    /// At one of the ends they are deeper than g already: an overlap, not a passage.
    DeepAtEnd,
}

/// What became of a pair, and how much work it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassageReport {
    /// What became of it.
    pub answer: PassageAnswer,
    /// How many intervals were looked at.
    pub intervals: usize,
}

/// Halvings of the step after which an interval is left undecided.
const MAX_HALVINGS: u32 = 40;

/// Intervals after which a pair is left undecided, so that the time is bounded where depths stay near g.
const MAX_INTERVALS: usize = 2_000;

/// Of pairs with a block that is not convex, intervals of one length with which a pair is left undecided when more are not
/// certified: where the cover holds more than the block none ever is, and each takes hundreds of times as long as one of two
/// convex blocks.
const MAX_OPEN_OF_COVERS: usize = 16;

/// The pairs of moving blocks that could meet: their boxes over the whole step do, **touching included**. The lower number
/// first, in ascending order.
pub fn swept_neighbours(motions: &[StraightMotion<'_>]) -> Vec<[usize; 2]> {
    let boxes: Vec<Box3> = motions.iter().map(|motion| Box3::of_blocks(motion.ends())).collect();
    let mut pairs = meeting_pairs(&boxes);
    pairs.sort_unstable();
    pairs
}

/// Whether two moving blocks pass through one another. `penetration_limit` is g.
pub fn passage(a: &StraightMotion<'_>, b: &StraightMotion<'_>, penetration_limit: &Number) -> PassageReport {
    let moving = MovingPair::new(a, b, penetration_limit);
    let certificate = Certificate::new(&moving);
    let report = |answer, intervals| PassageReport { answer, intervals };
    // The whole step first: nearly every pair ends here, and its ends are not deep then.
    if certificate.is_free(&[BigInt::from(0), BigInt::from(1)], 0) {
        return report(PassageAnswer::NoPassage, 1);
    }
    let deeper_at = |time: &BigRational| {
        let [one, two] = [a, b].map(|motion| motion.block_at(time));
        let g = penetration_limit.to_rational();
        penetration(&one, &two).filter(|found| found.depth_squared() > &g * &g)
    };
    if [0, 1].iter().any(|&end| deeper_at(&BigRational::from_integer(end.into())).is_some()) {
        return report(PassageAnswer::DeepAtEnd, 1);
    }
    // Intervals of length 2^−halvings by the numbers of their starts in that length.
    let mut open = vec![BigInt::from(0)];
    let mut intervals = 1;
    for halvings in 1..=MAX_HALVINGS {
        let mut left = Vec::new();
        for start in open {
            let middle: BigInt = start * 2 + 1;
            let time = BigRational::new(middle.clone(), BigInt::from(1) << halvings);
            if let Some(depth) = deeper_at(&time) {
                return report(PassageAnswer::Passage { time, depth: Box::new(depth) }, intervals);
            }
            for ends in [[&middle - 1, middle.clone()], [middle.clone(), &middle + 1]] {
                intervals += 1;
                if !certificate.is_free(&ends, halvings) {
                    let [start, _] = ends;
                    left.push(start);
                }
            }
            if intervals > MAX_INTERVALS {
                return report(PassageAnswer::Undecided, intervals);
            }
        }
        open = left;
        if open.len() > MAX_OPEN_OF_COVERS && !(a.ends()[0].is_convex() && b.ends()[0].is_convex()) {
            return report(PassageAnswer::Undecided, intervals);
        }
        if open.is_empty() {
            return report(PassageAnswer::NoPassage, intervals);
        }
    }
    report(PassageAnswer::Undecided, intervals)
}
