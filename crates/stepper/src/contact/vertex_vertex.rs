//! Test 1: v-v.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::Plane;
use crate::contact::nearby_features::Planes;
use crate::contact::pair::Pair;
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, VertexId};

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the v-v contact of vertex `v` of A and vertex `w` of B, if there is one. Only those of its planes are asked that `planes` holds.
    pub(super) fn vertex_vertex(&mut self, v: VertexId, w: VertexId, planes: Planes) {
        if !planes.meets && !self.vertices_meet(v, w) {
            return;
        }
        self.candidates.clear();
        self.vertex_vertex_planes(v, w, |pair, number, plane| {
            if let Some(known) = planes.known(number) {
                pair.offer(plane, known);
            }
        });
        self.confirm(ContactKey::VertexVertex(v, w));
    }

    /// Two vertices are near, and one belongs to the other.
    pub(super) fn vertices_meet(&mut self, v: VertexId, w: VertexId) -> bool {
        let (one, two) = (self.a.vertex(v), self.b.vertex(w));
        if !M::vertex_takes_part(one.convex) || !M::vertex_takes_part(two.convex) {
            return false;
        }
        let about = ContactKey::VertexVertex(v, w).features();
        let near = M::vertex_vertex_near((one.at - two.at).length(), self.t.search);
        self.ask(Predicate::VertexVertexNear, &about, near)
            && (self.in_vertex_territory(Side::A, v, w) || self.in_regions(v, w))
    }

    /// The planes that may be the entrance of two vertices, with their numbers.
    #[inline(always)]
    pub(super) fn vertex_vertex_planes(
        &mut self,
        v: VertexId,
        w: VertexId,
        mut each: impl FnMut(&mut Self, usize, Plane),
    ) {
        let (a, b) = (self.a, self.b);
        let of_b = b.block().topology().vertex_faces(w).iter().map(|&face| Plane::VertexFace(Side::A, v, face));
        let of_a = a.block().topology().vertex_faces(v).iter().map(|&face| Plane::VertexFace(Side::B, w, face));
        let mut number = 0;
        for plane in of_b.chain(of_a) {
            each(self, number, plane);
            number += 1;
        }
        if M::edge_entrances() {
            for &own in a.edges_at(v) {
                for &other in b.edges_at(w) {
                    each(self, number, Plane::EdgeEdge(own, other));
                    number += 1;
                }
            }
        }
    }

    /// Each of the two vertices lies in the other's vertex region.
    fn in_regions(&mut self, v: VertexId, w: VertexId) -> bool {
        self.in_vertex_region(Side::A, v, w) && (!M::both_regions() || self.in_vertex_region(Side::B, w, v))
    }

    /// Vertex `v` of `side` lies in the vertex region of `w` of the other block: `(v − w)·u ≤ 0` for all edges at `w`.
    fn in_vertex_region(&mut self, side: Side, v: VertexId, w: VertexId) -> bool {
        let (own, other) = (self.prepared(side), self.prepared(side.other()));
        let offset = own.vertex(v).at - other.vertex(w).at;
        M::region(other.edges_at(w)).iter().all(|&e| {
            let about = [Feature::Vertex(side, v), Feature::Vertex(side.other(), w), Feature::Edge(side.other(), e)];
            self.ask(Predicate::VertexRegion, &about, M::vertex_region(offset.dot(other.edge_at_vertex(w, e).away)))
        })
    }
}
