//! Whether the interiors of two blocks meet, exactly, by their surfaces: what decides it where a block is not convex.
//!
//! Inside a block is what the triangles of its surface enclose: a ray from there crosses an odd number of them. What two
//! insides share is a volume or nothing, and its boundary, but for lines and points, lies within triangles. So each triangle
//! is cut (`pieces`) where other triangles of either surface pass through it, stand on it or lie in its plane. Along a piece
//! neither inside changes; the interiors meet exactly when on one side of some piece both insides are.
//!
//! Every sign asked for is taken from [`crate::number::Ball`]s where these prove it, else from integers. Boxes and trees of them
//! leave out only what certainly does not matter; triangles that stand for a face may be others than those from its first
//! vertex where it is exactly in one plane (`faces`).

mod faces;
mod pieces;
mod rays;
mod surfaces;
#[cfg(test)]
mod tests;

use crate::point_in_surface::{surface_holds_origin, triangles};
use crate::separation::{PointSet, SeparablePoints, on_lattice, separate};
use num_bigint::BigInt;
use pieces::{Piece, Plane};
use rockproof_model::{Block, Vec3};
use surfaces::Surfaces;
pub(crate) use surfaces::ball;

/// Whether the insides of two blocks share a volume; **touching is not sharing**.
///
/// A triangle is first cut by the other block, which is then inside or not next to the whole of a part. Only where it is inside
/// on some side can both be, and only such a part is cut by the triangle's own block and asked about that.
pub(crate) fn surfaces_meet(a: &Block, b: &Block) -> bool {
    let surfaces = Surfaces::of(&[a, b]);
    let is_shared = |base: usize| {
        let plane = Plane::of(&surfaces, base);
        let own = surfaces.triangles()[base].block;
        let shares = |part: &Piece<'_>| {
            let [below, above] = part.insides(1 - own);
            let shared = |piece: &Piece<'_>| {
                let in_own = piece.insides(own);
                below && in_own[0] || above && in_own[1]
            };
            (below || above) && part.any_part(own, shared)
        };
        plane.whole().any_part(1 - own, shares)
    };
    (0..surfaces.triangles().len()).any(|base| surfaces.reaches_other(base) && is_shared(base))
}

/// Whether the inside of a block and the hull of some points share a volume; **touching is not sharing**. The hull has an
/// inside.
///
/// Either a part of the surface is within the hull, which no plane then separates from it, or the hull is inside or outside
/// as a whole.
pub(crate) fn meets_hull(block: &Block, hull: PointSet<'_>) -> bool {
    let surface = Surfaces::of(&[block]);
    let within = |corners: SeparablePoints| !separate(corners.set(), hull).is_separated;
    let is_boundary = |piece: &Piece<'_>| {
        let [below, above] = piece.insides(0);
        below != above && (piece.is_whole() || within(SeparablePoints::new(piece.corners())))
    };
    let vertices = block.vertices();
    (0..surface.triangles().len()).any(|base| {
        let corners = surface.triangles()[base].corners.map(|v| vertices[v.index()].clone());
        within(SeparablePoints::new(corners.to_vec())) && Plane::of(&surface, base).whole().any_part(0, is_boundary)
    }) || holds_middle(block, hull)
}

/// Whether the mean of the points is inside the block; no part of its surface is within their hull.
fn holds_middle(block: &Block, hull: PointSet<'_>) -> bool {
    let [vertices, points] = on_lattice([block.vertices(), hull.exact]);
    let count = BigInt::from(points.len());
    let sum = points.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, p| sum.plus(p));
    let around: Vec<Vec3<BigInt>> = vertices.iter().map(|v| v.scaled(&count).minus(&sum)).collect();
    let around: Vec<_> = triangles(block, &around).map(|corners| corners.map(Clone::clone)).collect();
    surface_holds_origin(&around)
}
