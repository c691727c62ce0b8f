//! Where a contact acts and along which normal: the plane of its entrance.

use crate::contact::{ContactRules, PreparedBlock};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::{EdgeId, Entrance, FaceId, VertexId};

/// A contact's entrance at the start of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane<R> {
    /// Whether block i, which enters, is A.
    pub(super) a_enters: bool,
    /// P on block i (m).
    pub(super) p: Vector<R>,
    /// Q on block j (m).
    pub(super) q: Vector<R>,
    /// Unit, from j to i.
    pub(super) normal: Vector<R>,
    /// `h0 = n·(P − Q)` in m.
    pub(super) gap: R,
}

/// The plane of an entrance of two blocks. Feet of edges that are parallel, which no classification gives, are not finite.
pub(super) fn plane<R: Real, M: ContactRules>(
    a: &PreparedBlock<R>,
    b: &PreparedBlock<R>,
    entrance: &Entrance,
) -> Plane<R> {
    match *entrance {
        Entrance::VertexFace(vertex, face) => vertex_face(true, a, vertex, b, face),
        Entrance::FaceVertex(face, vertex) => vertex_face(false, b, vertex, a, face),
        Entrance::EdgeEdge(edge_a, edge_b) => edge_edge::<R, M>(a, edge_a, b, edge_b),
    }
}

fn vertex_face<R: Real>(
    a_enters: bool,
    i: &PreparedBlock<R>,
    vertex: VertexId,
    j: &PreparedBlock<R>,
    face: FaceId,
) -> Plane<R> {
    let (p, face) = (i.vertex(vertex).at, j.face(face));
    let gap = face.normal.dot(p - face.point);
    Plane { a_enters, p, q: p - face.normal * gap, normal: face.normal, gap }
}

fn edge_edge<R: Real, M: ContactRules>(
    a: &PreparedBlock<R>,
    edge_a: EdgeId,
    b: &PreparedBlock<R>,
    edge_b: EdgeId,
) -> Plane<R> {
    let (one, two) = (a.edge(edge_a), b.edge(edge_b));
    let product = one.direction.cross(two.direction);
    let sine = product.length();
    let unit = product / sine;
    let lean = unit.dot(a.lean(edge_a)) - unit.dot(b.lean(edge_b));
    let normal = if M::sigma_is_positive(lean) { unit } else { -unit };
    let offset = two.p - one.p;
    let squared = sine * sine;
    let p = one.p + one.direction * (offset.cross(two.direction).dot(product) / squared);
    let q = two.p + two.direction * (offset.cross(one.direction).dot(product) / squared);
    Plane { a_enters: true, p, q, normal, gap: normal.dot(one.p - two.p) }
}
