//! How deep two blocks overlap (SPEC section 7), exactly: convex pairs by the least translation that parts them
//! (`convex`), others by their deepest point (`vertices`); and the largest depth of a scene.

mod convex;
mod faces;
mod vertices;

use self::faces::FaceDirections;
use crate::Gap;
use crate::rational::Rational;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;
use rockproof_model::lattice::Lattice;
use rockproof_model::{Block, Sign, Vec3};
use std::cell::OnceCell;
use std::cmp::Ordering;

/// How two blocks overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Penetration {
    /// Of two convex blocks the largest gap over all directions: negative where they overlap, its square that of the least
    /// translation; zero where they touch; positive apart. Of others negative where they overlap, its square that of the
    /// distance from the other's surface of the deepest vertex, or, if none is inside, of the deepest middle of an edge
    /// between its crossings with faces, or else of such a diagonal of a face; where this is none or shallow, of the deepest of it and of middles of
    /// convex cells in both blocks; else zero.
    pub gap: Gap,
    /// The direction in which A moves to get free, not of unit length. Of several equally good ones, the first: A's faces,
    /// B's faces, then edges of A with edges of B; of points A's, then B's, each with the first face, edge or vertex that
    /// is nearest. Zero where no point is inside.
    pub direction: Vec3<BigRational>,
}

impl Penetration {
    /// The depth in m: the f64 nearest to it, ties to even; zero where the blocks do not overlap, `None` on overflow.
    pub fn depth_m(&self) -> Option<f64> {
        if self.gap.sign.is_negative() { self.gap.squared.sqrt_rounded() } else { Some(0.0) }
    }

    /// The direction in which A moves to get free, in f64: each component rounded to nearest, not of unit length.
    pub fn way_out(&self) -> [f64; 3] {
        self.direction.components().map(|c| c.to_f64().unwrap_or(f64::NAN))
    }

    /// That of blocks that touch, or of which no more is known.
    pub(crate) fn none() -> Penetration {
        Penetration { gap: Gap { sign: Sign::Zero, squared: BigRational::default() }, direction: Vec3::zero() }
    }

    /// The square of the depth in m², exactly; zero where the blocks do not overlap.
    pub fn depth_squared(&self) -> BigRational {
        if self.gap.sign.is_negative() { self.gap.squared.clone() } else { BigRational::default() }
    }
}

/// How deep two blocks overlap; `None` where one of them has no face with an area.
///
/// Convexity is that of the blocks as loaded.
pub fn penetration(a: &Block, b: &Block) -> Option<Penetration> {
    let pair = LatticePair::new(a, b);
    if a.is_convex() && b.is_convex() { convex::least_translation(&pair) } else { vertices::deepest_point(&pair) }
}

/// The deepest overlap in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Deepest {
    /// The blocks, the lower number first; of several pairs equally deep, the first.
    pub blocks: [usize; 2],
    /// Their overlap.
    pub penetration: Penetration,
}

/// The deepest overlap of a scene, `None` where no two blocks overlap, and how many pairs with boxes that overlap were left
/// out because one of the blocks has no face with an area.
///
/// A pair is examined exactly only if f64 bounds do not prove it shallower than another: a convex pair is no deeper than
/// its boxes overlap, nor than along a normal of its faces, and not much deeper or shallower than f64 finds along all directions.
pub fn deepest(blocks: &[&Block]) -> (Option<Deepest>, usize) {
    let mut pairs = overlapping_boxes(blocks);
    let directions: Vec<OnceCell<FaceDirections>> = blocks.iter().map(|_| OnceCell::new()).collect();
    for pair in pairs.iter_mut().filter(|pair| pair.blocks.iter().all(|&block| blocks[block].is_convex())) {
        let [a, b] = pair.blocks.map(|block| directions[block].get_or_init(|| FaceDirections::of(blocks[block])));
        pair.most = pair.most.min(faces::depth_bound(a, b));
    }
    // What is proved to be apart is no overlap.
    pairs.retain(|pair| pair.most > 0.0);
    pairs.sort_by(|one, two| two.most.total_cmp(&one.most).then(one.blocks.cmp(&two.blocks)));
    // The greatest depth that some pair is proved to have, and the pairs that may be as deep.
    let mut proved = 0.0f64;
    for pair in &mut pairs {
        if pair.most < proved {
            break;
        }
        let [a, b] = pair.blocks.map(|k| blocks[k]);
        if a.is_convex() && b.is_convex() {
            let (least, most) = convex::rough_depth(&LatticePair::new(a, b));
            pair.most = pair.most.min(most);
            proved = proved.max(least);
        }
    }
    pairs.retain(|pair| pair.most >= proved);
    pairs.sort_by_key(|pair| pair.blocks);
    let (mut best, mut left_out): (Option<Deepest>, usize) = (None, 0);
    for Candidate { blocks: [i, j], .. } in pairs {
        match penetration(blocks[i], blocks[j]) {
            None => left_out += 1,
            Some(found) if found.gap.sign.is_negative() => {
                let deeper = |best: &Deepest| found.depth_squared() > best.penetration.depth_squared();
                if best.as_ref().is_none_or(deeper) {
                    best = Some(Deepest { blocks: [i, j], penetration: found });
                }
            }
            Some(_) => {}
        }
    }
    (best, left_out)
}

/// Two blocks whose boxes overlap.
struct Candidate {
    blocks: [usize; 2],
    /// They are certainly no deeper (m).
    most: f64,
}

/// Pairs whose boxes share more than their surfaces.
fn overlapping_boxes(blocks: &[&Block]) -> Vec<Candidate> {
    // Numbers are rounded to nearest, so an end that f64 puts beyond another is not before it.
    let boxes: Vec<[[f64; 2]; 3]> = blocks
        .iter()
        .map(|block| {
            let bounds = block.bounds();
            let ends = |k: usize| [bounds.min.components()[k].approximate(), bounds.max.components()[k].approximate()];
            [ends(0), ends(1), ends(2)]
        })
        .collect();
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    order.sort_by(|&i, &j| boxes[i][0][0].total_cmp(&boxes[j][0][0]));
    let mut found = Vec::new();
    for (place, &i) in order.iter().enumerate() {
        for &j in order[place + 1..].iter().take_while(|&&j| boxes[j][0][0] <= boxes[i][0][1]) {
            let common = |k: usize| boxes[i][k][1].min(boxes[j][k][1]) - boxes[i][k][0].max(boxes[j][k][0]);
            let apart =
                (0..3).any(|k| common(k) < 0.0 || (common(k) == 0.0 && exactly_apart([blocks[i], blocks[j]], k)));
            if apart {
                continue;
            }
            let convex = blocks[i].is_convex() && blocks[j].is_convex();
            let out = |k: usize| (boxes[i][k][1] - boxes[j][k][0]).min(boxes[j][k][1] - boxes[i][k][0]);
            // A few roundings of the ends and of their difference.
            let size = boxes[i].iter().chain(&boxes[j]).flatten().fold(0.0f64, |most, end| most.max(end.abs()));
            let most = if convex {
                (0..3).map(out).fold(f64::INFINITY, f64::min) + 4.0 * f64::EPSILON * size
            } else {
                f64::INFINITY
            };
            found.push(Candidate { blocks: [i.min(j), i.max(j)], most });
        }
    }
    found
}

/// Whether two boxes share no more than their surfaces along an axis, exactly.
fn exactly_apart(blocks: [&Block; 2], axis: usize) -> bool {
    let [one, two] = blocks.map(|block| {
        let bounds = block.bounds();
        [(*bounds.min.components()[axis]).clone(), (*bounds.max.components()[axis]).clone()]
    });
    one[1] <= two[0] || two[1] <= one[0]
}

/// Two blocks with their vertices on a common lattice.
struct LatticePair<'a> {
    blocks: [&'a Block; 2],
    /// Vertices in lattice units.
    points: [Vec<Vec3<BigInt>>; 2],
    /// Lattice units per metre.
    scale: (BigInt, BigInt),
}

impl<'a> LatticePair<'a> {
    fn new(a: &'a Block, b: &'a Block) -> LatticePair<'a> {
        let lattice = Lattice::covering(a.coordinates().chain(b.coordinates()));
        let units = |block: &Block| block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect();
        LatticePair { blocks: [a, b], points: [units(a), units(b)], scale: lattice.units_per_metre() }
    }

    /// A point given in m, in lattice units; `None` where a coordinate is no number.
    fn in_units(&self, point: [f64; 3]) -> Option<Vec3<BigRational>> {
        let (units, metres) = &self.scale;
        let coordinate = |c: f64| Some(BigRational::from_float(c)? * units / metres);
        Some(Vec3::new(coordinate(point[0])?, coordinate(point[1])?, coordinate(point[2])?))
    }

    /// A squared length in m², from lattice units squared.
    fn square_metres(&self, numerator: BigInt, denominator: BigInt) -> BigRational {
        let (units, metres) = &self.scale;
        BigRational::new(numerator * metres * metres, denominator * units * units)
    }
}

/// The f64 next to a lattice number, infinite beyond their range.
fn near(value: &BigInt) -> f64 {
    value.to_f64().unwrap_or(f64::INFINITY)
}

/// Compares two fractions with denominators above zero.
fn compare((n1, d1): (&BigInt, &BigInt), (n2, d2): (&BigInt, &BigInt)) -> Ordering {
    (n1 * d2).cmp(&(n2 * d1))
}
