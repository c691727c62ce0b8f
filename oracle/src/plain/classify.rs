//! All tests of SPEC section 4 on a pair, in their order.

use super::pair::{ContactWithPlane, Pair};
use super::predicate_answer::PredicateAnswer;
use super::{edge_edge, exit, vertex_edge, vertex_face, vertex_vertex};
use crate::rational::Rational;
use rockproof_model::decision::{Predicate, Side};

/// The contacts of the pair, sorted.
pub(super) fn contacts<Q: Rational>(pair: &Pair<'_, Q>) -> Vec<ContactWithPlane<Q>> {
    if !pair.decide(Predicate::Neighbours, &[], neighbours(pair)) {
        return Vec::new();
    }
    let mut found = vertex_vertex::contacts(pair);
    for side in [Side::A, Side::B] {
        found.extend(vertex_edge::contacts(pair, side));
    }
    for side in [Side::A, Side::B] {
        found.extend(exit::shortest(pair, side, vertex_face::contacts(pair, side)));
    }
    found.extend(edge_edge::contacts(pair));
    found.sort_by_key(|contact| contact.key);
    for contact in &found {
        pair.record_gap_sign(&contact.plane);
    }
    exit::one_exit(pair, found)
}

/// Rough phase: A's box grown by s meets B's. **Touching counts.**
fn neighbours<Q: Rational>(pair: &Pair<'_, Q>) -> PredicateAnswer {
    let mut meet = PredicateAnswer { yes: true, tie: false };
    for axis in 0..3 {
        let (low_a, high_a) = pair.a.extent(axis);
        let (low_b, high_b) = pair.b.extent(axis);
        let search = &pair.limits.search;
        meet = meet
            .and(|| PredicateAnswer::at_most(&low_b, &high_a.plus(search)))
            .and(|| PredicateAnswer::at_most(&low_a.minus(search), &high_b));
    }
    meet
}
