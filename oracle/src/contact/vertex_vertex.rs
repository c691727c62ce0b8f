//! Test 1: v-v.

use super::entrance::{Candidate, Candidates, Planes};
use crate::classification::{Classification, Observer};
use crate::predicate::{BeyondVertex, LengthTolerance, Near, Vertex};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{ContactKey, VertexId};

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether vertices a of A and b of B touch, and through which entrance.
    ///
    /// Both convex, `|a − b| ≤ s`, and either in one another's territory or each in the other's vertex region; a
    /// candidate passes and the chosen one is not too deep. `planes` are the candidates that may pass.
    pub(crate) fn vertex_vertex(&mut self, a: VertexId, b: VertexId, mut planes: Planes) -> Option<Candidate> {
        if !(self.vertex_is_convex(Side::A, a) && self.vertex_is_convex(Side::B, b)) {
            return None;
        }
        let contact = ContactKey::VertexVertex(a, b);
        let of = contact.features();
        let near = self.decide(
            || Decision::about(Predicate::VertexVertexNear, &of),
            |run| run.sign(&Near { a, b, limit: LengthTolerance::Search }).is_at_least_zero(),
        );
        if !near {
            return None;
        }
        let (vertex_a, vertex_b) = ((Side::A, a), (Side::B, b));
        if !(self.share_territory(a, b)
            || (self.in_vertex_region(vertex_a, vertex_b) && self.in_vertex_region(vertex_b, vertex_a)))
        {
            return None;
        }
        let (at_a, at_b) = (self.pair.topology(Side::A), self.pair.topology(Side::B));
        let mut candidates = Candidates::new();
        self.add_faces(vertex_a, at_b.vertex_faces(b), &mut planes, &mut candidates);
        self.add_faces(vertex_b, at_a.vertex_faces(a), &mut planes, &mut candidates);
        self.add_edges(at_a.vertex_edges(a), at_b.vertex_edges(b), &mut planes, &mut candidates);
        let chosen = self.choose(of, candidates)?;
        self.not_too_deep(contact, &chosen, || Decision::about(Predicate::EntranceDepth, &of)).then_some(chosen)
    }

    /// Whether `(point − at)·e ≤ 0` for all edges e at the vertex `at`; **a tie says yes**.
    fn in_vertex_region(&mut self, point: Vertex, at: Vertex) -> bool {
        let edges = self.pair.topology(at.0).vertex_edges(at.1);
        edges.iter().all(|&edge| {
            let features = [Feature::Vertex(point.0, point.1), Feature::Vertex(at.0, at.1), Feature::Edge(at.0, edge)];
            self.decide(
                || Decision::about(Predicate::VertexRegion, &features),
                |run| run.sign(&BeyondVertex { point, at, edge }).is_at_most_zero(),
            )
        })
    }
}
