//! The deepest point of one block inside the other: what overlap means where a block is not convex.
//!
//! The inside of a block is that of its faces' triangles from the first vertex of each loop, as its volume is. A
//! point's depth is its distance from the other's surface, the least over the faces (where its foot on the plane is
//! inside the polygon), the edges (where its foot is inside) and the vertices. The points looked at are the first sort of these of which some are
//! inside; the third only where the interiors meet:
//!
//! 1. the vertices of either block;
//! 2. the middles of edges between crossings: where an edge passes through faces of the other block it is cut, and the
//!    middle of each part is looked at. A crossing itself is on both surfaces and so no depth; the stretch of the edge
//!    between two crossings is what is inside, and its middle, a rational point, stands for it;
//! 3. the same of the diagonals by which faces of four vertices and more are cut into triangles: faces bent by rounding are passed through
//!    by nothing else where both blocks have all their vertices.
//!
//! Blocks overlap without these where their surfaces coincide, as those of two equal blocks do; and where surfaces nearly coincide, these are next to
//! the surface, however deep the blocks overlap. So where they are [`SHALLOW`] or none, the deepest is looked for among them and
//!
//! 4. the middles of convex cells in both blocks (`common_cells`). Where neither these nor the points before are inside, and all faces are planar,
//! 5. the middles of the common parts of the blocks' convex cells, cut exactly ([`crate::convex_cells`]). Where faces are bent, the depth is then 0: the blocks
//!    overlap in slivers between bent faces, or in a part too narrow for the cells of 4 (`common_cells::NARROW`).
//!
//! Of 4 and 5 the depth is the lesser of the distances from both surfaces, as the point is a corner of neither. Of all but the vertices the depth is
//! that of points inside, at most that of the deepest ones.
//!
//! f64 answers first wherever it proves the answer (`near`); what is left is exact.

mod common_cells;
mod lattice_point;
mod near;

use super::{LatticePair, Penetration};
use crate::Gap;
use crate::convex_cells::{ConvexCell, cells};
use crate::interiors::surfaces_meet;
use crate::point_in_surface::{surface_holds_origin, triangle_corners, triangle_holds_origin};
use crate::separation::{SeparablePoints, separate};
use lattice_point::{Fraction, NearestPoint};
use near::{Feature, NearSurface, View};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::topology::loop_pairs;
use rockproof_model::{Block, Sign, Vec3, VertexId};
use std::cell::OnceCell;

/// A depth of the largest coordinate over this or less may be all that vertices show of a deep overlap, where surfaces nearly coincide: by rounding, by
/// the unevenness of faces, or since one block was moved a little against another like it. It is far more than `penetration` and unevenness are.
const SHALLOW: u64 = 1 << 4;

/// Rounding to f64 bends faces of a block by less than its largest coordinate over this.
const BENT: u64 = 1 << 44;

/// The deepest point of either block; `None` where a block has no face with an area.
pub(super) fn deepest_point(pair: &LatticePair<'_>) -> Option<Penetration> {
    let view = View::of([&pair.points[0], &pair.points[1]]);
    let surfaces = [LatticeSurface::new(pair, &view, 0)?, LatticeSurface::new(pair, &view, 1)?];
    let best = deepest_vertex(&surfaces).or_else(|| {
        deepest_of(&surfaces, |side| {
            surfaces[side].middles_between_crossings(&surfaces[1 - side], edges(pair.blocks[side]))
        })
    });
    let best = match best {
        Some(best) if !surfaces.iter().any(|surface| best.nearest.is_within(&surface.bounds, SHALLOW)) => Some(best),
        None if !interiors_meet(pair) => None,
        best => {
            let diagonals = |side: usize| {
                surfaces[side].middles_between_crossings(&surfaces[1 - side], diagonals(pair.blocks[side]))
            };
            let best = best.or_else(|| deepest_of(&surfaces, diagonals));
            let middles = common_cells::middles(pair.blocks);
            let middles = middles.into_iter().filter_map(|middle| Some(Fraction::of(&pair.in_units(middle)?)));
            deepest_common(&surfaces, best, middles).or_else(|| {
                let is_planar = surfaces.iter().all(LatticeSurface::has_planar_faces);
                if is_planar { deepest_common(&surfaces, None, exact_middles(pair)) } else { None }
            })
        }
    };
    let Some(DeepPoint { nearest, is_of_a }) = best else {
        return Some(Penetration::none());
    };
    // A's point moves to the surface; where it is B's, A moves the other way.
    let way = if is_of_a { nearest.way } else { nearest.way.negated() };
    let squared = pair.square_metres(nearest.numerator, nearest.denominator);
    let direction = way.map(|c| BigRational::from_integer(c.clone()));
    Some(Penetration { gap: Gap { sign: Sign::Negative, squared }, direction })
}

/// A point inside the other block, by its nearest point on the other's surface.
struct DeepPoint {
    nearest: NearestPoint,
    is_of_a: bool,
}

fn deepest_vertex(surfaces: &[LatticeSurface<'_>; 2]) -> Option<DeepPoint> {
    deepest_of(surfaces, |side| surfaces[side].points.iter().map(|p| Fraction::whole(p.clone())).collect())
}

/// The deepest of some points of each block, the first of several equally deep.
fn deepest_of(surfaces: &[LatticeSurface<'_>; 2], points: impl Fn(usize) -> Vec<Fraction>) -> Option<DeepPoint> {
    let mut best: Option<DeepPoint> = None;
    for side in 0..2 {
        let other = &surfaces[1 - side];
        for point in points(side) {
            let deeper_than_best =
                |nearest: &NearestPoint| best.as_ref().is_none_or(|best| nearest.cmp_square(&best.nearest).is_gt());
            if let Some(nearest) = other.depth(point, deeper_than_best) {
                best = Some(DeepPoint { nearest, is_of_a: side == 0 });
            }
        }
    }
    best
}

/// Whether the interiors of two blocks meet.
fn interiors_meet(pair: &LatticePair<'_>) -> bool {
    let [a, b] = pair.blocks.map(|block| SeparablePoints::new(block.vertices().to_vec()));
    !separate(a.set(), b.set()).is_separated && surfaces_meet(pair.blocks[0], pair.blocks[1])
}

/// The ends of a block's edges.
fn edges(block: &Block) -> Vec<[VertexId; 2]> {
    block.topology().edges().iter().map(|edge| [edge.p, edge.q]).collect()
}

/// The ends of the diagonals by which its faces are cut into triangles.
fn diagonals(block: &Block) -> Vec<[VertexId; 2]> {
    let of_face = |face: &Vec<VertexId>| (2..face.len() - 1).map(|k| [face[0], face[k]]).collect::<Vec<_>>();
    block.topology().faces().iter().flat_map(of_face).collect()
}

/// The middles of what two of the blocks' convex cells share.
fn exact_middles(pair: &LatticePair<'_>) -> impl Iterator<Item = Fraction> {
    let [ones, twos] = pair.blocks.map(cells);
    let (units, metres) = pair.scale.clone();
    let shared = move |one: ConvexCell| twos.iter().filter_map(|two| one.common(two)).collect::<Vec<_>>();
    let parts = ones.into_iter().flat_map(shared);
    parts.map(move |common| Fraction::of(&common.middle().map(|c| c * &units / &metres)))
}

/// The deepest of a point and of some points that are corners of neither block: the first of several equally deep.
fn deepest_common(
    surfaces: &[LatticeSurface<'_>; 2],
    mut best: Option<DeepPoint>,
    points: impl Iterator<Item = Fraction>,
) -> Option<DeepPoint> {
    for point in points {
        let deeper =
            |nearest: &NearestPoint| best.as_ref().is_none_or(|best| nearest.cmp_square(&best.nearest).is_gt());
        // Deep in B as a point of A, and the other way round.
        let Some(as_a) = surfaces[1].depth(point.clone(), deeper) else { continue };
        let Some(as_b) = surfaces[0].depth(point, deeper) else { continue };
        let is_of_a = as_a.cmp_square(&as_b).is_le();
        best = Some(DeepPoint { nearest: if is_of_a { as_a } else { as_b }, is_of_a });
    }
    best
}

/// The surface of a block in lattice units.
struct LatticeSurface<'p> {
    block: &'p Block,
    points: &'p [Vec3<BigInt>],
    /// Normal of each face, as far as asked for.
    normals: Vec<OnceCell<Vec3<BigInt>>>,
    /// Least and greatest coordinates.
    bounds: [Vec3<BigInt>; 2],
    view: &'p View,
    near: NearSurface<'p>,
    /// Whether all faces are planar, if that was asked.
    is_planar: OnceCell<bool>,
}

impl<'p> LatticeSurface<'p> {
    /// `None` where no face has an area.
    fn new(pair: &'p LatticePair<'_>, view: &'p View, side: usize) -> Option<LatticeSurface<'p>> {
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

    /// How deep a point is inside; `None` where it is not inside, or its depth not one that is asked for.
    fn depth(&self, point: Fraction, is_asked_for: impl Fn(&NearestPoint) -> bool) -> Option<NearestPoint> {
        let near = self.view.point(&point);
        let is_inside = self.near.holds(&near);
        if is_inside == Some(false) || !self.box_holds(&point) {
            return None;
        }
        let point = point.reduced();
        let nearest = self.nearest(&point, &self.near.nearest_features(&near))?;
        let is_deep = is_asked_for(&nearest) && !Zero::is_zero(&nearest.numerator);
        let is_inside = is_deep && is_inside.unwrap_or_else(|| self.holds(&point));
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
        around.any(|other| !self.near.holds(&self.view.point(&other)).unwrap_or_else(|| self.holds(&other)))
    }

    /// Whether the corners of each face are in one plane, exactly.
    fn has_planar_faces(&self) -> bool {
        let at = |v: &VertexId| &self.points[v.index()];
        let is_planar = |(number, face): (usize, &Vec<VertexId>)| {
            face.len() == 3 || face.iter().all(|v| Zero::is_zero(&self.normal(number).dot(&at(v).minus(at(&face[0])))))
        };
        self.block.topology().faces().iter().enumerate().all(is_planar)
    }

    /// The middles of the parts into which the other's triangles cut each of some edges or diagonals, where they cut it at all.
    fn middles_between_crossings(&self, other: &LatticeSurface<'_>, edges: Vec<[VertexId; 2]>) -> Vec<Fraction> {
        let surface: Vec<_> = triangle_corners(other.block).collect();
        let mut middles = Vec::new();
        for edge in edges {
            let [p, q] = edge.map(|v| &self.points[v.index()]);
            let d = q.minus(p);
            let may_meet = |triangle: &usize| other.near.may_be_crossed(&self.near, edge, *triangle);
            let meeting = (0..surface.len()).filter(may_meet);
            let mut places: Vec<BigRational> = meeting
                .filter_map(|triangle| crossing(p, &d, surface[triangle].map(|v| &other.points[v.index()])))
                .collect();
            if places.is_empty() {
                continue;
            }
            places.extend([BigRational::zero(), BigRational::one()]);
            places.sort();
            places.dedup();
            let middle = |two: &[BigRational]| (&two[0] + &two[1]) / BigInt::from(2);
            middles.extend(places.windows(2).map(|two| Fraction::between(p, &d, &middle(two))));
        }
        middles
    }

    /// Whether a point is inside the block's box; **its surface does not count**.
    fn box_holds(&self, point: &Fraction) -> bool {
        let [to_low, to_high] = self.bounds.each_ref().map(|corner| point.way_to(corner));
        let below = to_low.components().into_iter().all(BigInt::is_negative);
        below && to_high.components().into_iter().all(BigInt::is_positive)
    }

    /// The nearest of some features, the first of several: faces, edges, vertices.
    fn nearest(&self, point: &Fraction, features: &[Feature]) -> Option<NearestPoint> {
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

    /// The foot on a face's plane, where it is inside the polygon or on its boundary, in units finer by the point's
    /// denominator.
    fn to_face(&self, point: &Fraction, face: usize) -> Option<NearestPoint> {
        let (n, corners) = (self.normal(face), &self.block.topology().faces()[face]);
        let ways: Vec<_> = corners.iter().map(|v| point.way_to(&self.points[v.index()])).collect();
        if Zero::is_zero(&n.norm_squared()) || !projects_inside(n, &ways) {
            return None;
        }
        let n = n.scaled(&(&point.denominator * &point.denominator));
        // The plane goes through the corners' mean: k times the distance times |N|.
        let k = BigInt::from(corners.len());
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
    /// a point on them can have a distance from it.
    fn holds(&self, point: &Fraction) -> bool {
        let ways: Vec<_> = self.points.iter().map(|v| point.way_to(v)).collect();
        let around: Vec<_> =
            triangle_corners(self.block).map(|corners| corners.map(|v| ways[v.index()].clone())).collect();
        !around.iter().any(triangle_holds_origin) && surface_holds_origin(&around)
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

/// Where `p + t·d` meets a triangle whose plane it passes through, its boundary included, for t from 0 to 1.
fn crossing(p: &Vec3<BigInt>, d: &Vec3<BigInt>, corners: [&Vec3<BigInt>; 3]) -> Option<BigRational> {
    let [a, b, c] = corners.map(|v| v.minus(p));
    let n = b.minus(&a).cross(&c.minus(&a));
    let towards = n.dot(d);
    if Zero::is_zero(&towards) {
        return None;
    }
    let sides = [(&a, &b), (&b, &c), (&c, &a)].map(|(p, q)| p.cross(q).dot(d));
    let is_outside = |side: &BigInt| !Zero::is_zero(side) && side.is_positive() != towards.is_positive();
    if sides.iter().any(is_outside) {
        return None;
    }
    let before = n.dot(&a);
    let beyond = &towards - &before;
    let is_on_edge = [&before, &beyond].into_iter().all(|part| !is_outside(part));
    is_on_edge.then(|| BigRational::new(before, towards))
}

#[cfg(test)]
mod tests;
