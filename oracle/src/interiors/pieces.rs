//! A triangle of a surface cut along what meets it.

use super::surfaces::{HomogeneousPoint, Surfaces, Triangle, ball};
use crate::number::Ball;
use num_bigint::BigInt;
use num_traits::Zero;
use rockproof_model::block::Point;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Sign, Vec3, VertexId};
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

/// A convex polygon: each corner, its last coordinate above zero, with the number of the line from it to the next.
type Polygon = Vec<(Rc<Homogeneous>, usize)>;

/// The plane of a triangle, seen along an axis to which it is not parallel.
struct Plane<'s> {
    surfaces: &'s Surfaces,
    base: &'s Triangle,
    /// The axis left out.
    axis: usize,
    /// Which triangles are in it.
    holds: Vec<bool>,
    /// Lines in it: the triangle's edges, then those to cut along.
    lines: Vec<Homogeneous>,
}

/// A part of a triangle through which no triangle passes.
pub(super) struct Piece<'s> {
    plane: &'s Plane<'s>,
    /// Its corners, of the piece that is the whole triangle those of the triangle.
    polygon: &'s Polygon,
}

/// Whether one of a triangle's pieces is as asked.
pub(super) fn any(surfaces: &Surfaces, base: usize, asked: impl Fn(&Piece<'_>) -> bool) -> bool {
    let plane = Plane::of(surfaces, base);
    let corners = plane.base.corners.map(|v| plane.flat(surfaces.vertex(plane.base.block, v)));
    let corners = corners.map(|[u, v]| Rc::new(Homogeneous::new(Vec3::new(u, v, BigInt::from(1)))));
    let polygon = corners.into_iter().enumerate().map(|(edge, corner)| (corner, edge)).collect();
    plane.any_piece(polygon, 3, &asked)
}

impl<'s> Plane<'s> {
    fn of(surfaces: &'s Surfaces, base: usize) -> Plane<'s> {
        let sides = surfaces.sides(&surfaces.triangles()[base]);
        let base = &surfaces.triangles()[base];
        let across = base.across(surfaces).components();
        let axis = (0..3).max_by_key(|&axis| across[axis].magnitude()).unwrap_or(0);
        let mut plane = Plane { surfaces, base, axis, holds: Vec::new(), lines: Vec::new() };
        let [a, b, c] = base.corners;
        for edge in [[a, b], [b, c], [c, a]] {
            plane.add_edge(base.block, edge);
        }
        for other in surfaces.triangles() {
            let signs = other.corners.map(|v| sides[other.block][v.index()]);
            let count = |sign: Sign| signs.iter().filter(|&&s| s == sign).count();
            plane.holds.push(count(Sign::Zero) == 3);
            if !std::ptr::eq(base, other) && base.is_near(other) {
                plane.add_cuts(other, signs, count(Sign::Zero));
            }
        }
        plane
    }

    /// Adds the lines along which another triangle cuts the base, its vertices being on these sides.
    fn add_cuts(&mut self, other: &Triangle, signs: [Sign; 3], zeros: usize) {
        let [a, b, c] = other.corners;
        let on_plane = |v: VertexId| other.corners.iter().zip(signs).any(|(&own, sign)| own == v && sign.is_zero());
        if zeros >= 2 {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                let is_own = other.block == self.base.block && [p, q].iter().all(|v| self.base.corners.contains(v));
                if on_plane(p) && on_plane(q) && !is_own {
                    self.add_edge(other.block, [p, q]);
                }
            }
        } else if signs.contains(&Sign::Negative) && signs.contains(&Sign::Positive) {
            let base = self.base.corners.map(|v| self.surfaces.side(other, self.base.block, v));
            if base.contains(&Sign::Negative) && base.contains(&Sign::Positive) {
                self.add_plane(other);
            }
        }
    }

    /// A point without its coordinate along the axis.
    fn flat(&self, p: &Vec3<BigInt>) -> [BigInt; 2] {
        [1, 2].map(|k| p.components()[(self.axis + k) % 3].clone())
    }

    /// A vector with its coordinate along the axis last.
    fn turned(&self, v: &Vec3<BigInt>) -> [BigInt; 3] {
        [1, 2, 0].map(|k| v.components()[(self.axis + k) % 3].clone())
    }

    /// The line through two points of the plane.
    fn add_edge(&mut self, block: usize, vertices: [VertexId; 2]) {
        let [p, q] = vertices.map(|v| {
            let [u, v] = self.flat(self.surfaces.vertex(block, v));
            Vec3::new(u, v, BigInt::from(1))
        });
        self.lines.push(Homogeneous::new(p.cross(&q)));
    }

    /// The line that another triangle's plane shares with this one.
    fn add_plane(&mut self, other: &Triangle) {
        let ((n, d), (m, e)) = (self.equation(self.base), self.equation(other));
        let [nu, nv, nw] = self.turned(&n);
        let [mu, mv, mw] = self.turned(&m);
        let line = Vec3::new(mu * &nw - &mw * nu, mv * &nw - &mw * nv, mw * d - e * nw);
        self.lines.push(Homogeneous::new(line));
    }

    /// The n and d of a triangle's plane `n·p = d`.
    fn equation(&self, triangle: &Triangle) -> (Vec3<BigInt>, BigInt) {
        let n = triangle.across(self.surfaces);
        (n.clone(), n.dot(self.surfaces.vertex(triangle.block, triangle.corners[0])))
    }

    /// The point of the plane above a point of the flat polygon.
    fn point_above(&self, flat: &Vec3<BigInt>) -> HomogeneousPoint {
        let (n, d) = self.equation(self.base);
        let [nu, nv, nw] = self.turned(&n);
        let last = d * &flat.z - nu * &flat.x - nv * &flat.y;
        let mut along = [BigInt::zero(), BigInt::zero(), BigInt::zero()];
        along[(self.axis + 1) % 3] = &flat.x * &nw;
        along[(self.axis + 2) % 3] = &flat.y * &nw;
        along[self.axis] = last;
        let [x, y, z] = along;
        HomogeneousPoint::new(Vec3::new(x, y, z), &flat.z * nw)
    }

    /// Cuts a polygon along the lines from one on, and asks about the pieces.
    fn any_piece(&self, polygon: Polygon, from: usize, asked: &dyn Fn(&Piece<'_>) -> bool) -> bool {
        for line in from..self.lines.len() {
            if let Some(halves) = self.split(&polygon, line) {
                return halves.into_iter().any(|half| self.any_piece(half, line + 1, asked));
            }
        }
        asked(&Piece { plane: self, polygon: &polygon })
    }

    /// The parts of a polygon on both sides of a line; `None` where the line does not pass through it.
    fn split(&self, polygon: &Polygon, line: usize) -> Option<[Polygon; 2]> {
        let signs: Vec<Sign> = polygon.iter().map(|(corner, _)| self.lines[line].sign_of_product(corner)).collect();
        if !signs.contains(&Sign::Negative) || !signs.contains(&Sign::Positive) {
            return None;
        }
        let mut halves = [Polygon::new(), Polygon::new()];
        for (i, (corner, edge)) in polygon.iter().enumerate() {
            let next = signs[(i + 1) % signs.len()];
            let half = |sign: Sign| usize::from(sign.is_positive());
            match (signs[i], next) {
                (Sign::Zero, next) => {
                    halves[half(next)].push((corner.clone(), *edge));
                    halves[half(next.reversed())].push((corner.clone(), line));
                }
                (own, next) if next == own.reversed() => {
                    let crossing = Rc::new(self.crossing(*edge, line));
                    halves[half(own)].push((corner.clone(), *edge));
                    halves[half(own)].push((crossing.clone(), line));
                    halves[half(next)].push((crossing, *edge));
                }
                (own, _) => halves[half(own)].push((corner.clone(), *edge)),
            }
        }
        Some(halves)
    }

    /// Where two lines that are not parallel meet.
    fn crossing(&self, one: usize, other: usize) -> Homogeneous {
        let point = self.lines[one].exact.cross(&self.lines[other].exact);
        let is_negative = ExactRing::sign(&point.z).is_negative();
        Homogeneous::new(if is_negative { point.negated() } else { point })
    }
}

impl Piece<'_> {
    /// Whether the piece is its whole triangle: each half of a cut has a side along the cut.
    pub(super) fn is_whole(&self) -> bool {
        self.polygon.iter().all(|(_, edge)| *edge < 3)
    }

    /// The corners in m.
    pub(super) fn corners(&self) -> Vec<Point> {
        let plane = self.plane;
        self.polygon.iter().map(|(corner, _)| plane.surfaces.in_metres(&plane.point_above(&corner.exact))).collect()
    }

    /// Whether it is inside a block next to the piece: below it and above it, as its triangle's vector across points.
    ///
    /// What holds next to one point of the piece holds next to all but those on lines and in points where triangles stand
    /// on it. So the point is in no other triangle's plane: weights 1, j, j² of three corners, with the first j for which
    /// that is so. Each plane excludes two j at most.
    pub(super) fn insides(&self, block: usize) -> [bool; 2] {
        let plane = self.plane;
        let asked = |place: &HomogeneousPoint| plane.surfaces.insides(block, place, plane.base, &plane.holds);
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
        let corners = [0, 1, 2].map(|k| &self.polygon[k].0.exact);
        let below = |k: usize| &corners[(k + 1) % 3].z * &corners[(k + 2) % 3].z;
        let flat = (0..3).fold(Vec3::zero(), |flat: Vec3<BigInt>, k| {
            let factor = &weights[k] * below(k);
            flat.plus(&Vec3::new(&corners[k].x * &factor, &corners[k].y * &factor, BigInt::zero()))
        });
        let denominator = &corners[0].z * &corners[1].z * &corners[2].z * sum;
        self.plane.point_above(&Vec3::new(flat.x, flat.y, denominator))
    }
}
