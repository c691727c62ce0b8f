//! Aims at decisions about vertices near edges, and about crossing edges.

use super::exact::{AffineMargin, ExactPlacement, IntVector, IntegerRoot};
use super::f64_view::{F64Vector, cross, dot, length, minus, plus, times, unit};
use super::vertices::around;
use super::{Aim, DirectedPair, about, linear, side};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_traits::Zero;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{Criteria, EdgeId, FaceId, Vec3, VertexId};

/// A near vertex and edge, with the vertex's side.
fn near(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<(Side, VertexId, EdgeId)> {
    let asked = side(sampler);
    let (vertex, edge) = pair.f64_view.vertex_edge(sampler, asked)?;
    Some((asked, vertex, edge))
}

/// The lattice of the edge's faces and of the edges at the vertex.
fn exact_of<'p>(
    pair: &DirectedPair<'p>,
    (asked, vertex, edge): (Side, VertexId, EdgeId),
    start: F64Vector,
) -> ExactPlacement<'p> {
    let vertices: Vec<_> =
        pair.faces_at_edge(asked.other(), edge).chain([(asked, vertex)]).chain(around(pair, asked, vertex)).collect();
    pair.exact(&vertices, start)
}

/// A point of the edge some sixteenths along it.
fn on_edge(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, side: Side, edge: EdgeId) -> F64Vector {
    let (p, d) = pair.f64_view.edge(side, edge);
    plus(p, times(d, sampler.between(3, 13) as f64 / 16.0))
}

/// The foot of a vertex exactly at an end of an edge.
pub(super) fn foot_inside(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let (asked, vertex, edge) = near(sampler, pair)?;
    let other = asked.other();
    let (_, distance) = pair.f64_view.foot(asked, vertex, edge);
    let start = if distance <= pair.search() {
        [0.0; 3]
    } else {
        let target = plus(on_edge(sampler, pair, other, edge), pair.jitter(sampler, pair.search() / 2.0));
        pair.offset_to((asked, vertex), target)
    };
    let exact = exact_of(pair, (asked, vertex, edge), start);
    let d = exact.direction(other, edge);
    let from_p = exact.along((asked, vertex), exact.edge(other, edge).p, &d);
    let margin = if sampler.chance(50) { from_p } else { from_p.negated().plus(&d.norm_squared()) };
    let features = [Feature::Vertex(asked, vertex), Feature::Edge(other, edge)];
    linear(sampler, &exact, about(Predicate::FootInside, &features), &margin)
}

/// How far from an edge a vertex is outside its territory and within the search distance; `None` if nowhere.
fn beyond_territory(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<f64> {
    let (low, high) = (pair.territory(), pair.search());
    (low < 0.9 * high).then(|| low + (high - low) * sampler.between(4, 60) as f64 / 64.0)
}

/// A vertex exactly on the boundary of an edge's region: in the direction of a face's normal from the edge.
pub(super) fn edge_region(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let (asked, vertex, edge) = near(sampler, pair)?;
    let other = asked.other();
    let e = pair.f64_view.block(other).topology().edge(edge);
    let face = if sampler.chance(50) { e.left } else { e.right };
    let away = times(pair.f64_view.normal(other, face), beyond_territory(sampler, pair)?);
    let target = plus(on_edge(sampler, pair, other, edge), away);
    let exact = exact_of(pair, (asked, vertex, edge), pair.offset_to((asked, vertex), target));
    let m = exact.inward(other, edge, face);
    let margin = exact.along((asked, vertex), e.p, &m).negated();
    let features = [Feature::Vertex(asked, vertex), Feature::Edge(other, edge), Feature::Face(other, face)];
    linear(sampler, &exact, about(Predicate::EdgeRegion, &features), &margin)
}

/// The foot of a vertex exactly on the boundary of the vertex's region with respect to one edge there, and in it with
/// respect to the others.
pub(super) fn foot_region(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let (asked, vertex, edge) = near(sampler, pair)?;
    let other = asked.other();
    let (_, d) = pair.f64_view.edge(other, edge);
    let e = pair.f64_view.block(other).topology().edge(edge);
    let arms: Vec<F64Vector> = around(pair, asked, vertex)
        .map(|(_, w)| minus(pair.f64_view.vertex(asked, w), pair.f64_view.vertex(asked, vertex)))
        .collect();
    // The way x from the foot to the vertex is square to the edge and to the arm; x·arm ≥ 0 for the other arms, and
    // x is between the two faces' outward normals.
    let inward = |face: FaceId, d: F64Vector| cross(pair.f64_view.normal(other, face), d);
    let (left, right) = (inward(e.left, d), inward(e.right, times(d, -1.0)));
    let first = sampler.below(arms.len() as u64) as usize;
    let (k, x) = (0..2 * arms.len()).find_map(|i| {
        let k = (first + i / 2) % arms.len();
        let x = times(unit(cross(d, arms[k])), if i % 2 == 0 { 1.0 } else { -1.0 });
        let in_regions = dot(x, left) <= 0.0
            && dot(x, right) <= 0.0
            && arms.iter().enumerate().all(|(j, arm)| j == k || dot(x, *arm) >= 0.0);
        (in_regions && length(x) > 0.5).then_some((k, x))
    })?;
    let target = plus(on_edge(sampler, pair, other, edge), times(x, beyond_territory(sampler, pair)?));
    let exact = exact_of(pair, (asked, vertex, edge), pair.offset_to((asked, vertex), target));
    let at = pair.f64_view.block(asked).topology().vertex_edges(vertex)[k];
    let end = exact.edge(asked, at).other(vertex);
    let away = exact.vertex(asked, end).minus(exact.vertex(asked, vertex));
    let d = exact.direction(other, edge);
    // f − a = −(x − (x·d)d/d²) with x = a − p, so (f − a)·e = x·(d(d·e) − e d²)/d².
    let w = d.scaled(&d.dot(&away)).minus(&away.scaled(&d.norm_squared()));
    let margin = exact.along((asked, vertex), e.p, &w).negated();
    let features = [Feature::Vertex(asked, vertex), Feature::Edge(other, edge), Feature::Edge(asked, at)];
    linear(sampler, &exact, about(Predicate::FootRegion, &features), &margin)
}

/// A vertex exactly the search distance or the territory radius from an edge's line.
pub(super) fn distance(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> Option<Aim> {
    let (asked, vertex, edge) = near(sampler, pair)?;
    let exact = exact_of(pair, (asked, vertex, edge), [0.0; 3]);
    let d = exact.direction(asked.other(), edge);
    let territory = predicate == Predicate::EdgeTerritory && pair.set.criteria == Criteria::Revised;
    let radius = if territory { &exact.territory } else { &exact.search };
    let arm = if territory { shorter_arm(&exact, asked.other(), edge, &d, radius) } else { None };
    if territory && radius.is_zero() {
        return None;
    }
    let (u, over, rational) = match arm {
        // A quarter of the shorter face's width is smaller than r: the arm itself, shortened.
        Some((arm, over)) => {
            let arm = if sampler.chance(50) { arm } else { arm.negated() };
            (arm, over * BigInt::from(LAMBDA_INVERSE), true)
        }
        None => {
            let (u, norm) = outward(sampler, &exact, asked.other(), edge)?;
            // L·u/|u|, with |u| = root / 2^shift.
            (u.scaled(&(radius << norm.shift)), norm.root.clone(), norm.is_exact())
        }
    };
    // x = a − p is to become (k/8)·d + u/over.
    let eighth = BigInt::from(sampler.between(1, 7));
    let target = d.scaled(&(&eighth * &over)).plus(&u.scaled(&BigInt::from(8)));
    let over = over * BigInt::from(8);
    let p = exact.edge(asked.other(), edge).p;
    let x = exact.vertex(asked, vertex).minus(exact.vertex(asked.other(), p)).scaled(&over);
    let way = target.minus(&x);
    let way = if asked == Side::B { way } else { way.negated() };
    let axis = (0..3).max_by_key(|&i| u.components()[i].magnitude().clone())?;
    let outward = u.components()[axis].sign() == num_bigint::Sign::Plus;
    if u.components()[axis].is_zero() {
        return None;
    }
    let decision = about(predicate, &[Feature::Vertex(asked, vertex), Feature::Edge(asked.other(), edge)]);
    Some(Aim {
        decision,
        root: exact.offset_by(&way, &over),
        exact: rational,
        axis,
        rising: outward != (asked == Side::B),
        reach: f64::INFINITY,
    })
}

/// A vector away from the edge, square to it, and its length: rational where one offers itself.
fn outward(
    sampler: &mut PairSampler<'_>,
    exact: &ExactPlacement<'_>,
    side: Side,
    edge: EdgeId,
) -> Option<(IntVector, IntegerRoot)> {
    let e = exact.edge(side, edge);
    let mut choices: Vec<(IntVector, IntegerRoot)> = Vec::new();
    for face in [e.left, e.right] {
        let n = exact.normal(side, face).clone();
        // A face that is not quite planar has a normal that is not quite square to the edge.
        let square = n.dot(&exact.direction(side, edge)).is_zero();
        for u in square.then_some(n).into_iter().chain([exact.inward(side, edge, face).negated()]) {
            let norm = IntegerRoot::of(&u.norm_squared());
            choices.push((u, norm));
        }
    }
    // A 3-4-5 mixture of a normal and the in-plane direction square to it, where both lengths are whole.
    if let [(n, n_norm), (m, m_norm), _, _] = &choices[..]
        && n_norm.is_exact()
        && m_norm.is_exact()
        && sampler.chance(50)
    {
        let u = n.scaled(&(&m_norm.root * 3)).plus(&m.scaled(&(&n_norm.root * 4)));
        choices.push((u, IntegerRoot { root: &n_norm.root * &m_norm.root * 5, shift: 0 }));
    }
    let whole: Vec<usize> = (0..choices.len()).filter(|&i| choices[i].1.is_exact()).collect();
    let i = if whole.is_empty() { sampler.below(choices.len() as u64) as usize } else { *sampler.pick(&whole) };
    choices.into_iter().nth(i)
}

/// The arm from the edge's line to the furthest vertex of the narrower of its faces, times `|d|²`, and that factor; if
/// a quarter of its length is below `radius`.
fn shorter_arm(
    exact: &ExactPlacement<'_>,
    side: Side,
    edge: EdgeId,
    d: &IntVector,
    radius: &BigInt,
) -> Option<(IntVector, BigInt)> {
    let e = exact.edge(side, edge);
    let dd = d.norm_squared();
    let p = exact.vertex(side, e.p);
    let width = |face: FaceId| {
        let corners = exact.block(side).topology().face(face);
        corners
            .iter()
            .map(|&v| {
                let x = exact.vertex(side, v).minus(p);
                x.scaled(&dd).minus(&d.scaled(&x.dot(d)))
            })
            .max_by_key(Vec3::norm_squared)
    };
    let (left, right) = (width(e.left)?, width(e.right)?);
    let arm = if left.norm_squared() <= right.norm_squared() { left } else { right };
    let limit = radius * &dd * BigInt::from(LAMBDA_INVERSE);
    (arm.norm_squared() < &limit * &limit).then_some((arm, dd))
}

/// Crossing edges: foot at an end, or gap exactly 0, s or −g.
pub(super) fn edge_edge(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> Option<Aim> {
    let (ea, eb) = pair.f64_view.edge_edge(sampler)?;
    let start = across(sampler, pair, ea, eb)?;
    let exact =
        pair.exact(&pair.faces_at_edge(Side::A, ea).chain(pair.faces_at_edge(Side::B, eb)).collect::<Vec<_>>(), start);
    let (d1, d2) = (exact.direction(Side::A, ea), exact.direction(Side::B, eb));
    let n = d1.cross(&d2);
    let (pa, pb) = (exact.edge(Side::A, ea).p, exact.edge(Side::B, eb).p);
    let decision = about(predicate, &[Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)]);
    let margin = if predicate == Predicate::FeetInside {
        let w = if sampler.chance(50) { d2.cross(&n) } else { d1.cross(&n) };
        // (p_B − p_A)·w is the foot's place along the edge, times |n|².
        let place = exact.along((Side::B, pb), pa, &w);
        if sampler.chance(50) { place } else { place.negated().plus(&n.norm_squared()) }
    } else {
        let n = exact.perpendicular(ea, eb);
        let gap = exact.along((Side::A, pa), pb, &n);
        let scaled = (gap, n.norm_squared(), BigInt::from(1));
        level(&exact, &scaled, predicate)
    };
    linear(sampler, &exact, decision, &margin)
}

/// The margin of a gap decision: h, s − h or h + g.
pub(super) fn level(
    exact: &ExactPlacement<'_>,
    gap: &(AffineMargin, BigInt, BigInt),
    predicate: Predicate,
) -> AffineMargin {
    match predicate {
        Predicate::VertexFaceNear | Predicate::EdgeEdgeNear => exact.gap_above(gap, &-&exact.search).negated(),
        Predicate::VertexFaceDepth | Predicate::EdgeEdgeDepth | Predicate::EntranceDepth => {
            exact.gap_above(gap, &exact.penetration)
        }
        _ => gap.0.clone(),
    }
}

/// An offset of B that makes the edges cross inside, about a gap apart; none if they do.
pub(crate) fn across(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    ea: EdgeId,
    eb: EdgeId,
) -> Option<F64Vector> {
    let (s, t, apart) = pair.f64_view.feet(ea, eb)?;
    let inside = |x: f64| (0.05..0.95).contains(&x);
    if inside(s) && inside(t) && apart <= pair.search() {
        return Some([0.0; 3]);
    }
    let ((p, d), (q, e)) = (pair.f64_view.edge(Side::A, ea), pair.f64_view.edge(Side::B, eb));
    let mut part = || sampler.between(2, 14) as f64 / 16.0;
    let (s, t) = (part(), part());
    let n = unit(cross(d, e));
    // Keep B on the side of A where it is.
    let n = if dot(n, minus(q, p)) < 0.0 { times(n, -1.0) } else { n };
    let apart = pair.search() * sampler.between(-16, 64) as f64 / 64.0;
    let way = minus(plus(p, times(d, s)), plus(q, times(e, t)));
    Some(pair.on_grid(plus(way, times(n, apart))))
}
