//! What f64 proves of a point and a surface, so that exact numbers are asked only for what it leaves open: most points are
//! certainly outside, most edges certainly pass by most triangles, and few features can be the nearest ones.

use super::Fraction;
use crate::interiors::ball;
use crate::number::Ball;
use crate::point_in_surface::{are_odd, ray, triangle_corners};
use num_bigint::BigInt;
use rockproof_model::block::face_normal;
use rockproof_model::topology::loop_pairs;
use rockproof_model::{Block, Ring, Sign, Vec3, VertexId};

/// Lattice points as f64 sees them: from one of them, in a unit in which no coordinate is above 1.
pub(super) struct View {
    origin: Vec3<BigInt>,
    /// The unit is 2^shift lattice units.
    shift: i64,
}

/// A point, times a denominator between 1/2 and 1.
pub(super) struct NearPoint {
    numerators: Vec3<Ball>,
    denominator: Ball,
}

/// A part of a surface, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feature {
    Face(usize),
    Edge(usize),
    Vertex(usize),
}

/// The surface of a block.
pub(super) struct NearSurface<'b> {
    block: &'b Block,
    points: Vec<Vec3<Ball>>,
    /// Normal of each face.
    normals: Vec<Vec3<Ball>>,
    /// Corners and normal of each triangle.
    triangles: Vec<([VertexId; 3], Vec3<Ball>)>,
}

/// The features that may be the nearest to a point: faces, edges, vertices, each by number.
pub(super) struct NearestFeatures {
    /// Every other has no foot of the point or is certainly farther away than one of these.
    pub(super) features: Vec<Feature>,
    /// At least the square of the point's distance from the surface, in the view's unit.
    pub(super) most_squared: f64,
}

/// A squared distance is between these.
pub(super) struct Range {
    pub(super) least: f64,
    most: f64,
}

/// Rays that are tried before exact numbers are asked whether a point is inside.
const RAYS: i32 = 2;

impl View {
    /// Sees both blocks' vertices from the first of all.
    pub(super) fn of(points: [&[Vec3<BigInt>]; 2]) -> View {
        let origin = points[0][0].clone();
        let all = points.into_iter().flatten();
        let shift = all.flat_map(|p| p.minus(&origin).components().map(|c| c.bits())).max().unwrap_or(0);
        View { origin, shift: shift as i64 }
    }

    fn place(&self, point: &Vec3<BigInt>) -> Vec3<Ball> {
        point.minus(&self.origin).map(|c| ball(c, self.shift))
    }

    pub(super) fn point(&self, point: &Fraction) -> NearPoint {
        let bits = point.denominator.bits() as i64;
        let from_origin = point.numerators.minus(&self.origin.scaled(&point.denominator));
        let numerators = from_origin.map(|c| ball(c, self.shift + bits));
        NearPoint { numerators, denominator: ball(&point.denominator, bits) }
    }

    /// The square of a distance `√(numerator / denominator)` in lattice units.
    pub(super) fn square(&self, numerator: &BigInt, denominator: &BigInt) -> Range {
        let bits = denominator.bits() as i64;
        Range::of(ball(numerator, bits + 2 * self.shift), ball(denominator, bits))
    }
}

impl Range {
    /// A quotient of what is not below zero, its denominator above zero.
    fn of(numerator: Ball, denominator: Ball) -> Range {
        // A rounding each of both ends and one of the quotient, with room; what is no number bounds nothing.
        let least = (numerator.middle - numerator.radius) / (denominator.middle + denominator.radius);
        let most = (numerator.middle + numerator.radius) / (denominator.middle - denominator.radius);
        let room = 8.0 * f64::EPSILON;
        let is_bounded = denominator.middle > denominator.radius && !most.is_nan();
        Range {
            least: if least > 0.0 { (least * (1.0 - room)).next_down() } else { 0.0 },
            most: if is_bounded { (most * (1.0 + room)).next_up() } else { f64::INFINITY },
        }
    }
}

impl<'b> NearSurface<'b> {
    pub(super) fn new(view: &View, block: &'b Block, points: &[Vec3<BigInt>]) -> NearSurface<'b> {
        let points: Vec<_> = points.iter().map(|p| view.place(p)).collect();
        let normals = block.topology().faces().iter().map(|face| face_normal(&points, face)).collect();
        let triangle = |corners: [VertexId; 3]| {
            let [a, b, c] = corners.map(|v| &points[v.index()]);
            (corners, b.minus(a).cross(&c.minus(a)))
        };
        let triangles = triangle_corners(block).map(triangle).collect();
        NearSurface { block, points, normals, triangles }
    }

    /// The ways from a point to all vertices, times the point's denominator.
    pub(super) fn ways(&self, point: &NearPoint) -> Vec<Vec3<Ball>> {
        self.points.iter().map(|v| v.scaled(&point.denominator).minus(&point.numerators)).collect()
    }

    /// Whether a point is inside, where that is certain; **one on the surface is not**, which is never certain.
    pub(super) fn holds(&self, point: &NearPoint) -> Option<bool> {
        let ways = self.ways(point);
        let is_beside = |axis: usize| {
            let signs = || ways.iter().map(|way| way.components()[axis].certain_sign());
            signs().all(|sign| matches!(sign, Some(Sign::Positive | Sign::Zero)))
                || signs().all(|sign| matches!(sign, Some(Sign::Negative | Sign::Zero)))
        };
        if (0..3).any(is_beside) {
            return Some(false);
        }
        (1..=RAYS).find_map(|k| self.is_odd(&ways, k))
    }

    /// Whether a ray along (1, k, k²) from where the ways begin crosses the surface an odd number of times. `None` where it
    /// is not certain for each triangle ([`NearSurface::ray_crosses`]).
    fn is_odd(&self, ways: &[Vec3<Ball>], k: i32) -> Option<bool> {
        let ray = ray(k);
        are_odd((0..self.triangles.len()).map(|triangle| self.ray_crosses(triangle, ways, &ray)))
    }

    /// Whether a ray from where the ways begin crosses a triangle. `None` where it is not certain that the ray's line misses it or passes through its
    /// inside away from the beginning.
    pub(super) fn ray_crosses(&self, triangle: usize, ways: &[Vec3<Ball>], ray: &Vec3<Ball>) -> Option<bool> {
        let (corners, n) = &self.triangles[triangle];
        let [a, b, c] = corners.map(|v| &ways[v.index()]);
        let (before, towards) = (n.dot(a).certain_sign(), n.dot(ray).certain_sign());
        // The plane is met at a·n / ray·n; behind the beginning is no crossing.
        let is_behind = matches!((before, towards), (Some(one), Some(two)) if one == two.reversed() && !one.is_zero());
        if is_behind {
            return Some(false);
        }
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| p.cross(q).dot(ray).certain_sign());
        if sides.contains(&Some(Sign::Positive)) && sides.contains(&Some(Sign::Negative)) {
            return Some(false);
        }
        // All on one side: of the sign of ray·n, which is their sum.
        let is_through = sides[0].is_some_and(|side| !side.is_zero()) && sides.iter().all(|side| *side == sides[0]);
        before.filter(|before| is_through && !before.is_zero()).map(|before| Some(before) == sides[0])
    }

    /// Whether the point where the ways begin may be on a triangle: `false` where it is certainly beside its plane or beyond one of its sides.
    pub(super) fn may_hold_beginning(&self, triangle: usize, ways: &[Vec3<Ball>]) -> bool {
        let (corners, n) = &self.triangles[triangle];
        let [a, b, c] = corners.map(|v| &ways[v.index()]);
        let is_beside = n.dot(a).certain_sign().is_some_and(|sign| !sign.is_zero());
        let is_beyond = |(p, q): (&Vec3<Ball>, &Vec3<Ball>)| p.cross(q).dot(n).certain_sign() == Some(Sign::Negative);
        !is_beside && ![(a, b), (b, c), (c, a)].into_iter().any(is_beyond)
    }

    /// The corners of each triangle.
    pub(super) fn triangles(&self) -> impl ExactSizeIterator<Item = [VertexId; 3]> + '_ {
        self.triangles.iter().map(|(corners, _)| *corners)
    }

    /// Which edges of another block may meet which triangles of this one: `false` for those that certainly do not.
    pub(super) fn may_be_crossed(&self, other: &NearSurface<'_>, edge: [VertexId; 2], triangle: usize) -> bool {
        let (corners, n) = &self.triangles[triangle];
        let [p, q] = edge.map(|v| &other.points[v.index()]);
        let [a, b, c] = corners.map(|v| self.points[v.index()].minus(p));
        // Both ends on the same side of the plane.
        let start = n.dot(&a).certain_sign();
        let end = n.dot(&self.points[corners[0].index()].minus(q)).certain_sign();
        if start.is_some_and(|sign| !sign.is_zero()) && start == end {
            return false;
        }
        // The edge's line passes by on the outer side of one side of the triangle and on the inner of another.
        let d = q.minus(p);
        let sides = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| p.cross(q).dot(&d).certain_sign());
        !(sides.contains(&Some(Sign::Positive)) && sides.contains(&Some(Sign::Negative)))
    }

    /// The features that may be the nearest to a point, and a bound of its distance.
    pub(super) fn nearest_features(&self, point: &NearPoint) -> NearestFeatures {
        let ways = self.ways(point);
        let topology = self.block.topology();
        let one = Ball::from_i32(1);
        let vertices: Vec<Range> = ways.iter().map(|way| Range::of(way.norm_squared(), one)).collect();
        let mut most = vertices.iter().map(|range| range.most).fold(f64::INFINITY, f64::min);
        let mut found: Vec<(Feature, f64)> = Vec::new();
        for (number, face) in topology.faces().iter().enumerate() {
            let n = &self.normals[number];
            let off = face.iter().fold(Vec3::zero(), |sum: Vec3<Ball>, v| sum.plus(&ways[v.index()])).dot(n);
            let corners = Ball::from_i32(face.len() as i32);
            let range = Range::of(off.squared(), n.norm_squared().times(&corners.squared()));
            if range.least > most {
                continue;
            }
            match projects_inside(&ways, n, face) {
                Some(false) => continue,
                Some(true) => most = most.min(range.most),
                None => {}
            }
            found.push((Feature::Face(number), range.least));
        }
        for (number, edge) in topology.edges().iter().enumerate() {
            let [p, q] = [edge.p, edge.q].map(|v| v.index());
            let d = self.points[q].minus(&self.points[p]);
            let range = Range::of(d.cross(&ways[p]).norm_squared(), d.norm_squared());
            if range.least > most {
                continue;
            }
            match [p, q].map(|v| d.dot(&ways[v]).certain_sign()) {
                [Some(Sign::Zero | Sign::Positive), _] | [_, Some(Sign::Zero | Sign::Negative)] => continue,
                [Some(_), Some(_)] => most = most.min(range.most),
                _ => {}
            }
            found.push((Feature::Edge(number), range.least));
        }
        found.extend(vertices.iter().enumerate().map(|(number, range)| (Feature::Vertex(number), range.least)));
        found.retain(|(_, least)| *least <= most);
        let features = found.into_iter().map(|(feature, _)| feature).collect();
        let most_squared = Range::of(Ball { middle: most, radius: 0.0 }, point.denominator.squared()).most;
        NearestFeatures { features, most_squared }
    }
}

/// Whether the beginning of all ways, seen along n, is inside a polygon or on its boundary, where that is certain.
fn projects_inside(ways: &[Vec3<Ball>], n: &Vec3<Ball>, corners: &[VertexId]) -> Option<bool> {
    // The polygon in a frame of two vectors across n; any frame gives the same answer.
    let size = n.components().map(|c| c.middle.abs());
    let axis = (0..3).min_by(|&j, &k| size[j].total_cmp(&size[k])).unwrap_or(0);
    let unit = |k: usize| Ball::from_i32(i32::from(k == axis));
    let u = n.cross(&Vec3::new(unit(0), unit(1), unit(2)));
    let v = n.cross(&u);
    let mut inside = false;
    for (p, q) in loop_pairs(corners) {
        let [p, q] = [p, q].map(|corner| [u.dot(&ways[corner.index()]), v.dot(&ways[corner.index()])]);
        let turn = p[0].times(&q[1]).minus(&p[1].times(&q[0])).certain_sign();
        let is_sure = |sign: Option<Sign>| sign.is_some_and(|sign| !sign.is_zero());
        // On a side's line, and not certainly beyond its ends.
        let is_beside = |k: usize| {
            let signs = [p[k], q[k]].map(Ball::certain_sign);
            is_sure(signs[0]) && signs[0] == signs[1]
        };
        if !is_sure(turn) && !is_beside(0) && !is_beside(1) {
            return None;
        }
        let below = |at: &[Ball; 2]| at[1].certain_sign().map(Sign::is_negative);
        let (p_below, q_below) = (below(&p)?, below(&q)?);
        if p_below != q_below {
            inside ^= turn.filter(|turn| !turn.is_zero())?.is_positive() == p_below;
        }
    }
    Some(inside)
}

#[cfg(test)]
mod tests;
