//! The surface of a block on the lattice of a pair: how deep a point is inside. f64 answers first wherever it proves the answer (`near`).

use super::lattice_point::{Fraction, NearestPoint};
use super::near::{Feature, NearPoint, NearSurface, NearestFeatures, View};
use crate::penetration::LatticePair;
use crate::point_in_surface::{are_odd, ray, ray_crosses, triangle_holds_origin};
use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::topology::loop_pairs;
use rockproof_model::{Block, Vec3, VertexId};
use std::cell::OnceCell;

/// Rounding to f64 bends faces of a block by less than its largest coordinate over this.
const BENT: u64 = 1 << 44;

/// The surface of a block in lattice units.
pub(super) struct LatticeSurface<'p> {
    pub(super) block: &'p Block,
    pub(super) points: &'p [Vec3<BigInt>],
    /// Normal of each face, as far as asked for.
    normals: Vec<OnceCell<Vec3<BigInt>>>,
    /// Least and greatest coordinates.
    pub(super) bounds: [Vec3<BigInt>; 2],
    view: &'p View,
    pub(super) near: NearSurface<'p>,
    /// Whether all faces are planar, if that was asked.
    is_planar: OnceCell<bool>,
}

impl<'p> LatticeSurface<'p> {
    /// `None` where no face has an area.
    pub(super) fn new(pair: &'p LatticePair<'_>, view: &'p View, side: usize) -> Option<LatticeSurface<'p>> {
        let (block, points) = (pair.blocks[side], pair.points[side].as_slice());
        let corner = |pick: fn(BigInt, BigInt) -> BigInt| {
            let first = points[0].clone();
            points.iter().cloned().fold(first, |a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        let bounds = [corner(std::cmp::min), corner(std::cmp::max)];
        let normals = vec![OnceCell::new(); block.topology().faces().len()];
        let near = NearSurface::new(view, block, points);
        let surface = LatticeSurface { block, points, normals, bounds, view, near, is_planar: OnceCell::new() };
        let has_area = (0..surface.normals.len()).any(|face| !Zero::is_zero(&surface.normal(face).norm_squared()));
        has_area.then_some(surface)
    }

    fn normal(&self, face: usize) -> &Vec3<BigInt> {
        self.normals[face].get_or_init(|| face_normal(self.points, &self.block.topology().faces()[face]))
    }

    /// How deep a point is inside; `None` where it is not inside, or not deeper than what it is to be deeper than.
    pub(super) fn depth(&self, point: Fraction, deeper_than: Option<&NearestPoint>) -> Option<NearestPoint> {
        let near = self.view.point(&point);
        let is_inside = self.near.holds(&near);
        if is_inside == Some(false) || !self.box_holds(&point) {
            return None;
        }
        let NearestFeatures { features, most_squared } = self.near.nearest_features(&near);
        let least_squared = |known: &NearestPoint| self.view.square(&known.numerator, &known.denominator).least;
        if deeper_than.is_some_and(|known| most_squared < least_squared(known)) {
            return None;
        }
        let point = point.reduced();
        let nearest = self.nearest(&point, &features)?;
        let is_deeper = deeper_than.is_none_or(|known| nearest.cmp_square(known).is_gt());
        let is_inside =
            is_deeper && !Zero::is_zero(&nearest.numerator) && is_inside.unwrap_or_else(|| self.holds(&point, &near));
        (is_inside && !self.is_in_sliver(&point, &nearest)).then_some(nearest)
    }

    /// Whether a point inside lies between triangles of one face where the block is not: the triangles of a face that is not convex reach out of it,
    /// and cancel there but for what rounding bends the face. Round a point that deep all is inside, so six points at half of its depth tell. Of depths
    /// that a bent face can have by itself it is not asked.
    fn is_in_sliver(&self, point: &Fraction, nearest: &NearestPoint) -> bool {
        if self.is_planar.get_or_init(|| self.has_planar_faces()) == &true || nearest.is_within(&self.bounds, BENT) {
            return false;
        }
        // No more than half of the depth, in units finer by the point's denominator and by 16.
        let finer = BigInt::from(16);
        let (numerators, denominator) = (point.numerators.scaled(&finer), &point.denominator * &finer);
        let half: BigInt = (&nearest.numerator * denominator.pow(2) / &nearest.denominator).sqrt() / 2;
        let beside = |k: usize, way: BigInt| {
            let mut numerators = numerators.components().map(Clone::clone);
            numerators[k] += way;
            let [x, y, z] = numerators;
            Fraction { numerators: Vec3::new(x, y, z), denominator: denominator.clone() }
        };
        let mut around = (0..3).flat_map(|k| [beside(k, half.clone()), beside(k, -&half)]);
        around.any(|other| {
            let near = self.view.point(&other);
            !self.near.holds(&near).unwrap_or_else(|| self.holds(&other, &near))
        })
    }

    /// Whether the corners of each face are in one plane, exactly.
    pub(super) fn has_planar_faces(&self) -> bool {
        let at = |v: &VertexId| &self.points[v.index()];
        let is_planar = |(number, face): (usize, &Vec<VertexId>)| {
            face.len() == 3 || face.iter().all(|v| Zero::is_zero(&self.normal(number).dot(&at(v).minus(at(&face[0])))))
        };
        self.block.topology().faces().iter().enumerate().all(is_planar)
    }

    /// Whether a point is inside the block's box; **its surface does not count**.
    fn box_holds(&self, point: &Fraction) -> bool {
        let [to_low, to_high] = self.bounds.each_ref().map(|corner| point.way_to(corner));
        let below = to_low.components().into_iter().all(BigInt::is_negative);
        below && to_high.components().into_iter().all(BigInt::is_positive)
    }

    /// The nearest of some features, the first of several: faces, edges, vertices.
    pub(super) fn nearest(&self, point: &Fraction, features: &[Feature]) -> Option<NearestPoint> {
        let of = |feature: &Feature| match *feature {
            Feature::Face(face) => self.to_face(point, face),
            Feature::Edge(edge) => self.to_edge(point, edge),
            Feature::Vertex(vertex) => {
                let way = point.way_to(&self.points[vertex]);
                Some(NearestPoint { numerator: way.norm_squared(), denominator: BigInt::one(), way })
            }
        };
        // `min_by` keeps the first of several.
        let nearest = features.iter().filter_map(of).min_by(NearestPoint::cmp_square)?;
        Some(nearest.on_coarser_lattice(&point.denominator))
    }

    /// Whether a point, seen along a face's normal, is on the face or its boundary; **over a face without an area none is**.
    pub(super) fn is_over_face(&self, point: &Fraction, face: usize) -> bool {
        self.ways_over_face(point, face).is_some()
    }

    /// The ways from such a point to the face's corners; `None` of any other.
    fn ways_over_face(&self, point: &Fraction, face: usize) -> Option<Vec<Vec3<BigInt>>> {
        let (n, corners) = (self.normal(face), &self.block.topology().faces()[face]);
        let ways: Vec<_> = corners.iter().map(|v| point.way_to(&self.points[v.index()])).collect();
        (!Zero::is_zero(&n.norm_squared()) && projects_inside(n, &ways)).then_some(ways)
    }

    /// The foot on a face's plane, where it is inside the polygon or on its boundary, in units finer by the point's
    /// denominator.
    fn to_face(&self, point: &Fraction, face: usize) -> Option<NearestPoint> {
        let ways = self.ways_over_face(point, face)?;
        let n = self.normal(face).scaled(&(&point.denominator * &point.denominator));
        // The plane goes through the corners' mean: k times the distance times |N|.
        let k = BigInt::from(ways.len());
        let off = n.dot(&ways.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, way| sum.plus(way)));
        let denominator = n.norm_squared() * &k * &k;
        let way = if off.is_negative() { n.negated() } else { n };
        Some(NearestPoint { numerator: &off * &off, denominator, way })
    }

    /// The foot on an edge, where it is strictly inside, in units finer by the point's denominator.
    fn to_edge(&self, point: &Fraction, edge: usize) -> Option<NearestPoint> {
        let edge = &self.block.topology().edges()[edge];
        let [p, q] = [edge.p, edge.q].map(|v| point.way_to(&self.points[v.index()]));
        let (d, from) = (q.minus(&p), p.negated());
        let (along, length) = (d.dot(&from), d.norm_squared());
        if !along.is_positive() || along >= length {
            return None;
        }
        let way = d.scaled(&along).minus(&from.scaled(&length));
        Some(NearestPoint { numerator: way.norm_squared(), denominator: &length * &length, way })
    }

    /// Whether a point is inside; **one on the surface is not**. An uneven face's triangles are not in the face's plane, so
    /// a point on them can have a distance from it. Exact numbers are asked only of triangles that f64 leaves open.
    pub(super) fn holds(&self, point: &Fraction, near: &NearPoint) -> bool {
        let near_ways = self.near.ways(near);
        let ways = vec![OnceCell::new(); self.points.len()];
        let way = |v: VertexId| ways[v.index()].get_or_init(|| point.way_to(&self.points[v.index()]));
        let triangles = || self.near.triangles().enumerate();
        let is_on = |(triangle, corners)| {
            self.near.may_hold_beginning(triangle, &near_ways) && triangle_holds_origin(<[_; 3]>::map(corners, way))
        };
        if triangles().any(is_on) {
            return false;
        }
        // As `surface_holds_origin` does it, along the same rays.
        let along = |k: i32| {
            let (near_ray, exact_ray) = (ray(k), ray(k));
            are_odd(triangles().map(|(triangle, corners)| {
                let seen = self.near.ray_crosses(triangle, &near_ways, &near_ray);
                seen.or_else(|| ray_crosses(corners.map(way), &exact_ray))
            }))
        };
        (1..).find_map(along).unwrap_or(false)
    }
}

/// Whether the beginning of the ways to a polygon's corners, seen along n, is inside the polygon or on its boundary.
fn projects_inside(n: &Vec3<BigInt>, ways: &[Vec3<BigInt>]) -> bool {
    // The polygon in a frame of two vectors across n: u and n × u, neither of unit length.
    let size = n.components().map(|c| c.abs());
    let axis = (0..3).min_by_key(|&k| &size[k]).unwrap_or(0);
    let unit = |k: usize| BigInt::from(i32::from(k == axis));
    let u = n.cross(&Vec3::new(unit(0), unit(1), unit(2)));
    let v = n.cross(&u);
    let flat: Vec<[BigInt; 2]> = ways.iter().map(|way| [u.dot(way), v.dot(way)]).collect();
    let mut inside = false;
    for (p, q) in loop_pairs(&(0..flat.len()).collect::<Vec<_>>()) {
        let (p, q) = (&flat[p], &flat[q]);
        let turn = &p[0] * &q[1] - &p[1] * &q[0];
        let within = |k: usize| !(&p[k] * &q[k]).is_positive();
        if Zero::is_zero(&turn) && within(0) && within(1) {
            return true;
        }
        if p[1].is_negative() != q[1].is_negative() && turn.is_positive() == p[1].is_negative() {
            inside = !inside;
        }
    }
    inside
}
