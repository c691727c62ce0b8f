//! The area on which a contact's cohesion and tensile strength act: its share of the overlap of its two faces.

use crate::contact::PreparedBlock;
use crate::dynamics::contact::StepContact;
use crate::dynamics::material::Joint;
use crate::dynamics::plane::Plane;
use crate::dynamics::solve::Solve;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::{Contact, EdgeId, Entrance, FaceId, VertexId};

/// Gives the contacts of a pair their shares of the areas in which the pair's faces overlap.
pub(super) fn share<R: Solve>(
    active: &mut [StepContact<R>],
    prepared: [&PreparedBlock<R>; 2],
    joint: &Joint<R>,
    overlap_sine: R,
) {
    let joined: Vec<Option<[FaceId; 2]>> =
        active.iter().map(|c| faces(prepared, &c.contact, &c.plane, overlap_sine)).collect();
    for (contact, both) in active.iter_mut().zip(&joined) {
        let Some(both) = both else { continue };
        let sharing = joined.iter().filter(|other| other.as_ref() == Some(both)).count();
        let area = overlap(prepared, *both, contact.plane.normal) / R::from_f64(sharing as f64);
        contact.cohesive = joint.cohesion * area;
        contact.tensile_gap = joint.tension * area / joint.normal;
    }
}

/// The faces of A and B that a contact joins, if they face each other within the overlap angle.
pub(super) fn faces<R: Real>(
    [a, b]: [&PreparedBlock<R>; 2],
    contact: &Contact,
    plane: &Plane<R>,
    overlap_sine: R,
) -> Option<[FaceId; 2]> {
    // From B to A.
    let up = if plane.a_enters { plane.normal } else { -plane.normal };
    let at_vertex = |block: &PreparedBlock<R>, vertex: VertexId| block.block().topology().vertex_faces(vertex).to_vec();
    let at_edge = |block: &PreparedBlock<R>, edge: EdgeId| {
        let edge = block.edge(edge).edge;
        let mut both = vec![edge.left, edge.right];
        both.sort_unstable();
        both
    };
    let (of_a, of_b) = match contact.entrance {
        Entrance::VertexFace(vertex, face) => (at_vertex(a, vertex), vec![face]),
        Entrance::FaceVertex(face, vertex) => (vec![face], at_vertex(b, vertex)),
        Entrance::EdgeEdge(edge_a, edge_b) => (at_edge(a, edge_a), at_edge(b, edge_b)),
    };
    Some([squarest(a, &of_a, -up, overlap_sine)?, squarest(b, &of_b, up, overlap_sine)?])
}

/// The face whose normal is nearest to `towards`, if it is within the overlap angle of it. A tie takes the first.
fn squarest<R: Real>(
    block: &PreparedBlock<R>,
    faces: &[FaceId],
    towards: Vector<R>,
    overlap_sine: R,
) -> Option<FaceId> {
    let cosine = |face: FaceId| block.face(face).normal.dot(towards);
    let mut best = *faces.first()?;
    for &face in &faces[1..] {
        if cosine(face) > cosine(best) {
            best = face;
        }
    }
    let sine = block.face(best).normal.cross(towards).length();
    (cosine(best) > R::ZERO && sine <= overlap_sine).then_some(best)
}

/// The area in which two faces overlap, seen along the unit vector `along` (m²).
///
/// A polygon is the signed sum of the triangles of its fan, whatever its shape, so the overlap is the sum over pairs of
/// triangles of signed overlaps, and each of those is a convex polygon.
pub(super) fn overlap<R: Real>([a, b]: [&PreparedBlock<R>; 2], [face_a, face_b]: [FaceId; 2], along: Vector<R>) -> R {
    let (x, y) = tangents(along);
    let origin = a.face(face_a).point;
    let flat = |block: &PreparedBlock<R>, face: FaceId| -> Vec<[R; 2]> {
        let corners = block.block().topology().face(face);
        corners.iter().map(|&v| block.vertex(v).at - origin).map(|p| [x.dot(p), y.dot(p)]).collect()
    };
    let (one, two) = (fan(&flat(a, face_a)), fan(&flat(b, face_b)));
    let pairs = one.iter().flat_map(|t| two.iter().map(move |u| (t, u)));
    pairs.fold(R::ZERO, |sum, (t, u)| sum + common(t, u)).abs()
}

/// Two unit vectors that make a right-handed frame with a third.
#[inline(always)]
pub(super) fn tangents<R: Real>(normal: Vector<R>) -> (Vector<R>, Vector<R>) {
    let size = normal.components().map(R::abs);
    let (zero, one) = (R::ZERO, R::from_f64(1.0));
    let axis = if !size[1].below(size[0]) && !size[2].below(size[0]) {
        Vector::new(one, zero, zero)
    } else if !size[2].below(size[1]) {
        Vector::new(zero, one, zero)
    } else {
        Vector::new(zero, zero, one)
    };
    let first = normal.cross(axis).unit();
    (first, normal.cross(first))
}

/// Corners that turn left, and the sign they had: true for left.
type Triangle<R> = ([[R; 2]; 3], bool);

fn fan<R: Real>(polygon: &[[R; 2]]) -> Vec<Triangle<R>> {
    let triangle = |two: &[[R; 2]]| {
        let corners = [polygon[0], two[0], two[1]];
        let left = !turn(corners[0], corners[1], corners[2]).below(R::ZERO);
        if left { (corners, true) } else { ([corners[0], corners[2], corners[1]], false) }
    };
    polygon[1..].windows(2).map(triangle).collect()
}

/// Twice the area of a triangle, positive when it turns left.
fn turn<R: Real>(a: [R; 2], b: [R; 2], c: [R; 2]) -> R {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The signed area that two triangles have in common: one is clipped by the sides of the other.
fn common<R: Real>((one, left): &Triangle<R>, (two, also_left): &Triangle<R>) -> R {
    let mut polygon = one.to_vec();
    for k in 0..3 {
        let (p, q) = (two[k], two[(k + 1) % 3]);
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (m, &here) in polygon.iter().enumerate() {
            let next = polygon[(m + 1) % polygon.len()];
            let (side, after) = (turn(p, q, here), turn(p, q, next));
            let (inside, next_inside) = (!side.below(R::ZERO), !after.below(R::ZERO));
            if inside {
                kept.push(here);
            }
            if inside != next_inside {
                let share = side / (side - after);
                kept.push([0, 1].map(|c| here[c] + (next[c] - here[c]) * share));
            }
        }
        polygon = kept;
    }
    let Some((&first, rest)) = polygon.split_first() else { return R::ZERO };
    let twice = rest.windows(2).fold(R::ZERO, |sum, two| sum + turn(first, two[0], two[1]));
    let area = twice * R::from_f64(0.5);
    if left == also_left { area } else { -area }
}
