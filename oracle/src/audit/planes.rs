//! Planes of faces that separate two blocks.

use super::Decider;
use crate::PreparedBlock;
use crate::number::{Ball, UNDERFLOW};
use crate::pair::Pair;
use crate::separation::on_lattice;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::block::face_normal;
use rockproof_model::decision::Side;
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, FaceId, Vec3};

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
    pub(super) fn of(solid: &PreparedBlock) -> FacePlanes {
        let reach = |n: [f64; 3]| {
            solid.vertices.iter().map(|p| dot(n, [p.x.0, p.y.0, p.z.0])).fold(f64::NEG_INFINITY, f64::max)
        };
        let directions = solid.faces.iter().map(|face| {
            let n = [face.normal.x.0, face.normal.y.0, face.normal.z.0];
            let size = dot(n, n).sqrt();
            let n = n.map(|c| c / size);
            (n, reach(n))
        });
        let ends = solid.box_min.iter().chain(&solid.box_max);
        FacePlanes {
            directions: directions.collect(),
            largest: ends.fold(0.0f64, |most, c| most.max(c.abs())),
            error: solid.errors.coordinate,
        }
    }
}

/// The decider that shows that the plane of a face of either block separates them, **touching included**.
pub(super) fn separating_face(pair: &Pair<'_>, planes: [&FacePlanes; 2]) -> Option<Decider> {
    let size = planes[0].largest.max(planes[1].largest);
    let error = planes[0].error.max(planes[1].error);
    let mut open: Vec<(Side, FaceId)> = Vec::new();
    for side in [Side::A, Side::B] {
        let (own, other) = (planes[usize::from(side == Side::B)], pair.solid(side.other()));
        for (face, &(n, reach)) in own.directions.iter().enumerate() {
            let start = other.vertices.iter().map(|p| dot(n, [p.x.0, p.y.0, p.z.0])).fold(f64::INFINITY, f64::min);
            let gap = start - reach;
            // A dot product of three terms is off by at most 3 roundoffs of the sum of its terms' sizes (N. J. Higham,
            // Accuracy and Stability, section 3.1) and what the coordinates are off; twice that and the rounding of the
            // difference are below 16 roundoffs.
            let sum = n[0].abs() + n[1].abs() + n[2].abs();
            let doubt = sum * (size * (8.0 * f64::EPSILON) + 4.0 * error) + 16.0 * UNDERFLOW;
            if gap > doubt {
                return Some(Decider::FacePlane);
            }
            // The face's own plane differs from the direction by roundoffs of normals: those of the nearby ones are asked.
            if gap > -4.0 * doubt {
                open.push((side, FaceId::at(face)));
            }
        }
    }
    if open.is_empty() {
        return None;
    }
    let points = on_lattice([Side::A, Side::B].map(|side| pair.solid(side).block().vertices()));
    open.into_iter().any(|(side, face)| separates_exactly(pair, &points, side, face)).then_some(Decider::ExactFacePlane)
}

/// Whether along a face's normal the other block begins where this one ends, **or beyond**.
fn separates_exactly(pair: &Pair<'_>, points: &[Vec<Vec3<BigInt>>; 2], side: Side, face: FaceId) -> bool {
    let k = usize::from(side == Side::B);
    let (own, other) = (&points[k], &points[1 - k]);
    let n = face_normal(own, &pair.topology(side).faces()[face.index()]);
    if Zero::is_zero(&n.norm_squared()) {
        return false;
    }
    let (end, start) = (own.iter().map(|p| n.dot(p)).max(), other.iter().map(|p| n.dot(p)).min());
    end.zip(start).is_some_and(|(end, start)| end <= start)
}

/// Whether the vertices do not all lie in one plane, exactly.
pub(super) fn has_inside(solid: &PreparedBlock) -> bool {
    // f64 first: any determinant that is certainly not zero.
    let ball = |v: &Vec3<crate::number::Approx>| v.map(|c| Ball { middle: c.0, radius: solid.errors.coordinate });
    let origin = ball(&solid.vertices[0]);
    let from: Vec<Vec3<Ball>> = solid.vertices[1..].iter().map(|v| ball(v).minus(&origin)).collect();
    let sure = from.windows(2).any(|two| {
        let n = two[0].cross(&two[1]);
        from.iter().any(|p| n.dot(p).certain_sign().is_some_and(|sign| !sign.is_zero()))
    });
    sure || {
        let [points, _] = on_lattice([solid.block().vertices(), &[]]);
        let from: Vec<Vec3<BigInt>> = points[1..].iter().map(|p| p.minus(&points[0])).collect();
        let first = from.iter().find(|p| !Zero::is_zero(&p.norm_squared()));
        let n = first.and_then(|d| from.iter().map(|p| d.cross(p)).find(|n| !Zero::is_zero(&n.norm_squared())));
        n.is_some_and(|n| from.iter().any(|p| !ExactRing::sign(&n.dot(p)).is_zero()))
    }
}

/// The square of the greatest distance of a face's vertex from the face's plane, in m².
pub(super) fn unevenness_squared(block: &Block) -> BigRational {
    let lattice = Lattice::covering(block.coordinates());
    let points: Vec<Vec3<BigInt>> = block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect();
    let mut most = BigRational::zero();
    for face in block.topology().faces().iter().filter(|face| face.len() > 3) {
        let n = face_normal(&points, face);
        let square = n.norm_squared();
        if Zero::is_zero(&square) {
            continue;
        }
        // k times the distances times |N|, the plane being that through the mean of the k vertices.
        let k = BigInt::from(face.len());
        let sum = face.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, &v| sum.plus(&points[v.index()]));
        let middle = n.dot(&sum);
        let off = face.iter().map(|&v| (&k * n.dot(&points[v.index()]) - &middle).abs()).max().unwrap_or_default();
        most = most.max(BigRational::new(&off * &off, square * &k * &k));
    }
    let (units, metres) = lattice.units_per_metre();
    most * BigRational::new(&metres * &metres, &units * &units)
}

fn dot(n: [f64; 3], p: [f64; 3]) -> f64 {
    n[0] * p[0] + n[1] * p[1] + n[2] * p[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepared_block::tests::bent_box;
    use rockproof_model::Number;

    #[test]
    fn unevenness_is_the_greatest_distance_from_a_face_s_own_plane() {
        // N of the top is (−3, −3, 18), its corners' n·p are 54 and 45 by turns, so 9/2 from their mean: (9/2)² / 342.
        let expected = BigRational::new(9.into(), 152.into());
        for (scale, square) in [("1", (1, 1)), ("1/7", (1, 49)), ("3/8", (9, 64)), ("5", (25, 1))] {
            let square = BigRational::new(square.0.into(), square.1.into());
            let block = bent_box(&scale.parse::<Number>().expect("a number"));
            assert_eq!(unevenness_squared(&block), &expected * square, "{scale}");
        }
    }
}
