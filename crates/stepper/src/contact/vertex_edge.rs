//! Test 2: v-e, and e-v with the roles exchanged.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::Plane;
use crate::contact::nearby_features::Planes;
use crate::contact::pair::Pair;
use crate::contact::prepared_block::FaceOfEdge;
use crate::contact::territory::distance_to_line;
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, VertexId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the contact of vertex `v` of `side` and edge `e` of the other block, if there is one. Only those of its planes are asked that
    /// `planes` holds.
    pub(super) fn vertex_edge(&mut self, side: Side, v: VertexId, e: EdgeId, planes: Planes) {
        let ridge = self.prepared(side.other()).edge(e);
        let of_end = |pair: &mut Self| {
            M::ends_before_edge()
                && (pair.in_vertex_territory(side, v, ridge.edge.p) || pair.in_vertex_territory(side, v, ridge.edge.q))
        };
        if !planes.meets && !self.vertex_meets_edge(side, v, e, of_end) {
            return;
        }
        self.candidates.clear();
        self.vertex_edge_planes(side, v, e, |pair, number, plane| {
            if let Some(known) = planes.known(number) {
                pair.offer(plane, known);
            }
        });
        self.confirm(match side {
            Side::A => ContactKey::VertexEdge(v, e),
            Side::B => ContactKey::EdgeVertex(e, v),
        });
    }

    /// A vertex is near an edge, of no end of which it is, and belongs to it.
    #[inline(always)]
    pub(super) fn vertex_meets_edge(
        &mut self,
        side: Side,
        v: VertexId,
        e: EdgeId,
        of_end: impl FnOnce(&mut Self) -> bool,
    ) -> bool {
        let (own, other) = (self.prepared(side), self.prepared(side.other()));
        let (vertex, ridge) = (own.vertex(v), other.edge(e));
        if !M::vertex_takes_part(vertex.convex) || !M::edge_takes_part(ridge.convex) || !self.foot_inside(side, v, e) {
            return false;
        }
        let asked = [Feature::Vertex(side, v), Feature::Edge(side.other(), e)];
        let distance = distance_to_line(vertex.at, ridge);
        if !self.ask(Predicate::VertexEdgeNear, &asked, M::vertex_edge_near(distance, self.t.search)) {
            return false;
        }
        !of_end(self)
            && (self.in_edge_radius(side, v, e, distance)
                || (self.in_edge_region(side, v, e) && self.foot_in_vertex_region(side, v, e)))
    }

    /// The planes that may be the entrance of vertex `v` of `side` and edge `e` of the other block, with their numbers.
    #[inline(always)]
    pub(super) fn vertex_edge_planes(
        &mut self,
        side: Side,
        v: VertexId,
        e: EdgeId,
        mut each: impl FnMut(&mut Self, usize, Plane),
    ) {
        let (own, edge) = (self.prepared(side), self.prepared(side.other()).edge(e).edge);
        let mut faces = [edge.left, edge.right];
        faces.sort_unstable();
        for (number, face) in faces.into_iter().enumerate() {
            each(self, number, Plane::VertexFace(side, v, face));
        }
        if M::edge_entrances() {
            for (number, &at) in (faces.len()..).zip(own.edges_at(v)) {
                each(self, number, if side == Side::A { Plane::EdgeEdge(at, e) } else { Plane::EdgeEdge(e, at) });
            }
        }
    }

    /// `(a − p)·m ≤ 0` for both faces at the edge.
    fn in_edge_region(&mut self, side: Side, v: VertexId, e: EdgeId) -> bool {
        let other = self.prepared(side.other());
        let ridge = other.edge(e);
        let offset = self.prepared(side).vertex(v).at - ridge.p;
        [(ridge.edge.left, FaceOfEdge::Left), (ridge.edge.right, FaceOfEdge::Right)].into_iter().all(|(face, of)| {
            let about = [Feature::Vertex(side, v), Feature::Edge(side.other(), e), Feature::Face(side.other(), face)];
            self.ask(Predicate::EdgeRegion, &about, M::edge_region(offset.dot(other.into_face(e, of))))
        })
    }

    /// `(f − a)·u ≤ 0` for all edges at the vertex, f its foot on the edge.
    fn foot_in_vertex_region(&mut self, side: Side, v: VertexId, e: EdgeId) -> bool {
        let (own, ridge) = (self.prepared(side), self.prepared(side.other()).edge(e));
        let from_p = own.vertex(v).at - ridge.p;
        let to_foot = ridge.direction * from_p.dot(ridge.direction) - from_p;
        M::region(own.edges_at(v)).iter().all(|&at| {
            let about = [Feature::Vertex(side, v), Feature::Edge(side.other(), e), Feature::Edge(side, at)];
            self.ask(Predicate::FootRegion, &about, M::foot_region(to_foot.dot(own.edge_at_vertex(v, at).away)))
        })
    }
}
