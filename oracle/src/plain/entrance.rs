//! The entrance of v-v and v-e: of the candidate planes that are true exits, or of all if none is, the one with the
//! largest gap (SPEC section 4, "Entrance").

use super::edge_edge;
use super::pair::{ContactWithPlane, EntrancePlane, Pair};
use super::predicate_answer::PredicateAnswer;
use super::vertex_face;
use crate::rational::Rational;
use rockproof_model::decision::{Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, Entrance, FaceId, VertexId};

/// The candidates of one contact that pass the no-overlap check.
pub(super) struct Candidates<'p, 'a, Q> {
    pair: &'p Pair<'a, Q>,
    planes: Vec<EntrancePlane<Q>>,
}

impl<'p, 'a, Q: Rational> Candidates<'p, 'a, Q> {
    pub(super) fn new(pair: &'p Pair<'a, Q>) -> Self {
        Candidates { pair, planes: Vec::new() }
    }

    /// A vertex of `side` and a face of the other block, if the cone passes the plane.
    pub(super) fn vertex_face(&mut self, side: Side, vertex: VertexId, face: FaceId) {
        if vertex_face::cone_passes(self.pair, side, vertex, face) {
            self.planes.push(vertex_face::plane(self.pair, side, vertex, face));
        }
    }

    /// Two convex edges (those at convex vertices are, and those that v-e is about), if they are not nearly parallel and the
    /// wedges pass.
    pub(super) fn edge_edge(&mut self, a: EdgeId, b: EdgeId) {
        if !edge_edge::nearly_parallel(self.pair, a, b) {
            let plane = edge_edge::plane(self.pair, a, b);
            if edge_edge::wedges_pass(self.pair, (a, b), &plane) {
                self.planes.push(plane);
            }
        }
    }

    /// The contact of these two features, if a candidate passes and the chosen one is not too deep.
    pub(super) fn confirm(self, key: ContactKey) -> Option<ContactWithPlane<Q>> {
        let pair = self.pair;
        let (planes, chosen) = self.choose()?;
        let contact = ContactWithPlane { key, plane: planes[chosen.index].clone() };
        let features = key.features();
        for (index, (plane, tie)) in planes.iter().zip(chosen.ties).enumerate() {
            let verdict = PredicateAnswer { yes: index == chosen.index, tie };
            let [of_a, of_b] = plane.entrance.features();
            pair.decide(Predicate::EntranceChoice, &[features[0], features[1], of_a, of_b], verdict);
        }
        pair.not_too_deep(Predicate::EntranceDepth, &features, &contact).then_some(contact)
    }

    /// The candidates to choose from, in order, and which of them is chosen; `None` when there is none.
    fn choose(self) -> Option<(Vec<EntrancePlane<Q>>, Choice)> {
        let mut planes = self.planes;
        planes.sort_by_key(|plane| plane.entrance);
        // Asked only where there is a choice.
        if planes.len() > 1 {
            let mut preferred = true_exits_or_all(self.pair, &planes).into_iter();
            planes.retain(|_| preferred.next() == Some(true));
        }
        let chosen = first_of_the_largest(&planes, &self.pair.limits.equal)?;
        Some((planes, chosen))
    }
}

/// For each of several planes, whether it is a true exit; if none is, all count. Under `classic` every plane that passes
/// is one, and nothing is asked.
pub(super) fn true_exits_or_all<Q: Rational>(pair: &Pair<'_, Q>, planes: &[EntrancePlane<Q>]) -> Vec<bool> {
    if pair.is_classic() {
        return vec![true; planes.len()];
    }
    let mut exits: Vec<bool> = planes.iter().map(|plane| is_true_exit(pair, plane)).collect();
    if !exits.contains(&true) {
        exits.fill(true);
    }
    exits
}

fn is_true_exit<Q: Rational>(pair: &Pair<'_, Q>, plane: &EntrancePlane<Q>) -> bool {
    let verdict = match plane.entrance {
        Entrance::VertexFace(vertex, face) => vertex_face::is_true_exit(pair, Side::A, vertex, face),
        Entrance::FaceVertex(face, vertex) => vertex_face::is_true_exit(pair, Side::B, vertex, face),
        Entrance::EdgeEdge(a, b) => edge_edge::is_true_exit(pair, (a, b), plane),
    };
    pair.decide(Predicate::TrueExit, &plane.entrance.features(), verdict)
}

/// Which of several planes is chosen, and how firmly.
pub(super) struct Choice {
    /// Position of the chosen plane.
    pub(super) index: usize,
    /// For each plane, whether it is the largest or chosen only by an exact tie.
    pub(super) ties: Vec<bool>,
}

impl Choice {
    /// Whether any of the comparisons that led to the choice was an exact tie.
    pub(super) fn is_tied(&self) -> bool {
        self.ties.contains(&true)
    }
}

/// The first of the planes whose gap equals the largest one by Eq. (1): `h_k ≥ h_best − ε·|h_best|`.
///
/// Compared by signed squares: `h_best − ε·|h_best| = f·h_best` with `f = 1 ∓ ε` for a positive (negative) gap, so the
/// test is `h_k·|h_k| ≥ f·|f|·h_best·|h_best|`. The tie flag of a plane says that this held with equality for it, or, for
/// the largest, for any other one.
pub(super) fn first_of_the_largest<Q: Rational>(planes: &[EntrancePlane<Q>], equal: &Q) -> Option<Choice> {
    let gap = |k: usize| &planes[k].gap_signed_square;
    let best = (0..planes.len()).reduce(|best, k| if gap(k) > gap(best) { k } else { best })?;
    let one = Q::from_integer(1);
    let factor = if gap(best).sign().is_positive() { one.minus(equal) } else { one.plus(equal) };
    let threshold = factor.signed_square().times(gap(best));
    let reaches: Vec<PredicateAnswer> =
        (0..planes.len()).map(|k| PredicateAnswer::at_least(gap(k), &threshold)).collect();
    let index = (0..planes.len()).find(|&k| k == best || reaches[k].yes)?;
    let mut ties: Vec<bool> = reaches.iter().map(|r| r.tie).collect();
    ties[best] = (0..planes.len()).any(|k| k != best && reaches[k].tie);
    for (tie, plane) in ties.iter_mut().zip(planes) {
        *tie |= plane.unsided;
    }
    Some(Choice { index, ties })
}
