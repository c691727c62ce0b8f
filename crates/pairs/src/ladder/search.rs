//! Finding the decision that a tolerance settles, and the square of the value at which it does.

use super::LadderPair;
use super::dip::{DipMeasure, cone, wedges};
use super::exact_root;
use super::exits::{one_exit, true_exit};
use crate::directed::edges::across;
use crate::directed::exact::{ExactPlacement, at_most, fraction};
use crate::directed::f64_view::{F64Vector, cross, length, minus};
use crate::directed::faces::Corner;
use crate::directed::vertices::DRAWS;
use crate::directed::{DirectedPair, side};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Criteria, EdgeId, FaceId, VertexId};

/// A decision, the square of the critical value (m², or dimensionless), and how far B is to be moved first (m).
pub(super) type CriticalDecision = Option<(Decision, BigRational, F64Vector)>;

/// No move.
pub(super) const NO_MOVE: F64Vector = [0.0; 3];

/// λ = 1/4, less a thousandth: what is measured against it is in f64.
const QUARTER: f64 = 0.25 * 0.999;

/// A decision that the tolerance settles, of the kind asked for.
pub(super) fn found(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>) -> CriticalDecision {
    let LadderPair { directed: pair, tolerance, kind, .. } = ladder;
    let revised = pair.set.criteria == Criteria::Revised;
    match *tolerance {
        "search" => match kind % 4 {
            0 => to_vertex(sampler, pair, Predicate::VertexVertexNear),
            1 => to_edge(sampler, pair, Predicate::VertexEdgeNear),
            2 => face_gap(sampler, pair, Predicate::VertexFaceNear),
            _ => edge_gap(sampler, pair, Predicate::EdgeEdgeNear),
        },
        // Under `classic` every territory is the search distance.
        "territory" if revised => match kind % 6 {
            0 | 1 => nearly_parallel(sampler, ladder, true),
            2 | 3 => true_exit(sampler, ladder),
            4 => to_vertex(sampler, pair, Predicate::VertexTerritory),
            _ => to_edge(sampler, pair, Predicate::EdgeTerritory),
        },
        "penetration" => match kind % 6 {
            4 => entrance_depth(sampler, pair),
            0 | 5 if revised => cone(sampler, ladder, DipMeasure::Length),
            1 if revised => wedges(sampler, ladder, DipMeasure::Length),
            0 | 1 | 2 | 5 => face_gap(sampler, pair, Predicate::VertexFaceDepth),
            _ => edge_gap(sampler, pair, Predicate::EdgeEdgeDepth),
        },
        "overlap_sine" => match kind % 4 {
            0 | 3 => one_exit(sampler, pair),
            1 => wedges(sampler, ladder, DipMeasure::Angle),
            _ => cone(sampler, ladder, DipMeasure::Angle),
        },
        "parallel_sine" => nearly_parallel(sampler, ladder, false),
        // Most gaps have an irrational ratio.
        "equal" => (0..DRAWS).find_map(|_| equal(sampler, ladder)),
        _ => None,
    }
}

fn to_vertex(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> CriticalDecision {
    let (va, vb) = pair.f64_view.vertex_vertex(sampler)?;
    let distance = length(minus(pair.f64_view.vertex(Side::A, va), pair.f64_view.vertex(Side::B, vb)));
    let limit = quarter_edge(pair, Side::A, va).min(quarter_edge(pair, Side::B, vb));
    if predicate == Predicate::VertexTerritory && distance >= limit {
        return None;
    }
    let exact = pair.exact(&[(Side::A, va), (Side::B, vb)], NO_MOVE);
    let apart = exact.vertex(Side::A, va).minus(exact.vertex(Side::B, vb));
    let decision = Decision::about(predicate, &[Feature::Vertex(Side::A, va), Feature::Vertex(Side::B, vb)]);
    Some((decision, exact.square_metres(&apart.norm_squared(), &BigInt::one()), NO_MOVE))
}

/// λ times the shortest edge at a vertex, a little less to be sure.
fn quarter_edge(pair: &DirectedPair<'_>, side: Side, vertex: VertexId) -> f64 {
    let edges = pair.f64_view.block(side).topology().vertex_edges(vertex).iter();
    edges.map(|&e| length(pair.f64_view.edge(side, e).1)).fold(f64::INFINITY, f64::min) * QUARTER
}

fn to_edge(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> CriticalDecision {
    let asked = side(sampler);
    let other = asked.other();
    let (v, e) = pair.f64_view.vertex_edge(sampler, asked)?;
    let (along, distance) = pair.f64_view.foot(asked, v, e);
    let too_far = predicate == Predicate::EdgeTerritory && distance >= quarter_width(pair, other, e);
    if !(0.0..1.0).contains(&along) || too_far {
        return None;
    }
    let exact = pair.exact(&pair.faces_at_edge(other, e).chain([(asked, v)]).collect::<Vec<_>>(), NO_MOVE);
    let d = exact.direction(other, e);
    let x = exact.vertex(asked, v).minus(exact.vertex(other, exact.edge(other, e).p));
    let decision = Decision::about(predicate, &[Feature::Vertex(asked, v), Feature::Edge(other, e)]);
    Some((decision, exact.square_metres(&x.cross(&d).norm_squared(), &d.norm_squared()), NO_MOVE))
}

/// λ times the smaller width of the faces at an edge, a little less to be sure.
fn quarter_width(pair: &DirectedPair<'_>, side: Side, edge: EdgeId) -> f64 {
    let e = pair.f64_view.block(side).topology().edge(edge);
    let (p, d) = pair.f64_view.edge(side, edge);
    let far = |(side, v): (Side, VertexId)| length(cross(minus(pair.f64_view.vertex(side, v), p), d)) / length(d);
    let width = |face: FaceId| pair.corners(side, face).map(far).fold(0.0, f64::max);
    width(e.left).min(width(e.right)) * QUARTER
}

/// A gap (for `search`) or a depth (for `penetration`) of a vertex over a face.
fn face_gap(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> CriticalDecision {
    let asked = side(sampler);
    let (v, f) = pair.f64_view.vertex_face(sampler, asked);
    if pair.f64_view.above_face(asked, v, f).1 > 0.0 {
        return None;
    }
    let exact = pair.exact(&pair.corners(asked.other(), f).chain([(asked, v)]).collect::<Vec<_>>(), NO_MOVE);
    let (gap, square, k) = exact.gap(asked, v, f);
    let features = [Feature::Vertex(asked, v), Feature::Face(asked.other(), f)];
    depth_or_gap(&exact, Decision::about(predicate, &features), &gap.constant, square * &k * &k)
}

/// A gap or a depth of crossing edges.
fn edge_gap(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> CriticalDecision {
    let (ea, eb) = pair.f64_view.edge_edge(sampler)?;
    let (s, t, _) = pair.f64_view.feet(ea, eb)?;
    if !((0.0..1.0).contains(&s) && (0.0..1.0).contains(&t)) {
        return None;
    }
    let exact = both_edges(pair, (ea, eb), NO_MOVE);
    let n = exact.perpendicular(ea, eb);
    let gap = exact.along((Side::A, exact.edge(Side::A, ea).p), exact.edge(Side::B, eb).p, &n).constant;
    let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
    depth_or_gap(&exact, Decision::about(predicate, &features), &gap, n.norm_squared())
}

pub(super) fn both_edges<'p>(
    pair: &DirectedPair<'p>,
    (ea, eb): (EdgeId, EdgeId),
    start: F64Vector,
) -> ExactPlacement<'p> {
    pair.exact(&pair.faces_at_edge(Side::A, ea).chain(pair.faces_at_edge(Side::B, eb)).collect::<Vec<_>>(), start)
}

/// The depth of a vertex below the way in, at a corner of the other block to whose territory it is brought.
fn entrance_depth(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> CriticalDecision {
    let (corner, (start, face)) = (0..DRAWS).find_map(|_| {
        let corner = Corner::choose(sampler, pair, 1)?;
        let place = corner.overlap(sampler, pair)?;
        Some((corner, place))
    })?;
    let vertices = pair.corners(corner.side.other(), face).chain([(corner.side, corner.vertex)]);
    let exact = pair.exact(&vertices.collect::<Vec<_>>(), start);
    let (gap, square, k) = exact.gap(corner.side, corner.vertex, face);
    let decision = Decision::about(Predicate::EntranceDepth, &corner.contact());
    let (decision, squared, _) = depth_or_gap(&exact, decision, &gap.constant, square * &k * &k)?;
    Some((decision, squared, start))
}

/// `gap²/square`, where the gap has the sign that the decision asks about.
fn depth_or_gap(exact: &ExactPlacement<'_>, decision: Decision, gap: &BigInt, square: BigInt) -> CriticalDecision {
    let deep =
        matches!(decision.predicate, Predicate::VertexFaceDepth | Predicate::EdgeEdgeDepth | Predicate::EntranceDepth);
    (!gap.is_zero() && deep == gap.is_negative())
        .then(|| (decision, exact.square_metres(&(gap * gap), &square), NO_MOVE))
}

/// The sine between two edges, or (`by_territory`) how far one drifts from the other over the longer's length. The
/// edges are brought across each other.
fn nearly_parallel(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>, by_territory: bool) -> CriticalDecision {
    let pair = &ladder.directed;
    let (ea, eb) = pair.f64_view.edge_edge(sampler)?;
    let start = across(sampler, pair, ea, eb)?;
    let squared = ladder.of_edges((ea, eb), || {
        let exact = both_edges(pair, (ea, eb), NO_MOVE);
        let (d1, d2) = (exact.direction(Side::A, ea), exact.direction(Side::B, eb));
        let (cross, l1, l2) = (d1.cross(&d2).norm_squared(), d1.norm_squared(), d2.norm_squared());
        let sine = (cross.clone(), &l1 * &l2);
        let drift = exact.in_square_metres(cross, l1.max(l2));
        // Under `revised` both must hold: one can only decide where the other says yes.
        let (decides, (numerator, denominator)) = match by_territory {
            true => (at_most(&sine, &pair.set.parallel_sine), drift),
            false => (pair.set.criteria == Criteria::Classic || at_most(&drift, &pair.set.territory), sine),
        };
        decides.then(|| fraction(numerator, denominator))
    })?;
    let features = [Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)];
    Some((Decision::about(Predicate::NearlyParallel, &features), BigRational::clone(&squared), start))
}

/// The relative difference of the gaps of a vertex above two faces of a corner of the other block, to which it is
/// brought.
fn equal(sampler: &mut PairSampler<'_>, ladder: &LadderPair<'_>) -> CriticalDecision {
    let pair = &ladder.directed;
    let corner = Corner::choose(sampler, pair, 2)?;
    let start = corner.visit(sampler, pair)?;
    let f = *sampler.pick(&corner.faces);
    let (asked, other) = (corner.side, corner.side.other());
    // The squares of two gaps have a rational ratio; the gaps have one where the areas of the faces do.
    if !corner.faces.iter().any(|&g| g != f && has_rational_area_ratio(ladder, other, [f, g])) {
        return None;
    }
    let vertices = corner.faces.iter().flat_map(|&f| pair.corners(other, f)).chain([(asked, corner.vertex)]);
    let exact = pair.exact(&vertices.collect::<Vec<_>>(), start);
    // Signed squares of the gaps order as the gaps do; a plane without area has the gap 0. None is in lowest terms.
    let gaps: Vec<(FaceId, BigInt, BigInt)> = corner
        .faces
        .iter()
        .map(|&f| {
            let (gap, square, k) = exact.gap(asked, corner.vertex, f);
            let over = square * &k * &k;
            let over = if over.is_zero() { BigInt::one() } else { over };
            (f, gap.constant.signum() * &gap.constant * &gap.constant, over)
        })
        .collect();
    let order = |g: &(FaceId, BigInt, BigInt), h: &(FaceId, BigInt, BigInt)| (&g.1 * &h.2).cmp(&(&h.1 * &g.2));
    let (best, largest, largest_over) = gaps.iter().max_by(|g, h| order(g, h).then(h.0.cmp(&g.0)))?;
    let (_, second, second_over) = gaps.iter().find(|(face, ..)| *face == f)?;
    if f == *best || largest.is_zero() || largest.is_positive() != second.is_positive() {
        return None;
    }
    // ε = |h_best − h|/|h_best| = |1 − √(h²/h_best²)|; rational where the ratio is a square: where numerator times denominator is one, in
    // whichever terms.
    let (numerator, denominator) = (second.abs() * largest_over, largest.abs() * second_over);
    let product = numerator * &denominator;
    let root = product.sqrt();
    if &root * &root != product {
        return None;
    }
    let share = BigRational::one() - BigRational::new(root, denominator);
    let [a, b] = corner.contact();
    let [c, d] = corner.candidate(f);
    Some((Decision::about(Predicate::EntranceChoice, &[a, b, c, d]), share.pow(2), start))
}

/// Whether the ratio of the areas of two faces is rational: where the product of their squares is a square.
fn has_rational_area_ratio(ladder: &LadderPair<'_>, side: Side, [f, g]: [FaceId; 2]) -> bool {
    ladder.area_ratios[side as usize].get(f.index(), g.index(), || {
        let pair = &ladder.directed;
        let exact = pair.exact(&pair.corners(side, f).chain(pair.corners(side, g)).collect::<Vec<_>>(), NO_MOVE);
        exact_root(&(exact.normal(side, f).norm_squared() * exact.normal(side, g).norm_squared())).is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{Block, BlockOptions, Number, ToleranceSet, Vec3};

    /// Of a corner of a cube three faces have the area 1/2, the fourth one of √3/2.
    #[test]
    fn areas_have_a_rational_ratio_where_neither_or_both_have_a_root() {
        let point = |c: [i32; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c));
        let points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(point).to_vec();
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|face| face.map(VertexId).to_vec()).to_vec();
        let corner = Block::new(points, faces, &BlockOptions::default()).expect("a tetrahedron");
        let set = ToleranceSet::ZERO;
        let ladder = LadderPair::new((&corner, &corner), &set, ("equal", 0));
        for (f, g) in (0..4).flat_map(|f| (0..4).map(move |g| (f, g))) {
            let rational = has_rational_area_ratio(&ladder, Side::B, [f, g].map(FaceId));
            assert_eq!(rational, (f == 2) == (g == 2), "{f} {g}");
        }
    }
}
