//! The entrance of a contact: the plane with the largest gap among the true exits, or among all that pass if none is
//! (SPEC section 4, "Entrance").

use super::no_overlap::Passes;
use crate::classification::{Classification, Observer};
use crate::predicate::{
    AbovePlane, Edge, EdgesApart, Factor, GapWithin, LargerGap, LengthTolerance, Polynomial, Vertex,
};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, Entrance, FaceId, Sign};
use smallvec::SmallVec;

/// A plane through which the blocks may enter one another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) entrance: Entrance,
    /// What turns the stored normal from B to A: σ for e-e, − for f-v, + for v-f.
    pub(crate) turn: Sign,
    /// Sign of the gap.
    pub(crate) gap: Sign,
    /// Whether a feature may dip below the plane: `false` once the no-overlap check has shown that none does.
    pub(crate) may_dip: bool,
}

impl Candidate {
    /// The plane after its no-overlap check, if it passed.
    pub(crate) fn passing(self, passes: Passes) -> Option<Candidate> {
        (passes != Passes::No).then_some(Candidate { may_dip: passes == Passes::Dipping, ..self })
    }
}

/// Which entrances of a v-v or v-e contact may pass their no-overlap checks: asked of one after the other, in the order of SPEC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Planes {
    /// A bit each; the last one stands for all others.
    possible: u32,
}

impl Planes {
    /// Nothing is known.
    pub(crate) const ALL: Planes = Planes { possible: u32::MAX };

    /// What may pass, in order; `None` where nothing may.
    pub(crate) fn of(passing: impl Iterator<Item = bool>) -> Option<Planes> {
        let possible = passing.enumerate().fold(0, |all, (k, may)| all | u32::from(may) << k.min(31));
        (possible != 0).then_some(Planes { possible })
    }

    /// Whether the next one may pass.
    #[inline(always)]
    fn next(&mut self) -> bool {
        let may = self.possible & 1 == 1;
        // The last bit stays.
        self.possible = self.possible >> 1 | self.possible & 1 << 31;
        may
    }
}

/// Candidates in the order in which ties are broken.
pub(crate) type Candidates = SmallVec<[Candidate; 24]>;

impl<O: Observer> Classification<'_, '_, O> {
    /// The plane of a vertex and a face of the other block, with the sign of its gap.
    pub(crate) fn face_candidate(&mut self, vertex: Vertex, face: FaceId) -> Candidate {
        let (entrance, turn, face) = match vertex.0 {
            Side::A => (Entrance::VertexFace(vertex.1, face), Sign::Positive, (Side::B, face)),
            Side::B => (Entrance::FaceVertex(face, vertex.1), Sign::Negative, (Side::A, face)),
        };
        let gap = self.decide_sign(|| about_gap(&entrance), |run| run.sign(&AbovePlane { vertex, face }));
        Candidate { entrance, turn, gap, may_dip: true }
    }

    /// The plane of two edges, with the sign of its gap.
    pub(crate) fn edge_candidate(&mut self, edge_a: EdgeId, edge_b: EdgeId, sigma: Sign) -> Candidate {
        let entrance = Entrance::EdgeEdge(edge_a, edge_b);
        let gap =
            self.decide_sign(|| about_gap(&entrance), |run| run.sign(&EdgesApart { edge_a, edge_b }).times(sigma));
        Candidate { entrance, turn: sigma, gap, may_dip: true }
    }

    /// Adds the planes of a vertex and those of `faces` whose plane its cone passes.
    pub(crate) fn add_faces(
        &mut self,
        vertex: Vertex,
        faces: &[FaceId],
        planes: &mut Planes,
        candidates: &mut Candidates,
    ) {
        for &face in faces {
            if !planes.next() {
                continue;
            }
            let passes = self.cone_passes(vertex, (vertex.0.other(), face));
            if passes != Passes::No {
                candidates.extend(self.face_candidate(vertex, face).passing(passes));
            }
        }
    }

    /// Adds the planes of crossing edges whose wedges pass. Convex edges all: those at convex vertices, and those that v-e is about.
    pub(crate) fn add_edges(
        &mut self,
        edges_a: &[EdgeId],
        edges_b: &[EdgeId],
        planes: &mut Planes,
        candidates: &mut Candidates,
    ) {
        for &edge_a in edges_a.iter() {
            for &edge_b in edges_b {
                if !planes.next() || self.nearly_parallel(edge_a, edge_b) {
                    continue;
                }
                let sigma = self.orientation(edge_a, edge_b);
                let passes = self.wedges_pass(edge_a, edge_b, sigma);
                if passes != Passes::No {
                    candidates.extend(self.edge_candidate(edge_a, edge_b, sigma).passing(passes));
                }
            }
        }
    }

    /// Leaves the true exits among several planes, or all if none is one.
    pub(crate) fn prefer_true_exits(&mut self, candidates: &mut Candidates) {
        if self.classic || (!O::is_active() && candidates.iter().all(|c| !c.may_dip)) {
            return;
        }
        let exits: SmallVec<[bool; 24]> = candidates.iter().map(|candidate| self.is_true_exit(candidate)).collect();
        if exits.contains(&true) {
            let mut exits = exits.into_iter();
            candidates.retain(|_| exits.next() == Some(true));
        }
    }

    /// Of the true exits, or of all candidates if none is one, that with the largest gap; of those equal to it by Eq. (1),
    /// the first. `None` without candidates. A single candidate is not asked whether it is a true exit.
    pub(crate) fn choose(&mut self, of: [Feature; 2], mut candidates: Candidates) -> Option<Candidate> {
        if candidates.len() > 1 {
            self.prefer_true_exits(&mut candidates);
        }
        self.largest_or_equal(of, &candidates)
    }

    fn largest_or_equal(&mut self, of: [Feature; 2], candidates: &[Candidate]) -> Option<Candidate> {
        if O::is_active() && self.observer.takes_smallest_gap() {
            return self.smallest_gap(candidates);
        }
        if !O::is_active() {
            return self.first_equal_to_largest(candidates).map(|chosen| candidates[chosen]);
        }
        let best = self.largest_gap(candidates)?;
        let mut chosen = None;
        for (k, candidate) in candidates.iter().enumerate() {
            let about = || {
                let [a, b] = candidate.entrance.features();
                Decision::about(Predicate::EntranceChoice, &[of[0], of[1], a, b])
            };
            let ties = self.decide(about, |run| {
                // Those behind the best one cannot win; they are compared only for the record.
                let ties = k == best || run.equals_best(candidate, &candidates[best]);
                ties && k <= best && chosen.is_none()
            });
            if ties {
                chosen = Some(*candidate);
            }
        }
        chosen
    }

    /// Index of the first gap that equals the largest by Eq. (1), without asking which is the largest: among nearly equal gaps that takes
    /// long numbers, and Eq. (1) mostly does not.
    pub(crate) fn first_equal_to_largest(&mut self, candidates: &[Candidate]) -> Option<usize> {
        if self.one_minus_equal().is_negative() {
            let best = self.largest_gap(candidates)?;
            return Some(self.first_equal_to(best, candidates));
        }
        let equals = |one: usize, other: usize| self.equals_best(&candidates[one], &candidates[other]);
        (!candidates.is_empty()).then(|| first_equal_to_all(candidates.len(), equals))
    }

    /// Index of the first gap that equals the largest by Eq. (1), where the first of the largest is known.
    pub(crate) fn first_equal_to(&mut self, best: usize, candidates: &[Candidate]) -> usize {
        (0..best).find(|&k| self.equals_best(&candidates[k], &candidates[best])).unwrap_or(best)
    }

    /// Index of the largest gap; of exactly equal ones the first.
    pub(crate) fn largest_gap(&mut self, candidates: &[Candidate]) -> Option<usize> {
        let mut best = 0;
        for k in 1..candidates.len() {
            if self.compare_gaps(&candidates[k], &candidates[best], Factor::One).is_positive() {
                best = k;
            }
        }
        (!candidates.is_empty()).then_some(best)
    }

    /// The candidate with the smallest gap; of exactly equal ones the first.
    fn smallest_gap(&mut self, candidates: &[Candidate]) -> Option<Candidate> {
        let mut best = *candidates.first()?;
        for candidate in &candidates[1..] {
            if self.compare_gaps(candidate, &best, Factor::One).is_negative() {
                best = *candidate;
            }
        }
        Some(best)
    }

    /// Eq. (1): `h_k ≥ h_best − ε·|h_best|`; **a tie says yes**.
    pub(crate) fn equals_best(&mut self, candidate: &Candidate, best: &Candidate) -> bool {
        let factor = if best.gap.is_negative() { Factor::OnePlusEqual } else { Factor::OneMinusEqual };
        self.compare_gaps(candidate, best, factor).is_at_least_zero()
    }

    /// Sign of `h₁ − f·h₂`.
    fn compare_gaps(&mut self, first: &Candidate, second: &Candidate, factor: Factor) -> Sign {
        let factor_sign = match factor {
            Factor::OneMinusEqual => self.one_minus_equal(),
            Factor::One | Factor::OnePlusEqual => Sign::Positive,
        };
        let second_sign = second.gap.times(factor_sign);
        if first.gap != second_sign {
            return Sign::of_ordering(first.gap.cmp(&second_sign));
        }
        // One plane beside itself: equal, and never below `f` times itself, whatever Eq. (1)'s f.
        if first.gap.is_zero() || first.entrance == second.entrance {
            return Sign::Zero;
        }
        let larger = LargerGap { first: first.entrance, second: second.entrance, factor };
        let value = larger.value(&self.float_view()).0;
        // One plane that two pairs of features span, likewise; that takes fewer digits than the sign.
        if !O::is_active() && factor != Factor::One {
            let known = value.abs() > self.bound_of::<LargerGap>(larger.variant());
            if !known && self.cascade.share_plane(&first.entrance, &second.entrance) {
                return Sign::Zero;
            }
        }
        self.sign_of_value(&larger, value).times(first.gap)
    }

    fn one_minus_equal(&self) -> Sign {
        Sign::of_ordering(rockproof_model::Number::from_integer(1).cmp(&self.tolerances.equal))
    }

    /// `h ≤ limit`; **a tie says yes**.
    pub(crate) fn gap_at_most(&mut self, candidate: &Candidate, limit: LengthTolerance) -> bool {
        !candidate.gap.is_positive() || self.sign(&GapWithin { entrance: candidate.entrance, limit }).is_at_least_zero()
    }

    /// `h ≥ −g`; **a tie says yes**.
    fn gap_not_deeper(&mut self, candidate: &Candidate) -> bool {
        !candidate.gap.is_negative()
            || self
                .sign(&GapWithin { entrance: candidate.entrance, limit: LengthTolerance::Penetration })
                .is_at_least_zero()
    }

    /// Whether a contact is not too deep: it is kept, and then nothing is asked, or its plane has `h ≥ −g`; **a tie says
    /// yes**.
    pub(crate) fn not_too_deep(
        &mut self,
        contact: ContactKey,
        plane: &Candidate,
        decision: impl Fn() -> Decision,
    ) -> bool {
        self.is_kept(contact) || self.decide(decision, |run| run.gap_not_deeper(plane))
    }
}

/// The first of several gaps that is at least `g(h) = h − ε·|h|` of every one, the largest that is: where ε is from 0 to 1, g grows with h and
/// is never above it. `equals` says it of one gap and the g of another.
fn first_equal_to_all(count: usize, mut equals: impl FnMut(usize, usize) -> bool) -> usize {
    // Equal to all before `next`; each before it is below g of one of these.
    let mut first = 0;
    for next in 1..count {
        if !equals(first, next) {
            // What is not below g of this one is larger than the former first, and so equal to all that that one was equal to.
            first = (first + 1..next).find(|&k| equals(k, next)).unwrap_or(next);
        }
    }
    first
}

fn about_gap(entrance: &Entrance) -> Decision {
    Decision::about(Predicate::GapSign, &entrance.features())
}

/// An edge's two faces, ascending: the order in which candidates are tried.
pub(crate) fn faces_of<O: Observer>(run: &Classification<'_, '_, O>, edge: Edge) -> [FaceId; 2] {
    let ends = *run.pair.topology(edge.0).edge(edge.1);
    [ends.left.min(ends.right), ends.left.max(ends.right)]
}

#[cfg(test)]
mod tests {
    use super::first_equal_to_all;

    /// For every row of up to five gaps, many of them equal by Eq. (1), some to one another's neighbours but not to one another.
    #[test]
    fn the_first_that_equals_all_is_the_first_that_equals_the_largest() {
        let (mut rows, mut between) = (0, 0);
        for halves in [0, 1, 2] {
            // 2·h_k ≥ 2·h − 2ε·|h|.
            let equals = |one: i32, other: i32| 2 * one >= 2 * other - halves * other.abs();
            for count in 1..=5u32 {
                for number in 0..9i32.pow(count) {
                    let gaps: Vec<i32> = (0..count).map(|k| number / 9i32.pow(k) % 9 - 4).collect();
                    let largest = gaps.iter().copied().max().expect("a gap");
                    let expected = gaps.iter().position(|&gap| equals(gap, largest));
                    let found = first_equal_to_all(gaps.len(), |one, other| equals(gaps[one], gaps[other]));
                    assert_eq!(Some(found), expected, "{gaps:?}, ε = {halves}/2");
                    rows += 1;
                    between += u32::from(found > 0 && gaps[found] < largest);
                }
            }
        }
        assert!(rows > 100_000 && between > 1_000, "{rows} rows, in {between} neither the first nor the largest");
    }
}
