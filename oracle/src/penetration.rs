//! How deep two convex blocks overlap: the least translation that parts them, exactly.
//!
//! A translation along a unit vector n, from B to A, parts the blocks when it brings A's lowest point along n up to B's
//! highest. The least one is along the normal of a face of the Minkowski difference of the blocks (S. Cameron and R.
//! K. Culley, 1986): a face normal of A or of B, or a cross product of an edge of each. Every direction gives a
//! translation that parts them, so trying all of these, whether or not they are faces there, gives the least.
//! For blocks apart the same calculation gives the widest slab between them that is normal to one of these directions.

use crate::Gap;
use crate::rational::Rational;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::block::face_normal;
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Sign, Vec3};

/// How two convex blocks overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Penetration {
    /// The largest gap over all directions: negative where they overlap, its square that of the least translation; zero
    /// where they touch; positive apart.
    pub gap: Gap,
    /// The direction in which A moves to get free, not of unit length. Of several least ones, the first: A's faces, B's
    /// faces, then edges of A with edges of B.
    pub direction: Vec3<BigRational>,
}

impl Penetration {
    /// The depth in m: the f64 nearest to it, ties to even; zero where the blocks do not overlap, `None` on overflow.
    pub fn depth_m(&self) -> Option<f64> {
        if self.gap.sign.is_negative() { self.gap.squared.sqrt_rounded() } else { Some(0.0) }
    }
}

/// The least translation that parts two convex blocks; `None` where one of them is not convex, or has no face with an area.
///
/// Convexity is that of the blocks as loaded.
pub fn penetration(a: &Block, b: &Block) -> Option<Penetration> {
    if !a.is_convex() || !b.is_convex() {
        return None;
    }
    let lattice = Lattice::covering(a.coordinates().chain(b.coordinates()));
    let [a_points, b_points] =
        [a, b].map(|block| block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect::<Vec<Vec3<BigInt>>>());
    let edges = |block: &Block, points: &[Vec3<BigInt>]| -> Vec<Vec3<BigInt>> {
        let edges = block.topology().edges().iter();
        edges.map(|e| points[e.q as usize].minus(&points[e.p as usize])).collect()
    };
    let faces = |block: &Block, points: &[Vec3<BigInt>]| -> Vec<Vec3<BigInt>> {
        block.topology().faces().iter().map(|face| face_normal(points, face)).collect()
    };
    let mut best: Option<(Vec3<BigInt>, BigInt, BigInt)> = None;
    let mut consider = |n: Vec3<BigInt>| {
        let square = n.norm_squared();
        if Zero::is_zero(&square) {
            return;
        }
        let (Some(low), Some(high)) =
            (a_points.iter().map(|p| n.dot(p)).min(), b_points.iter().map(|p| n.dot(p)).max())
        else {
            return;
        };
        let gap = low - high;
        if best.as_ref().is_none_or(|(_, other, other_square)| above(&gap, &square, other, other_square)) {
            best = Some((n, gap, square));
        }
    };
    faces(a, &a_points).into_iter().for_each(|n| consider(n.negated()));
    faces(b, &b_points).into_iter().for_each(&mut consider);
    for one in edges(a, &a_points) {
        for other in edges(b, &b_points) {
            let n = one.cross(&other);
            consider(n.clone());
            consider(n.negated());
        }
    }
    let (n, gap, square) = best?;
    let (units, metres) = lattice.units_per_metre();
    let squared = BigRational::new(&gap * &gap * &metres * &metres, square * &units * &units);
    let direction = n.map(|c| BigRational::from_integer(c.clone()));
    Some(Penetration { gap: Gap { sign: ExactRing::sign(&gap), squared }, direction })
}

/// Whether `gap/√square` is above `other/√other_square`; a tie says no.
fn above(gap: &BigInt, square: &BigInt, other: &BigInt, other_square: &BigInt) -> bool {
    let signed = |value: &BigInt, by: &BigInt| {
        let size = value * value * by;
        if ExactRing::sign(value) == Sign::Negative { -size } else { size }
    };
    signed(gap, other_square) > signed(other, square)
}

/// The deepest overlap in a scene of convex blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deepest {
    /// The blocks, the lower number first; of several pairs equally deep, the first.
    pub blocks: [usize; 2],
    /// Their overlap.
    pub penetration: Penetration,
}

/// The deepest overlap of a scene, `None` where no two convex blocks overlap, and how many pairs with boxes that
/// overlap were left out because one of the blocks is not convex.
pub fn deepest(blocks: &[&Block]) -> (Option<Deepest>, usize) {
    let (mut best, mut left_out): (Option<Deepest>, usize) = (None, 0);
    let bounds: Vec<_> = blocks.iter().map(|block| block.bounds()).collect();
    for i in 0..blocks.len() {
        for j in i + 1..blocks.len() {
            let apart = |k: usize| {
                let side = |v: usize, high: bool| {
                    if high { bounds[v].max.components()[k] } else { bounds[v].min.components()[k] }
                };
                side(i, true) <= side(j, false) || side(j, true) <= side(i, false)
            };
            // Boxes that only touch hold no overlap.
            if (0..3).any(apart) {
                continue;
            }
            match penetration(blocks[i], blocks[j]) {
                None => left_out += 1,
                Some(found) if found.gap.sign.is_negative() => {
                    if best.as_ref().is_none_or(|best| found.gap.squared > best.penetration.gap.squared) {
                        best = Some(Deepest { blocks: [i, j], penetration: found });
                    }
                }
                Some(_) => {}
            }
        }
    }
    (best, left_out)
}
