//! Test 4 of SPEC section 4: crossing e-e.

use super::pair::{ContactWithPlane, EntrancePlane, Pair};
use super::predicate_answer::PredicateAnswer;
use super::vector::{cross, difference, dot, multiple, squared_length, sum};
use crate::rational::Rational;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, Entrance};

/// All e-e contacts of the pair.
pub(super) fn contacts<Q: Rational>(pair: &Pair<'_, Q>) -> Vec<ContactWithPlane<Q>> {
    let mut found = Vec::new();
    for a in pair.a.block.topology().edge_ids() {
        for b in pair.b.block.topology().edge_ids() {
            found.extend(contact(pair, a, b));
        }
    }
    found
}

fn contact<Q: Rational>(pair: &Pair<'_, Q>, a: EdgeId, b: EdgeId) -> Option<ContactWithPlane<Q>> {
    let crossing = pair.a.block.edge_is_convex(a)
        && pair.b.block.edge_is_convex(b)
        && !nearly_parallel(pair, a, b)
        && feet_inside(pair, a, b)
        && !an_end_belongs_elsewhere(pair, a, b);
    if !crossing {
        return None;
    }
    let contact = ContactWithPlane { key: ContactKey::EdgeEdge(a, b), plane: plane(pair, a, b) };
    let passes = pair.not_too_deep(Predicate::EdgeEdgeDepth, &edges(a, b), &contact)
        && pair.decide(Predicate::EdgeEdgeNear, &edges(a, b), contact.plane.near(&pair.limits))
        && wedges_pass(pair, (a, b), &contact.plane);
    passes.then_some(contact)
}

/// `|d1 × d2|² ≤ sp²·|d1|²·|d2|²` and, under `revised`, `|d1 × d2|² ≤ r²·max(|d1|², |d2|²)` as well.
/// **A tie says yes.**
pub(super) fn nearly_parallel<Q: Rational>(pair: &Pair<'_, Q>, a: EdgeId, b: EdgeId) -> bool {
    let (d1, d2) = (&pair.a.edges[a.index()], &pair.b.edges[b.index()]);
    let area_squared = squared_length(&cross(&d1.direction, &d2.direction));
    let limits = &pair.limits;
    let by_angle = limits.parallel_squared.times(&d1.length_squared).times(&d2.length_squared);
    let mut verdict = PredicateAnswer::at_most(&area_squared, &by_angle);
    if !pair.is_classic() {
        let longer_squared = (&d1.length_squared).max(&d2.length_squared);
        let by_length = limits.territory_squared.times(longer_squared);
        verdict = verdict.and(|| PredicateAnswer::at_most(&area_squared, &by_length));
    }
    pair.decide(Predicate::NearlyParallel, &edges(a, b), verdict)
}

/// The plane of two edges that are not parallel: `n = σ·(d1 × d2)`, σ the sign of
/// `n·(m_L + m_R)_A − n·(m_L + m_R)_B` (**zero counts as +**); `h = n·(p_A − p_B)/|n|`, 0 for `n = 0`.
pub(super) fn plane<Q: Rational>(pair: &Pair<'_, Q>, a: EdgeId, b: EdgeId) -> EntrancePlane<Q> {
    let (d1, d2) = (&pair.a.edges[a.index()], &pair.b.edges[b.index()]);
    let product = cross(&d1.direction, &d2.direction);
    let inward_a = dot(&product, &sum(&d1.inward[0], &d1.inward[1]));
    let inward_b = dot(&product, &sum(&d2.inward[0], &d2.inward[1]));
    let side = inward_a.minus(&inward_b).sign();
    let sigma = Q::from_integer(if side.is_negative() { -1 } else { 1 });
    let normal = multiple(&sigma, &product);
    let from_b_to_a = difference(pair.vertex(Side::A, pair.a.edge(a).p), pair.vertex(Side::B, pair.b.edge(b).p));
    let gap_signed_square =
        dot(&normal, &from_b_to_a).signed_square().over(&squared_length(&normal)).unwrap_or_else(Q::zero);
    let entrance = Entrance::EdgeEdge(a, b);
    EntrancePlane { entrance, normal, gap_signed_square, unsided: side.is_zero() }
}

/// **Wedges pass**: `n·m ≥ 0` for A's two inward directions and `n·m ≤ 0` for B's two, each within the tolerance where
/// `(n·m)² ≤ so²·|n|²·|m|²` and, under `revised`, `(n·m)²·w² ≤ g²·|n|²·|m|²` as well. **A tie says yes.**
pub(super) fn wedges_pass<Q: Rational>(pair: &Pair<'_, Q>, (a, b): (EdgeId, EdgeId), plane: &EntrancePlane<Q>) -> bool {
    let limits = &pair.limits;
    let verdict = every_wing(pair, (a, b), plane, |wing| {
        let by_angle = || {
            let limit = limits.overlap_squared.times(&wing.lengths_squared);
            PredicateAnswer::at_most(&wing.rise.squared(), &limit)
        };
        let by_length = || wing.dips_at_most(&limits.penetration_squared);
        if pair.is_classic() { by_angle() } else { by_angle().and(by_length) }
    });
    pair.decide(Predicate::WedgesPass, &edges(a, b), verdict)
}

/// The plane of two edges is a **true exit** under `revised`: `n·m ≥ 0` for A's two inward directions and `n·m ≤ 0` for
/// B's two, or `(n·m)²·w² ≤ (r/10)²·|n|²·|m|²`. **A tie says yes.**
pub(super) fn is_true_exit<Q: Rational>(
    pair: &Pair<'_, Q>,
    both: (EdgeId, EdgeId),
    plane: &EntrancePlane<Q>,
) -> PredicateAnswer {
    every_wing(pair, both, plane, |wing| wing.dips_at_most(&pair.limits.exit_squared))
}

/// One of the four faces at two edges, along their normal n.
struct WedgeFace<'a, Q> {
    /// `n·m`, for B's faces `−n·m`: negative where the face dips.
    rise: Q,
    /// `|n|²·|m|²`
    lengths_squared: Q,
    /// `w²`
    width_squared: &'a Q,
}

impl<Q: Rational> WedgeFace<'_, Q> {
    /// `(n·m)²·w² ≤ limit²·|n|²·|m|²`: the face's far end is within the limit of the plane. **A tie says yes.**
    fn dips_at_most(&self, limit_squared: &Q) -> PredicateAnswer {
        let dip = self.rise.squared().times(self.width_squared);
        PredicateAnswer::at_most(&dip, &limit_squared.times(&self.lengths_squared))
    }
}

/// All four faces at two edges rise along n (**a tie says yes**) or are tolerated.
fn every_wing<Q: Rational>(
    pair: &Pair<'_, Q>,
    (a, b): (EdgeId, EdgeId),
    plane: &EntrancePlane<Q>,
    tolerated: impl Fn(&WedgeFace<'_, Q>) -> PredicateAnswer,
) -> PredicateAnswer {
    let n = &plane.normal;
    let mut all = PredicateAnswer { yes: true, tie: plane.unsided };
    for (line, along_n) in [(&pair.a.edges[a.index()], 1), (&pair.b.edges[b.index()], -1)] {
        for (inward, width_squared) in line.inward.iter().zip(&line.width_squared) {
            let rise = dot(n, inward).times(&Q::from_integer(along_n));
            let lengths_squared = squared_length(n).times(&squared_length(inward));
            let wing = WedgeFace { rise, lengths_squared, width_squared };
            all = all.and(|| PredicateAnswer::at_least_zero(&wing.rise).or(|| tolerated(&wing)));
        }
    }
    all
}

/// The feet of the common perpendicular lie strictly inside both edges. **A tie says no.**
///
/// With `w = p_B − p_A` and `c = d1 × d2` they are at `t = (w × d2)·c / |c|²` along d1 and `u = (w × d1)·c / |c|²`
/// along d2; `0 < t, u < 1` is asked without the division.
fn feet_inside<Q: Rational>(pair: &Pair<'_, Q>, a: EdgeId, b: EdgeId) -> bool {
    let (d1, d2) = (&pair.a.edges[a.index()].direction, &pair.b.edges[b.index()].direction);
    let c = cross(d1, d2);
    let whole = squared_length(&c);
    let w = difference(pair.vertex(Side::B, pair.b.edge(b).p), pair.vertex(Side::A, pair.a.edge(a).p));
    let inside = |part: Q| PredicateAnswer::above_zero(&part).and(|| PredicateAnswer::above_zero(&whole.minus(&part)));
    let verdict = inside(dot(&cross(&w, d2), &c)).and(|| inside(dot(&cross(&w, d1), &c)));
    pair.decide(Predicate::FeetInside, &edges(a, b), verdict)
}

/// One of the four endpoints lies in the territory of the other edge or of one of its endpoints.
fn an_end_belongs_elsewhere<Q: Rational>(pair: &Pair<'_, Q>, a: EdgeId, b: EdgeId) -> bool {
    let (ends_a, ends_b) = (pair.a.edge(a), pair.b.edge(b));
    let at_an_end = [ends_a.p, ends_a.q]
        .into_iter()
        .any(|end_a| [ends_b.p, ends_b.q].into_iter().any(|end_b| pair.in_vertex_territory(end_a, end_b)));
    at_an_end
        || [ends_a.p, ends_a.q].into_iter().any(|end| pair.in_edge_territory(Side::A, end, b))
        || [ends_b.p, ends_b.q].into_iter().any(|end| pair.in_edge_territory(Side::B, end, a))
}

fn edges(a: EdgeId, b: EdgeId) -> [Feature; 2] {
    [Feature::Edge(Side::A, a), Feature::Edge(Side::B, b)]
}
