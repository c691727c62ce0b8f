//! The convex hulls of two blocks on a common lattice, exact and in f64.

use super::slab::{Direction, Slab};
use crate::hull::convex_hull;
use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::{ExactRing, Ring};
use rockproof_model::{Block, Vec3, VertexId};

/// Vertices of a block beyond which its hull is not worked out: that takes the fourth power of their number.
const MAX_VERTICES: usize = 48;

/// A convex hull in numbers of some kind.
pub(super) struct Hull<T> {
    pub(super) points: Vec<Vec3<T>>,
    /// Three corners of each face, in the order in which the outside sees them turn to the left.
    pub(super) faces: Vec<[usize; 3]>,
    pub(super) edges: Vec<[usize; 2]>,
}

impl<T: Ring> Hull<T> {
    /// The normal of a face, outwards.
    pub(super) fn normal(&self, face: usize) -> Vec3<T> {
        let [p, q, r] = self.faces[face];
        self.direction([p, q]).cross(&self.direction([q, r]))
    }

    pub(super) fn direction(&self, [p, q]: [usize; 2]) -> Vec3<T> {
        self.points[q].minus(&self.points[p])
    }
}

impl Hull<BigInt> {
    /// The hull of a block on the lattice; `None` where it has too many vertices or no volume.
    pub(super) fn of(block: &Block, lattice: &Lattice) -> Option<Self> {
        if block.vertices().len() > MAX_VERTICES {
            return None;
        }
        let hull = Hull::as_it_is(block, lattice);
        if hull.holds_its_points(block) {
            return Some(hull);
        }
        Some(Hull::as_it_is(&convex_hull(block.vertices()).ok()?, lattice))
    }

    fn as_it_is(block: &Block, lattice: &Lattice) -> Self {
        let topology = block.topology();
        Hull {
            points: block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect(),
            faces: topology.faces().iter().map(|f| [f[0], f[1], f[2]].map(VertexId::index)).collect(),
            edges: topology.edges().iter().map(|e| [e.p.index(), e.q.index()]).collect(),
        }
    }

    /// Whether every face is planar and no vertex lies beyond one: then the block is its own hull.
    fn holds_its_points(&self, block: &Block) -> bool {
        block.topology().faces().iter().enumerate().all(|(number, face)| {
            let normal = self.normal(number);
            let base = normal.dot(&self.points[face[0].index()]);
            !is_zero(&normal)
                && self.points.iter().zip((0..).map(VertexId)).all(|(point, number)| {
                    let sign = ExactRing::sign(&normal.dot(point).minus(&base));
                    sign.is_at_most_zero() && (sign.is_zero() || !face.contains(&number))
                })
        })
    }
}

pub(super) fn is_zero(vector: &Vec3<BigInt>) -> bool {
    vector.components().iter().all(|c| c.is_zero())
}

/// Two hulls on one lattice. The same in f64 tells most directions whose slab is certainly not the widest.
pub(super) struct HullPair {
    pub(super) exact: [Hull<BigInt>; 2],
    near: [Hull<Near>; 2],
}

/// 2⁻⁵²: twice what one rounding of a number near 1 takes.
const EPSILON: f64 = f64::EPSILON;

impl HullPair {
    pub(super) fn new(a: Hull<BigInt>, b: Hull<BigInt>) -> HullPair {
        let exact = [a, b];
        let (seen, bits) = seen_from_a_point(&exact);
        let near = [0, 1].map(|side: usize| Hull {
            points: seen[side].iter().map(|p| p.map(|c| Near::of(c, bits))).collect(),
            faces: exact[side].faces.clone(),
            edges: exact[side].edges.clone(),
        });
        HullPair { exact, near }
    }

    /// The widest slab across some directions, the first of equal ones; `None` where none of them is a direction.
    pub(super) fn widest(&self, directions: Vec<Direction>) -> Option<Slab> {
        let bounds: Vec<[f64; 2]> = directions.iter().map(|&direction| self.bounds(direction)).collect();
        let certain = bounds.iter().map(|bounds| bounds[0]).fold(f64::NEG_INFINITY, f64::max);
        let possible = directions.into_iter().zip(bounds).filter(|(_, bounds)| bounds[1] >= certain);
        possible.filter_map(|(direction, _)| self.slab(direction)).reduce(Slab::wider)
    }

    /// The slab across a direction; `None` for none.
    fn slab(&self, direction: Direction) -> Option<Slab> {
        let [a, b] = &self.exact;
        Slab::across(a, b, &direction.of(a, b))
    }

    /// What the width of a slab is at least and at most, in the unit of the hulls in f64; everything where these know nothing.
    ///
    /// With ε = 2⁻⁵², coordinates are at most 1 and off by ε at most, so parts of an edge by 3.01 ε, of the product of two edges by 33 ε, and of the
    /// longest direction, which is of the third power, by 341 ε: of any by 512 ε. A dot product of a point with a direction whose largest part
    /// is N is then off by 3·512 ε + 3·N·ε from both and by less than 5·N·ε in rounding, a width by twice that and 3·N·ε.
    fn bounds(&self, direction: Direction) -> [f64; 2] {
        let [a, b] = &self.near;
        let direction = direction.of(a, b);
        let least = |hull: &Hull<Near>| hull.points.iter().map(|p| p.dot(&direction).0).fold(f64::INFINITY, f64::min);
        let most =
            |hull: &Hull<Near>| hull.points.iter().map(|p| p.dot(&direction).0).fold(f64::NEG_INFINITY, f64::max);
        let width = least(a) - most(b);
        let largest = direction.components().iter().map(|c| c.0.abs()).fold(0.0, f64::max);
        let off = (3_072.0 + 20.0 * largest) * EPSILON;
        let length = direction.dot(&direction).0.sqrt();
        let lengths =
            [length * (1.0 - 8.0 * EPSILON) - 900.0 * EPSILON, length * (1.0 + 8.0 * EPSILON) + 900.0 * EPSILON];
        if lengths[0] <= 0.0 {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let [low, high] = [width - off, width + off];
        // A quotient is rounded by far less than what its numerator was widened by.
        let low = low / if low > 0.0 { lengths[1] } else { lengths[0] };
        let high = high / if high > 0.0 { lengths[0] } else { lengths[1] };
        [low.next_down(), high.next_up()]
    }
}

/// The points of both hulls from one of them, so that a pair far from the origin loses nothing, and the bits of the longest coordinate.
fn seen_from_a_point(hulls: &[Hull<BigInt>; 2]) -> ([Vec<Vec3<BigInt>>; 2], u64) {
    let origin = &hulls[0].points[0];
    let seen: [Vec<Vec3<BigInt>>; 2] =
        [0, 1].map(|side: usize| hulls[side].points.iter().map(|p| p.minus(origin)).collect());
    let bits = seen.iter().flatten().flat_map(|p| p.components().map(BigInt::bits)).max().unwrap_or(0);
    (seen, bits)
}

/// A number in f64 whose error the reader bounds.
#[derive(Clone, Debug)]
struct Near(f64);

impl Near {
    /// An integer of at most so many bits, divided by 2 to their power: within 2⁻⁵².
    fn of(value: &BigInt, bits: u64) -> Near {
        // 64 bits below the highest are more than f64 holds.
        let dropped = bits.saturating_sub(64);
        let rounded = (value >> dropped).to_f64().unwrap_or(f64::NAN);
        Near(rounded / 2f64.powi((bits - dropped) as i32))
    }
}

impl Ring for Near {
    fn from_i32(value: i32) -> Self {
        Near(value.into())
    }
    fn plus(&self, other: &Self) -> Self {
        Near(self.0 + other.0)
    }
    fn minus(&self, other: &Self) -> Self {
        Near(self.0 - other.0)
    }
    fn times(&self, other: &Self) -> Self {
        Near(self.0 * other.0)
    }
    fn negated(&self) -> Self {
        Near(-self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{Number, Point};

    /// Numbers at random that are the same in every run.
    struct Dice(u64);

    impl Dice {
        fn below(&mut self, n: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) % n
        }

        /// On a grid of few points, where much is parallel and much ties; with all digits of f64; or few steps from a grid.
        fn coordinate(&mut self, sort: u64) -> f64 {
            let grid = self.below(4) as f64;
            match sort {
                0 => grid,
                1 => grid / 3.0 + (self.below(1 << 31) as f64) * 2f64.powi(-31),
                _ => grid + (self.below(3) as f64 - 1.0) * f64::EPSILON,
            }
        }
    }

    fn block(dice: &mut Dice, sort: u64, shift: [f64; 3]) -> Option<Block> {
        let number = |value: f64| Number::from_f64(value).expect("finite");
        let mut point = || {
            let [x, y, z] = shift.map(|shift| number(dice.coordinate(sort)).plus(&number(shift)));
            Point::new(x, y, z)
        };
        let points: Vec<Point> = (0..6).map(|_| point()).collect();
        convex_hull(&points).ok()
    }

    /// The sign of `bound` · |direction| − width, by the squares with their signs, times the square of the bound's denominator.
    fn compared(bound: f64, slab: &Slab, bits: u64) -> std::cmp::Ordering {
        if bound.is_infinite() {
            return bound.total_cmp(&0.0);
        }
        let (numerator, denominator) = Number::from_f64(bound).expect("finite").to_rational().into_raw();
        let signed_square = |x: BigInt| if x < BigInt::ZERO { -(&x * &x) } else { &x * &x };
        (signed_square(numerator << bits) * &slab.length2).cmp(&signed_square(&slab.width * denominator))
    }

    #[test]
    fn bounds_hold_every_width_and_the_widest_slab_is_that_of_all_directions() {
        hold_every_width(60);
    }

    #[test]
    #[ignore = "five seconds; .ci/run runs it"]
    fn bounds_hold_every_width_and_the_widest_slab_is_that_of_all_directions_at_full_size() {
        hold_every_width(120);
    }

    fn hold_every_width(rounds: u64) {
        let mut dice = Dice(3);
        let (mut lists, mut all, mut left) = (0, 0, 0);
        for round in 0..rounds {
            let sort = round % 3;
            // Apart, near and inside one another; far from the origin; far from one another.
            let shift = [[0.0; 3], [2.5, 0.0, 1.0], [1e6, 0.0, 0.0], [4.0, 1e5, -1.0]][round as usize / 3 % 4];
            let near = if shift[0] > 1e5 { [1e6 - 2.0, 0.0, 1.0] } else { [0.0; 3] };
            let (Some(a), Some(b)) = (block(&mut dice, sort, shift), block(&mut dice, sort, near)) else { continue };
            let lattice = Lattice::covering(a.coordinates().chain(b.coordinates()));
            let (Some(of_a), Some(of_b)) = (Hull::of(&a, &lattice), Hull::of(&b, &lattice)) else { continue };
            let pair = HullPair::new(of_a, of_b);
            let (_, bits) = seen_from_a_point(&pair.exact);
            for directions in [Direction::across_features(&pair), Direction::across_points(&pair)] {
                let mut slabs = Vec::new();
                let (mut certain, mut highest) = (f64::NEG_INFINITY, Vec::new());
                for &direction in &directions {
                    let [low, high] = pair.bounds(direction);
                    certain = certain.max(low);
                    highest.push(high);
                    let Some(slab) = pair.slab(direction) else {
                        assert!(low.is_infinite() && high.is_infinite(), "{direction:?} is none");
                        continue;
                    };
                    assert!(compared(low, &slab, bits).is_le(), "{direction:?} of round {round}");
                    assert!(compared(high, &slab, bits).is_ge(), "{direction:?} of round {round}");
                    slabs.push(slab);
                }
                lists += 1;
                all += directions.len();
                left += highest.into_iter().filter(|high| *high >= certain).count();
                let widest = slabs.into_iter().reduce(Slab::wider).map(|slab| (slab.width, slab.length2));
                let found = pair.widest(directions).map(|slab| (slab.width, slab.length2));
                assert_eq!(found, widest, "round {round}");
            }
        }
        assert!(lists * 6 > rounds * 5, "{lists} lists of directions");
        // It leaves few: else it is of no use.
        assert!(left * 4 < all, "{left} of {all} directions left");
    }
}
