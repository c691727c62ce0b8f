//! Whether a point is inside a surface of triangles, exactly.

use num_traits::Zero;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Ring, Vec3, VertexId};

/// The triangles of a block's faces, each face from the first vertex of its loop, by the numbers of their vertices.
pub(crate) fn triangle_corners(block: &Block) -> impl Iterator<Item = [VertexId; 3]> {
    block.topology().faces().iter().flat_map(|face| {
        let first = face[0];
        face[1..].windows(2).map(move |two| [first, two[0], two[1]])
    })
}

/// The same triangles with the given vertices.
pub(crate) fn triangles<'a, T>(block: &'a Block, points: &'a [Vec3<T>]) -> impl Iterator<Item = [&'a Vec3<T>; 3]> {
    triangle_corners(block).map(|corners| corners.map(|v| &points[v.index()]))
}

/// Whether the origin is inside a closed surface of triangles; **it must not be on the surface**.
///
/// A ray from the origin crosses the surface an odd number of times. The direction is (1, k, k²) with the first k for which
/// the ray's line meets no edge of a triangle and lies in no triangle's plane; each edge and each plane excludes two k at
/// most.
pub(crate) fn surface_holds_origin<T: ExactRing + Zero>(triangles: &[[Vec3<T>; 3]]) -> bool {
    (1i32..).find_map(|k| odd_crossings(triangles, &ray(k))).unwrap_or(false)
}

/// The direction (1, k, k²).
pub(crate) fn ray<T: Ring>(k: i32) -> Vec3<T> {
    let k = T::from_i32(k);
    Vec3::new(T::from_i32(1), k.clone(), k.squared())
}

/// Whether the origin is in a triangle that has an area, its boundary included.
pub(crate) fn triangle_holds_origin<T: ExactRing + Zero>([a, b, c]: [&Vec3<T>; 3]) -> bool {
    let n = b.minus(a).cross(&c.minus(a));
    let is_plane = n.components().into_iter().any(|c| !c.is_zero());
    is_plane
        && n.dot(a).sign().is_zero()
        && [(a, b), (b, c), (c, a)].iter().all(|(p, q)| !p.cross(q).dot(&n).sign().is_negative())
}

/// Whether a ray from the origin crosses triangles an odd number of times; `None` where it meets an edge or lies in a plane.
fn odd_crossings<T: ExactRing + Zero>(triangles: &[[Vec3<T>; 3]], ray: &Vec3<T>) -> Option<bool> {
    are_odd(triangles.iter().map(|triangle| ray_crosses(triangle.each_ref(), ray)))
}

/// Whether an odd number of triangles is crossed; `None` where that is not known of one.
pub(crate) fn are_odd(mut crossings: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    crossings.try_fold(false, |odd, crosses| Some(odd ^ crosses?))
}

/// Whether a ray from the origin, which is not on the triangle, crosses it. `None` where it may not be asked: its line is along the triangle's plane, or
/// the plane is in front of the origin and the line meets that of a side.
pub(crate) fn ray_crosses<T: ExactRing + Zero>([a, b, c]: [&Vec3<T>; 3], ray: &Vec3<T>) -> Option<bool> {
    let n = b.minus(a).cross(&c.minus(a));
    if n.components().into_iter().all(Zero::is_zero) {
        return Some(false);
    }
    let towards = n.dot(ray).sign();
    if towards.is_zero() {
        return None;
    }
    // The plane is met at a·n / ray·n.
    if n.dot(a).sign() != towards {
        return Some(false);
    }
    let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| p.cross(q).dot(ray).sign());
    if sides.iter().any(|side| side.is_zero()) {
        return None;
    }
    Some(sides.iter().all(|&side| side == towards))
}
