//! Territories: the zones around vertices and edges that belong to them (SPEC section 4, building blocks).

use super::pair::Pair;
use super::predicate_answer::PredicateAnswer;
use super::vector::{difference, squared_length};
use crate::rational::Rational;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{EdgeId, VertexId};

impl<Q: Rational> Pair<'_, Q> {
    /// A vertex of A and one of B: each in the other's territory, which is one question: both are convex and
    /// `|a − b| ≤ min(r_a, r_b)`. **A tie says yes.**
    pub(super) fn in_vertex_territory(&self, a: VertexId, b: VertexId) -> bool {
        if !self.a.block.vertex_is_convex(a) || !self.b.block.vertex_is_convex(b) {
            return false;
        }
        let apart = squared_length(&difference(self.vertex(Side::A, a), self.vertex(Side::B, b)));
        let radius_squared = (&self.a.vertex_radius_squared[a.index()]).min(&self.b.vertex_radius_squared[b.index()]);
        let features = [Feature::Vertex(Side::A, a), Feature::Vertex(Side::B, b)];
        self.decide(Predicate::VertexTerritory, &features, PredicateAnswer::at_most(&apart, radius_squared))
    }

    /// Vertex of `side` in the territory of an edge of the other block: both are convex, the foot lies strictly inside
    /// the edge, and the distance to the line is ≤ r_e. **A tie of the distance says yes.**
    pub(super) fn in_edge_territory(&self, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
        self.side(side).block.vertex_is_convex(vertex)
            && self.side(side.other()).block.edge_is_convex(edge)
            && self.foot_inside(side, vertex, edge)
            && self.within_edge_radius(side, vertex, edge)
    }

    /// The foot of a vertex of `side` on the line of an edge of the other block lies strictly inside the edge.
    /// **A tie says no.**
    pub(super) fn foot_inside(&self, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
        let other = self.side(side.other());
        let along = other.against_line(self.vertex(side, vertex), edge).along;
        let length_squared = &other.edges[edge.index()].length_squared;
        let verdict =
            PredicateAnswer::above_zero(&along).and(|| PredicateAnswer::above_zero(&length_squared.minus(&along)));
        self.decide(Predicate::FootInside, &vertex_and_edge(side, vertex, edge), verdict)
    }

    /// The distance from a vertex of `side` to the line of an edge of the other block is ≤ r_e.
    pub(super) fn within_edge_radius(&self, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
        let verdict = self.line_within(side, vertex, edge, &self.side(side.other()).edge_radius_squared[edge.index()]);
        self.decide(Predicate::EdgeTerritory, &vertex_and_edge(side, vertex, edge), verdict)
    }

    /// `|(x − p) × d|² ≤ radius²·|d|²`: the squared distance to the line against a squared radius, over no denominator.
    pub(super) fn line_within(
        &self,
        side: Side,
        vertex: VertexId,
        edge: EdgeId,
        radius_squared: &Q,
    ) -> PredicateAnswer {
        let other = self.side(side.other());
        let beside_squared = other.against_line(self.vertex(side, vertex), edge).beside_squared;
        let length_squared = &other.edges[edge.index()].length_squared;
        PredicateAnswer::at_most(&beside_squared, &radius_squared.times(length_squared))
    }
}

/// The features of a decision about a vertex of `side` and an edge of the other block, the vertex first.
pub(super) fn vertex_and_edge(side: Side, vertex: VertexId, edge: EdgeId) -> [Feature; 2] {
    [Feature::Vertex(side, vertex), Feature::Edge(side.other(), edge)]
}
