//! Aims at decisions about vertices and faces, and about which of two faces is the way in.

use super::edges::level;
use super::exact::AffineMargin;
use super::f64_view::{F64Vector, dot, length, minus, plus, times, unit};
use super::vertices::DRAWS;
use super::{Aim, DirectedPair, about, linear, side};
use crate::families::PairSampler;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::One;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{Criteria, EdgeId, FaceId, Number, VertexId};
use std::rc::Rc;

/// A vertex over a face at a gap of exactly 0, s or −g, or over one of its sides.
pub(super) fn vertex_face(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, predicate: Predicate) -> Option<Aim> {
    let asked = side(sampler);
    let other = asked.other();
    let (vertex, face) = pair.f64_view.vertex_face(sampler, asked);
    let at_side = predicate == Predicate::InsideFace;
    let k = sampler.below(pair.f64_view.block(other).topology().faces()[face.index()].len() as u64) as usize;
    let start = over_face(sampler, pair, (asked, vertex), face, at_side.then_some(k));
    let vertices: Vec<_> = pair.corners(other, face).chain([(asked, vertex)]).collect();
    let exact = pair.exact(&vertices, start);
    let both = [Feature::Vertex(asked, vertex), Feature::Face(other, face)];
    let margin = if at_side {
        let n = exact.normal(other, face);
        let p = vertices[k].1;
        let q = vertices[(k + 1) % (vertices.len() - 1)].1;
        let inward = n.cross(&exact.vertex(other, q).minus(exact.vertex(other, p)));
        exact.along((asked, vertex), p, &inward)
    } else {
        level(&exact, &exact.gap(asked, vertex, face), predicate)
    };
    let decision = match (predicate, asked) {
        // The table of decisions names A's feature first here.
        (Predicate::GapSign, Side::B) => about(predicate, &[both[1], both[0]]),
        _ => about(predicate, &both),
    };
    linear(sampler, &exact, decision, &margin)
}

/// An offset of B that brings a vertex over the inside of a face, or over the middle part of its side `k`, at a gap
/// between −g and s; none if it is so.
pub(crate) fn over_face(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    (asked, vertex): (Side, VertexId),
    face: FaceId,
    k: Option<usize>,
) -> F64Vector {
    let (gap, outside) = pair.f64_view.above_face(asked, vertex, face);
    if k.is_none() && outside == 0.0 && gap.abs() <= 2.0 * pair.search() {
        return [0.0; 3];
    }
    let other = asked.other();
    let loop_ = pair.f64_view.block(other).topology().face(face);
    let at = |i: usize| pair.f64_view.vertex(other, loop_[i % loop_.len()]);
    let foot = match k {
        Some(k) => {
            let t = sampler.between(2, 14) as f64 / 16.0;
            plus(at(k), times(minus(at(k + 1), at(k)), t))
        }
        None => {
            let (c, corner) = (pair.f64_view.centre(other, face), at(sampler.below(loop_.len() as u64) as usize));
            plus(c, times(minus(corner, c), sampler.between(0, 12) as f64 / 16.0))
        }
    };
    let up = if k.is_some() && gap.abs() <= pair.search() {
        gap
    } else {
        let share = sampler.between(-32, 64) as f64 / 64.0;
        share * if share < 0.0 { 2.0 * pair.penetration() } else { pair.search() }
    };
    let target = plus(foot, times(pair.f64_view.normal(other, face), up));
    pair.offset_to((asked, vertex), target)
}

/// A vertex in the territory of a convex corner, as deep as g under the way in. Possible where g is within the territory.
pub(super) fn entrance_depth(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let corner = Corner::choose(sampler, pair, 1)?;
    let (g, r) = (pair.penetration(), corner.territory(pair));
    if g >= 0.9 * r {
        return None;
    }
    let (start, face) = (0..DRAWS).find_map(|_| {
        let face = *sampler.pick(&corner.faces);
        let n = pair.f64_view.normal(corner.side.other(), face);
        let drawn = pair.jitter(sampler, r);
        let x = minus(drawn, times(n, dot(drawn, n) + g));
        (length(x) < 0.98 * r && corner.enters(pair, x, face)).then(|| (corner.offset_to(pair, x), face))
    })?;
    let vertices: Vec<_> = pair.corners(corner.side.other(), face).chain([(corner.side, corner.vertex)]).collect();
    let exact = pair.exact(&vertices, start);
    let margin = level(&exact, &exact.gap(corner.side, corner.vertex, face), Predicate::EntranceDepth);
    linear(sampler, &exact, about(Predicate::EntranceDepth, &corner.contact()), &margin)
}

/// A vertex in the territory of a convex corner, two faces of the corner the best ways in: equally far from it, or
/// different by the share ε.
pub(super) fn entrance_choice(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    let corner = Corner::choose(sampler, pair, 2)?;
    let r = corner.territory(pair);
    let i = sampler.below(corner.faces.len() as u64) as usize;
    let j = (i + 1 + sampler.below(corner.faces.len() as u64 - 1) as usize) % corner.faces.len();
    let (first, second) = (corner.faces[i], corner.faces[j]);
    let normal = |face: FaceId| pair.f64_view.normal(corner.side.other(), face);
    let apart = unit(minus(normal(first), normal(second)));
    let start = (0..DRAWS).find_map(|_| {
        let drawn = pair.jitter(sampler, r.min(pair.penetration()));
        let x = minus(drawn, times(apart, dot(drawn, apart)));
        let best = corner.best(pair, x);
        let deepest = dot(normal(first), x) >= -pair.penetration();
        (length(x) < 0.98 * r && deepest && (best == first || best == second)).then(|| corner.offset_to(pair, x))
    })?;
    let ([a, b], [c, d]) = (corner.contact(), corner.candidate(first));
    let decision = about(Predicate::EntranceChoice, &[a, b, c, d]);
    two_faces(sampler, pair, (corner.side, corner.vertex), [first, second], start, decision)
}

/// A vertex inside a concave block, as deep under one as under the other of two faces that a convex edge joins.
pub(super) fn shortest_exit(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<Aim> {
    if pair.f64_view.a.is_convex() && pair.f64_view.b.is_convex() {
        return None;
    }
    let (asked, vertex, edge) = (0..DRAWS).find_map(|_| ridge_under_vertex(sampler, pair, false))?;
    let other = asked.other();
    let e = pair.f64_view.block(other).topology().edge(edge);
    let (low, high) = (pair.territory(), pair.penetration());
    if low >= 0.9 * high {
        return None;
    }
    let depth = low + (high - low) * sampler.between(4, 60) as f64 / 64.0;
    let start = under_faces(sampler, pair, (asked, vertex, edge), [depth, depth])?;
    let [first, second] = if sampler.chance(50) { [e.left, e.right] } else { [e.right, e.left] };
    let decision = about(Predicate::ShortestExit, &[Feature::Vertex(asked, vertex), Feature::Face(other, first)]);
    two_faces(sampler, pair, (asked, vertex), [first, second], start, decision)
}

/// A vertex, and a convex edge of the other block (a `blunt` one, of more than 90 degrees) whose two faces its cone
/// passes.
pub(crate) fn ridge_under_vertex(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    blunt: bool,
) -> Option<(Side, VertexId, EdgeId)> {
    let asked = side(sampler);
    let (vertex, edge) = pair.f64_view.vertex_edge(sampler, asked)?;
    let e = pair.f64_view.block(asked.other()).topology().edge(edge);
    let passes = |face: FaceId| pair.cone_passes((asked, vertex), face, None);
    let normal = |face: FaceId| pair.f64_view.normal(asked.other(), face);
    let shaped = !blunt || dot(normal(e.left), normal(e.right)) > 0.0;
    (shaped && passes(e.left) && passes(e.right)).then_some((asked, vertex, edge))
}

/// An offset of B that puts a vertex under both faces at an edge, at these depths; `None` where the faces are nearly
/// parallel.
pub(crate) fn under_faces(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    (asked, vertex, edge): (Side, VertexId, EdgeId),
    [left, right]: [f64; 2],
) -> Option<F64Vector> {
    let other = asked.other();
    let e = pair.f64_view.block(other).topology().edge(edge);
    let (n, m) = (pair.f64_view.normal(other, e.left), pair.f64_view.normal(other, e.right));
    let (p, d) = pair.f64_view.edge(other, edge);
    let place = plus(p, times(d, sampler.between(4, 12) as f64 / 16.0));
    // x = −(α·n + β·m) with x·n = −left, x·m = −right.
    let c = dot(n, m);
    let square = 1.0 - c * c;
    let (alpha, beta) = ((left - c * right) / square, (right - c * left) / square);
    let target = minus(place, plus(times(n, alpha), times(m, beta)));
    (square > 1e-3).then(|| pair.offset_to((asked, vertex), target))
}

/// The gap of the first face equal to that of the second, or smaller by the share ε of it (Eq. (1)).
fn two_faces(
    sampler: &mut PairSampler<'_>,
    pair: &DirectedPair<'_>,
    (asked, vertex): (Side, VertexId),
    [first, second]: [FaceId; 2],
    start: F64Vector,
    decision: Decision,
) -> Option<Aim> {
    let other = asked.other();
    let vertices: Vec<_> =
        pair.corners(other, first).chain(pair.corners(other, second)).chain([(asked, vertex)]).collect();
    let exact = pair.exact(&vertices, start);
    let (h1, h2) = (exact.gap(asked, vertex, first), exact.gap(asked, vertex, second));
    let share = if sampler.chance(50) { pair.set.equal.clone() } else { Number::ZERO };
    let margin = equal_gaps(&h1, &h2, &share)?;
    let aim = linear(sampler, &exact, decision, &margin)?;
    // |h2| was opened on the side where it starts.
    let there = pair.f64_view.moved(aim.approximate_root()).above_face(asked, vertex, second).0;
    let same_side = (there < 0.0) == (h2.0.constant.sign() == num_bigint::Sign::Minus);
    (share.is_zero() || (same_side && there != 0.0)).then_some(aim)
}

/// `h1 − h2 + ε·|h2|` times a positive number, given each as `k·|N|·h`, `|N|²` and `k`.
fn equal_gaps(
    (q1, square1, k1): &(AffineMargin, BigInt, BigInt),
    (q2, square2, k2): &(AffineMargin, BigInt, BigInt),
    share: &Number,
) -> Option<AffineMargin> {
    // h1·|N1||N2| = q1·|N2|/k1; with |N2|/|N1| = √(N1²·N2²)/N1² one root is enough.
    let product = super::exact::IntegerRoot::of(&(square1 * square2));
    let one = BigRational::one();
    let best_is_negative = q2.constant.sign() == num_bigint::Sign::Minus;
    // h2 − ε|h2| = h2·(1 ∓ ε)
    let factor = if best_is_negative { one + share.to_rational() } else { one - share.to_rational() };
    let left = q1.times(&(&product.root * k2 * factor.denom()));
    let right = q2.times(&((square1 * k1 * factor.numer()) << product.shift));
    let mut margin = left.minus(&right);
    margin.exact = product.is_exact();
    (!margin.gradient.components().iter().all(|c| num_traits::Zero::is_zero(*c))).then_some(margin)
}

/// A vertex and a convex corner of the other block that it is brought to.
pub(crate) struct Corner {
    pub(crate) side: Side,
    pub(crate) vertex: VertexId,
    owner: VertexId,
    /// The faces of the corner that are ways in: [`DirectedPair::ways_in`].
    pub(crate) faces: Rc<[FaceId]>,
}

impl Corner {
    /// A corner with at least `least` faces to enter by.
    pub(crate) fn choose(sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>, least: usize) -> Option<Corner> {
        (0..DRAWS).find_map(|_| {
            let (va, vb) = pair.f64_view.vertex_vertex(sampler)?;
            let side = side(sampler);
            let (vertex, owner) = if side == Side::A { (va, vb) } else { (vb, va) };
            let faces = pair.ways_in((side, vertex), owner);
            (faces.len() >= least).then_some(Corner { side, vertex, owner, faces })
        })
    }

    /// A's and B's feature.
    pub(crate) fn contact(&self) -> [Feature; 2] {
        match self.side {
            Side::A => [Feature::Vertex(Side::A, self.vertex), Feature::Vertex(Side::B, self.owner)],
            Side::B => [Feature::Vertex(Side::A, self.owner), Feature::Vertex(Side::B, self.vertex)],
        }
    }

    /// A's and B's feature of the candidate that one of the corner's faces is.
    pub(crate) fn candidate(&self, face: FaceId) -> [Feature; 2] {
        match self.side {
            Side::A => [Feature::Vertex(Side::A, self.vertex), Feature::Face(Side::B, face)],
            Side::B => [Feature::Face(Side::A, face), Feature::Vertex(Side::B, self.vertex)],
        }
    }

    /// An offset of B that puts the vertex somewhere in the corner's territory, no deeper than g.
    pub(crate) fn visit(&self, sampler: &mut PairSampler<'_>, pair: &DirectedPair<'_>) -> Option<F64Vector> {
        let r = self.territory(pair);
        (0..DRAWS).find_map(|_| {
            let x = pair.jitter(sampler, r.min(pair.penetration()));
            (length(x) < 0.98 * r).then(|| self.offset_to(pair, x))
        })
    }

    /// An offset of B that puts the vertex into the corner's territory, and the face below which it is the way in.
    pub(crate) fn overlap(
        &self,
        sampler: &mut PairSampler<'_>,
        pair: &DirectedPair<'_>,
    ) -> Option<(F64Vector, FaceId)> {
        let r = self.territory(pair);
        (0..DRAWS).find_map(|n| {
            let x = pair.jitter(sampler, r / f64::from(1 << (n % 4)));
            let face = self.best(pair, x);
            let below = dot(pair.f64_view.normal(self.side.other(), face), x) < 0.0;
            (below && length(x) < 0.98 * r && self.enters(pair, x, face)).then(|| (self.offset_to(pair, x), face))
        })
    }

    /// Whether nothing dips below the face, so that the plane passes and is a true exit whatever the tolerances, and it
    /// is a better way in when the vertex is `x` away from the corner than the other faces of both corners.
    fn enters(&self, pair: &DirectedPair<'_>, x: F64Vector, face: FaceId) -> bool {
        let other = self.side.other();
        let edges = pair.f64_view.block(self.side).topology().vertex_edges(self.vertex);
        let level = edges.iter().all(|&e| pair.dip((self.side, self.vertex), face, e) <= 0.0);
        let gap = dot(pair.f64_view.normal(other, face), x);
        let rivals = pair.f64_view.block(self.side).topology().vertex_faces(self.vertex).iter();
        let mut rivals = rivals.filter(|&&f| pair.cone_passes((other, self.owner), f, None));
        level
            && self.best(pair, x) == face
            && rivals.all(|&f| -dot(pair.f64_view.normal(self.side, f), x) <= gap + f64::EPSILON * length(x))
    }

    /// The offset of B that puts the vertex `x` away from the corner.
    fn offset_to(&self, pair: &DirectedPair<'_>, x: F64Vector) -> F64Vector {
        pair.offset_to((self.side, self.vertex), plus(pair.f64_view.vertex(self.side.other(), self.owner), x))
    }

    /// The face with the largest gap when the vertex is `x` away from the corner.
    fn best(&self, pair: &DirectedPair<'_>, x: F64Vector) -> FaceId {
        let gap = |f: &&FaceId| dot(pair.f64_view.normal(self.side.other(), **f), x);
        self.faces.iter().max_by(|f, g| gap(f).total_cmp(&gap(g))).copied().unwrap_or(self.faces[0])
    }

    /// The radius of the two vertices' common territory.
    fn territory(&self, pair: &DirectedPair<'_>) -> f64 {
        if pair.set.criteria == Criteria::Classic {
            return pair.territory();
        }
        let edges = |side: Side, v: VertexId| {
            let all = pair.f64_view.block(side).topology().vertex_edges(v).iter();
            all.map(move |&e| length(pair.f64_view.edge(side, e).1) / f64::from(LAMBDA_INVERSE))
        };
        let shortest = edges(self.side, self.vertex).chain(edges(self.side.other(), self.owner));
        shortest.fold(pair.territory(), f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

    #[test]
    fn equal_gaps_vanish_where_they_are_equal() {
        let affine = |constant: i32, x: i32| AffineMargin {
            constant: BigInt::from(constant),
            gradient: Vec3::new(BigInt::from(x), BigInt::from(0), BigInt::from(0)),
            exact: true,
        };
        // h1 = (8 + t)/2, h2 = (21 − t)/3: equal at t = 18/5.
        let h1 = (affine(8, 1), BigInt::from(4), BigInt::from(1));
        let h2 = (affine(21, -1), BigInt::from(9), BigInt::from(1));
        let margin = equal_gaps(&h1, &h2, &Number::ZERO).unwrap();
        let root = BigRational::new(-margin.constant, margin.gradient.x);
        assert_eq!(root, BigRational::new(18.into(), 5.into()));
    }
}
