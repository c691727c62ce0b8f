//! The zones around convex vertices and edges that belong to them (SPEC section 4, "Territory radius").

use crate::contact::contact_rules::ContactRules;
use crate::contact::pair::Pair;
use crate::contact::prepared_block::PreparedEdge;
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, VertexId};

/// The distance of a point from an edge's line.
#[inline]
pub(super) fn distance_to_line<R: Real>(point: Vector<R>, edge: &PreparedEdge<R>) -> R {
    (point - edge.p).cross(edge.direction).length()
}

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Vertex `v` of `side` is in the territory of vertex `w` of the other block (and `w` in that of `v`).
    #[inline]
    pub(super) fn in_vertex_territory(&mut self, side: Side, v: VertexId, w: VertexId) -> bool {
        let (one, two) = (self.prepared(side).vertex(v), self.prepared(side.other()).vertex(w));
        if !M::vertex_takes_part(one.convex) || !M::vertex_takes_part(two.convex) {
            return false;
        }
        let radius = M::shared_radius(M::vertex_radius(self.t, one.shortest), M::vertex_radius(self.t, two.shortest));
        let inside = M::vertex_territory((one.at - two.at).length(), radius);
        let about = match side {
            Side::A => ContactKey::VertexVertex(v, w),
            Side::B => ContactKey::VertexVertex(w, v),
        };
        self.ask(Predicate::VertexTerritory, &about.features(), inside)
    }

    /// Vertex `v` of `side` is in the territory of edge `e` of the other block.
    pub(super) fn in_edge_territory(&mut self, side: Side, v: VertexId, e: EdgeId) -> bool {
        let (vertex, edge) = (self.prepared(side).vertex(v), self.prepared(side.other()).edge(e));
        M::vertex_takes_part(vertex.convex)
            && M::edge_takes_part(edge.convex)
            && self.foot_inside(side, v, e)
            && self.in_edge_radius(side, v, e, distance_to_line(vertex.at, edge))
    }

    /// The foot of vertex `v` of `side` lies strictly inside edge `e` of the other block.
    #[inline(always)]
    pub(super) fn foot_inside(&mut self, side: Side, v: VertexId, e: EdgeId) -> bool {
        let (at, edge) = (self.prepared(side).vertex(v).at, self.prepared(side.other()).edge(e));
        let inside = M::foot_inside((at - edge.p).dot(edge.direction), (at - edge.q).dot(edge.direction));
        self.ask(Predicate::FootInside, &[Feature::Vertex(side, v), Feature::Edge(side.other(), e)], inside)
    }

    /// A vertex whose foot is inside the edge is within the edge's radius.
    pub(super) fn in_edge_radius(&mut self, side: Side, v: VertexId, e: EdgeId, distance: R) -> bool {
        let [left, right] = self.prepared(side.other()).widths(e);
        let inside = M::edge_territory(distance, M::edge_radius(self.t, left, right));
        self.ask(Predicate::EdgeTerritory, &[Feature::Vertex(side, v), Feature::Edge(side.other(), e)], inside)
    }
}
