//! Test 3: v-f, and f-v with the roles exchanged.

use crate::contact::pair::Pair;
use crate::contact::prepared_block::{FaceOfEdge, PreparedBlock};
use crate::contact::rules::ContactRules;
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, FaceId, VertexId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the contact of vertex `v` of `side` and face `f` of the other block, if there is one.
    pub(super) fn vertex_face(&mut self, side: Side, v: VertexId, f: FaceId) {
        let other = self.solid(side.other());
        let (at, face) = (self.solid(side).vertex(v).at, other.face(f));
        let asked = [Feature::Vertex(side, v), Feature::Face(side.other(), f)];
        let gap = face.normal.dot(at - face.point);
        let contact = match side {
            Side::A => ContactKey::VertexFace(v, f),
            Side::B => ContactKey::FaceVertex(f, v),
        };
        if !self.ask(Predicate::VertexFaceNear, &asked, M::vertex_face_near(gap, self.t.search))
            || !self.ask(Predicate::VertexFaceDepth, &asked, self.vertex_face_depth(gap, contact))
            || !self.ask(Predicate::InsideFace, &asked, is_over_face::<R, M>(at, other, f))
            || self.belongs_to_rim(side, v, f)
            || !self.cone_passes(side, v, f)
        {
            return;
        }
        let entrance = self.vertex_face_entrance(side, v, f);
        self.record(contact, entrance);
    }

    /// Not too deep: the gap is at least −g, or the contact is kept.
    fn vertex_face_depth(&self, gap: R, contact: ContactKey) -> bool {
        M::vertex_face_depth(gap, self.t.penetration) || self.is_kept(contact)
    }

    /// A vertex is in the territory of a vertex or an edge of the face.
    fn belongs_to_rim(&mut self, side: Side, v: VertexId, f: FaceId) -> bool {
        if !M::vertex_takes_part(self.solid(side).vertex(v).convex) {
            return false;
        }
        let topology = self.solid(side.other()).block().topology();
        (M::vertices_before_faces_and_edges() && topology.face(f).iter().any(|&w| self.in_vertex_territory(side, v, w)))
            || (M::edges_before_faces_and_edges()
                && topology.face_edges(f).iter().any(|&e| self.in_edge_territory(side, v, e)))
    }
}

/// The projection of a point along the normal lies strictly inside the face. **On the rim says no.**
fn is_over_face<R: Real, M: ContactRules>(at: Vector<R>, solid: &PreparedBlock<R>, f: FaceId) -> bool {
    if solid.turns_left(f) {
        solid.block().topology().face_edges(f).iter().all(|&e| M::inside_face(inward(at, solid, f, e)))
    } else {
        winds_around::<R, M>(at, solid, f)
    }
}

/// How far a point is on the inner side of edge `e` of face `f`.
#[inline]
fn inward<R: Real>(at: Vector<R>, solid: &PreparedBlock<R>, f: FaceId, e: EdgeId) -> R {
    let ridge = solid.edge(e);
    let side = if ridge.edge.left == f { FaceOfEdge::Left } else { FaceOfEdge::Right };
    (at - ridge.p).dot(solid.into_face(e, side))
}

/// Inside by the winding number (Sunday 2001), for a face with a corner that turns right. Levels are measured from the
/// point along a direction in the face plane. What counts as above at the point's own level changes nothing, because each
/// corner's level is judged once for both its edges; so only sides are decisions.
fn winds_around<R: Real, M: ContactRules>(at: Vector<R>, solid: &PreparedBlock<R>, f: FaceId) -> bool {
    let topology = solid.block().topology();
    let corners = topology.face(f);
    let upwards = across(solid.face(f).normal);
    let level = |corner: VertexId| (solid.vertex(corner).at - at).dot(upwards);
    let first = level(corners[0]);
    let mut start = first;
    let mut winding = 0;
    for (k, &e) in topology.face_edges(f).iter().enumerate() {
        let end = corners.get(k + 1).map_or(first, |&corner| level(corner));
        let (from_above, to_above) = (R::ZERO.below(start), R::ZERO.below(end));
        // Where an edge may lie at the point's own level, its side is asked: the point may be on it.
        let misses_level = (R::ZERO.surely_below(start) && R::ZERO.surely_below(end))
            || (start.surely_below(R::ZERO) && end.surely_below(R::ZERO));
        start = end;
        if misses_level {
            continue;
        }
        let side = inward(at, solid, f, e);
        match (M::inside_face(side), M::inside_face(-side)) {
            (true, _) if !from_above && to_above => winding += 1,
            (_, true) if from_above && !to_above => winding -= 1,
            (false, false) if is_between_ends(at, solid, e) => return false,
            _ => {}
        }
    }
    winding != 0
}

/// For a point on an edge's line: whether it is on the edge, ends included.
fn is_between_ends<R: Real>(at: Vector<R>, solid: &PreparedBlock<R>, e: EdgeId) -> bool {
    let ridge = solid.edge(e);
    !(at - ridge.p).dot(ridge.direction).surely_below(R::ZERO)
        && !R::ZERO.surely_below((at - ridge.q).dot(ridge.direction))
}

/// A direction across `normal`, without rounding: the cross product with the axis it leans to least.
fn across<R: Real>(normal: Vector<R>) -> Vector<R> {
    let Vector { x, y, z } = normal;
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    if !ay.below(ax) && !az.below(ax) {
        Vector::new(R::ZERO, z, -y)
    } else if !az.below(ay) {
        Vector::new(-z, R::ZERO, x)
    } else {
        Vector::new(y, -x, R::ZERO)
    }
}
