//! Aims at decisions about vertices and faces, and about which of two faces is the way in.

use super::edges::level;
use super::exact::{Affine, Exact};
use super::shadow::{V, dot, length, minus, plus, times};
use super::{Aim, Pair, about, linear, side};
use crate::campaign::families::Kit;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::One;
use rockproof_model::Number;
use rockproof_model::decision::{Feature, Predicate, Side};

fn corners(pair: &Pair<'_>, side: Side, face: u32) -> impl Iterator<Item = (Side, u32)> {
    pair.shadow.block(side).topology().faces()[face as usize].iter().map(move |&v| (side, v))
}

/// A vertex over a face at a gap of exactly 0, s or −g, or over one of its sides.
pub(super) fn vertex_face(kit: &mut Kit<'_>, pair: &Pair<'_>, predicate: Predicate) -> Option<Aim> {
    let asked = side(kit);
    let other = asked.other();
    let (vertex, face) = pair.shadow.vertex_face(kit, asked);
    let at_side = predicate == Predicate::InsideFace;
    let k = kit.below(pair.shadow.block(other).topology().faces()[face as usize].len() as u64) as usize;
    let start = over_face(kit, pair, (asked, vertex), face, at_side.then_some(k));
    let vertices: Vec<_> = corners(pair, other, face).chain([(asked, vertex)]).collect();
    let exact = Exact::new(pair.blocks(), &vertices, start, pair.set);
    let both = [Feature::Vertex(asked, vertex), Feature::Face(other, face)];
    let margin = if at_side {
        let n = exact.normal(other, face);
        let p = vertices[k].1;
        let q = vertices[(k + 1) % (vertices.len() - 1)].1;
        let inward = n.cross(&exact.vertex(other, q).minus(&exact.vertex(other, p)));
        exact.along((asked, vertex), p, &inward)
    } else {
        level(&exact, &exact.gap(asked, vertex, face), predicate)
    };
    let decision = match (predicate, asked) {
        // The table of decisions names A's feature first here.
        (Predicate::GapSign, Side::B) => about(predicate, &[both[1], both[0]]),
        _ => about(predicate, &both),
    };
    linear(kit, &exact, decision, &margin)
}

/// An offset of B that brings a vertex over the inside of a face, or over the middle part of its side `k`, at a gap
/// between −g and s; none if it is so.
fn over_face(kit: &mut Kit<'_>, pair: &Pair<'_>, (asked, vertex): (Side, u32), face: u32, k: Option<usize>) -> V {
    let (gap, outside) = pair.shadow.above_face(asked, vertex, face);
    if k.is_none() && outside == 0.0 && gap.abs() <= 2.0 * pair.search() {
        return [0.0; 3];
    }
    let other = asked.other();
    let loop_ = &pair.shadow.block(other).topology().faces()[face as usize];
    let at = |i: usize| pair.shadow.vertex(other, loop_[i % loop_.len()]);
    let foot = match k {
        Some(k) => {
            let t = kit.between(2, 14) as f64 / 16.0;
            plus(at(k), times(minus(at(k + 1), at(k)), t))
        }
        None => {
            let (c, corner) = (pair.shadow.centre(other, face), at(kit.below(loop_.len() as u64) as usize));
            plus(c, times(minus(corner, c), kit.between(0, 12) as f64 / 16.0))
        }
    };
    let up = if k.is_some() && gap.abs() <= pair.search() {
        gap
    } else {
        let share = kit.between(-32, 64) as f64 / 64.0;
        share * if share < 0.0 { 2.0 * pair.penetration() } else { pair.search() }
    };
    let target = plus(foot, times(pair.shadow.normal(other, face), up));
    let way = minus(target, pair.shadow.vertex(asked, vertex));
    let way = if asked == Side::B { way } else { times(way, -1.0) };
    pair.shadow.on_grid(way, pair.precision)
}

/// A vertex inside a convex corner, the shallowest face at a depth of exactly g.
pub(super) fn entrance_depth(kit: &mut Kit<'_>, pair: &Pair<'_>) -> Option<Aim> {
    let corner = Corner::choose(kit, pair)?;
    let depth = pair.penetration();
    let start = corner.enter(kit, pair, depth, 1.5 * depth);
    let face = corner.shallowest(pair, start);
    let vertices: Vec<_> = corners(pair, corner.side.other(), face).chain([(corner.side, corner.vertex)]).collect();
    let exact = Exact::new(pair.blocks(), &vertices, start, pair.set);
    let margin = level(&exact, &exact.gap(corner.side, corner.vertex, face), Predicate::EntranceDepth);
    let aim = linear(kit, &exact, about(Predicate::EntranceDepth, &corner.contact()), &margin)?;
    (corner.shallowest(pair, aim.approximate_root()) == face).then_some(aim)
}

/// A vertex at a convex corner, two faces of the corner equally far from it, or by the share ε.
pub(super) fn entrance_choice(kit: &mut Kit<'_>, pair: &Pair<'_>) -> Option<Aim> {
    let corner = Corner::choose(kit, pair)?;
    let faces = pair.shadow.block(corner.side.other()).topology().vertex_faces(corner.owner);
    let first = kit.below(faces.len() as u64) as usize;
    let second = (first + 1 + kit.below(faces.len() as u64 - 1) as usize) % faces.len();
    let start = corner.enter(kit, pair, 0.0, pair.penetration());
    let (first, second) = (faces[first], faces[second]);
    let [a, b] = corner.contact();
    let candidate = match corner.side {
        Side::A => [Feature::Vertex(Side::A, corner.vertex), Feature::Face(Side::B, first)],
        Side::B => [Feature::Face(Side::A, first), Feature::Vertex(Side::B, corner.vertex)],
    };
    let decision = about(Predicate::EntranceChoice, &[a, b, candidate[0], candidate[1]]);
    two_faces(kit, pair, (corner.side, corner.vertex), [first, second], start, decision)
}

/// A vertex inside a concave block, as deep under one as under the other of two faces that a convex edge joins.
pub(super) fn shortest_exit(kit: &mut Kit<'_>, pair: &Pair<'_>) -> Option<Aim> {
    let asked = side(kit);
    let other = pair.shadow.block(asked.other());
    if pair.shadow.a.is_convex() && pair.shadow.b.is_convex() {
        return None;
    }
    let (vertex, edge) = pair.shadow.vertex_edge(kit, asked)?;
    let e = other.topology().edges()[edge as usize];
    let (p, d) = pair.shadow.edge(asked.other(), edge);
    let inward = plus(pair.shadow.normal(asked.other(), e.left), pair.shadow.normal(asked.other(), e.right));
    let depth = pair.penetration() * kit.between(8, 60) as f64 / 64.0;
    let place = plus(p, times(d, kit.between(4, 12) as f64 / 16.0));
    let target = minus(place, times(inward, depth));
    let way = minus(target, pair.shadow.vertex(asked, vertex));
    let way = if asked == Side::B { way } else { times(way, -1.0) };
    let start = pair.shadow.on_grid(way, pair.precision);
    let [first, second] = if kit.chance(50) { [e.left, e.right] } else { [e.right, e.left] };
    let decision =
        about(Predicate::ShortestExit, &[Feature::Vertex(asked, vertex), Feature::Face(asked.other(), first)]);
    two_faces(kit, pair, (asked, vertex), [first, second], start, decision)
}

/// The gap of the first face equal to that of the second, or smaller by the share ε of it (Eq. (1)).
fn two_faces(
    kit: &mut Kit<'_>,
    pair: &Pair<'_>,
    (asked, vertex): (Side, u32),
    [first, second]: [u32; 2],
    start: V,
    decision: rockproof_model::decision::Decision,
) -> Option<Aim> {
    let other = asked.other();
    let vertices: Vec<_> =
        corners(pair, other, first).chain(corners(pair, other, second)).chain([(asked, vertex)]).collect();
    let exact = Exact::new(pair.blocks(), &vertices, start, pair.set);
    let (h1, h2) = (exact.gap(asked, vertex, first), exact.gap(asked, vertex, second));
    let share = if kit.chance(50) { pair.set.equal.clone() } else { Number::ZERO };
    let margin = equal_gaps(&h1, &h2, &share)?;
    let aim = linear(kit, &exact, decision, &margin)?;
    // |h2| was opened on the side where it starts.
    let there = pair.shadow.moved(aim.approximate_root()).above_face(asked, vertex, second).0;
    let same_side = (there < 0.0) == (h2.0.constant.sign() == num_bigint::Sign::Minus);
    (share.is_zero() || (same_side && there != 0.0)).then_some(aim)
}

/// `h1 − h2 + ε·|h2|` times a positive number, given each as `k·|N|·h`, `|N|²` and `k`.
fn equal_gaps(
    (q1, square1, k1): &(Affine, BigInt, BigInt),
    (q2, square2, k2): &(Affine, BigInt, BigInt),
    share: &Number,
) -> Option<Affine> {
    // h1·|N1||N2| = q1·|N2|/k1; with |N2|/|N1| = √(N1²·N2²)/N1² one root is enough.
    let product = super::exact::Root::of(&(square1 * square2));
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
struct Corner {
    side: Side,
    vertex: u32,
    owner: u32,
}

impl Corner {
    fn choose(kit: &mut Kit<'_>, pair: &Pair<'_>) -> Option<Corner> {
        let (va, vb) = pair.shadow.vertex_vertex(kit)?;
        let side = side(kit);
        let (vertex, owner) = if side == Side::A { (va, vb) } else { (vb, va) };
        Some(Corner { side, vertex, owner })
    }

    /// A's and B's feature.
    fn contact(&self) -> [Feature; 2] {
        match self.side {
            Side::A => [Feature::Vertex(Side::A, self.vertex), Feature::Vertex(Side::B, self.owner)],
            Side::B => [Feature::Vertex(Side::A, self.owner), Feature::Vertex(Side::B, self.vertex)],
        }
    }

    /// An offset of B that puts the vertex behind every face of the corner, by between `low` and `high` for a corner
    /// of a box.
    fn enter(&self, kit: &mut Kit<'_>, pair: &Pair<'_>, low: f64, high: f64) -> V {
        let other = self.side.other();
        let mut target = pair.shadow.vertex(other, self.owner);
        for &face in pair.shadow.block(other).topology().vertex_faces(self.owner) {
            let depth = low + (high - low) * kit.between(0, 64) as f64 / 64.0;
            target = minus(target, times(pair.shadow.normal(other, face), depth));
        }
        let way = minus(target, pair.shadow.vertex(self.side, self.vertex));
        let way = if self.side == Side::B { way } else { times(way, -1.0) };
        pair.shadow.on_grid(way, pair.precision)
    }

    /// The face of the corner with the largest gap when B has moved by `offset`.
    fn shallowest(&self, pair: &Pair<'_>, offset: V) -> u32 {
        let other = self.side.other();
        let moved = if self.side == Side::B { offset } else { times(offset, -1.0) };
        let x = minus(plus(pair.shadow.vertex(self.side, self.vertex), moved), pair.shadow.vertex(other, self.owner));
        let faces = pair.shadow.block(other).topology().vertex_faces(self.owner);
        let gap = |f: &&u32| dot(pair.shadow.normal(other, **f), x);
        debug_assert!(length(x).is_finite(), "coordinates are finite");
        faces.iter().max_by(|f, g| gap(f).total_cmp(&gap(g))).copied().unwrap_or(faces[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::Vec3;

    #[test]
    fn equal_gaps_vanish_where_they_are_equal() {
        let affine = |constant: i32, x: i32| Affine {
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
