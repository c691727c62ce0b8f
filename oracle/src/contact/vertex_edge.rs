//! Test 2: v-e, and e-v with the roles exchanged.

use super::entrance::{Candidate, Candidates, Planes, faces_of};
use super::territory::about_vertex_edge;
use crate::classification::{Classification, Observer};
use crate::predicate::{Edge, FootBeyondVertex, InwardOf, LengthTolerance, NearLine, Vertex};
use rockproof_model::ContactKey;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether a vertex touches an edge of the other block, and through which entrance.
    ///
    /// Both convex, the foot strictly inside, the distance ≤ s, the vertex in the territory of neither end, and either
    /// in the edge's territory or each in the other's region; a candidate passes and the chosen one is not too deep. `planes` are
    /// the candidates that may pass.
    pub(crate) fn vertex_edge(&mut self, vertex: Vertex, edge: Edge, mut planes: Planes) -> Option<Candidate> {
        if !(self.vertex_is_convex(vertex.0, vertex.1) && self.edge_is_convex(edge.0, edge.1)) {
            return None;
        }
        if !self.foot_inside(vertex, edge) || !self.near_edge(vertex, edge) {
            return None;
        }
        let ends = *self.pair.topology(edge.0).edge(edge.1);
        if self.vertices_share_territory(vertex, ends.p) || self.vertices_share_territory(vertex, ends.q) {
            return None;
        }
        if !(self.within_edge_territory(vertex, edge)
            || (self.in_edge_region(vertex, edge) && self.foot_in_vertex_region(vertex, edge)))
        {
            return None;
        }
        let mut candidates = Candidates::new();
        self.add_faces(vertex, &faces_of(self, edge), &mut planes, &mut candidates);
        let at_vertex = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        let contact = match vertex.0 {
            Side::A => {
                self.add_edges(at_vertex, &[edge.1], &mut planes, &mut candidates);
                ContactKey::VertexEdge(vertex.1, edge.1)
            }
            Side::B => {
                self.add_edges(&[edge.1], at_vertex, &mut planes, &mut candidates);
                ContactKey::EdgeVertex(edge.1, vertex.1)
            }
        };
        let of = contact.features();
        let chosen = self.choose(of, candidates)?;
        self.not_too_deep(contact, &chosen, || Decision::about(Predicate::EntranceDepth, &of)).then_some(chosen)
    }

    fn near_edge(&mut self, vertex: Vertex, edge: Edge) -> bool {
        self.decide(
            || about_vertex_edge(Predicate::VertexEdgeNear, vertex, edge),
            |run| run.sign(&NearLine { vertex, edge, limit: LengthTolerance::Search }).is_at_least_zero(),
        )
    }

    /// Whether `(v − p)·m_L ≤ 0` and `(v − p)·m_R ≤ 0`; **a tie says yes**.
    fn in_edge_region(&mut self, vertex: Vertex, edge: Edge) -> bool {
        let ends = *self.pair.topology(edge.0).edge(edge.1);
        [(ends.left, false), (ends.right, true)].into_iter().all(|(face, right)| {
            let features =
                [Feature::Vertex(vertex.0, vertex.1), Feature::Edge(edge.0, edge.1), Feature::Face(edge.0, face)];
            self.decide(
                || Decision::about(Predicate::EdgeRegion, &features),
                |run| run.sign(&InwardOf { vertex, edge, right }).is_at_most_zero(),
            )
        })
    }

    /// Whether `(f − v)·e ≤ 0` for the foot f on the edge and all edges e at the vertex; **a tie says yes**.
    fn foot_in_vertex_region(&mut self, vertex: Vertex, edge: Edge) -> bool {
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        edges.iter().all(|&at_vertex| {
            let features = [
                Feature::Vertex(vertex.0, vertex.1),
                Feature::Edge(edge.0, edge.1),
                Feature::Edge(vertex.0, at_vertex),
            ];
            self.decide(
                || Decision::about(Predicate::FootRegion, &features),
                |run| run.sign(&FootBeyondVertex { vertex, edge, at_vertex }).is_at_most_zero(),
            )
        })
    }
}
