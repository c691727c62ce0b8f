//! Static error bounds that hold for every pair of unit size, known once for the whole process.
//!
//! A polynomial of degree n whose lengths are all at most M has at most `M^n` times the error it has where they are at
//! most 1: every rounding is relative, so dividing all lengths by M divides every intermediate value of degree k and
//! its error by `M^k`. (A power of two would make that exact; for other M think of bounds, not of values: those are
//! products and sums of magnitudes, and homogeneous.) Underflow is not relative. M is kept within `2^±50`: then an
//! underflow of 2⁻¹⁰⁷⁵ in a value of degree k ≤ 14 is below 2⁻³²² of `u·M^k`, far less than the inflation of a bound.

use crate::number::{Approx, UNIT_ROUNDOFF};
use crate::pair::Pair;
use crate::predicate::{LARGEST_DEGREE, SLOTS};
use crate::view::{Scales, joint_extent};
use std::sync::atomic::{AtomicU64, Ordering};

/// One bound a slot, for faces of at most `longest_loop` vertices and coordinates off by at most `coordinate`.
pub(crate) struct UnitBounds {
    pub(crate) longest_loop: usize,
    pub(crate) coordinate: f64,
    // Written at most a few times each, always with the same value; NaN until then.
    bounds: [AtomicU64; SLOTS],
}

impl UnitBounds {
    const fn new(longest_loop: usize, coordinate: f64) -> UnitBounds {
        UnitBounds { longest_loop, coordinate, bounds: [const { AtomicU64::new(f64::NAN.to_bits()) }; SLOTS] }
    }

    /// The bound, or NaN if nobody has asked for it yet.
    #[inline(always)]
    pub(crate) fn get(&self, slot: usize) -> f64 {
        f64::from_bits(self.bounds[slot].load(Ordering::Relaxed))
    }

    pub(crate) fn set(&self, slot: usize, bound: f64) {
        self.bounds[slot].store(bound.to_bits(), Ordering::Relaxed);
    }
}

/// How far coordinates that are no f64s may be off, per size of the pair. Half of it is used, so that they may lie some eight sizes from
/// the origin.
const ROUNDED: f64 = 16.0 * UNIT_ROUNDOFF;

/// For coordinates that f64 holds, and for others.
static BOUNDS: [UnitBounds; 6] = [
    UnitBounds::new(4, 0.0),
    UnitBounds::new(8, 0.0),
    UnitBounds::new(32, 0.0),
    UnitBounds::new(4, ROUNDED),
    UnitBounds::new(8, ROUNDED),
    UnitBounds::new(32, ROUNDED),
];

/// The bounds that hold for a pair of size M, and the powers of M to multiply them by: infinite where they do not apply.
pub(crate) fn unit_bounds_for(
    pair: &Pair<'_>,
    scales: &Scales<Approx>,
) -> (&'static UnitBounds, [f64; LARGEST_DEGREE + 1]) {
    const SMALLEST: f64 = 1.0 / (1u64 << 50) as f64;
    const LARGEST: f64 = (1u64 << 50) as f64;
    let longest_loop = pair.a.longest_loop().max(pair.b.longest_loop());
    let lengths = [scales.search, scales.territory, scales.penetration].map(|l| l.0);
    let size = lengths.into_iter().fold(joint_extent(pair.a, pair.b), f64::max) * (1.0 + 1e-12);
    let ratios = [scales.overlap, scales.parallel, scales.equal].map(|r| r.0);
    let coordinate = pair.a.errors.coordinate.max(pair.b.errors.coordinate);
    // Half, for the roundings in this very comparison; nothing is nothing.
    let bounds = BOUNDS.iter().find(|b| longest_loop <= b.longest_loop && coordinate <= size * b.coordinate * 0.5);
    // Written so that NaN anywhere ends as "does not apply".
    let applies = bounds.is_some() && (SMALLEST..=LARGEST).contains(&size) && ratios.into_iter().all(|r| r <= 1.0);
    let mut powers = [if applies { 1.0 } else { f64::INFINITY }; LARGEST_DEGREE + 1];
    for k in 1..powers.len() {
        powers[k] = powers[k - 1] * size;
    }
    (bounds.unwrap_or(&BOUNDS[0]), powers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepared_block::PreparedBlock;
    use num_rational::BigRational;
    use rockproof_model::{Block, BlockOptions, Number, Vec3};

    const NO_LENGTHS: [f64; 3] = [0.0; 3];
    const NO_RATIOS: [f64; 3] = [0.0; 3];

    /// What is found for a pair under tolerances of these lengths and ratios.
    fn found(blocks: &[Block; 2], lengths: [f64; 3], ratios: [f64; 3]) -> Option<([f64; 2], Vec<f64>)> {
        let [a, b] = [0, 1].map(|k: usize| PreparedBlock::new(&blocks[k]));
        let ([search, territory, penetration], [overlap, parallel, equal]) = (lengths.map(Approx), ratios.map(Approx));
        let (unit, whole, one) = (Approx(1.0), Approx(1.0), Approx(1.0));
        let scales = Scales { unit, search, territory, penetration, one, overlap, parallel, whole, equal };
        let (bounds, powers) = unit_bounds_for(&Pair::new(&a, &b), &scales);
        if powers.iter().all(|power| power.is_infinite()) {
            return None;
        }
        Some(([bounds.longest_loop as f64, bounds.coordinate], powers.to_vec()))
    }

    /// Two cubes of this edge side by side, the first at `x` from the origin.
    fn cubes(x: &BigRational, edge: &BigRational) -> [Block; 2] {
        let number = |value: &BigRational| Number::from_rational(value.clone());
        [0, 1].map(|k| {
            let low = x + edge * BigRational::from_integer(k.into());
            let (zero, side) = (Number::ZERO, number(edge));
            let (min, max) =
                (Vec3::new(number(&low), zero.clone(), zero), Vec3::new(number(&(&low + edge)), side.clone(), side));
            Block::cuboid(&min, &max).unwrap()
        })
    }

    fn whole(n: i64) -> BigRational {
        BigRational::from_integer(n.into())
    }

    /// Two prisms one over the other, over a polygon of so many corners on a parabola.
    fn prisms(corners: i32) -> [Block; 2] {
        let n = corners as u32;
        let sides = (0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]);
        let faces: Vec<Vec<u32>> = [(0..n).rev().collect(), (n..2 * n).collect()].into_iter().chain(sides).collect();
        [0, 1].map(|at| {
            let places = [at, at + 1].into_iter().flat_map(|z| (0..corners).map(move |k| [k, k * k, z]));
            let vertices = places.map(|[x, y, z]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c)));
            Block::new(vertices.collect(), faces.clone(), &BlockOptions { planarity: Number::ZERO }).unwrap()
        })
    }

    #[test]
    fn a_bound_is_unknown_until_it_is_set() {
        let bounds = UnitBounds::new(4, 0.0);
        assert!(bounds.get(3).is_nan());
        bounds.set(3, 0.25);
        assert_eq!(bounds.get(3), 0.25);
        assert!(bounds.get(2).is_nan());
    }

    #[test]
    fn powers_are_those_of_the_size_and_a_little_more() {
        let third = BigRational::new(1.into(), 3.into());
        let thirds = cubes(&whole(2), &third);
        // The largest of the pair's extent and the three lengths.
        for (lengths, size) in
            [([1.0 / 3.0; 3], 2.0 / 3.0), ([5.0, 1.0, 0.0], 5.0), ([1.0, 5.0, 0.0], 5.0), ([0.0, 1.0, 5.0], 5.0)]
        {
            let (_, powers) = found(&thirds, lengths, NO_RATIOS).expect("of moderate size");
            assert_eq!(powers.len(), LARGEST_DEGREE + 1);
            let mut exact = 1.0;
            for (degree, power) in powers.into_iter().enumerate() {
                assert!((exact..=exact * (1.0 + 2e-11)).contains(&power), "{power} for {size}^{degree}");
                exact *= size;
            }
        }
    }

    #[test]
    fn fractions_are_held_within_eight_sizes_of_the_origin() {
        let third = BigRational::new(1.into(), 3.into());
        let lengths = [1.0 / 3.0; 3];
        // The pair is 2/3 long; its largest coordinates are 4, 7, 8½, 13, 31 and 150,000 times that.
        for (x, near) in [(2, true), (4, true), (5, false), (8, false), (20, false), (100_000, false)] {
            let bounds = found(&cubes(&whole(x), &third), lengths, NO_RATIOS).map(|(bounds, _)| bounds);
            assert_eq!(bounds, near.then_some([4.0, ROUNDED]), "at {x}");
        }
        // What f64 holds may be anywhere.
        for x in [0, 20, 1 << 30] {
            let (bounds, _) = found(&cubes(&whole(x), &whole(1)), NO_LENGTHS, NO_RATIOS).expect("exact");
            assert_eq!(bounds, [4.0, 0.0], "at {x}");
        }
    }

    #[test]
    fn long_faces_and_sizes_and_ratios_out_of_range_have_no_unit_bound() {
        for (corners, longest) in [(4, Some(4.0)), (5, Some(8.0)), (8, Some(8.0)), (9, Some(32.0)), (33, None)] {
            let bounds = found(&prisms(corners), NO_LENGTHS, NO_RATIOS).map(|(bounds, _)| bounds);
            assert_eq!(bounds, longest.map(|longest| [longest, 0.0]), "{corners} corners");
        }
        // Two edges: a pair of twice this size.
        for (exponent, held) in [(-52, false), (-50, true), (48, true), (50, false)] {
            let edge = whole(2).pow(exponent);
            assert_eq!(found(&cubes(&whole(0), &edge), NO_LENGTHS, NO_RATIOS).is_some(), held, "edges of 2^{exponent}");
        }
        let cubes = cubes(&whole(0), &whole(1));
        assert!(found(&cubes, NO_LENGTHS, [1.0; 3]).is_some());
        for place in 0..3 {
            for ratio in [1.5, f64::NAN] {
                let mut ratios = NO_RATIOS;
                ratios[place] = ratio;
                assert!(found(&cubes, NO_LENGTHS, ratios).is_none(), "{ratios:?}");
            }
        }
    }
}
