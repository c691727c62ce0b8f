//! The least translation that parts two convex blocks.
//!
//! A translation along a unit vector n, from B to A, parts the blocks when it brings A's lowest point along n up to B's
//! highest. The least one is along the normal of a face of the Minkowski difference of the blocks (S. Cameron and R.
//! K. Culley, 1986): a face normal of A or of B, or a cross product of an edge of each. Every direction gives a
//! translation that parts them, so trying all of these, whether or not they are faces there, gives the least.
//! For blocks apart the same calculation gives the widest slab between them that is normal to one of these directions.
//!
//! f64 first measures all directions; those that it does not prove worse than another are measured exactly.

use super::{LatticePair, Penetration, compare, near};
use crate::Gap;
use crate::f64_vector::{cross, dot};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, EdgeId, FaceId, Vec3};

/// The direction with the largest gap; `None` where no direction has a length.
pub(super) fn least_translation(pair: &LatticePair<'_>) -> Option<Penetration> {
    let rough = F64Pair::new(pair);
    let gaps = rough.measured();
    let best = gaps.iter().map(|&(_, gap)| gap - rough.doubt).fold(f64::NEG_INFINITY, f64::max);
    let mut found: Option<(Vec3<BigInt>, BigInt, BigInt)> = None;
    // Whatever is not a number decides nothing.
    for (direction, _) in gaps.iter().filter(|&&(_, gap)| gap.is_nan() || best.is_nan() || gap + rough.doubt >= best) {
        let n = direction.exactly(pair);
        let square = n.norm_squared();
        if Zero::is_zero(&square) {
            continue;
        }
        let (Some(low), Some(high)) =
            (pair.points[0].iter().map(|p| n.dot(p)).min(), pair.points[1].iter().map(|p| n.dot(p)).max())
        else {
            continue;
        };
        let gap = low - high;
        let signed = |gap: &BigInt| gap * gap.abs();
        let above = |(_, other, other_square): &(Vec3<BigInt>, BigInt, BigInt)| {
            compare((&signed(&gap), &square), (&signed(other), other_square)).is_gt()
        };
        if found.as_ref().is_none_or(above) {
            found = Some((n, gap, square));
        }
    }
    let (n, gap, square) = found?;
    let direction = n.map(|c| BigRational::from_integer(c.clone()));
    Some(Penetration {
        gap: Gap { sign: ExactRing::sign(&gap), squared: pair.square_metres(&gap * &gap, square) },
        direction,
    })
}

/// At least and at most how deep the blocks overlap, in m; zero for blocks apart.
pub(super) fn rough_depth(pair: &LatticePair<'_>) -> (f64, f64) {
    let rough = F64Pair::new(pair);
    let gaps = rough.measured().into_iter().map(|(_, gap)| if gap.is_nan() { f64::INFINITY } else { gap });
    let gap = gaps.fold(f64::NEG_INFINITY, f64::max);
    if !gap.is_finite() {
        return (0.0, f64::INFINITY);
    }
    let metre = near(&pair.scale.0) / near(&pair.scale.1);
    let (least, most) = ((-gap - rough.doubt) / metre, (-gap + rough.doubt) / metre);
    let slack = 8.0 * f64::EPSILON;
    (least.max(0.0) * (1.0 - slack), if most.is_nan() { f64::INFINITY } else { most.max(0.0) * (1.0 + slack) })
}

/// A direction in which the blocks may part.
#[derive(Clone, Copy, Debug)]
enum Direction {
    /// Against a face of A.
    OfA(FaceId),
    /// Along a face of B.
    OfB(FaceId),
    /// Along the cross product of an edge of A with one of B, or against it.
    Edges(EdgeId, EdgeId, bool),
}

impl Direction {
    fn exactly(self, pair: &LatticePair<'_>) -> Vec3<BigInt> {
        let face = |side: usize, face: FaceId| face_normal(&pair.points[side], pair.blocks[side].topology().face(face));
        match self {
            Direction::OfA(f) => face(0, f).negated(),
            Direction::OfB(f) => face(1, f),
            Direction::Edges(one, two, against) => {
                let n = edge(pair, 0, one).cross(&edge(pair, 1, two));
                if against { n.negated() } else { n }
            }
        }
    }
}

fn edge(pair: &LatticePair<'_>, side: usize, edge: EdgeId) -> Vec3<BigInt> {
    let ends = pair.blocks[side].topology().edge(edge);
    pair.points[side][ends.q.index()].minus(&pair.points[side][ends.p.index()])
}

/// Both blocks in f64, in lattice units from the first vertex of A.
struct F64Pair<'p, 'a> {
    pair: &'p LatticePair<'a>,
    points: [Vec<[f64; 3]>; 2],
    /// No gap is off by more (lattice units) but of edges that are nearly parallel.
    doubt: f64,
}

/// The gap along a cross product shorter than this share of its factors' lengths is less certain, the shorter the less.
const PARALLEL: f64 = 1.0 / 1024.0;

/// A cross product shorter than this share is formed exactly, then rounded.
const FORMED_EXACTLY: f64 = PARALLEL * PARALLEL * PARALLEL * PARALLEL;

/// A direction and the gap along it in f64, in lattice units, which is off by no more than `doubt`.
struct MeasuredGap {
    direction: Direction,
    gap: f64,
    doubt: f64,
}

impl<'p, 'a> F64Pair<'p, 'a> {
    fn new(pair: &'p LatticePair<'a>) -> F64Pair<'p, 'a> {
        let origin = &pair.points[0][0];
        let side = |side: usize| -> Vec<[f64; 3]> {
            let relative = pair.points[side].iter().map(|p| p.minus(origin));
            relative.map(|p| [near(&p.x), near(&p.y), near(&p.z)]).collect()
        };
        let points = [side(0), side(1)];
        let size = points.iter().flatten().flatten().fold(0.0f64, |most, c| most.max(c.abs()));
        // Edges and face normals are within a roundoff of the exact ones, cross products no shorter than
        // `PARALLEL`, or exact: the angle to the exact direction is below 2⁻³⁶. Turning a direction by an angle moves a gap
        // by that angle times the distance of two points, below 4·size. A cross product of rounded edges is off by at most
        // 8 roundoffs of the product of their lengths, so that of a share x of it the angle is below 2⁻⁴⁹/x: 2⁻⁹ at
        // `FORMED_EXACTLY`, and always below 2⁻³⁶·`PARALLEL`/x.
        F64Pair { pair, points, doubt: size * 2f64.powi(-33) }
    }

    /// Edge directions, rounded once: the difference of rounded ends would lose a short one.
    fn edges(&self, side: usize) -> Vec<[f64; 3]> {
        let all = self.pair.blocks[side].topology().edge_ids();
        all.map(|e| edge(self.pair, side, e)).map(|d| [near(&d.x), near(&d.y), near(&d.z)]).collect()
    }

    /// The gap along each direction that may have the largest, off by no more than `doubt`, in lattice units.
    fn measured(&self) -> Vec<(Direction, f64)> {
        let gaps = self.gaps();
        let best = gaps.iter().map(|found| found.gap - found.doubt).fold(f64::NEG_INFINITY, f64::max);
        // Whatever is not a number decides nothing.
        let may_be_best = gaps.into_iter().filter(|found| found.gap.is_nan() || found.gap + found.doubt >= best);
        let sharp = may_be_best.map(|found| {
            let is_sharp = found.doubt <= self.doubt;
            (found.direction, if is_sharp { found.gap } else { self.exact_gap(found.direction) })
        });
        sharp.collect()
    }

    /// The gap along each direction.
    fn gaps(&self) -> Vec<MeasuredGap> {
        let faces = |block: &Block| block.topology().face_ids();
        let [a, b] = self.pair.blocks;
        let of_faces = faces(a).map(Direction::OfA).chain(faces(b).map(Direction::OfB));
        let sharp = |direction, gap| MeasuredGap { direction, gap, doubt: self.doubt };
        let mut found: Vec<MeasuredGap> =
            of_faces.map(|direction| sharp(direction, self.exact_gap(direction))).collect();
        let (ones, twos) = (self.edges(0), self.edges(1));
        for (one, &first) in ones.iter().enumerate() {
            for (two, &second) in twos.iter().enumerate() {
                let n = cross(first, second);
                let places = [false, true].map(|against| Direction::Edges(EdgeId::at(one), EdgeId::at(two), against));
                let share = (dot(n, n) / (dot(first, first) * dot(second, second))).sqrt();
                if share > FORMED_EXACTLY {
                    // The angle to the exact cross product grows as the product gets shorter.
                    let doubt = self.doubt * (PARALLEL / share).max(1.0);
                    let gaps = [self.gap(n), self.gap(n.map(|c| -c))];
                    found.extend(places.into_iter().zip(gaps).map(|(direction, gap)| MeasuredGap {
                        direction,
                        gap,
                        doubt,
                    }));
                } else {
                    found.extend(places.map(|place| sharp(place, self.exact_gap(place))));
                }
            }
        }
        found
    }

    /// The gap along a direction that is formed exactly; minus infinity for one without length.
    fn exact_gap(&self, direction: Direction) -> f64 {
        let n = direction.exactly(self.pair);
        if Zero::is_zero(&n.norm_squared()) {
            return f64::NEG_INFINITY;
        }
        // Scaled by a power of two, so that no square leaves f64.
        let top = n.components().iter().map(|c| c.bits()).max().unwrap_or(0).saturating_sub(900);
        self.gap([&n.x, &n.y, &n.z].map(|c| near(&(c >> top))))
    }

    fn gap(&self, n: [f64; 3]) -> f64 {
        let most = n.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        let n = n.map(|c| c / most);
        let along =
            |points: &[[f64; 3]], sign: f64| points.iter().map(|&p| sign * dot(n, p)).fold(f64::INFINITY, f64::min);
        let gap = along(&self.points[0], 1.0) + along(&self.points[1], -1.0);
        gap / dot(n, n).sqrt()
    }
}
