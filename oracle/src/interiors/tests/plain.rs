//! Whether the insides of two blocks meet, the plain way: every triangle from the first vertex of its face, cut along the whole
//! lines of all others, each piece asked by rays through all triangles. Pieces have fractions for corners; triangles, and rays from a place times its
//! denominator, are whole numbers, since to reduce fractions would take most of the time.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rockproof_model::{Block, Vec3};

type Place = Vec3<BigRational>;
type Whole = Vec3<BigInt>;

struct Triangle {
    block: usize,
    corners: [Whole; 3],
    across: Whole,
}

impl Triangle {
    /// Above zero on the side to which the vector across points.
    fn height(&self, place: &Whole) -> BigInt {
        self.height_times(place, &BigInt::one())
    }

    /// The height of a place given by its coordinates times a denominator, times that.
    fn height_times(&self, place: &Whole, denominator: &BigInt) -> BigInt {
        self.across.dot(&place.minus(&self.corners[0].scaled(denominator)))
    }

    fn heights(&self, other: &Triangle) -> [BigInt; 3] {
        other.corners.each_ref().map(|corner| self.height(corner))
    }
}

fn fractions(whole: &Whole) -> Place {
    whole.map(|c| BigRational::from_integer(c.clone()))
}

/// A multiple of all denominators.
fn multiple_of<'f>(fractions: impl Iterator<Item = &'f BigRational>) -> BigInt {
    fractions.fold(BigInt::one(), |multiple, fraction| {
        if (&multiple % fraction.denom()).is_zero() { multiple } else { multiple * fraction.denom() }
    })
}

/// A place times such a multiple.
fn times(place: &Place, multiple: &BigInt) -> Whole {
    place.map(|c| c.numer() * (multiple / c.denom()))
}

fn whole(value: i32) -> BigRational {
    BigRational::from_integer(value.into())
}

/// Those of both blocks, in a unit in which all coordinates are whole.
fn triangles(blocks: [&Block; 2]) -> Vec<Triangle> {
    let points =
        |block: &Block| -> Vec<Place> { block.vertices().iter().map(|v| v.map(|c| c.to_rational())).collect() };
    let points = blocks.map(points);
    let multiple = multiple_of(points.iter().flatten().flat_map(Vec3::components));
    let mut all = Vec::new();
    for (number, block) in blocks.into_iter().enumerate() {
        let points: Vec<Whole> = points[number].iter().map(|p| times(p, &multiple)).collect();
        for face in block.topology().faces() {
            for two in face[1..].windows(2) {
                let corners = [face[0], two[0], two[1]].map(|v| points[v.index()].clone());
                let across = corners[1].minus(&corners[0]).cross(&corners[2].minus(&corners[0]));
                if across.components().into_iter().any(|c| !c.is_zero()) {
                    all.push(Triangle { block: number, corners, across });
                }
            }
        }
    }
    all
}

/// Vectors in the plane of a triangle whose zero lines through a point of it are those along which another triangle cuts: the
/// height above such a line is `vector · (place − point)`.
fn cuts(base: &Triangle, other: &Triangle) -> Vec<(Whole, Place)> {
    let heights = base.heights(other);
    let is_on = |k: usize| heights[k % 3].is_zero();
    let mut found = Vec::new();
    for k in (0..3).filter(|&k| is_on(k) && is_on(k + 1)) {
        let (p, q) = (&other.corners[k], &other.corners[(k + 1) % 3]);
        found.push((base.across.cross(&q.minus(p)), fractions(p)));
    }
    if heights.iter().any(Signed::is_positive) && heights.iter().any(Signed::is_negative) {
        let k = (0..3).find(|&k| heights[k].is_positive() != heights[(k + 1) % 3].is_positive()).unwrap_or(0);
        let (h, next) = (&heights[k], &heights[(k + 1) % 3]);
        let share = BigRational::new(h.clone(), h - next);
        let (p, q) = (fractions(&other.corners[k]), fractions(&other.corners[(k + 1) % 3]));
        found.push((base.across.cross(&base.across.cross(&other.across)), p.plus(&q.minus(&p).scaled(&share))));
    }
    found
}

/// The convex pieces of a triangle.
fn pieces(all: &[Triangle], base: usize) -> Vec<Vec<Place>> {
    let mut pieces = vec![all[base].corners.each_ref().map(fractions).to_vec()];
    for other in (0..all.len()).filter(|&other| other != base) {
        for (vector, point) in cuts(&all[base], &all[other]) {
            let vector = fractions(&vector);
            pieces = pieces.into_iter().flat_map(|piece| halves(piece, &vector, &point)).collect();
        }
    }
    pieces
}

fn halves(piece: Vec<Place>, vector: &Place, point: &Place) -> Vec<Vec<Place>> {
    let heights: Vec<BigRational> = piece.iter().map(|corner| vector.dot(&corner.minus(point))).collect();
    if !heights.iter().any(Signed::is_positive) || !heights.iter().any(Signed::is_negative) {
        return vec![piece];
    }
    [1, -1]
        .map(|side| {
            let mut half = Vec::new();
            for k in 0..piece.len() {
                let next = (k + 1) % piece.len();
                let (h, to) = (&heights[k] * whole(side), &heights[next] * whole(side));
                if !h.is_negative() {
                    half.push(piece[k].clone());
                }
                if (h.is_positive() && to.is_negative()) || (h.is_negative() && to.is_positive()) {
                    half.push(piece[k].plus(&piece[next].minus(&piece[k]).scaled(&(&h / (&h - to)))));
                }
            }
            half
        })
        .into()
}

/// Whether next to a place in a triangle, on no other triangle's plane but its own, it is inside a block: below and above.
fn insides(all: &[Triangle], base: &Triangle, block: usize, place: &Place) -> Option<[bool; 2]> {
    let others: Vec<&Triangle> = all
        .iter()
        .filter(|other| other.block == block && base.heights(other).iter().any(|height| !height.is_zero()))
        .collect();
    let denominator = multiple_of(place.components().into_iter());
    let place = times(place, &denominator);
    let heights: Vec<BigInt> = others.iter().map(|other| other.height_times(&place, &denominator)).collect();
    if heights.iter().any(Zero::is_zero) {
        return None;
    }
    (1..).find_map(|k| {
        let ray = Vec3::new(1, k, k * k).map(|&c: &i32| BigInt::from(c));
        let leaves = base.across.dot(&ray);
        let mut odd = [false; 2];
        for (other, height) in others.iter().zip(&heights) {
            let towards = other.across.dot(&ray);
            if leaves.is_zero() || towards.is_zero() {
                return None;
            }
            let ways = other.corners.each_ref().map(|corner| corner.scaled(&denominator).minus(&place));
            let turns = [0, 1, 2].map(|i| ways[i].cross(&ways[(i + 1) % 3]).dot(&ray) * &towards);
            if turns.iter().any(Zero::is_zero) {
                return None;
            }
            if turns.iter().all(Signed::is_positive) {
                odd[usize::from(height.is_negative() == towards.is_positive())] ^= true;
            }
        }
        Some(if leaves.is_positive() { odd } else { [odd[1], odd[0]] })
    })
}

/// Whether the insides of two blocks share a volume.
pub(super) fn meet(a: &Block, b: &Block) -> bool {
    let all = triangles([a, b]);
    (0..all.len()).any(|base| {
        pieces(&all, base).iter().any(|piece| {
            let insides = (1..).find_map(|j| {
                let weights = [whole(1), whole(j), whole(j * j)];
                let sum: BigRational = weights.iter().sum();
                let place = (0..3).fold(Vec3::zero(), |sum: Place, k| sum.plus(&piece[k].scaled(&weights[k])));
                let place = place.scaled(&(BigRational::one() / sum));
                let [in_a, in_b] = [0, 1].map(|block| insides(&all, &all[base], block, &place));
                in_a.zip(in_b)
            });
            insides.is_some_and(|(in_a, in_b)| in_a[0] && in_b[0] || in_a[1] && in_b[1])
        })
    })
}
