//! Aims at decisions about boxes, and about vertices near vertices.

use super::exact::{ExactPlacement, IntVector, IntegerRoot};
use super::f64_view::{F64Vector, dot, length, minus, plus, times, unit};
use super::{Aim, DirectedPair, about, linear, side};
use crate::families::PairSampler;
use crate::shapes::rotation::cube_turn;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{Block, Criteria, Number, Vec3, VertexId};

/// One axis on which the boxes are exactly `search` apart; on the others they must overlap already.
pub(super) fn neighbours(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let (a, b) = pair.blocks();
    let axis = sampler.below(3) as usize;
    let meets = |i: usize| {
        let ((a_low, a_high), (b_low, b_high)) = (extent(a, i), extent(b, i));
        a_low <= b_high && b_low <= a_high
    };
    if !(0..3).all(|i| i == axis || meets(i)) {
        return None;
    }
    let ((a_low, a_high), (b_low, b_high)) = (extent(a, axis), extent(b, axis));
    let above = b_low.approximate() + b_high.approximate() > a_low.approximate() + a_high.approximate();
    let search = pair.set.search.to_rational();
    let mut root = [(); 3].map(|()| BigRational::zero());
    root[axis] = if above {
        a_high.to_rational() + search - b_low.to_rational()
    } else {
        a_low.to_rational() - search - b_high.to_rational()
    };
    Some(Aim {
        decision: about(Predicate::Neighbours, &[]),
        root,
        exact: true,
        axis,
        rising: !above,
        reach: f64::INFINITY,
    })
}

/// The smallest and largest coordinate of the block along an axis.
fn extent(block: &Block, axis: usize) -> (&Number, &Number) {
    let along = || block.vertices().iter().map(|v| v.components()[axis]);
    let zero = &block.vertices()[0].components()[axis];
    (along().min().unwrap_or(zero), along().max().unwrap_or(zero))
}

/// `|a − b|` exactly the search distance or the territory radius.
pub(super) fn distance(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> Option<Aim> {
    let f64_view = &pair.f64_view;
    let (va, vb) = f64_view.vertex_vertex(sampler)?;
    let mut vertices = vec![(Side::A, va), (Side::B, vb)];
    let territory = predicate == Predicate::VertexTerritory && pair.set.criteria == Criteria::Revised;
    if territory {
        vertices.extend(around(pair, Side::A, va).chain(around(pair, Side::B, vb)));
    }
    let exact = pair.exact(&vertices, [0.0; 3]);
    let apart = exact.vertex(Side::A, va).minus(exact.vertex(Side::B, vb));
    let current = minus(f64_view.vertex(Side::A, va), f64_view.vertex(Side::B, vb));
    let decision = about(predicate, &[Feature::Vertex(Side::A, va), Feature::Vertex(Side::B, vb)]);
    // b goes to a + L·u/|u|: B moves by (a − b) + that.
    let (radius, over) = if territory {
        smallest_radius(&exact, va, vb)?
    } else {
        (Radius::Length(exact.search.clone()), BigInt::from(1))
    };
    let (vector, over) = match radius {
        Radius::Length(length) => {
            let (u, whole) = best_direction(sampler, current);
            (u.scaled(&length), over * whole)
        }
        Radius::Vector(edge) => {
            let turn = cube_turn(sampler.below(24) as u32);
            let row = |i: usize| (0..3).fold(BigInt::zero(), |s, j| s + edge.components()[j] * turn[i][j]);
            (Vec3::new(row(0), row(1), row(2)), over)
        }
    };
    let axis = (0..3).max_by_key(|&i| vector.components()[i].magnitude().clone())?;
    if vector.components()[axis].is_zero() {
        return None;
    }
    let rising = vector.components()[axis].sign() == num_bigint::Sign::Minus;
    let moved = vector.plus(&apart.scaled(&over));
    Some(Aim { decision, root: exact.offset_by(&moved, &over), exact: true, axis, rising, reach: f64::INFINITY })
}

enum Radius {
    /// Of this length in lattice units.
    Length(BigInt),
    /// As long as this vector.
    Vector(IntVector),
}

/// `min(r_a, r_b)` of the revised criteria, with what it is to be divided by.
fn smallest_radius(exact: &ExactPlacement<'_>, va: VertexId, vb: VertexId) -> Option<(Radius, BigInt)> {
    let edges = |side: Side, v: VertexId| exact.block(side).topology().vertex_edges(v).iter().map(move |&e| (side, e));
    let shortest = edges(Side::A, va)
        .chain(edges(Side::B, vb))
        .map(|(side, e)| exact.direction(side, e))
        .min_by_key(rockproof_model::Vec3::norm_squared)?;
    let square = shortest.norm_squared();
    let quarter = BigInt::from(LAMBDA_INVERSE);
    if exact.territory.is_zero() {
        return None;
    }
    Some(if &exact.territory * &exact.territory * &quarter * &quarter <= square {
        (Radius::Length(exact.territory.clone()), BigInt::from(1))
    } else {
        match IntegerRoot::of(&square) {
            root if root.is_exact() => (Radius::Length(root.root), quarter),
            _ => (Radius::Vector(shortest), quarter),
        }
    })
}

/// A vector of whole components and length that points from a to b about as the present one does, and its length.
fn best_direction(sampler: &mut PairSampler<'_>, current: F64Vector) -> (IntVector, BigInt) {
    let mut best: Option<(f64, [i128; 3], i128)> = None;
    // Along an axis half of the time: the place is binary then, and the tie survives in a float.
    let axes = sampler.chance(50);
    for number in 0..6 {
        let (u, whole) = if axes {
            let mut axis = [0; 3];
            axis[number % 3] = if number < 3 { 1 } else { -1 };
            (axis, 1)
        } else {
            sampler.whole_vector()
        };
        let closeness = -u.iter().zip(current).map(|(c, x)| *c as f64 * x).sum::<f64>() / whole as f64;
        if best.as_ref().is_none_or(|(most, ..)| closeness > *most) {
            best = Some((closeness, u, whole));
        }
    }
    let (_, [x, y, z], whole) = best.unwrap_or((0.0, [1, 0, 0], 1));
    (Vec3::new(BigInt::from(x), BigInt::from(y), BigInt::from(z)), BigInt::from(whole))
}

/// How many places are tried before the features are given up.
pub(crate) const DRAWS: usize = 12;

/// The other ends of the edges at a vertex.
pub(super) fn around<'p>(
    pair: &'p DirectedPair<'_>,
    side: Side,
    vertex: VertexId,
) -> impl Iterator<Item = (Side, VertexId)> + 'p {
    let topology = pair.f64_view.block(side).topology();
    topology.vertex_edges(vertex).iter().map(move |&e| (side, topology.edge(e).other(vertex)))
}

/// A vertex exactly on the boundary of the region of another, `(a − b)·e = 0`, and in both regions otherwise, outside the
/// territory.
pub(super) fn region(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let (va, vb) = pair.f64_view.vertex_vertex(sampler)?;
    let asked = side(sampler);
    let (vertex, owner) = if asked == Side::A { (va, vb) } else { (vb, va) };
    let other = asked.other();
    let topology = pair.f64_view.block(other).topology();
    let edge = *sampler.pick(topology.vertex_edges(owner));
    let end = topology.edge(edge).other(owner);
    let e = unit(minus(pair.f64_view.vertex(other, end), pair.f64_view.vertex(other, owner)));
    let (low, high) = (pair.territory(), pair.search());
    if low >= 0.95 * high {
        return None;
    }
    let arms = |side: Side, v: VertexId| around(pair, side, v).map(move |(_, w)| (side, v, w));
    let start = (0..DRAWS).find_map(|_| {
        // Away from the corner's edges and along those of the vertex, square to the one edge.
        let drawn = arms(other, owner).chain(arms(asked, vertex)).fold([0.0; 3], |sum, (side, v, w)| {
            let arm = unit(minus(pair.f64_view.vertex(side, w), pair.f64_view.vertex(side, v)));
            let weight = sampler.between(0, 64) as f64 * if side == other { -1.0 } else { 1.0 };
            plus(sum, times(arm, weight))
        });
        let x = unit(minus(drawn, times(e, dot(drawn, e))));
        let x = times(x, low + (high - low) * sampler.between(2, 62) as f64 / 64.0);
        let in_regions = arms(other, owner).chain(arms(asked, vertex)).all(|(side, v, w)| {
            let arm = minus(pair.f64_view.vertex(side, w), pair.f64_view.vertex(side, v));
            let along = dot(x, arm) * if side == other { 1.0 } else { -1.0 };
            (side == other && w == end) || along <= 0.0
        });
        let target = plus(pair.f64_view.vertex(other, owner), x);
        (length(x) > low && in_regions).then(|| pair.offset_to((asked, vertex), target))
    })?;
    let exact = pair.exact(&[(asked, vertex), (other, owner), (other, end)], start);
    let away = exact.vertex(other, end).minus(exact.vertex(other, owner));
    let margin = exact.along((asked, vertex), owner, &away).negated();
    let features = [Feature::Vertex(asked, vertex), Feature::Vertex(other, owner), Feature::Edge(other, edge)];
    linear(sampler, &exact, about(Predicate::VertexRegion, &features), &margin)
}
