//! Territories: the zones around vertices and edges that belong to them (SPEC section 4, "Territory radius").

use crate::classification::{Classification, Observer};
use crate::predicate::{Edge, FootAlong, LengthTolerance, Near, NearForEdge, NearLine, NearLineForHeight, Vertex};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{EdgeId, VertexId};

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether vertices a of A and b of B lie in one another's territory: both convex and `|a − b| ≤ min(r_a, r_b)`;
    /// **a tie says yes**.
    pub(crate) fn share_territory(&mut self, a: VertexId, b: VertexId) -> bool {
        if (!O::is_active() && self.vertices_out_of_reach(a, b, self.territory_distance))
            || !(self.vertex_is_convex(Side::A, a) && self.vertex_is_convex(Side::B, b))
        {
            return false;
        }
        let decision =
            || Decision::about(Predicate::VertexTerritory, &[Feature::Vertex(Side::A, a), Feature::Vertex(Side::B, b)]);
        self.decide(decision, |run| {
            if run.classic {
                return run.sign(&Near { a, b, limit: LengthTolerance::Search }).is_at_least_zero();
            }
            run.sign(&Near { a, b, limit: LengthTolerance::Territory }).is_at_least_zero()
                && run.within_shortest_edge((Side::A, a), a, b)
                && run.within_shortest_edge((Side::B, b), a, b)
        })
    }

    /// `|a − b| ≤ λ·(shortest edge at the vertex)`
    fn within_shortest_edge(&mut self, at: Vertex, a: VertexId, b: VertexId) -> bool {
        let edges = self.pair.topology(at.0).vertex_edges(at.1);
        edges.iter().all(|&edge| self.sign(&NearForEdge { a, b, edge: (at.0, edge) }).is_at_least_zero())
    }

    /// [`Classification::share_territory`] for vertices given with their sides.
    pub(crate) fn vertices_share_territory(&mut self, vertex: Vertex, other: VertexId) -> bool {
        match vertex.0 {
            Side::A => self.share_territory(vertex.1, other),
            Side::B => self.share_territory(other, vertex.1),
        }
    }

    /// Whether a vertex lies in the territory of an edge of the other block: both convex, its foot strictly inside
    /// (**a tie says no**), its distance to the line ≤ r_e (**a tie says yes**).
    pub(crate) fn in_edge_territory(&mut self, vertex: Vertex, edge: Edge) -> bool {
        if self.beyond_territory_of_edge(vertex, edge.1)
            || !(self.vertex_is_convex(vertex.0, vertex.1) && self.edge_is_convex(edge.0, edge.1))
        {
            return false;
        }
        // Most feet are inside, and most distances too large: that goes first where decisions are not recorded in the order of SPEC.
        if O::is_active() {
            return self.foot_inside(vertex, edge) && self.within_edge_territory(vertex, edge);
        }
        self.within_edge_territory(vertex, edge) && self.foot_inside(vertex, edge)
    }

    /// Whether a vertex is certainly too far from an edge of the other block to be in its territory or in that of its ends.
    pub(crate) fn beyond_territory_of_edge(&self, vertex: Vertex, edge: EdgeId) -> bool {
        !O::is_active() && self.vertex_out_of_reach_of_edge(vertex, edge, self.territory_distance)
    }

    /// Whether the foot of a vertex lies strictly inside an edge; **a tie says no**.
    pub(crate) fn foot_inside(&mut self, vertex: Vertex, edge: Edge) -> bool {
        self.decide(
            || about_vertex_edge(Predicate::FootInside, vertex, edge),
            |run| {
                run.sign(&FootAlong { vertex, edge, from_end: false }).is_positive()
                    && run.sign(&FootAlong { vertex, edge, from_end: true }).is_positive()
            },
        )
    }

    /// Whether the distance of a vertex to an edge's line is ≤ r_e, `r_e = min(r, λ·w_e)`; **a tie says yes**.
    pub(crate) fn within_edge_territory(&mut self, vertex: Vertex, edge: Edge) -> bool {
        self.decide(
            || about_vertex_edge(Predicate::EdgeTerritory, vertex, edge),
            |run| {
                if run.classic {
                    return run.sign(&NearLine { vertex, edge, limit: LengthTolerance::Search }).is_at_least_zero();
                }
                if run.sign(&NearLine { vertex, edge, limit: LengthTolerance::Territory }).is_negative() {
                    return false;
                }
                // w_e is the smaller of two greatest distances: within λ·w_e means within λ of some corner of each face.
                let ends = *run.pair.topology(edge.0).edge(edge.1);
                [ends.left, ends.right].into_iter().all(|face| {
                    let corners = run.pair.topology(edge.0).face(face);
                    corners
                        .iter()
                        .filter(|&&w| w != ends.p && w != ends.q)
                        .any(|&height_at| run.sign(&NearLineForHeight { vertex, edge, height_at }).is_at_least_zero())
                })
            },
        )
    }
}

pub(crate) fn about_vertex_edge(predicate: Predicate, vertex: Vertex, edge: Edge) -> Decision {
    Decision::about(predicate, &[Feature::Vertex(vertex.0, vertex.1), Feature::Edge(edge.0, edge.1)])
}
