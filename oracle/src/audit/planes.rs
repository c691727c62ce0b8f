//! Planes of faces that separate two blocks.

use super::Decider;
use crate::PreparedBlock;
use crate::f64_vector::dot;
use crate::field::{DoubleBall, Field};
use crate::number::{Ball, UNDERFLOW};
use crate::separation::{PointSet, on_lattice};
use num_bigint::BigInt;
use num_traits::Zero;
use rockproof_model::block::face_normal;
use rockproof_model::ring::ExactRing;
use rockproof_model::{FaceId, Ring, Sign, Vec3};
use smallvec::SmallVec;

/// The faces of a block as directions in f64, each taken as exact: how far the block reaches along them.
pub(super) struct FacePlanes {
    /// A direction near to the face's normal, with components of at most about 1, and the block's greatest coordinate along it.
    directions: Vec<([f64; 3], f64)>,
    /// Bounds the coordinates of the block.
    largest: f64,
    /// Bounds the distance of a coordinate from its f64.
    error: f64,
}

impl FacePlanes {
    pub(super) fn of(prepared: &PreparedBlock) -> FacePlanes {
        let reach = |n: [f64; 3]| {
            prepared.vertices.iter().map(|p| dot(n, [p.x.0, p.y.0, p.z.0])).fold(f64::NEG_INFINITY, f64::max)
        };
        let directions = prepared.faces.iter().map(|face| {
            let n = [face.normal.x.0, face.normal.y.0, face.normal.z.0];
            let size = dot(n, n).sqrt();
            let n = n.map(|c| c / size);
            (n, reach(n))
        });
        let ends = prepared.box_min.iter().chain(&prepared.box_max);
        FacePlanes {
            directions: directions.collect(),
            largest: ends.fold(0.0f64, |most, c| most.max(c.abs())),
            error: prepared.errors.coordinate,
        }
    }
}

/// How far along a direction the other block begins beyond the end of the direction's own one, in f64 (m).
struct FaceGap {
    value: f64,
    /// It is off by less.
    doubt: f64,
}

/// The gaps along the faces of both blocks, each with the place of its block, 0 or 1.
fn gaps<'p>(
    prepared: [&'p PreparedBlock; 2],
    planes: [&'p FacePlanes; 2],
) -> impl Iterator<Item = (usize, FaceId, FaceGap)> {
    let size = planes[0].largest.max(planes[1].largest);
    let error = planes[0].error.max(planes[1].error);
    [0, 1].into_iter().flat_map(move |k| {
        let other = &prepared[1 - k].vertices;
        planes[k].directions.iter().enumerate().map(move |(face, &(n, reach))| {
            let start = other.iter().map(|p| dot(n, [p.x.0, p.y.0, p.z.0])).fold(f64::INFINITY, f64::min);
            // A dot product of three terms is off by at most 3 roundoffs of the sum of its terms' sizes (N. J. Higham,
            // Accuracy and Stability, section 3.1) and what the coordinates are off; twice that and the rounding of the
            // difference are below 16 roundoffs.
            let sum = n[0].abs() + n[1].abs() + n[2].abs();
            let doubt = sum * (size * (8.0 * f64::EPSILON) + 4.0 * error) + 16.0 * UNDERFLOW;
            (k, FaceId::at(face), FaceGap { value: start - reach, doubt })
        })
    })
}

/// The decider that shows that the plane of a face of either block separates them, **touching included**.
pub(super) fn separating_face(prepared: [&PreparedBlock; 2], planes: [&FacePlanes; 2]) -> Option<Decider> {
    let mut open: SmallVec<[(usize, FaceId); 8]> = SmallVec::new();
    for (k, face, FaceGap { value, doubt }) in gaps(prepared, planes) {
        if value > doubt {
            return Some(Decider::FacePlane);
        }
        // The face's own plane differs from the direction by roundoffs of normals: those of the nearby ones are asked.
        if value > -4.0 * doubt {
            open.push((k, face));
        }
    }
    if open.is_empty() {
        return None;
    }
    let doubles = DoublePair::of(prepared);
    let mut undecided: SmallVec<[(usize, FaceId); 8]> = SmallVec::new();
    for (k, face) in open {
        match doubles.is_beyond(k, face) {
            Some(true) => return Some(Decider::ExactFacePlane),
            Some(false) => {}
            None => undecided.push((k, face)),
        }
    }
    if undecided.is_empty() {
        return None;
    }
    let points = on_lattice(prepared.map(|one| one.block().vertices()));
    let separates = |(k, face)| separates_exactly(prepared, &points, k, face);
    undecided.into_iter().any(separates).then_some(Decider::ExactFacePlane)
}

/// A length in m that two blocks are certainly further apart than, along the normal of a face; negative infinity where nothing is known.
pub(super) fn greatest_certain_gap(prepared: [&PreparedBlock; 2], planes: [&FacePlanes; 2]) -> f64 {
    // Directions are longer than 1 by a few roundoffs at most.
    let certain = gaps(prepared, planes).map(|(_, _, gap)| (gap.value - gap.doubt) * (1.0 - 16.0 * f64::EPSILON));
    certain.fold(f64::NEG_INFINITY, f64::max)
}

/// The depth in m that the penetration of two convex blocks certainly does not exceed: the least that moving along the normal
/// of a face takes, of the faces along which f64 finds it least. Penetration of convex blocks is the least over directions
/// among which these normals are (`penetration::convex`), so any face bounds it. Infinite where nothing is known.
pub(super) fn greatest_depth(prepared: [&PreparedBlock; 2], planes: [&FacePlanes; 2]) -> f64 {
    let gaps: SmallVec<[(usize, FaceId, FaceGap); 16]> = gaps(prepared, planes).collect();
    let best = gaps.iter().map(|(_, _, gap)| gap.value - gap.doubt).fold(f64::NEG_INFINITY, f64::max);
    let doubles = DoublePair::of(prepared);
    let nearby = gaps.iter().filter(|(_, _, gap)| gap.value + gap.doubt >= best);
    nearby.map(|&(k, face, _)| doubles.depth_at_most(k, face)).fold(f64::INFINITY, f64::min)
}

/// Two blocks in some 100 bits.
struct DoublePair<'p> {
    prepared: [&'p PreparedBlock; 2],
    points: [Vec<Vec3<DoubleBall>>; 2],
}

impl<'p> DoublePair<'p> {
    fn of(prepared: [&'p PreparedBlock; 2]) -> DoublePair<'p> {
        DoublePair { prepared, points: prepared.map(|prepared| PointSet::of(prepared).doubles()) }
    }

    /// The normal of a face of block k, and along it how far beyond the end of its block the other one begins, times the
    /// normal's length; `None` where nothing is known.
    fn gap(&self, k: usize, face: FaceId) -> Option<(Vec3<DoubleBall>, DoubleBall)> {
        let (own, other) = (&self.points[k], &self.points[1 - k]);
        let n = face_normal(own, self.prepared[k].block().topology().face(face));
        let start = least(other.iter().map(|p| n.dot(p)))?;
        let end_against = least(own.iter().map(|p| n.dot(p).negated()))?;
        Some((n, start.plus(&end_against)))
    }

    /// Whether along the normal of a face of block k the other block begins where this one ends, **or beyond**; `None` where
    /// that is open.
    fn is_beyond(&self, k: usize, face: FaceId) -> Option<bool> {
        let (n, gap) = self.gap(k, face)?;
        match gap.certain_sign()? {
            Sign::Negative => Some(false),
            // A normal without length has no direction: along it every gap is zero.
            Sign::Zero | Sign::Positive => (n.norm_squared().certain_sign()? == Sign::Positive).then_some(true),
        }
    }

    /// The depth in m that parts the blocks along the normal of a face of block k, rounded up; infinite where it is not known.
    fn depth_at_most(&self, k: usize, face: FaceId) -> f64 {
        let Some((n, gap)) = self.gap(k, face) else { return f64::INFINITY };
        let ((gap, gap_error), (square, square_error)) = (gap.nearby(), n.norm_squared().nearby());
        let length = (square - square_error).next_down().sqrt().next_down();
        let depth = ((gap_error - gap).next_up() / length).next_up();
        // Written so that what is not a number bounds nothing.
        if length > 0.0 && depth >= 0.0 { depth } else { f64::INFINITY }
    }
}

/// The least of some numbers; `None` where nothing is known of one.
fn least(mut all: impl Iterator<Item = DoubleBall>) -> Option<DoubleBall> {
    let first = all.next()?;
    all.try_fold(first, |least, next| least.lesser(&next))
}

/// Whether along the normal of a face of block k the other block begins where this one ends, **or beyond**.
fn separates_exactly(prepared: [&PreparedBlock; 2], points: &[Vec<Vec3<BigInt>>; 2], k: usize, face: FaceId) -> bool {
    let (own, other) = (&points[k], &points[1 - k]);
    let n = face_normal(own, prepared[k].block().topology().face(face));
    if Zero::is_zero(&n.norm_squared()) {
        return false;
    }
    let (end, start) = (own.iter().map(|p| n.dot(p)).max(), other.iter().map(|p| n.dot(p)).min());
    end.zip(start).is_some_and(|(end, start)| end <= start)
}

/// Whether the vertices do not all lie in one plane, exactly.
pub(super) fn has_inside(prepared: &PreparedBlock) -> bool {
    // f64 first: any determinant that is certainly not zero.
    let ball = |v: &Vec3<crate::number::Approx>| v.map(|c| Ball { middle: c.0, radius: prepared.errors.coordinate });
    let origin = ball(&prepared.vertices[0]);
    let from: Vec<Vec3<Ball>> = prepared.vertices[1..].iter().map(|v| ball(v).minus(&origin)).collect();
    let sure = from.windows(2).any(|two| {
        let n = two[0].cross(&two[1]);
        from.iter().any(|p| n.dot(p).certain_sign().is_some_and(|sign| !sign.is_zero()))
    });
    sure || {
        let [points, _] = on_lattice([prepared.block().vertices(), &[]]);
        let from: Vec<Vec3<BigInt>> = points[1..].iter().map(|p| p.minus(&points[0])).collect();
        let first = from.iter().find(|p| !Zero::is_zero(&p.norm_squared()));
        let n = first.and_then(|d| from.iter().map(|p| d.cross(p)).find(|n| !Zero::is_zero(&n.norm_squared())));
        n.is_some_and(|n| from.iter().any(|p| !ExactRing::sign(&n.dot(p)).is_zero()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use rockproof_model::{Block, BlockOptions, Number, Point};

    fn number(text: &str) -> Number {
        Number::from_rational(text.parse().expect("a fraction"))
    }

    /// 10 to a power.
    fn power(exponent: i32) -> Number {
        let power = BigRational::from_integer(BigInt::from(10).pow(exponent.unsigned_abs()));
        Number::from_rational(if exponent < 0 { power.recip() } else { power })
    }

    fn block(vertices: Vec<Point>, faces: &[&[u32]]) -> Block {
        let faces = faces.iter().map(|face| face.to_vec()).collect();
        Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).expect("a block")
    }

    fn cuboid(low: [&str; 3], high: [&str; 3]) -> Block {
        let [low, high] = [low, high].map(|[x, y, z]| Vec3::new(number(x), number(y), number(z)));
        Block::cuboid(&low, &high).expect("a block")
    }

    /// The prism of height 1 on a triangle that goes round counter-clockwise.
    fn prism(corners: [[&str; 2]; 3]) -> Block {
        let at = |z: &'static str| corners.map(|[x, y]| Vec3::new(number(x), number(y), number(z)));
        let faces: [&[u32]; 5] = [&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
        block([at("0"), at("1")].concat(), &faces)
    }

    fn mapped(block: &Block, map: impl Fn(&Point) -> Point) -> Block {
        block.with_vertices(block.vertices().iter().map(map).collect())
    }

    /// The answer, which must be the same both ways round.
    fn separating(a: &Block, b: &Block) -> Option<Decider> {
        let [a, b] = [a, b].map(PreparedBlock::new);
        let planes = [&a, &b].map(FacePlanes::of);
        let found = separating_face([&a, &b], planes.each_ref());
        let [one, other] = planes.each_ref();
        assert_eq!(separating_face([&b, &a], [other, one]), found);
        found
    }

    #[test]
    fn a_dot_product_is_the_sum_of_three_products() {
        assert_eq!(dot([2.0, 3.0, 5.0], [7.0, 11.0, 13.0]), 112.0);
    }

    #[test]
    fn no_face_separates_blocks_that_overlap_by_less_than_floats_see() {
        let unit = cuboid(["0"; 3], ["1"; 3]);
        let beside = cuboid(["1", "1/3", "1/3"], ["2", "4/3", "4/3"]);
        let turns = [("3/5", "4/5"), ("5/13", "12/13"), ("199/19801", "19800/19801")];
        let shifts =
            [["0"; 3], ["71/7", "113/33", "1/13"], ["1/13", "-71/7", "113/33"], ["1000001/7", "-1000000", "10001/3"]];
        for ((cosine, sine), axis) in turns.into_iter().flat_map(|turn| (0..3).map(move |axis| (turn, axis))) {
            let (c, s) = (number(cosine), number(sine));
            for (size, shift) in ["1", "1/10000"].into_iter().flat_map(|size| shifts.map(|shift| (number(size), shift)))
            {
                let placed = |block: &Block, by: &Number| {
                    mapped(block, |v| {
                        let mut place = [v.x.plus(by), v.y.clone(), v.z.clone()].map(|c| c.times(&size));
                        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                        let (p, q) = (place[i].clone(), place[j].clone());
                        place[i] = p.times(&c).plus(&q.times(&s).negated());
                        place[j] = p.times(&s).plus(&q.times(&c));
                        let [x, y, z] = place;
                        Vec3::new(x.plus(&number(shift[0])), y.plus(&number(shift[1])), z.plus(&number(shift[2])))
                    })
                };
                let what = || format!("axis {axis}, {cosine}, {size:?}, {shift:?}");
                let a = placed(&unit, &Number::ZERO);
                // What sums of two f64 see and what only integers do.
                for little in [power(-25), power(-45)] {
                    // Any plane that separated them would go through the inside of both.
                    assert_eq!(separating(&a, &placed(&beside, &little.negated())), None, "{}", what());
                    for apart in [Number::ZERO, little] {
                        let found = separating(&a, &placed(&beside, &apart));
                        assert_eq!(found, Some(Decider::ExactFacePlane), "{}", what());
                    }
                }
            }
        }
    }

    /// Four corners whose loop crosses itself and encloses nothing, as both its triangles cancel; f64 rounds them and sees an area.
    #[test]
    fn a_face_without_area_separates_nothing() {
        let corner = |[x, y]: [i32; 2]| {
            let at = |c: i32| Number::from_f64(f64::from(c) / 2f64.powi(30)).expect("a number");
            Vec3::new(at(x), at(y), Number::from_integer(1))
        };
        let flat = cuboid(["-1", "-1", "0"], ["1", "1", "1"]);
        let crossed = [
            [-536_870_911, -536_870_909],
            [-204_035_018, -497_657_868],
            [-148_147_628, -233_254_914],
            [184_688_265, -194_041_873],
        ];
        let crossed = crossed.map(corner);
        let roof = flat.with_vertices(flat.vertices()[..4].iter().cloned().chain(crossed).collect());
        let top =
            roof.topology().face_ids().find(|&f| roof.topology().face(f).iter().all(|v| v.index() > 3)).expect("a top");
        let (direction, _) = FacePlanes::of(&PreparedBlock::new(&roof)).directions[top.index()];
        assert!(direction.iter().all(|c| c.is_finite()), "{direction:?}");
        let little = power(-16);
        for (low, high) in [("1", "2"), ("-1", "0")] {
            let beside = cuboid(["-2", "-2", low], ["2", "2", high]);
            let into = if low == "1" { little.negated() } else { little.clone() };
            assert_eq!(separating(&roof, &beside), Some(Decider::ExactFacePlane));
            assert_eq!(
                separating(&roof, &mapped(&beside, |v| Vec3::new(v.x.clone(), v.y.clone(), v.z.plus(&into)))),
                None
            );
        }
    }

    #[test]
    fn no_face_separates_blocks_that_overlap_whatever_their_size() {
        let cube = cuboid(["0"; 3], ["1"; 3]);
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let corners = corners.map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
        let tetrahedron = block(corners.to_vec(), &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]]);
        // At x = 31/20 the thin triangle is between y = 1.4868 and y = 1.5776, and the box below 1.495.
        let thin = [["11/5", "2"], ["16/5", "3"], ["3/10", "1/2"]];
        let small = cuboid(["38/25", "7/5", "1/4"], ["79/50", "299/200", "3/4"]);
        let pairs = [
            (cube.clone(), cube),
            (tetrahedron.clone(), tetrahedron),
            (prism(thin), small.clone()),
            (prism([thin[2], thin[0], thin[1]]), small),
        ];
        for exponent in [-160, -100, -80, -10, 0, 10, 60, 62, 64, 78, 80, 103, 110] {
            let scale = power(exponent);
            for (k, (a, b)) in pairs.iter().enumerate() {
                let [a, b] = [a, b].map(|block| mapped(block, |v| v.map(|c| c.times(&scale))));
                assert_eq!(separating(&a, &b), None, "pair {k} times 10^{exponent}");
            }
        }
    }
}
