//! The deepest vertex of one block inside the other: what overlap means where a block is not convex.
//!
//! The inside of a block is that of its faces' triangles from the first vertex of each loop, as its volume is. A
//! vertex's depth is its distance from the other's surface, the least over the faces (where its foot on the plane is
//! inside the polygon), the edges (where its foot is inside) and the vertices.

use super::{Penetration, Units, compare};
use crate::Gap;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::topology::loop_pairs;
use rockproof_model::{Block, Sign, Vec3};

/// The deepest vertex of either block; `None` where a block has no face with an area.
pub(super) fn deepest_vertex(pair: &Units<'_>) -> Option<Penetration> {
    let surfaces = [Surface::new(pair, 0)?, Surface::new(pair, 1)?];
    let mut best: Option<(Nearest, bool)> = None;
    for side in 0..2 {
        let other = &surfaces[1 - side];
        for point in &pair.points[side] {
            if !other.box_holds(point) {
                continue;
            }
            let Some(nearest) = other.nearest(point) else { continue };
            let deeper = best.as_ref().is_none_or(|(best, _)| nearest.cmp_square(best).is_gt());
            if deeper && !Zero::is_zero(&nearest.numerator) && other.holds(point) {
                best = Some((nearest, side == 0));
            }
        }
    }
    let Some((nearest, of_a)) = best else {
        let gap = Gap { sign: Sign::Zero, squared: BigRational::zero() };
        return Some(Penetration { gap, direction: Vec3::zero() });
    };
    // A's vertex moves to the surface; where it is B's, A moves the other way.
    let way = if of_a { nearest.way } else { nearest.way.negated() };
    let squared = pair.square_metres(nearest.numerator, nearest.denominator);
    let direction = way.map(|c| BigRational::from_integer(c.clone()));
    Some(Penetration { gap: Gap { sign: Sign::Negative, squared }, direction })
}

/// The point of a surface next to a point: the squared distance as a fraction, and the way there times something above zero.
struct Nearest {
    numerator: BigInt,
    denominator: BigInt,
    way: Vec3<BigInt>,
}

impl Nearest {
    fn cmp_square(&self, other: &Nearest) -> std::cmp::Ordering {
        compare((&self.numerator, &self.denominator), (&other.numerator, &other.denominator))
    }
}

/// The surface of a block in lattice units.
struct Surface<'p> {
    block: &'p Block,
    points: &'p [Vec3<BigInt>],
    /// Normal of each face.
    normals: Vec<Vec3<BigInt>>,
    /// Least and greatest coordinates.
    bounds: [Vec3<BigInt>; 2],
}

impl<'p> Surface<'p> {
    fn new(pair: &'p Units<'_>, side: usize) -> Option<Surface<'p>> {
        let (block, points) = (pair.blocks[side], &pair.points[side]);
        let normals: Vec<_> = block.topology().faces().iter().map(|face| face_normal(points, face)).collect();
        if normals.iter().all(|n| Zero::is_zero(&n.norm_squared())) {
            return None;
        }
        let corner = |pick: fn(BigInt, BigInt) -> BigInt| {
            let first = points[0].clone();
            points.iter().cloned().fold(first, |a, b| Vec3::new(pick(a.x, b.x), pick(a.y, b.y), pick(a.z, b.z)))
        };
        let bounds = [corner(std::cmp::min), corner(std::cmp::max)];
        Some(Surface { block, points, normals, bounds })
    }

    /// Whether a point is inside the block's box; **its surface does not count**.
    fn box_holds(&self, point: &Vec3<BigInt>) -> bool {
        let [low, high] = &self.bounds;
        (0..3).all(|k| low.components()[k] < point.components()[k] && point.components()[k] < high.components()[k])
    }

    /// The nearest point of the surface.
    fn nearest(&self, point: &Vec3<BigInt>) -> Option<Nearest> {
        let topology = self.block.topology();
        let faces = (0..topology.faces().len()).filter_map(|face| self.to_face(point, face));
        let edges = topology.edges().iter().filter_map(|edge| {
            let [p, q] = [edge.p, edge.q].map(|v| &self.points[v as usize]);
            self.to_edge(point, p, q)
        });
        let vertices = self.points.iter().map(|vertex| {
            let way = vertex.minus(point);
            Nearest { numerator: way.norm_squared(), denominator: BigInt::from(1), way }
        });
        // `min_by` keeps the first of several.
        faces.chain(edges).chain(vertices).min_by(Nearest::cmp_square)
    }

    /// The foot on a face's plane, where it is inside the polygon or on its boundary.
    fn to_face(&self, point: &Vec3<BigInt>, face: usize) -> Option<Nearest> {
        let (n, corners) = (&self.normals[face], &self.block.topology().faces()[face]);
        let square = n.norm_squared();
        if Zero::is_zero(&square) || !self.projects_inside(point, n, corners) {
            return None;
        }
        // The plane goes through the corners' mean: k times the distance times |N|.
        let k = BigInt::from(corners.len());
        let sum = corners.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, &v| sum.plus(&self.points[v as usize]));
        let off = n.dot(&sum) - &k * n.dot(point);
        let way = if off.is_negative() { n.negated() } else { n.clone() };
        Some(Nearest { numerator: &off * &off, denominator: square * &k * &k, way })
    }

    /// Whether a point, seen along n, is inside a polygon or on its boundary.
    fn projects_inside(&self, point: &Vec3<BigInt>, n: &Vec3<BigInt>, corners: &[u32]) -> bool {
        // The polygon in a frame of two vectors across n: u and n × u, neither of unit length.
        let size = n.components().map(|c| c.abs());
        let axis = (0..3).min_by_key(|&k| &size[k]).unwrap_or(0);
        let unit = |k: usize| BigInt::from(i32::from(k == axis));
        let u = n.cross(&Vec3::new(unit(0), unit(1), unit(2)));
        let v = n.cross(&u);
        let flat = |at: &Vec3<BigInt>| {
            let from_point = at.minus(point);
            [u.dot(&from_point), v.dot(&from_point)]
        };
        let mut inside = false;
        for (p, q) in loop_pairs(corners) {
            let (p, q) = (flat(&self.points[p as usize]), flat(&self.points[q as usize]));
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

    /// The foot on an edge, where it is strictly inside.
    fn to_edge(&self, point: &Vec3<BigInt>, p: &Vec3<BigInt>, q: &Vec3<BigInt>) -> Option<Nearest> {
        let (d, from) = (q.minus(p), point.minus(p));
        let (along, length) = (d.dot(&from), d.norm_squared());
        if !along.is_positive() || along >= length {
            return None;
        }
        let way = d.scaled(&along).minus(&from.scaled(&length));
        Some(Nearest { numerator: way.norm_squared(), denominator: &length * &length, way })
    }

    /// Whether a point that is not on the surface is inside: a ray from it crosses the surface an odd number of times. The
    /// direction is (1, k, k²) with the first k for which the ray's line meets no edge of a triangle and lies in no
    /// triangle's plane; each edge and each plane excludes two k at most.
    fn holds(&self, point: &Vec3<BigInt>) -> bool {
        let triangles: Vec<[Vec3<BigInt>; 3]> = self
            .block
            .topology()
            .faces()
            .iter()
            .flat_map(|face| face[1..].windows(2).map(|two| [face[0], two[0], two[1]]))
            .map(|corners| corners.map(|v| self.points[v as usize].minus(point)))
            .collect();
        (1i64..)
            .find_map(|k| odd_crossings(&triangles, &Vec3::new(1.into(), k.into(), (k * k).into())))
            .unwrap_or(false)
    }
}

/// Whether a ray from the origin crosses triangles an odd number of times; `None` where it meets an edge or lies in a plane.
fn odd_crossings(triangles: &[[Vec3<BigInt>; 3]], ray: &Vec3<BigInt>) -> Option<bool> {
    let mut odd = false;
    for [a, b, c] in triangles {
        let n = b.minus(a).cross(&c.minus(a));
        if Zero::is_zero(&n.norm_squared()) {
            continue;
        }
        let towards = n.dot(ray);
        if Zero::is_zero(&towards) {
            return None;
        }
        // The plane is met at a·n / ray·n.
        let height = n.dot(a);
        if Zero::is_zero(&height) || height.is_positive() != towards.is_positive() {
            continue;
        }
        let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| p.cross(q).dot(ray));
        if sides.iter().any(Zero::is_zero) {
            return None;
        }
        if sides.iter().all(|side| side.is_positive() == towards.is_positive()) {
            odd = !odd;
        }
    }
    Some(odd)
}
