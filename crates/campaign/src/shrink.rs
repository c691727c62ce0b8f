//! Makes a case smaller while it still shows the same finding: engine, cause, change, kind of
//! contact and deciding predicate.
//!
//! Greedy and deterministic: each step proposes a simpler case, and it is kept if it still shows the finding. Steps are
//! repeated until none helps or the allowed number of examinations is used up.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::case_file::Case;
use rockproof_differential::finding::{FAR, Finding};
use rockproof_differential::hull::convex_hull;
use rockproof_model::number::split_f64;
use rockproof_model::{Block, BlockOptions, Criteria, Number, Point};

/// Makes cases smaller.
pub struct Shrinker<'p> {
    panel: &'p EnginePanel,
    left: u64,
    /// The margin in roundoffs that the finding must keep, so that one far from any tie stays one.
    least: f64,
}

/// One of the two blocks of a case.
#[derive(Clone, Copy)]
enum CaseBlock {
    A,
    B,
}

impl CaseBlock {
    fn of(self, case: &mut Case) -> &mut Block {
        match self {
            CaseBlock::A => &mut case.a,
            CaseBlock::B => &mut case.b,
        }
    }
}

/// Bits a rounded coordinate may keep, few first.
const FEWER_BITS: [u32; 7] = [3, 5, 8, 12, 16, 24, 40];

impl<'p> Shrinker<'p> {
    /// A shrinker that may examine `evaluations` pairs. The panel should hold no engine the case is not about, and ask
    /// for metamorphic checks only where the case is about one.
    pub fn new(panel: &'p EnginePanel, evaluations: u64) -> Shrinker<'p> {
        Shrinker { panel, left: evaluations, least: 0.0 }
    }

    /// The smallest case found. A case that does not show its finding is returned as it is.
    pub fn shrink(mut self, case: Case) -> Case {
        self.least = case.about.margin_ulps.map(f64::abs).filter(|ulps| *ulps > FAR).map_or(0.0, |ulps| ulps / 10.0);
        let Some(finding) = self.reproduces(&case) else { return case };
        let mut best = case;
        best.describe(&finding, self.panel);
        loop {
            let before = size(&best);
            self.recentre(&mut best);
            self.drop_vertices(&mut best);
            self.shorten_coordinates(&mut best);
            self.simplify_tolerances(&mut best);
            if self.left == 0 || size(&best) >= before {
                break;
            }
        }
        if let Some(finding) = self.look(&best) {
            best.describe(&finding, self.panel);
        }
        best
    }

    fn reproduces(&mut self, case: &Case) -> Option<Finding> {
        self.left = self.left.checked_sub(1)?;
        self.look(case)
    }

    fn look(&self, case: &Case) -> Option<Finding> {
        let far_enough =
            |finding: &Finding| self.least == 0.0 || finding.margin_ulps().is_some_and(|u| u.abs() >= self.least);
        case.findings(self.panel).into_iter().find(far_enough)
    }

    /// Replaces `best` by `proposal` if that is simpler and shows the finding.
    fn keep(&mut self, best: &mut Case, proposal: Case) -> bool {
        let better = size(&proposal) < size(best) && self.reproduces(&proposal).is_some();
        if better {
            *best = proposal;
        }
        better
    }

    /// Moves a vertex of A to the origin.
    fn recentre(&mut self, best: &mut Case) {
        for vertex in 0..best.a.vertices().len().min(4) {
            let offset = best.a.vertices()[vertex].map(Number::negated);
            let proposal = Case { a: best.a.translated(&offset), b: best.b.translated(&offset), ..best.clone() };
            if self.keep(best, proposal) {
                return;
            }
        }
    }

    /// Takes the convex hull of all vertices but one, for as long as that works.
    fn drop_vertices(&mut self, best: &mut Case) {
        for which in [CaseBlock::A, CaseBlock::B] {
            let mut vertex = 0;
            while vertex < which.of(best).vertices().len() && which.of(best).vertices().len() > 4 && self.left > 0 {
                let mut proposal = best.clone();
                let block = which.of(&mut proposal);
                let mut points = block.vertices().to_vec();
                points.remove(vertex);
                let Ok(smaller) = convex_hull(&points) else {
                    vertex += 1;
                    continue;
                };
                *block = smaller;
                if !self.keep(best, proposal) {
                    vertex += 1;
                }
            }
        }
    }

    /// Rounds coordinates to few bits: all at once on a common grid, then block by block, then number by number.
    fn shorten_coordinates(&mut self, best: &mut Case) {
        let largest =
            best.a.coordinates().chain(best.b.coordinates()).map(|c| c.approximate().abs()).fold(0.0, f64::max);
        if largest == 0.0 || !largest.is_finite() {
            return;
        }
        let top = largest.log2().ceil() as i32;
        for which in [&[CaseBlock::A, CaseBlock::B][..], &[CaseBlock::A], &[CaseBlock::B]] {
            for bits in FEWER_BITS {
                let grid = top - bits as i32;
                let mut proposal = best.clone();
                let fits = which.iter().all(|w| {
                    let block = w.of(&mut proposal);
                    let points = block.vertices().iter().map(|p| p.map(|c| on_grid(c, grid))).collect();
                    rebuilt(block, points).map(|b| *block = b).is_some()
                });
                if fits && self.keep(best, proposal) {
                    break;
                }
            }
        }
        for which in [CaseBlock::A, CaseBlock::B] {
            for vertex in 0..which.of(best).vertices().len() {
                for axis in 0..3 {
                    self.shorten_one(best, which, vertex, axis);
                }
            }
        }
    }

    fn shorten_one(&mut self, best: &mut Case, which: CaseBlock, vertex: usize, axis: usize) {
        let simpler = |c: &Number| {
            let value = c.approximate();
            let near = [0.0, value.round(), (value * 8.0).round() / 8.0, (value * 1024.0).round() / 1024.0];
            near.into_iter().filter_map(|n| Number::from_f64(n).ok()).filter(|n| bits(n) < bits(c)).collect::<Vec<_>>()
        };
        let Some(point) = which.of(best).vertices().get(vertex) else { return };
        for number in simpler(point.components()[axis]) {
            let mut proposal = best.clone();
            let block = which.of(&mut proposal);
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

    /// Ideal tolerances, zeros and short numbers where they do.
    fn simplify_tolerances(&mut self, best: &mut Case) {
        if best.tolerances.criteria == Criteria::Classic {
            let mut proposal = best.clone();
            proposal.tolerances.criteria = Criteria::Revised;
            self.keep(best, proposal);
        }
        for place in 0..best.tolerances.numbers().len() {
            let number = best.tolerances.numbers()[place].1.clone();
            if number.is_zero() {
                continue;
            }
            let mut simpler = vec![Number::ZERO];
            let value = number.approximate();
            if value.is_finite() && value != 0.0 {
                let top = value.abs().log2().ceil() as i32;
                simpler.extend([1, 2, 4, 8, 16].map(|bits| on_grid(&number, top - bits)));
            }
            for shorter in simpler.into_iter().filter(|n| bits(n) < bits(&number)) {
                let mut proposal = best.clone();
                *proposal.tolerances.numbers_mut()[place].1 = shorter;
                if self.keep(best, proposal) {
                    break;
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
fn on_grid(number: &Number, exponent: i32) -> Number {
    let unit = power(exponent);
    let steps = (number.to_rational() / &unit).round();
    Number::from_rational(steps * unit)
}

fn power(exponent: i32) -> BigRational {
    let power = BigRational::from_integer(BigInt::from(1) << exponent.unsigned_abs() as usize);
    if exponent < 0 { power.recip() } else { power }
}

/// What a case costs its reader: features first, then bits, then tolerances that matter.
fn size(case: &Case) -> (usize, u64) {
    let features = |b: &Block| b.vertices().len() + b.topology().faces().len();
    let numbers = case.a.coordinates().chain(case.b.coordinates()).chain(case.tolerances.numbers().map(|(_, n)| n));
    let criteria = u64::from(case.tolerances.criteria == Criteria::Classic);
    (features(&case.a) + features(&case.b), numbers.map(bits).sum::<u64>() + criteria)
}

/// Bits needed to write a number down: those of its odd part, and of how far it is from 1.
fn bits(number: &Number) -> u64 {
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
