//! Test 4: crossing e-e.

use super::certified_reject::CertainPlace;
use super::entrance::Candidate;
use super::no_overlap::about_edges;
use crate::classification::{Classification, Observer};
use crate::predicate::{CommonFoot, LengthTolerance};
use rockproof_model::decision::{Predicate, Side};
use rockproof_model::{ContactKey, EdgeId};

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether two convex edges cross and touch.
    ///
    /// Not nearly parallel, the feet of the common perpendicular strictly inside both, no endpoint in the territory of
    /// the other edge or its ends, `h ≤ s`, not too deep, and the wedges pass. `feet` is what is known of the feet.
    pub(crate) fn edge_edge(&mut self, edge_a: EdgeId, edge_b: EdgeId, feet: CertainPlace) -> Option<Candidate> {
        if !(self.edge_is_convex(Side::A, edge_a) && self.edge_is_convex(Side::B, edge_b)) {
            return None;
        }
        if self.nearly_parallel(edge_a, edge_b) {
            return None;
        }
        if feet == CertainPlace::Inside {
            self.cascade.levels.float += 4;
        } else if !self.feet_inside(edge_a, edge_b) {
            return None;
        }
        let sigma = self.orientation(edge_a, edge_b);
        let candidate = self.edge_candidate(edge_a, edge_b, sigma);
        let near = self.decide(
            || about_edges(Predicate::EdgeEdgeNear, edge_a, edge_b),
            |run| run.gap_at_most(&candidate, LengthTolerance::Search),
        ) && self.not_too_deep(ContactKey::EdgeEdge(edge_a, edge_b), &candidate, || {
            about_edges(Predicate::EdgeEdgeDepth, edge_a, edge_b)
        });
        // What is cheaper to ask goes first, but where decisions are recorded in the order of SPEC.
        if !near || (O::is_active() && self.an_end_belongs_elsewhere(edge_a, edge_b)) {
            return None;
        }
        let candidate = candidate.passing(self.wedges_pass(edge_a, edge_b, sigma))?;
        (O::is_active() || !self.an_end_belongs_elsewhere(edge_a, edge_b)).then_some(candidate)
    }

    /// Whether both feet of the common perpendicular lie strictly inside; **a tie says no**.
    fn feet_inside(&mut self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        self.decide(
            || about_edges(Predicate::FeetInside, edge_a, edge_b),
            |run| {
                [(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)]
                    .into_iter()
                    .all(|(on, from_end)| run.sign(&CommonFoot { edge_a, edge_b, on, from_end }).is_positive())
            },
        )
    }

    fn an_end_belongs_elsewhere(&mut self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        let a = *self.pair.topology(Side::A).edge(edge_a);
        let b = *self.pair.topology(Side::B).edge(edge_b);
        let ends =
            [((Side::A, a.p), edge_b), ((Side::A, a.q), edge_b), ((Side::B, b.p), edge_a), ((Side::B, b.q), edge_a)];
        if ends.into_iter().all(|(end, edge)| self.beyond_territory_of_edge(end, edge)) {
            return false;
        }
        [a.p, a.q].into_iter().any(|end_a| [b.p, b.q].into_iter().any(|end_b| self.share_territory(end_a, end_b)))
            || [a.p, a.q].into_iter().any(|end| self.in_edge_territory((Side::A, end), (Side::B, edge_b)))
            || [b.p, b.q].into_iter().any(|end| self.in_edge_territory((Side::B, end), (Side::A, edge_a)))
    }
}
