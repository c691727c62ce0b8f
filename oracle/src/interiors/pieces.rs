//! A triangle of a surface cut along what meets it.
//!
//! What another triangle shares with the plane of the one to be cut, the base, is a segment, or for one in the plane its three
//! edges. A part of the base is cut along a segment's line only where the segment passes through the part's inside, so that no
//! segment passes through the inside of a piece in the end. The parts are convex. The inside of a convex polygon and a segment
//! share no point exactly where the line of a side of the polygon or that of the segment separates them, as it is with all
//! convex polygons in a plane: their difference, the polygon's points less the segment's, has no sides in other directions.

use super::surfaces::{HomogeneousPoint, Surfaces, Triangle, ball};
use crate::number::Ball;
use num_bigint::BigInt;
use num_traits::Zero;
use rockproof_model::block::Point;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Sign, Vec3, VertexId};
use std::cell::OnceCell;
use std::rc::Rc;

/// A vector of three homogeneous coordinates in the plane of two of the axes.
struct Homogeneous {
    exact: Vec3<BigInt>,
    /// The same times a power of two.
    near: Vec3<Ball>,
}

impl Homogeneous {
    fn new(exact: Vec3<BigInt>) -> Homogeneous {
        let shift = exact.components().into_iter().map(|c| c.bits() as i64).max().unwrap_or(0);
        Homogeneous { near: exact.map(|c| ball(c, shift)), exact }
    }

    fn sign_of_product(&self, other: &Homogeneous) -> Sign {
        let near = self.near.dot(&other.near).certain_sign();
        near.unwrap_or_else(|| ExactRing::sign(&self.exact.dot(&other.exact)))
    }
}

/// A side of a convex polygon.
#[derive(Clone)]
struct Side {
    line: Rc<Homogeneous>,
    /// The sign of the line's product with points inside.
    inner: Sign,
}

/// A convex polygon: each corner, its last coordinate above zero, with the side from it to the next.
#[derive(Clone)]
struct Polygon {
    corners: Vec<(Rc<Homogeneous>, Side)>,
    /// Whether it is the whole base.
    is_whole: bool,
}

/// What a triangle shares with the plane of the base.
struct Segment {
    line: Rc<Homogeneous>,
    /// Their last coordinates are above zero.
    ends: [Homogeneous; 2],
}

/// The plane of a triangle, the base, seen along an axis to which it is not parallel.
pub(super) struct Plane<'s> {
    surfaces: &'s Surfaces,
    base: &'s Triangle,
    /// The axis left out.
    axis: usize,
    /// Of each block what its triangles share with the plane, but for what misses the base's inside for sure, as far as asked
    /// for.
    segments: [OnceCell<Vec<Segment>>; 2],
}

/// A part of a triangle.
pub(super) struct Piece<'s> {
    plane: &'s Plane<'s>,
    polygon: Polygon,
}

impl<'s> Plane<'s> {
    /// The plane of a triangle of a surface.
    pub(super) fn of(surfaces: &'s Surfaces, base: usize) -> Plane<'s> {
        let base = &surfaces.triangles()[base];
        let across = base.across(surfaces).components();
        let axis = (0..3).max_by_key(|&axis| across[axis].magnitude()).unwrap_or(0);
        Plane { surfaces, base, axis, segments: [OnceCell::new(), OnceCell::new()] }
    }

    /// The whole triangle.
    pub(super) fn whole(&self) -> Piece<'_> {
        let corners = self.base.corners.map(|v| Rc::new(self.flat_vertex(self.base.block, v)));
        let side = |k: usize| {
            let line = Homogeneous::new(corners[k].exact.cross(&corners[(k + 1) % 3].exact));
            let inner = line.sign_of_product(&corners[(k + 2) % 3]);
            (corners[k].clone(), Side { line: Rc::new(line), inner })
        };
        Piece { plane: self, polygon: Polygon { corners: [side(0), side(1), side(2)].into(), is_whole: true } }
    }

    /// What the triangles of a block share with the plane.
    fn segments(&self, block: usize) -> &[Segment] {
        self.segments[block].get_or_init(|| {
            let mut segments = Vec::new();
            for other in self.surfaces.near(block, self.base).filter(|other| !std::ptr::eq(self.base, *other)) {
                self.add_segments(other, &mut segments);
            }
            segments
        })
    }

    /// Adds what another triangle shares with the plane, where it may pass through the base.
    fn add_segments(&self, other: &Triangle, segments: &mut Vec<Segment>) {
        let signs = self.surfaces.sides(self.base, other);
        let corners = [0, 1, 2].map(|k| (other.corners[k], signs[k]));
        let edges = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
        if signs.iter().filter(|sign| sign.is_zero()).count() >= 2 {
            for [(p, at_p), (q, at_q)] in edges {
                let is_own = other.block == self.base.block && [p, q].iter().all(|v| self.base.corners.contains(v));
                if at_p.is_zero() && at_q.is_zero() && !is_own {
                    let ends = [p, q].map(|v| self.flat_vertex(other.block, v));
                    let line = Rc::new(Homogeneous::new(ends[0].exact.cross(&ends[1].exact)));
                    segments.push(Segment { line, ends });
                }
            }
        } else if signs.contains(&Sign::Negative) && signs.contains(&Sign::Positive) {
            let base = self.surfaces.sides(other, self.base);
            if base.contains(&Sign::Negative) && base.contains(&Sign::Positive) {
                let on_plane = corners.into_iter().filter(|(_, sign)| sign.is_zero());
                let ends = on_plane.map(|(v, _)| self.flat_vertex(other.block, v)).chain(
                    edges
                        .into_iter()
                        .filter(|[(_, at_p), (_, at_q)]| !at_p.is_zero() && *at_q == at_p.reversed())
                        .map(|edge| self.crossing_of_edge(other.block, edge.map(|(v, _)| v))),
                );
                let ends: Result<[Homogeneous; 2], _> = ends.collect::<Vec<_>>().try_into();
                segments.extend(ends.ok().map(|ends| Segment { line: Rc::new(self.common_line(other)), ends }));
            }
        }
    }

    /// A vertex in the plane without its coordinate along the axis.
    fn flat_vertex(&self, block: usize, vertex: VertexId) -> Homogeneous {
        let [u, v, _] = self.turned(self.surfaces.vertex(block, vertex));
        Homogeneous::new(Vec3::new(u.clone(), v.clone(), BigInt::from(1)))
    }

    /// A vector with its coordinate along the axis last.
    fn turned<'v>(&self, v: &'v Vec3<BigInt>) -> [&'v BigInt; 3] {
        [1, 2, 0].map(|k| v.components()[(self.axis + k) % 3])
    }

    /// Where an edge passes through the plane, its vertices being on different sides.
    fn crossing_of_edge(&self, block: usize, vertices: [VertexId; 2]) -> Homogeneous {
        let [p, q] = vertices.map(|v| self.surfaces.vertex(block, v));
        let first = self.surfaces.vertex(self.base.block, self.base.corners[0]);
        let [at_p, at_q] = [p, q].map(|end| self.base.across(self.surfaces).dot(&end.minus(first)));
        let [[pu, pv, _], [qu, qv, _]] = [p, q].map(|end| self.turned(end));
        homogeneous_point(Vec3::new(pu * &at_q - qu * &at_p, pv * &at_q - qv * &at_p, at_q - at_p))
    }

    /// The line that another triangle's plane shares with this one.
    fn common_line(&self, other: &Triangle) -> Homogeneous {
        let ((n, d), (m, e)) = (self.equation(self.base), self.equation(other));
        let ([nu, nv, nw], [mu, mv, mw]) = (self.turned(n), self.turned(m));
        Homogeneous::new(Vec3::new(mu * nw - mw * nu, mv * nw - mw * nv, mw * d - e * nw))
    }

    /// The n and d of a triangle's plane `n·p = d`.
    fn equation<'t>(&self, triangle: &'t Triangle) -> (&'t Vec3<BigInt>, BigInt) {
        let n = triangle.across(self.surfaces);
        (n, n.dot(self.surfaces.vertex(triangle.block, triangle.corners[0])))
    }

    /// The point of the plane above a point of the flat polygon.
    fn point_above(&self, flat: &Vec3<BigInt>) -> HomogeneousPoint {
        let (n, d) = self.equation(self.base);
        let [nu, nv, nw] = self.turned(n);
        let last = d * &flat.z - nu * &flat.x - nv * &flat.y;
        let mut along = [BigInt::zero(), BigInt::zero(), BigInt::zero()];
        along[(self.axis + 1) % 3] = &flat.x * nw;
        along[(self.axis + 2) % 3] = &flat.y * nw;
        along[self.axis] = last;
        let [x, y, z] = along;
        HomogeneousPoint::new(Vec3::new(x, y, z), &flat.z * nw)
    }
}

impl Polygon {
    fn signs(&self, line: &Homogeneous) -> Vec<Sign> {
        self.corners.iter().map(|(corner, _)| line.sign_of_product(corner)).collect()
    }

    /// Whether a line passes through the inside.
    fn is_passed_by(&self, line: &Homogeneous) -> bool {
        let signs = self.signs(line);
        signs.contains(&Sign::Negative) && signs.contains(&Sign::Positive)
    }

    /// Whether a segment passes through the inside.
    fn is_reached_by(&self, segment: &Segment) -> bool {
        self.is_passed_by(&segment.line)
            && self
                .corners
                .iter()
                .all(|(_, side)| segment.ends.iter().any(|end| side.line.sign_of_product(end) == side.inner))
    }

    /// The parts on both sides of a line that passes through the inside: below zero and above.
    fn split(&self, line: &Rc<Homogeneous>) -> [Polygon; 2] {
        let signs = self.signs(line);
        let along = [Sign::Negative, Sign::Positive].map(|inner| Side { line: line.clone(), inner });
        let mut halves = [Vec::new(), Vec::new()];
        for (i, (corner, side)) in self.corners.iter().enumerate() {
            let next = signs[(i + 1) % signs.len()];
            let half = |sign: Sign| usize::from(sign.is_positive());
            match (signs[i], next) {
                (Sign::Zero, next) => {
                    let [own, other] = [half(next), half(next.reversed())];
                    halves[own].push((corner.clone(), side.clone()));
                    halves[other].push((corner.clone(), along[other].clone()));
                }
                (own, next) if next == own.reversed() => {
                    let crossing = Rc::new(homogeneous_point(side.line.exact.cross(&line.exact)));
                    let [own, next] = [half(own), half(next)];
                    halves[own].push((corner.clone(), side.clone()));
                    halves[own].push((crossing.clone(), along[own].clone()));
                    halves[next].push((crossing, side.clone()));
                }
                (own, _) => halves[half(own)].push((corner.clone(), side.clone())),
            }
        }
        halves.map(|corners| Polygon { corners, is_whole: false })
    }
}

/// A point whose last coordinate is not zero, so that it is above zero.
fn homogeneous_point(point: Vec3<BigInt>) -> Homogeneous {
    let is_negative = ExactRing::sign(&point.z).is_negative();
    Homogeneous::new(if is_negative { point.negated() } else { point })
}

impl Piece<'_> {
    /// Whether one of the parts is as asked into which a block's triangles cut the piece: none passes through such a part.
    ///
    /// Of the segments that pass through a part, the middle one of the list cuts it, and the others are handed on to the
    /// halves through which they pass. A segment passes through a half when its line does and one of its ends is on this side
    /// of the cut: the other sides of the half are sides of the part, which do not separate it.
    pub(super) fn any_part(&self, block: usize, asked: impl Fn(&Piece<'_>) -> bool) -> bool {
        let whole = &self.polygon;
        let reaching: Vec<&Segment> =
            self.plane.segments(block).iter().filter(|segment| whole.is_reached_by(segment)).collect();
        let mut open = vec![(whole.clone(), reaching)];
        while let Some((polygon, mut segments)) = open.pop() {
            if segments.is_empty() {
                if asked(&Piece { plane: self.plane, polygon }) {
                    return true;
                }
                continue;
            }
            let cut = &segments.swap_remove(segments.len() / 2).line;
            let ends: Vec<[Sign; 2]> =
                segments.iter().map(|segment| segment.ends.each_ref().map(|end| cut.sign_of_product(end))).collect();
            for (half, inner) in polygon.split(cut).into_iter().zip([Sign::Negative, Sign::Positive]) {
                let here =
                    segments.iter().zip(&ends).filter(|(_, ends)| ends.contains(&inner)).map(|(segment, _)| *segment);
                let here = here.filter(|segment| half.is_passed_by(&segment.line)).collect();
                open.push((half, here));
            }
        }
        false
    }

    /// Whether the piece is its whole triangle.
    pub(super) fn is_whole(&self) -> bool {
        self.polygon.is_whole
    }

    /// The corners in m.
    pub(super) fn corners(&self) -> Vec<Point> {
        let plane = self.plane;
        let place = |corner: &Homogeneous| plane.surfaces.in_metres(&plane.point_above(&corner.exact));
        self.polygon.corners.iter().map(|(corner, _)| place(corner)).collect()
    }

    /// Whether it is inside a block next to the piece, through which none of the block's triangles passes: below it and above
    /// it, as its triangle's vector across points.
    ///
    /// What holds next to one point of the piece holds next to all but those on lines and in points where triangles stand
    /// on it. So the point is on no triangle but those in the plane: weights 1, j, j² of three corners, with the first j for which
    /// that is so. Each other plane excludes two j at most.
    pub(super) fn insides(&self, block: usize) -> [bool; 2] {
        let plane = self.plane;
        let asked = |place: &HomogeneousPoint| plane.surfaces.insides(block, place, plane.base);
        (1i32..).find_map(|j| asked(&self.point(j))).unwrap_or_default()
    }

    /// A point strictly within the piece.
    fn point(&self, j: i32) -> HomogeneousPoint {
        let weights = [1, j, j * j].map(BigInt::from);
        let sum = &weights[0] + &weights[1] + &weights[2];
        if self.is_whole() {
            let base = self.plane.base;
            let corners = base.corners.iter().zip(&weights);
            let weighted = corners.map(|(&v, w)| self.plane.surfaces.vertex(base.block, v).scaled(w));
            return HomogeneousPoint::new(weighted.fold(Vec3::zero(), |sum, p| sum.plus(&p)), sum);
        }
        let corners = [0, 1, 2].map(|k| &self.polygon.corners[k].0.exact);
        let below = |k: usize| &corners[(k + 1) % 3].z * &corners[(k + 2) % 3].z;
        let flat = (0..3).fold(Vec3::zero(), |flat: Vec3<BigInt>, k| {
            let factor = &weights[k] * below(k);
            flat.plus(&Vec3::new(&corners[k].x * &factor, &corners[k].y * &factor, BigInt::zero()))
        });
        let denominator = &corners[0].z * &corners[1].z * &corners[2].z * sum;
        self.plane.point_above(&Vec3::new(flat.x, flat.y, denominator))
    }
}
