//! Test 1: v-v.

use crate::contact::pair::Pair;
use crate::contact::rules::ContactRules;
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, VertexId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the v-v contact of vertex `v` of A and vertex `w` of B, if there is one.
    pub(super) fn vertex_vertex(&mut self, v: VertexId, w: VertexId) {
        let (one, two) = (self.a.vertex(v), self.b.vertex(w));
        if !M::vertex_takes_part(one.convex) || !M::vertex_takes_part(two.convex) {
            return;
        }
        let contact = ContactKey::VertexVertex(v, w);
        let about = contact.features();
        let near = M::vertex_vertex_near((one.at - two.at).length(), self.t.search);
        if !self.ask(Predicate::VertexVertexNear, &about, near) {
            return;
        }
        if !self.in_vertex_territory(Side::A, v, w) && !self.in_regions(v, w) {
            return;
        }
        self.candidates.clear();
        for &face in self.b.block().topology().vertex_faces(w) {
            self.offer_vertex_face(Side::A, v, face);
        }
        for &face in self.a.block().topology().vertex_faces(v) {
            self.offer_vertex_face(Side::B, w, face);
        }
        if M::edge_entrances() {
            for &own in self.a.edges_at(v) {
                for &other in self.b.edges_at(w) {
                    self.offer_edge_edge(own, other);
                }
            }
        }
        self.confirm(contact);
    }

    /// Each of the two vertices lies in the other's vertex region.
    fn in_regions(&mut self, v: VertexId, w: VertexId) -> bool {
        self.in_vertex_region(Side::A, v, w) && (!M::both_regions() || self.in_vertex_region(Side::B, w, v))
    }

    /// Vertex `v` of `side` lies in the vertex region of `w` of the other block: `(v − w)·u ≤ 0` for all edges at `w`.
    fn in_vertex_region(&mut self, side: Side, v: VertexId, w: VertexId) -> bool {
        let (own, other) = (self.solid(side), self.solid(side.other()));
        let offset = own.vertex(v).at - other.vertex(w).at;
        M::region(other.edges_at(w)).iter().all(|&e| {
            let about = [Feature::Vertex(side, v), Feature::Vertex(side.other(), w), Feature::Edge(side.other(), e)];
            self.ask(Predicate::VertexRegion, &about, M::vertex_region(offset.dot(other.spoke(w, e).away)))
        })
    }
}
