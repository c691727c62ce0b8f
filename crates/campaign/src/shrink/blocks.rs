//! Makes the two blocks of a case smaller while it still shows its finding.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_differential::hull::convex_hull;
use rockproof_model::number::split_f64;
use rockproof_model::{Block, BlockOptions, Number, Point};

/// Makes blocks smaller.
pub(crate) struct BlockShrinker<'s> {
    /// Whether two blocks show the finding; `None` where no more may be examined.
    pub(crate) shows: &'s mut dyn FnMut(&[Block; 2]) -> Option<bool>,
    /// Whether no more may be examined.
    pub(crate) is_spent: bool,
}

/// Bits a rounded coordinate may keep, few first.
const FEWER_BITS: [u32; 7] = [3, 5, 8, 12, 16, 24, 40];

impl BlockShrinker<'_> {
    /// Tries each simplification once, one after the other.
    pub(crate) fn once(&mut self, best: &mut [Block; 2]) {
        self.recentre(best);
        self.drop_vertices(best);
        self.shorten_coordinates(best);
    }

    /// Tries them for as long as that helps.
    pub(crate) fn shrink(&mut self, best: &mut [Block; 2]) {
        loop {
            let before = size(best);
            self.once(best);
            if self.is_spent || size(best) >= before {
                break;
            }
        }
    }

    /// Replaces `best` by `proposal` if that is simpler and shows the finding.
    fn keep(&mut self, best: &mut [Block; 2], proposal: [Block; 2]) -> bool {
        if size(&proposal) >= size(best) || self.is_spent {
            return false;
        }
        let shown = (self.shows)(&proposal);
        self.is_spent = shown.is_none();
        let better = shown == Some(true);
        if better {
            *best = proposal;
        }
        better
    }

    /// Moves a vertex of A to the origin.
    fn recentre(&mut self, best: &mut [Block; 2]) {
        for vertex in 0..best[0].vertices().len().min(4) {
            let offset = best[0].vertices()[vertex].map(Number::negated);
            let proposal = best.each_ref().map(|block| block.translated(&offset));
            if self.keep(best, proposal) {
                return;
            }
        }
    }

    /// Takes the convex hull of all vertices but one, for as long as that works.
    fn drop_vertices(&mut self, best: &mut [Block; 2]) {
        for which in 0..2 {
            let mut vertex = 0;
            while vertex < best[which].vertices().len() && best[which].vertices().len() > 4 && !self.is_spent {
                let mut points = best[which].vertices().to_vec();
                points.remove(vertex);
                let Ok(smaller) = convex_hull(&points) else {
                    vertex += 1;
                    continue;
                };
                let mut proposal = best.clone();
                proposal[which] = smaller;
                if !self.keep(best, proposal) {
                    vertex += 1;
                }
            }
        }
    }

    /// Rounds coordinates to few bits: all at once on a common grid, then block by block, then number by number.
    fn shorten_coordinates(&mut self, best: &mut [Block; 2]) {
        let coordinates = best.iter().flat_map(Block::coordinates);
        let largest = coordinates.map(|c| c.approximate().abs()).fold(0.0, f64::max);
        if largest == 0.0 || !largest.is_finite() {
            return;
        }
        let top = largest.log2().ceil() as i32;
        for which in [&[0, 1][..], &[0], &[1]] {
            for bits in FEWER_BITS {
                let grid = top - bits as i32;
                let mut proposal = best.clone();
                let fits = which.iter().all(|&which| {
                    let block = &mut proposal[which];
                    let points = block.vertices().iter().map(|p| p.map(|c| on_grid(c, grid))).collect();
                    rebuilt(block, points).map(|b| *block = b).is_some()
                });
                if fits && self.keep(best, proposal) {
                    break;
                }
            }
        }
        for which in 0..2 {
            for vertex in 0..best[which].vertices().len() {
                for axis in 0..3 {
                    self.shorten_one(best, which, vertex, axis);
                }
            }
        }
    }

    fn shorten_one(&mut self, best: &mut [Block; 2], which: usize, vertex: usize, axis: usize) {
        let simpler = |c: &Number| {
            let value = c.approximate();
            let near = [0.0, value.round(), (value * 8.0).round() / 8.0, (value * 1024.0).round() / 1024.0];
            near.into_iter().filter_map(|n| Number::from_f64(n).ok()).filter(|n| bits(n) < bits(c)).collect::<Vec<_>>()
        };
        let Some(point) = best[which].vertices().get(vertex) else { return };
        for number in simpler(point.components()[axis]) {
            let mut proposal = best.clone();
            let block = &mut proposal[which];
            let mut points = block.vertices().to_vec();
            let Some(point) = points.get_mut(vertex) else { return };
            *[&mut point.x, &mut point.y, &mut point.z][axis] = number;
            if let Some(changed) = rebuilt(block, points) {
                *block = changed;
                if self.keep(best, proposal) {
                    return;
                }
            }
        }
    }
}

/// A block with its vertices moved a little: convex ones by their hull, so that faces which are no longer planar are
/// split; others only when every face is still planar and every edge bends the way it did.
fn rebuilt(block: &Block, points: Vec<Point>) -> Option<Block> {
    if block.vertices() == points {
        return None;
    }
    if block.is_convex() {
        return convex_hull(&points).ok();
    }
    let options = BlockOptions { planarity: Number::ZERO };
    Block::new(points, block.topology().faces().to_vec(), &options).ok()
}

/// The nearest multiple of 2^`exponent`, halves away from zero.
pub(super) fn on_grid(number: &Number, exponent: i32) -> Number {
    let unit = power(exponent);
    let steps = (number.to_rational() / &unit).round();
    Number::from_rational(steps * unit)
}

fn power(exponent: i32) -> BigRational {
    let power = BigRational::from_integer(BigInt::from(1) << exponent.unsigned_abs() as usize);
    if exponent < 0 { power.recip() } else { power }
}

/// What blocks cost their reader: features first, then bits.
pub(super) fn size(blocks: &[Block; 2]) -> (usize, u64) {
    let features = |b: &Block| b.vertices().len() + b.topology().faces().len();
    let numbers = blocks.iter().flat_map(Block::coordinates);
    (blocks.iter().map(features).sum(), numbers.map(bits).sum())
}

/// Bits needed to write a number down: those of its odd part, and of how far it is from 1.
pub(super) fn bits(number: &Number) -> u64 {
    match (number.as_f64(), number.as_ratio()) {
        (Some(0.0), _) | (None, None) => 0,
        (Some(value), _) => {
            let (significand, exponent) = split_f64(value);
            u64::from(64 - significand.unsigned_abs().leading_zeros())
                + u64::from(exponent.unsigned_abs().min(1100)) / 4
        }
        (None, Some(ratio)) => 2 + ratio.numer().bits() + ratio.denom().bits(),
    }
}
