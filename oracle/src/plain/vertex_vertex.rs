//! Test 1 of SPEC section 4: v-v.

use super::entrance::Candidates;
use super::pair::{ContactWithPlane, Pair};
use super::predicate_answer::PredicateAnswer;
use super::vector::{difference, dot, squared_length};
use crate::rational::Rational;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, VertexId};

/// All v-v contacts of the pair.
pub(super) fn contacts<Q: Rational>(pair: &Pair<'_, Q>) -> Vec<ContactWithPlane<Q>> {
    let mut found = Vec::new();
    for a in pair.a.block.topology().vertex_ids() {
        for b in pair.b.block.topology().vertex_ids() {
            found.extend(contact(pair, a, b));
        }
    }
    found
}

fn contact<Q: Rational>(pair: &Pair<'_, Q>, a: VertexId, b: VertexId) -> Option<ContactWithPlane<Q>> {
    let both_convex = pair.a.block.vertex_is_convex(a) && pair.b.block.vertex_is_convex(b);
    let belongs = both_convex
        && near(pair, a, b)
        && (pair.in_vertex_territory(a, b)
            || (in_vertex_region(pair, Side::A, a, b) && in_vertex_region(pair, Side::B, b, a)));
    if !belongs {
        return None;
    }
    let (a_topology, b_topology) = (pair.a.block.topology(), pair.b.block.topology());
    let mut candidates = Candidates::new(pair);
    for &face in b_topology.vertex_faces(b) {
        candidates.vertex_face(Side::A, a, face);
    }
    for &face in a_topology.vertex_faces(a) {
        candidates.vertex_face(Side::B, b, face);
    }
    for &edge_a in a_topology.vertex_edges(a) {
        for &edge_b in b_topology.vertex_edges(b) {
            candidates.edge_edge(edge_a, edge_b);
        }
    }
    candidates.confirm(ContactKey::VertexVertex(a, b))
}

/// `|a − b|² ≤ s²`. **A tie says yes.**
fn near<Q: Rational>(pair: &Pair<'_, Q>, a: VertexId, b: VertexId) -> bool {
    let apart = squared_length(&difference(pair.vertex(Side::A, a), pair.vertex(Side::B, b)));
    let features = [Feature::Vertex(Side::A, a), Feature::Vertex(Side::B, b)];
    pair.decide(Predicate::VertexVertexNear, &features, PredicateAnswer::at_most(&apart, &pair.limits.search_squared))
}

/// Vertex `asked` of `side` lies in the region of vertex `owner` of the other block: `(asked − owner)·e ≤ 0` for all
/// edges e at `owner`. **A tie says yes.**
fn in_vertex_region<Q: Rational>(pair: &Pair<'_, Q>, side: Side, asked: VertexId, owner: VertexId) -> bool {
    let offset = difference(pair.vertex(side, asked), pair.vertex(side.other(), owner));
    pair.side(side.other()).edges_away(owner).iter().all(|(edge, away)| {
        let features =
            [Feature::Vertex(side, asked), Feature::Vertex(side.other(), owner), Feature::Edge(side.other(), *edge)];
        pair.decide(Predicate::VertexRegion, &features, PredicateAnswer::at_most(&dot(&offset, away), &Q::zero()))
    })
}
