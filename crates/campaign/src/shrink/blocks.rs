//! Makes the two blocks of a case smaller while it still shows its finding.

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_differential::hull::Hull;
use rockproof_model::number::{power_of_two, split_f64};
use rockproof_model::{Block, BlockOptions, Number, Point};
use std::collections::HashMap;

/// What is asked of two blocks.
pub(crate) enum BlockQuestion<'b> {
    /// Whether they show the finding.
    Now(&'b [Block; 2]),
    /// The same as before of a case that has not changed since, when the answer was no: it counts as an examination.
    Again,
}

/// Whether two blocks show the finding; `None` where no more may be examined.
pub(crate) type Shows<'s> = dyn FnMut(BlockQuestion<'_>) -> Option<bool> + 's;

/// A simplification: what is simplified, by numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Attempt {
    Recentre { vertex: usize },
    Drop { block: usize, vertex: usize },
    Round { blocks: [bool; 2], grid: i32 },
    Shorten { block: usize, vertex: usize, axis: usize, choice: usize },
    Revise,
    Tolerance { place: usize, choice: usize },
}

/// Which simplifications of a case were refused. What follows from the case alone is refused again as long as the case is the same.
#[derive(Default)]
pub(crate) struct Refusals {
    /// How often the case has changed.
    changes: u64,
    /// After how many changes an attempt was refused, and whether the finding was asked for.
    refused: HashMap<Attempt, (u64, bool)>,
}

impl Refusals {
    /// Whether the finding was asked for when the attempt was refused, if that was so of the case as it is.
    pub(super) fn known(&self, attempt: Attempt) -> Option<bool> {
        let (changes, was_asked) = self.refused.get(&attempt)?;
        (*changes == self.changes).then_some(*was_asked)
    }

    pub(super) fn refuse(&mut self, attempt: Attempt, was_asked: bool) {
        self.refused.insert(attempt, (self.changes, was_asked));
    }

    pub(super) fn case_changed(&mut self) {
        self.changes += 1;
    }
}

/// Makes blocks smaller.
pub(crate) struct BlockShrinker<'s> {
    pub(crate) shows: &'s mut Shows<'s>,
    /// Whether no more may be examined.
    pub(crate) is_spent: bool,
    pub(crate) refusals: &'s mut Refusals,
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

    /// Replaces `best` by what is proposed for it, if anything is, if that is simpler and shows the finding.
    fn keep(
        &mut self,
        best: &mut [Block; 2],
        attempt: Attempt,
        propose: impl FnOnce(&[Block; 2]) -> Option<[Block; 2]>,
    ) -> bool {
        if self.is_spent {
            return false;
        }
        if let Some(was_asked) = self.refusals.known(attempt) {
            self.is_spent = was_asked && (self.shows)(BlockQuestion::Again).is_none();
            return false;
        }
        let Some(proposal) = propose(best).filter(|proposal| size(proposal) < size(best)) else {
            self.refusals.refuse(attempt, false);
            return false;
        };
        match (self.shows)(BlockQuestion::Now(&proposal)) {
            Some(true) => {
                *best = proposal;
                self.refusals.case_changed();
                return true;
            }
            Some(false) => self.refusals.refuse(attempt, true),
            None => self.is_spent = true,
        }
        false
    }

    /// Moves a vertex of A to the origin.
    fn recentre(&mut self, best: &mut [Block; 2]) {
        for vertex in 0..best[0].vertices().len().min(4) {
            let recentred = |best: &[Block; 2]| {
                let offset = best[0].vertices()[vertex].map(Number::negated);
                Some(best.each_ref().map(|block| block.translated(&offset)))
            };
            if self.keep(best, Attempt::Recentre { vertex }, recentred) {
                return;
            }
        }
    }

    /// Takes the convex hull of all vertices but one, for as long as that works.
    fn drop_vertices(&mut self, best: &mut [Block; 2]) {
        for block in 0..2 {
            let mut vertex = 0;
            while vertex < best[block].vertices().len() && best[block].vertices().len() > 4 && !self.is_spent {
                let without = |best: &[Block; 2]| {
                    let mut points = best[block].vertices().to_vec();
                    points.remove(vertex);
                    simpler(best, with_shape(best, block, Shape::Hull(Hull::of(&points).ok()?)))
                };
                if !self.keep(best, Attempt::Drop { block, vertex }, without) {
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
        for blocks in [[true, true], [true, false], [false, true]] {
            for grid in FEWER_BITS.map(|bits| top - bits as i32) {
                let rounded = |best: &[Block; 2]| {
                    let on_grid = |p: &Point| p.map(|c| on_grid(c, grid));
                    let shape = |block: usize| match blocks[block] {
                        true => moved(&best[block], best[block].vertices().iter().map(on_grid).collect()),
                        false => Some(Shape::Same(&best[block])),
                    };
                    simpler(best, [shape(0)?, shape(1)?])
                };
                if self.keep(best, Attempt::Round { blocks, grid }, rounded) {
                    break;
                }
            }
        }
        for block in 0..2 {
            for vertex in 0..best[block].vertices().len() {
                for axis in 0..3 {
                    self.shorten_one(best, block, vertex, axis);
                }
            }
        }
    }

    fn shorten_one(&mut self, best: &mut [Block; 2], block: usize, vertex: usize, axis: usize) {
        let shorter = |c: &Number| {
            let value = c.approximate();
            let near = [0.0, value.round(), (value * 8.0).round() / 8.0, (value * 1024.0).round() / 1024.0];
            near.into_iter().filter_map(|n| Number::from_f64(n).ok()).filter(|n| bits(n) < bits(c)).collect::<Vec<_>>()
        };
        let Some(point) = best[block].vertices().get(vertex) else { return };
        for (choice, number) in shorter(point.components()[axis]).into_iter().enumerate() {
            let shortened = |best: &[Block; 2]| {
                let mut points = best[block].vertices().to_vec();
                let point = &mut points[vertex];
                *[&mut point.x, &mut point.y, &mut point.z][axis] = number;
                simpler(best, with_shape(best, block, moved(&best[block], points)?))
            };
            if self.keep(best, Attempt::Shorten { block, vertex, axis, choice }, shortened) {
                return;
            }
        }
    }
}

/// What a block would become.
enum Shape<'b> {
    Same(&'b Block),
    Hull(Hull),
    /// The faces of a block with other vertices.
    Moved(Vec<Point>, &'b Block),
}

impl Shape<'_> {
    fn size(&self) -> (usize, u64) {
        match self {
            Shape::Same(block) => size_of(block.vertices(), block.topology().faces().len()),
            Shape::Hull(hull) => size_of(hull.vertices(), hull.face_count()),
            Shape::Moved(points, block) => size_of(points, block.topology().faces().len()),
        }
    }

    fn into_block(self) -> Option<Block> {
        match self {
            Shape::Same(block) => Some(block.clone()),
            Shape::Hull(hull) => hull.into_block().ok(),
            Shape::Moved(points, block) => {
                let options = BlockOptions { planarity: Number::ZERO };
                Block::new(points, block.topology().faces().to_vec(), &options).ok()
            }
        }
    }
}

/// Blocks of these shapes if they are smaller than `best`. Most are not, since a vertex that is moved cuts the faces at it into triangles; to see that
/// first spares making them.
fn simpler(best: &[Block; 2], shapes: [Shape<'_>; 2]) -> Option<[Block; 2]> {
    if sum(shapes.each_ref().map(Shape::size)) >= size(best) {
        return None;
    }
    let [a, b] = shapes.map(Shape::into_block);
    Some([a?, b?])
}

fn with_shape<'b>(best: &'b [Block; 2], which: usize, shape: Shape<'b>) -> [Shape<'b>; 2] {
    let mut shapes = best.each_ref().map(Shape::Same);
    shapes[which] = shape;
    shapes
}

/// A block with its vertices moved a little: convex ones by their hull, so that faces which are no longer planar are
/// split; others only when every face is still planar and every edge bends the way it did.
fn moved(block: &Block, points: Vec<Point>) -> Option<Shape<'_>> {
    if block.vertices() == points {
        return None;
    }
    if block.is_convex() { Hull::of(&points).ok().map(Shape::Hull) } else { Some(Shape::Moved(points, block)) }
}

/// The nearest multiple of 2^`exponent`, halves away from zero.
pub(super) fn on_grid(number: &Number, exponent: i32) -> Number {
    number.as_f64().and_then(|value| f64_on_grid(value, exponent)).unwrap_or_else(|| any_on_grid(number, exponent))
}

/// The same of an f64, in whole numbers of a register; `None` where the answer is beyond every f64.
fn f64_on_grid(value: f64, exponent: i32) -> Option<Number> {
    let (odd, own) = split_f64(value);
    // Not positive where the value is on the grid as it is.
    let dropped = exponent.saturating_sub(own);
    let steps = match dropped {
        ..=0 => return Number::from_f64(value).ok(),
        // Below 2^53, so half of the lowest bit that is kept can be added, and of more bits nothing is left.
        1..=62 => (odd.unsigned_abs() + (1 << (dropped - 1))) >> dropped,
        _ => 0,
    };
    if steps == 0 {
        return Some(Number::ZERO);
    }
    if exponent > 1023 {
        return None;
    }
    Number::from_f64((steps as f64 * power_of_two(exponent)).copysign(value)).ok()
}

fn any_on_grid(number: &Number, exponent: i32) -> Number {
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
    sum(blocks.each_ref().map(|block| Shape::Same(block).size()))
}

fn size_of(vertices: &[Point], faces: usize) -> (usize, u64) {
    let numbers = vertices.iter().flat_map(Point::components);
    (vertices.len() + faces, numbers.map(bits).sum())
}

fn sum(sizes: [(usize, u64); 2]) -> (usize, u64) {
    let [(features, bits), (others, other_bits)] = sizes;
    (features + others, bits + other_bits)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: i32, y: i32, z: i32) -> Point {
        let [x, y, z] = [x, y, z].map(Number::from_integer);
        Point::new(x, y, z)
    }

    fn third() -> Number {
        Number::from_rational(BigRational::new(1.into(), 3.into()))
    }

    /// Grids finer and coarser than a value, halves, zeros, the ends of f64, and values that no f64 has.
    #[test]
    fn numbers_on_a_grid_are_those_that_fractions_find() {
        let mut values = vec![0.0, -0.0, f64::MAX, -f64::MAX, f64::MIN_POSITIVE, f64::from_bits(1), f64::from_bits(3)];
        for k in 1..40 {
            let k = f64::from(k);
            values.extend([k / 8.0, -k / 8.0, k.sqrt(), -k * 1e-9, (k * 0.37).exp2(), k * 1e300, k * 3e-310]);
        }
        for value in values {
            let number = Number::from_f64(value).expect("finite");
            let near = split_f64(value).1;
            let grids = (-2..60).map(|above| near + above).chain([-1080, -1074, -40, -3, 0, 5, 1000, 1023, 1024]);
            for exponent in grids {
                let found = on_grid(&number, exponent);
                let sought = any_on_grid(&number, exponent);
                assert_eq!(found, sought, "{value:e} on a grid of 2^{exponent}");
                assert_eq!(found.as_f64().map(f64::to_bits), sought.as_f64().map(f64::to_bits));
            }
        }
        assert_eq!(on_grid(&third(), -1), Number::from_f64(0.5).expect("finite"));
    }

    /// How often it was asked now and again in one round in which every finding is gone but that of the blocks as they are.
    fn round(blocks: &mut [Block; 2], refusals: &mut Refusals) -> [usize; 2] {
        let mut asked = [0; 2];
        let mut shows = |ask: BlockQuestion<'_>| {
            asked[usize::from(matches!(ask, BlockQuestion::Again))] += 1;
            Some(false)
        };
        BlockShrinker { shows: &mut shows, is_spent: false, refusals }.once(blocks);
        asked
    }

    #[test]
    fn what_was_refused_is_looked_at_again_only_after_a_change() {
        let cuboid = |a: Point, b: Point| {
            Block::cuboid(&a, &b).expect("a block").translated(&Point::new(third(), third(), third()))
        };
        let mut blocks = [cuboid(at(0, 0, 0), at(3, 5, 7)), cuboid(at(1, 1, 1), at(4, 6, 9))];
        let mut refusals = Refusals::default();
        let [first, again] = round(&mut blocks, &mut refusals);
        assert!(first > 10 && again == 0, "{first} {again}");
        assert_eq!(round(&mut blocks, &mut refusals), [0, first], "all count once more");
        refusals.case_changed();
        assert_eq!(round(&mut blocks, &mut refusals), [first, 0]);
    }

    #[test]
    fn a_refusal_that_is_repeated_counts_as_an_examination() {
        let mut blocks = [at(0, 0, 0), at(1, 1, 1)].map(|low| {
            Block::cuboid(&low, &at(5, 7, 9)).expect("a block").translated(&Point::new(third(), third(), third()))
        });
        let mut refusals = Refusals::default();
        let [asked, _] = round(&mut blocks, &mut refusals);
        let mut left = asked - 1;
        let mut shows = |_: BlockQuestion<'_>| {
            left = left.checked_sub(1)?;
            Some(false)
        };
        let mut shrinker = BlockShrinker { shows: &mut shows, is_spent: false, refusals: &mut refusals };
        shrinker.once(&mut blocks);
        assert!(shrinker.is_spent);
    }
}
