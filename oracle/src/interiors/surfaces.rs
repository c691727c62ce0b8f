//! The triangles of one or two blocks on one lattice, and signs of what is asked about them.

use crate::number::Ball;
use crate::point_in_surface::triangle_corners;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use rockproof_model::block::Point;
use rockproof_model::lattice::Lattice;
use rockproof_model::number::power_of_two;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Number, Ring, Sign, Vec3, VertexId};
use std::cell::OnceCell;

/// A triangle of a surface; it has an area.
pub(super) struct Triangle {
    /// The number of its block.
    pub(super) block: usize,
    /// Its vertices, by their numbers in the block.
    pub(super) corners: [VertexId; 3],
    normal: Vec3<Ball>,
    exact_normal: OnceCell<Vec3<BigInt>>,
    bounds: [[f64; 2]; 3],
}

/// The surfaces of blocks, in lattice units from the first vertex of the first.
pub(super) struct Surfaces {
    exact: Vec<Vec<Vec3<BigInt>>>,
    near: Vec<Vec<Vec3<Ball>>>,
    triangles: Vec<Triangle>,
    /// The boxes of the blocks.
    bounds: Vec<[[f64; 2]; 3]>,
    /// In lattice units.
    origin: Vec3<BigInt>,
    lattice: Lattice,
}

/// A point: a fraction of lattice units, its denominator above zero.
pub(super) struct HomogeneousPoint {
    numerators: Vec3<BigInt>,
    denominator: BigInt,
    near: Vec3<Ball>,
    near_denominator: Ball,
}

impl Triangle {
    /// The vector across, exactly.
    pub(super) fn across(&self, surfaces: &Surfaces) -> &Vec3<BigInt> {
        self.exact_normal.get_or_init(|| {
            let [a, b, c] = self.corners.map(|v| &surfaces.exact[self.block][v.index()]);
            b.minus(a).cross(&c.minus(a))
        })
    }

    /// Whether the boxes of two triangles meet; may say yes of some that do not.
    pub(super) fn is_near(&self, other: &Triangle) -> bool {
        meet(&self.bounds, &other.bounds)
    }
}

fn meet(one: &[[f64; 2]; 3], other: &[[f64; 2]; 3]) -> bool {
    one.iter().zip(other).all(|(one, other)| one[0] <= other[1] && other[0] <= one[1])
}

impl Surfaces {
    pub(super) fn of(blocks: &[&Block]) -> Surfaces {
        let lattice = Lattice::covering(blocks.iter().flat_map(|block| block.coordinates()));
        let origin = blocks[0].vertices()[0].map(|c| lattice.units(c));
        let place = |v: &Point| v.map(|c| lattice.units(c)).minus(&origin);
        let exact: Vec<Vec<_>> = blocks.iter().map(|block| block.vertices().iter().map(place).collect()).collect();
        let near: Vec<Vec<_>> =
            exact.iter().map(|points| points.iter().map(|p| p.map(|c| ball(c, 0))).collect()).collect();
        let bounds = near.iter().map(|points: &Vec<Vec3<Ball>>| bounds_of(points)).collect();
        let mut surfaces = Surfaces { exact, near, triangles: Vec::new(), bounds, origin, lattice };
        for (number, block) in blocks.iter().enumerate() {
            let all = triangle_corners(block).filter_map(|corners| surfaces.triangle(number, corners));
            let all: Vec<Triangle> = all.collect();
            surfaces.triangles.extend(all);
        }
        surfaces
    }

    /// The triangle of three vertices, if it has an area.
    fn triangle(&self, block: usize, corners: [VertexId; 3]) -> Option<Triangle> {
        let points = corners.map(|v| self.near[block][v.index()]);
        let normal = points[1].minus(&points[0]).cross(&points[2].minus(&points[0]));
        let triangle = Triangle { block, corners, normal, exact_normal: OnceCell::new(), bounds: bounds_of(&points) };
        let is_sure = |c: &Ball| c.certain_sign().is_some_and(|sign| !sign.is_zero());
        let has_area =
            normal.components().into_iter().any(is_sure) || !Zero::is_zero(&triangle.across(self).norm_squared());
        has_area.then_some(triangle)
    }

    pub(super) fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    pub(super) fn blocks(&self) -> usize {
        self.exact.len()
    }

    pub(super) fn vertex(&self, block: usize, vertex: VertexId) -> &Vec3<BigInt> {
        &self.exact[block][vertex.index()]
    }

    /// Whether a triangle's box meets that of the other block; may say yes of some that do not.
    pub(super) fn reaches_other(&self, triangle: usize) -> bool {
        let triangle = &self.triangles[triangle];
        meet(&triangle.bounds, &self.bounds[1 - triangle.block])
    }

    /// On which side of a triangle's plane a vertex is.
    pub(super) fn side(&self, triangle: &Triangle, block: usize, vertex: VertexId) -> Sign {
        if triangle.block == block && triangle.corners.contains(&vertex) {
            return Sign::Zero;
        }
        let (own, first, vertex) = (triangle.block, triangle.corners[0].index(), vertex.index());
        let near = triangle.normal.dot(&self.near[block][vertex].minus(&self.near[own][first]));
        near.certain_sign().unwrap_or_else(|| {
            ExactRing::sign(&triangle.across(self).dot(&self.exact[block][vertex].minus(&self.exact[own][first])))
        })
    }

    /// The sides of a triangle's plane of every vertex of every block.
    pub(super) fn sides(&self, triangle: &Triangle) -> Vec<Vec<Sign>> {
        let of =
            |block: usize| (0..self.exact[block].len()).map(VertexId::at).map(move |v| self.side(triangle, block, v));
        (0..self.blocks()).map(|block| of(block).collect()).collect()
    }

    /// Whether next to a place in a triangle of some plane it is inside a block: below the plane and above it, as the plane's
    /// vector across points. `in_plane` tells of which triangles the plane is. `None` where the place is in the plane of
    /// another triangle.
    ///
    /// A ray each way is followed. Its direction is (1, k, k²) or its opposite, with the first k for which its line meets no
    /// edge and lies in no plane. It leaves the plane at once, so that triangles in it are not crossed.
    pub(super) fn insides(
        &self,
        block: usize,
        place: &HomogeneousPoint,
        plane: &Triangle,
        in_plane: &[bool],
    ) -> Option<[bool; 2]> {
        let away = |triangle: &Triangle| {
            let vector = |v: VertexId| self.way(place, block, v);
            triangle.corners.map(vector)
        };
        // Outside the block's box nothing is inside.
        if !place.may_be_in(&self.bounds[block]) {
            return Some([false; 2]);
        }
        let others: Vec<&Triangle> = self
            .triangles
            .iter()
            .zip(in_plane)
            .filter(|(triangle, in_plane)| triangle.block == block && !**in_plane)
            .map(|(triangle, _)| triangle)
            .collect();
        let from: Vec<[Way; 3]> = others.iter().map(|triangle| away(triangle)).collect();
        let mut before = Vec::with_capacity(others.len());
        for (triangle, ways) in others.iter().zip(&from) {
            let near = triangle.normal.dot(&ways[0].near);
            let sign = near.certain_sign().unwrap_or_else(|| {
                ExactRing::sign(&triangle.across(self).dot(&self.exact_way(place, block, ways[0].vertex)))
            });
            if sign.is_zero() {
                return None;
            }
            before.push(sign);
        }
        (1i32..).find_map(|k| {
            let leaves = self.along(plane, k);
            if leaves.is_zero() {
                return None;
            }
            let mut odd = [false; 2];
            for ((triangle, ways), before) in others.iter().zip(&from).zip(&before) {
                let towards = self.along(triangle, k);
                if towards.is_zero() {
                    return None;
                }
                if self.line_meets(place, block, ways, k, towards)? {
                    // Ahead of the place, or behind it.
                    let ahead = *before == towards;
                    odd[usize::from(ahead)] ^= true;
                }
            }
            // What is ahead is above the plane where the ray goes up.
            Some(if leaves.is_positive() { odd } else { [odd[1], odd[0]] })
        })
    }

    /// Whether the line through a place along (1, k, k²) passes through a triangle, seen from the place at `ways`; `None`
    /// where it meets an edge's line at the triangle.
    fn line_meets(
        &self,
        place: &HomogeneousPoint,
        block: usize,
        ways: &[Way; 3],
        k: i32,
        towards: Sign,
    ) -> Option<bool> {
        let mut touches = false;
        for i in 0..3 {
            let (p, q) = (&ways[i], &ways[(i + 1) % 3]);
            let near = p.near.cross(&q.near).dot(&ray(k));
            let sign = near.certain_sign().unwrap_or_else(|| {
                let [p, q] = [p, q].map(|way| self.exact_way(place, block, way.vertex));
                ExactRing::sign(&p.cross(&q).dot(&ray(k)))
            });
            if sign == towards.reversed() {
                return Some(false);
            }
            touches |= sign.is_zero();
        }
        if touches { None } else { Some(true) }
    }

    /// The sign of a triangle's vector across along (1, k, k²).
    fn along(&self, triangle: &Triangle, k: i32) -> Sign {
        let near = triangle.normal.dot(&ray(k)).certain_sign();
        near.unwrap_or_else(|| ExactRing::sign(&triangle.across(self).dot(&ray(k))))
    }

    fn way(&self, place: &HomogeneousPoint, block: usize, vertex: VertexId) -> Way {
        let vertex_near = self.near[block][vertex.index()];
        Way { vertex, near: vertex_near.scaled(&place.near_denominator).minus(&place.near) }
    }

    fn exact_way(&self, place: &HomogeneousPoint, block: usize, vertex: VertexId) -> Vec3<BigInt> {
        self.exact[block][vertex.index()].scaled(&place.denominator).minus(&place.numerators)
    }

    /// A point in m.
    pub(super) fn in_metres(&self, place: &HomogeneousPoint) -> Point {
        let (units, metres) = self.lattice.units_per_metre();
        let denominator = &place.denominator * units;
        let moved = place.numerators.plus(&self.origin.scaled(&place.denominator));
        moved.map(|c| Number::from_rational(BigRational::new(c * &metres, denominator.clone())))
    }
}

/// The way from a place to a vertex, times the place's denominator.
struct Way {
    vertex: VertexId,
    near: Vec3<Ball>,
}

impl HomogeneousPoint {
    /// The point `numerators / denominator`; the denominator is not zero.
    pub(super) fn new(numerators: Vec3<BigInt>, denominator: BigInt) -> HomogeneousPoint {
        let is_negative = ExactRing::sign(&denominator).is_negative();
        let (numerators, denominator) =
            if is_negative { (numerators.negated(), -denominator) } else { (numerators, denominator) };
        // In f64 the denominator is between 1/2 and 1, so that nothing leaves its range.
        let shift = denominator.bits() as i64;
        let near = numerators.map(|c| ball(c, shift));
        HomogeneousPoint { near, near_denominator: ball(&denominator, shift), numerators, denominator }
    }

    /// Whether it may be in a box.
    fn may_be_in(&self, bounds: &[[f64; 2]; 3]) -> bool {
        !self.near.components().into_iter().zip(bounds).any(|(c, ends)| {
            let [low, high] = ends.map(|end| Ball { middle: end, radius: 0.0 }.times(&self.near_denominator));
            // Of what is no number neither is true.
            c.plus(&high.negated()).certain_sign() == Some(Sign::Positive)
                || low.minus(c).certain_sign() == Some(Sign::Positive)
        })
    }
}

fn ray<T: Ring>(k: i32) -> Vec3<T> {
    let k = T::from_i32(k);
    Vec3::new(T::from_i32(1), k.clone(), k.squared())
}

fn bounds_of(points: &[Vec3<Ball>]) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|axis| {
        points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            let c = p.components()[axis];
            [low.min((c.middle - c.radius).next_down()), high.max((c.middle + c.radius).next_up())]
        })
    })
}

/// `value / 2^shift`, as near as f64 holds it.
pub(crate) fn ball(value: &BigInt, shift: i64) -> Ball {
    let bits = value.bits() as i64;
    if bits == 0 {
        return Ball { middle: 0.0, radius: 0.0 };
    }
    // The first 64 bits at most, and how far they are to be moved.
    let dropped = (bits - 64).max(0);
    let (digits, exponent) = (value >> dropped, dropped - shift);
    if bits - shift > 1000 {
        return Ball { middle: 0.0, radius: f64::INFINITY };
    }
    if bits - shift < -900 {
        return Ball { middle: 0.0, radius: power_of_two(-900) };
    }
    let middle = digits.to_f64().unwrap_or(f64::NAN) * power_of_two(exponent as i32);
    let is_exact = bits - value.trailing_zeros().unwrap_or(0) as i64 <= 53;
    // Cut to 64 bits and rounded to 53.
    Ball { middle, radius: if is_exact { 0.0 } else { middle.abs() * f64::EPSILON } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::Signed;

    /// Values short and long, exact in f64 and not, next to powers of two and far from them.
    fn values() -> Vec<BigInt> {
        let mut values = vec![BigInt::from(1), BigInt::from(5)];
        for k in [2u32, 40, 52, 53, 54, 63, 64, 65, 100, 700, 1030, 1100, 2500] {
            let power = BigInt::from(1) << k;
            values.extend([&power - 1, power.clone(), power + 1, BigInt::from(3).pow(k)]);
        }
        values.iter().flat_map(|value| [value.clone(), -value]).collect()
    }

    fn fraction(value: f64) -> BigRational {
        BigRational::from_float(value).expect("a finite number")
    }

    #[test]
    fn a_ball_holds_its_value_at_both_ends_of_its_range() {
        for value in values() {
            let bits = value.bits() as i64;
            // `value / 2^shift` is below 2^top and at least half of that.
            let tops =
                [-2000, -1100, -1074, -1012, -902, -901, -900, -899, -1, 0, 1, 999, 1000, 1001, 1002, 1024, 1100];
            let shifts = tops.into_iter().map(|top| bits - top).chain([0, 1, 900, 1100, 1160, 1200, 2500]);
            for shift in shifts {
                let found = ball(&value, shift);
                let what = || format!("{value} / 2^{shift}: {found:?}");
                let sign = found.certain_sign();
                assert!(sign.is_none_or(|sign| sign == ExactRing::sign(&value)), "{}", what());
                let is_within_range = (-899..=1000).contains(&(bits - shift));
                if found.radius == f64::INFINITY {
                    assert!(!is_within_range && found.middle.is_finite(), "{}", what());
                    continue;
                }
                let power = BigInt::from(1) << shift.unsigned_abs();
                let exact = BigRational::from(value.clone());
                let exact = if shift < 0 { exact * &power } else { exact / &power };
                let off = (exact - fraction(found.middle)).abs();
                assert!(off <= fraction(found.radius), "{}", what());
                if is_within_range {
                    // Twice a roundoff at most, and none where the value has no more digits than an f64.
                    let digits = value.magnitude() >> value.trailing_zeros().unwrap_or(0);
                    let most = if digits.bits() <= 53 { 0.0 } else { f64::EPSILON * found.middle.abs() };
                    assert!(found.radius <= most, "{}", what());
                }
            }
        }
    }

    #[test]
    fn a_box_holds_points_that_no_f64_is_equal_to() {
        for value in values().into_iter().filter(|value| value.bits() < 1000) {
            let at = |value: &BigInt| Vec3::new(ball(value, 0), ball(&-value, 0), ball(&BigInt::zero(), 0));
            let bounds = bounds_of(&[at(&value)]);
            for ([low, high], c) in bounds.into_iter().zip([value.clone(), -&value, BigInt::zero()]) {
                let c = BigRational::from(c);
                assert!(fraction(low) <= c && c <= fraction(high), "{c}: {low} to {high}");
            }
            // That of more points holds all.
            let zero = BigInt::zero();
            for [low, high] in [&bounds_of(&[at(&value), at(&zero)])[0], &bounds_of(&[at(&zero), at(&value)])[0]] {
                let c = BigRational::from(value.clone());
                assert!(fraction(*low) <= c.clone().min(BigRational::zero()) && c <= fraction(*high));
            }
        }
    }
}
