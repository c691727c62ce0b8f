//! Test 2 of SPEC section 4: v-e and e-v.

use super::entrance::Candidates;
use super::pair::{ContactWithPlane, Pair, in_order};
use super::predicate_answer::PredicateAnswer;
use super::territory::vertex_and_edge;
use super::vector::{difference, dot, multiple, sum};
use crate::rational::Rational;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, VertexId};

/// All contacts of a vertex of `side` and an edge of the other block.
pub(super) fn contacts<Q: Rational>(pair: &Pair<'_, Q>, side: Side) -> Vec<ContactWithPlane<Q>> {
    let mut found = Vec::new();
    for vertex in pair.side(side).block.topology().vertex_ids() {
        for edge in pair.side(side.other()).block.topology().edge_ids() {
            found.extend(contact(pair, side, vertex, edge));
        }
    }
    found
}

fn contact<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, edge: EdgeId) -> Option<ContactWithPlane<Q>> {
    let (own, other) = (pair.side(side), pair.side(side.other()));
    let belongs = own.block.vertex_is_convex(vertex)
        && other.block.edge_is_convex(edge)
        && pair.foot_inside(side, vertex, edge)
        && near(pair, side, vertex, edge)
        && !in_territory_of_an_end(pair, side, vertex, edge)
        && (pair.within_edge_radius(side, vertex, edge)
            || (in_edge_region(pair, side, vertex, edge) && foot_in_vertex_region(pair, side, vertex, edge)));
    if !belongs {
        return None;
    }
    let mut candidates = Candidates::new(pair);
    let line = other.edge(edge);
    for face in [line.left, line.right] {
        candidates.vertex_face(side, vertex, face);
    }
    for &own_edge in own.block.topology().vertex_edges(vertex) {
        let (edge_a, edge_b) = in_order(side, own_edge, edge);
        candidates.edge_edge(edge_a, edge_b);
    }
    candidates.confirm(match side {
        Side::A => ContactKey::VertexEdge(vertex, edge),
        Side::B => ContactKey::EdgeVertex(edge, vertex),
    })
}

/// The distance to the line is ≤ s. **A tie says yes.**
fn near<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
    let verdict = pair.line_within(side, vertex, edge, &pair.limits.search_squared);
    pair.decide(Predicate::VertexEdgeNear, &vertex_and_edge(side, vertex, edge), verdict)
}

fn in_territory_of_an_end<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
    let line = pair.side(side.other()).edge(edge);
    [line.p, line.q].into_iter().any(|end| {
        let (a, b) = in_order(side, vertex, end);
        pair.in_vertex_territory(a, b)
    })
}

/// `(a − p)·m_L ≤ 0` and `(a − p)·m_R ≤ 0`. **A tie says yes.**
fn in_edge_region<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
    let other = pair.side(side.other());
    let from_p = other.against_line(pair.vertex(side, vertex), edge).from_p;
    let ends = other.edge(edge);
    let [left, right] = &other.edges[edge.index()].inward;
    [(ends.left, left), (ends.right, right)].into_iter().all(|(face, inward)| {
        let [vertex, edge] = vertex_and_edge(side, vertex, edge);
        let features = [vertex, edge, Feature::Face(side.other(), face)];
        pair.decide(Predicate::EdgeRegion, &features, PredicateAnswer::at_most(&dot(&from_p, inward), &Q::zero()))
    })
}

/// The foot f of the vertex a on the line lies in a's region: `(f − a)·e ≤ 0` for all edges e at a. **A tie says yes.**
/// Asked only where the foot lies strictly inside the edge, so the edge has a length.
fn foot_in_vertex_region<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, edge: EdgeId) -> bool {
    let other = pair.side(side.other());
    let here = pair.vertex(side, vertex);
    let line = &other.edges[edge.index()];
    let share = other.against_line(here, edge).along.over(&line.length_squared).unwrap_or_else(Q::zero);
    let start = &other.vertices[other.edge(edge).p.index()];
    let foot = sum(start, &multiple(&share, &line.direction));
    let offset = difference(&foot, here);
    pair.side(side).edges_away(vertex).iter().all(|(own_edge, away)| {
        let [vertex, edge] = vertex_and_edge(side, vertex, edge);
        let features = [vertex, edge, Feature::Edge(side, *own_edge)];
        pair.decide(Predicate::FootRegion, &features, PredicateAnswer::at_most(&dot(&offset, away), &Q::zero()))
    })
}
