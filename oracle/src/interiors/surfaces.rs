//! The triangles of one or two blocks on one lattice, and signs of what is asked about them.

use super::faces::face_triangles;
use super::rays::Rays;
use crate::boxes::{Box3, BoxTree};
use crate::number::Ball;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use rockproof_model::block::Point;
use rockproof_model::lattice::Lattice;
use rockproof_model::number::power_of_two;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Number, Sign, Vec3, VertexId};
use std::cell::OnceCell;
use std::ops::Range;

/// A triangle of a surface; it has an area.
pub(super) struct Triangle {
    /// The number of its block.
    pub(super) block: usize,
    /// Its vertices, by their numbers in the block.
    pub(super) corners: [VertexId; 3],
    normal: Vec3<Ball>,
    exact_normal: OnceCell<Vec3<BigInt>>,
    bounds: Box3,
}

/// The surfaces of blocks, in lattice units from the first vertex of the first.
pub(super) struct Surfaces {
    exact: Vec<Vec<Vec3<BigInt>>>,
    near: Vec<Vec<Vec3<Ball>>>,
    triangles: Vec<Triangle>,
    blocks: Vec<Body>,
    /// In lattice units.
    origin: Vec3<BigInt>,
    lattice: Lattice,
}

/// What is kept of a block.
pub(super) struct Body {
    /// It certainly holds the block.
    pub(super) bounds: Box3,
    /// The numbers of its triangles.
    triangles: Range<usize>,
    /// Of its triangles' boxes, in their order.
    tree: BoxTree,
    /// Of its triangles seen along rays, in their order.
    pub(super) rays: Rays,
}

/// A point: a fraction of lattice units, its denominator above zero.
pub(super) struct HomogeneousPoint {
    pub(super) numerators: Vec3<BigInt>,
    pub(super) denominator: BigInt,
    pub(super) near: Vec3<Ball>,
    pub(super) near_denominator: Ball,
}

impl Triangle {
    /// The vector across, exactly.
    pub(super) fn across(&self, surfaces: &Surfaces) -> &Vec3<BigInt> {
        self.exact_normal.get_or_init(|| {
            let [a, b, c] = self.corners.map(|v| &surfaces.exact[self.block][v.index()]);
            b.minus(a).cross(&c.minus(a))
        })
    }

    /// The vector across.
    pub(super) fn normal(&self) -> &Vec3<Ball> {
        &self.normal
    }
}

impl Surfaces {
    pub(super) fn of(blocks: &[&Block]) -> Surfaces {
        let lattice = Lattice::covering(blocks.iter().flat_map(|block| block.coordinates()));
        let origin = blocks[0].vertices()[0].map(|c| lattice.units(c));
        let place = |v: &Point| v.map(|c| lattice.units(c)).minus(&origin);
        let exact: Vec<Vec<_>> = blocks.iter().map(|block| block.vertices().iter().map(place).collect()).collect();
        let near: Vec<Vec<_>> =
            exact.iter().map(|points| points.iter().map(|p| p.map(|c| ball(c, 0))).collect()).collect();
        let mut surfaces = Surfaces { exact, near, triangles: Vec::new(), blocks: Vec::new(), origin, lattice };
        for (number, block) in blocks.iter().enumerate() {
            let first = surfaces.triangles.len();
            for face in block.topology().faces() {
                let all = face_triangles(&surfaces, number, face);
                surfaces.triangles.extend(all);
            }
            let triangles = first..surfaces.triangles.len();
            let boxes = surfaces.triangles[triangles.clone()].iter().map(|triangle| triangle.bounds).collect();
            let bounds = bounds_of(&surfaces.near[number]);
            surfaces.blocks.push(Body { bounds, triangles, tree: BoxTree::new(boxes), rays: Rays::default() });
        }
        surfaces
    }

    /// The triangle of three vertices, if it has an area.
    pub(super) fn triangle(&self, block: usize, corners: [VertexId; 3]) -> Option<Triangle> {
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

    /// The triangles of a block.
    pub(super) fn of_block(&self, block: usize) -> &[Triangle] {
        &self.triangles[self.blocks[block].triangles.clone()]
    }

    pub(super) fn body(&self, block: usize) -> &Body {
        &self.blocks[block]
    }

    /// The triangles of a block whose boxes meet that of a triangle: all that meet the triangle are among them.
    pub(super) fn near(&self, block: usize, triangle: &Triangle) -> impl Iterator<Item = &Triangle> {
        let near = self.blocks[block].tree.meeting(&triangle.bounds);
        near.into_iter().map(move |k| &self.of_block(block)[k])
    }

    /// A vertex as near as f64 holds it.
    pub(super) fn near_vertex(&self, block: usize, vertex: VertexId) -> &Vec3<Ball> {
        &self.near[block][vertex.index()]
    }

    pub(super) fn vertex(&self, block: usize, vertex: VertexId) -> &Vec3<BigInt> {
        &self.exact[block][vertex.index()]
    }

    /// Whether a triangle's box meets that of the other block; may say yes of some that do not.
    pub(super) fn reaches_other(&self, triangle: usize) -> bool {
        let triangle = &self.triangles[triangle];
        triangle.bounds.meets(&self.blocks[1 - triangle.block].bounds)
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

    /// On which sides of a triangle's plane another's corners are.
    pub(super) fn sides(&self, triangle: &Triangle, other: &Triangle) -> [Sign; 3] {
        other.corners.map(|v| self.side(triangle, other.block, v))
    }

    /// A point in m.
    pub(super) fn in_metres(&self, place: &HomogeneousPoint) -> Point {
        let (units, metres) = self.lattice.units_per_metre();
        let denominator = &place.denominator * units;
        let moved = place.numerators.plus(&self.origin.scaled(&place.denominator));
        moved.map(|c| Number::from_rational(BigRational::new(c * &metres, denominator.clone())))
    }
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
}

/// A box that certainly holds points, none of whose coordinates is no number.
fn bounds_of(points: &[Vec3<Ball>]) -> Box3 {
    Box3::between([0, 1, 2].map(|axis| ends_of(points.iter().map(|p| *p.components()[axis]))))
}

/// The least and the greatest value that some numbers may have; whatever is no number may have any.
pub(super) fn ends_of(numbers: impl Iterator<Item = Ball>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| {
        let (least, most) = ((c.middle - c.radius).next_down(), (c.middle + c.radius).next_up());
        if least.is_nan() || most.is_nan() {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        [low.min(least), high.max(most)]
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
            for c in [&value, &-&value, &BigInt::zero()] {
                let [low, high] = ends_of([ball(c, 0)].into_iter());
                let c = BigRational::from(c.clone());
                assert!(fraction(low) <= c && c <= fraction(high), "{c}: {low} to {high}");
            }
            // That of more points holds all.
            let zero = BigInt::zero();
            for two in [[&value, &zero], [&zero, &value]] {
                let [low, high] = ends_of(two.into_iter().map(|c| ball(c, 0)));
                let c = BigRational::from(value.clone());
                assert!(fraction(low) <= c.clone().min(BigRational::zero()) && c <= fraction(high));
            }
        }
    }
}
