//! Aims at decisions about vertices near edges, and about crossing edges.

use super::exact::{Affine, Exact, Root, Z};
use super::shadow::{V, cross, dot, minus, plus, times, unit};
use super::vertices::around;
use super::{Aim, Pair, about, linear, side};
use crate::campaign::families::Kit;
use num_bigint::BigInt;
use num_traits::Zero;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{Criteria, Vec3};

/// The vertices of the two faces at an edge, its ends among them.
fn beside(pair: &Pair<'_>, side: Side, edge: u32) -> Vec<(Side, u32)> {
    let topology = pair.shadow.block(side).topology();
    let e = topology.edges()[edge as usize];
    [e.left, e.right].iter().flat_map(|&f| &topology.faces()[f as usize]).map(|&v| (side, v)).collect()
}

/// An offset of B that brings a vertex beside an edge: foot inside, within the search distance. None if it is so.
fn beside_edge(kit: &mut Kit<'_>, pair: &Pair<'_>, (x_side, vertex): (Side, u32), edge: u32) -> V {
    let (along, distance) = pair.shadow.foot(x_side, vertex, edge);
    if (0.02..0.98).contains(&along) && distance <= pair.search() {
        return [0.0; 3];
    }
    let (p, d) = pair.shadow.edge(x_side.other(), edge);
    let target = plus(p, times(d, kit.between(1, 15) as f64 / 16.0));
    // From the vertex to its target, for a vertex of B; the other way round when the edge moves.
    let way = minus(target, pair.shadow.vertex(x_side, vertex));
    let way = if x_side == Side::B { way } else { times(way, -1.0) };
    let jitter = pair.jitter(kit, pair.search() / 2.0);
    plus(pair.shadow.on_grid(way, pair.precision), jitter)
}

/// Foot at an end, on the boundary of the edge's region, or of the vertex's.
pub(super) fn vertex_edge(kit: &mut Kit<'_>, pair: &Pair<'_>, predicate: Predicate) -> Option<Aim> {
    let asked = side(kit);
    let (vertex, edge) = pair.shadow.vertex_edge(kit, asked)?;
    let start = beside_edge(kit, pair, (asked, vertex), edge);
    let mut vertices = beside(pair, asked.other(), edge);
    vertices.push((asked, vertex));
    vertices.extend(around(pair, asked, vertex));
    let exact = Exact::new(pair.blocks(), &vertices, start, pair.set);
    let e = exact.edge(asked.other(), edge);
    let d = exact.direction(asked.other(), edge);
    let both = [Feature::Vertex(asked, vertex), Feature::Edge(asked.other(), edge)];
    let (margin, decision) = match predicate {
        Predicate::FootInside => {
            let from_p = exact.along((asked, vertex), e.p, &d);
            let near_p = kit.chance(50);
            let margin = if near_p { from_p } else { from_p.negated().plus(&d.norm_squared()) };
            (margin, about(predicate, &both))
        }
        Predicate::EdgeRegion => {
            let face = if kit.chance(50) { e.left } else { e.right };
            let m = exact.inward(asked.other(), edge, face);
            let features = [both[0], both[1], Feature::Face(asked.other(), face)];
            (exact.along((asked, vertex), e.p, &m).negated(), about(predicate, &features))
        }
        _ => {
            let at = *kit.pick(pair.shadow.block(asked).topology().vertex_edges(vertex));
            let end = exact.edge(asked, at).other(vertex);
            let away = exact.vertex(asked, end).minus(&exact.vertex(asked, vertex));
            // f − a = −(x − (x·d)d/d²) with x = a − p, so (f − a)·e = x·(d(d·e) − e d²)/d².
            let w = d.scaled(&d.dot(&away)).minus(&away.scaled(&d.norm_squared()));
            let features = [both[0], both[1], Feature::Edge(asked, at)];
            (exact.along((asked, vertex), e.p, &w).negated(), about(predicate, &features))
        }
    };
    linear(kit, &exact, decision, &margin)
}

/// A vertex exactly the search distance or the territory radius from an edge's line.
pub(super) fn distance(kit: &mut Kit<'_>, pair: &Pair<'_>, predicate: Predicate) -> Option<Aim> {
    let asked = side(kit);
    let (vertex, edge) = pair.shadow.vertex_edge(kit, asked)?;
    let mut vertices = beside(pair, asked.other(), edge);
    vertices.push((asked, vertex));
    let exact = Exact::new(pair.blocks(), &vertices, [0.0; 3], pair.set);
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
            let arm = if kit.chance(50) { arm } else { arm.negated() };
            (arm, over * BigInt::from(LAMBDA_INVERSE), true)
        }
        None => {
            let (u, norm) = outward(kit, &exact, asked.other(), edge)?;
            // L·u/|u|, with |u| = root / 2^shift.
            (u.scaled(&(radius << norm.shift)), norm.root.clone(), norm.is_exact())
        }
    };
    // x = a − p is to become (k/8)·d + u/over.
    let eighth = BigInt::from(kit.between(1, 7));
    let target = d.scaled(&(&eighth * &over)).plus(&u.scaled(&BigInt::from(8)));
    let over = over * BigInt::from(8);
    let p = exact.edge(asked.other(), edge).p;
    let x = exact.vertex(asked, vertex).minus(&exact.vertex(asked.other(), p)).scaled(&over);
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
fn outward(kit: &mut Kit<'_>, exact: &Exact<'_>, side: Side, edge: u32) -> Option<(Z, Root)> {
    let e = exact.edge(side, edge);
    let mut choices: Vec<(Z, Root)> = Vec::new();
    for face in [e.left, e.right] {
        for u in [exact.normal(side, face), exact.inward(side, edge, face).negated()] {
            let norm = Root::of(&u.norm_squared());
            choices.push((u, norm));
        }
    }
    // A 3-4-5 mixture of a normal and the in-plane direction square to it, where both lengths are whole.
    if let [(n, n_norm), (m, m_norm), ..] = &choices[..] {
        if n_norm.is_exact() && m_norm.is_exact() && kit.chance(50) {
            let u = n.scaled(&(&m_norm.root * 3)).plus(&m.scaled(&(&n_norm.root * 4)));
            choices.push((u, Root { root: &n_norm.root * &m_norm.root * 5, shift: 0 }));
        }
    }
    let whole: Vec<usize> = (0..choices.len()).filter(|&i| choices[i].1.is_exact()).collect();
    let i = if whole.is_empty() { kit.below(choices.len() as u64) as usize } else { *kit.pick(&whole) };
    choices.into_iter().nth(i)
}

/// The arm from the edge's line to the furthest vertex of the narrower of its faces, times `|d|²`, and that factor; if
/// a quarter of its length is below `radius`.
fn shorter_arm(exact: &Exact<'_>, side: Side, edge: u32, d: &Z, radius: &BigInt) -> Option<(Z, BigInt)> {
    let e = exact.edge(side, edge);
    let dd = d.norm_squared();
    let p = exact.vertex(side, e.p);
    let width = |face: u32| {
        let corners = &exact.block(side).topology().faces()[face as usize];
        corners
            .iter()
            .map(|&v| {
                let x = exact.vertex(side, v).minus(&p);
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
pub(super) fn edge_edge(kit: &mut Kit<'_>, pair: &Pair<'_>, predicate: Predicate) -> Option<Aim> {
    let (ea, eb) = pair.shadow.edge_edge(kit)?;
    let start = across(kit, pair, ea, eb)?;
    let mut vertices = beside(pair, Side::A, ea);
    vertices.extend(beside(pair, Side::B, eb));
    let exact = Exact::new(pair.blocks(), &vertices, start, pair.set);
    let (d1, d2) = (exact.direction(Side::A, ea), exact.direction(Side::B, eb));
    let n = d1.cross(&d2);
    let (pa, pb) = (exact.edge(Side::A, ea).p, exact.edge(Side::B, eb).p);
    let decision = about(predicate, &[Feature::Edge(Side::A, ea), Feature::Edge(Side::B, eb)]);
    let margin = if predicate == Predicate::FeetInside {
        let w = if kit.chance(50) { d2.cross(&n) } else { d1.cross(&n) };
        // (p_B − p_A)·w is the foot's place along the edge, times |n|².
        let place = exact.along((Side::B, pb), pa, &w);
        if kit.chance(50) { place } else { place.negated().plus(&n.norm_squared()) }
    } else {
        let n = exact.perpendicular(ea, eb);
        let gap = exact.along((Side::A, pa), pb, &n);
        let scaled = (gap, n.norm_squared(), BigInt::from(1));
        level(&exact, &scaled, predicate)
    };
    linear(kit, &exact, decision, &margin)
}

/// The margin of a gap decision: h, s − h or h + g.
pub(super) fn level(exact: &Exact<'_>, gap: &(Affine, BigInt, BigInt), predicate: Predicate) -> Affine {
    match predicate {
        Predicate::VertexFaceNear | Predicate::EdgeEdgeNear => exact.gap_above(gap, &-&exact.search).negated(),
        Predicate::VertexFaceDepth | Predicate::EdgeEdgeDepth | Predicate::EntranceDepth => {
            exact.gap_above(gap, &exact.penetration)
        }
        _ => gap.0.clone(),
    }
}

/// An offset of B that makes the edges cross inside, about a gap apart; none if they do.
fn across(kit: &mut Kit<'_>, pair: &Pair<'_>, ea: u32, eb: u32) -> Option<V> {
    let (s, t, apart) = pair.shadow.feet(ea, eb)?;
    let inside = |x: f64| (0.05..0.95).contains(&x);
    if inside(s) && inside(t) && apart <= pair.search() {
        return Some([0.0; 3]);
    }
    let ((p, d), (q, e)) = (pair.shadow.edge(Side::A, ea), pair.shadow.edge(Side::B, eb));
    let mut part = || kit.between(2, 14) as f64 / 16.0;
    let (s, t) = (part(), part());
    let n = unit(cross(d, e));
    // Keep B on the side of A where it is.
    let n = if dot(n, minus(q, p)) < 0.0 { times(n, -1.0) } else { n };
    let apart = pair.search() * kit.between(-16, 64) as f64 / 64.0;
    let way = minus(plus(p, times(d, s)), plus(q, times(e, t)));
    Some(pair.shadow.on_grid(plus(way, times(n, apart)), pair.precision))
}
