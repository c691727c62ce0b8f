//! Static error bounds that hold for every pair of unit size, known once for the whole process.
//!
//! A polynomial of degree n whose lengths are all at most M has at most `M^n` times the error it has where they are at
//! most 1: every rounding is relative, so dividing all lengths by M divides every intermediate value of degree k and
//! its error by `M^k`. (A power of two would make that exact; for other M think of bounds, not of values: those are
//! products and sums of magnitudes, and homogeneous.) Underflow is not relative. M is kept within `2^±50`: then an
//! underflow of 2⁻¹⁰⁷⁵ in a value of degree k ≤ 14 is below 2⁻³²² of `u·M^k`, far less than the inflation of a bound.

use crate::number::{Approx, UNIT_ROUNDOFF};
use crate::pair::Pair;
use crate::predicate::{LARGEST_DEGREE, Polynomial, SLOTS};
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

/// What bounds for unit size are multiplied by: the powers of a pair's size; infinite where the bounds do not apply.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizePowers {
    /// Of the size of both blocks together.
    joint: [f64; LARGEST_DEGREE + 1],
    /// Of the size of the larger block.
    within: [f64; LARGEST_DEGREE + 1],
}

impl SizePowers {
    fn of_sizes(joint: f64, within: f64) -> SizePowers {
        let mut powers = SizePowers { joint: [1.0; LARGEST_DEGREE + 1], within: [1.0; LARGEST_DEGREE + 1] };
        for k in 1..=LARGEST_DEGREE {
            powers.joint[k] = powers.joint[k - 1] * joint;
            powers.within[k] = powers.within[k - 1] * within;
        }
        powers
    }

    /// Whether the bounds apply at all.
    #[inline(always)]
    pub(crate) fn apply(&self) -> bool {
        self.joint[0] <= 1.0
    }

    /// What the bounds of a polynomial are multiplied by.
    #[inline(always)]
    pub(crate) fn of<P: Polynomial>(&self) -> f64 {
        if P::WITHIN_BLOCKS { self.within[P::DEGREE] } else { self.joint[P::DEGREE] }
    }
}

/// The bounds that hold for a pair of size M, and the powers of M to multiply them by.
pub(crate) fn unit_bounds_for(pair: &Pair<'_>, scales: &Scales<Approx>) -> (&'static UnitBounds, SizePowers) {
    const SMALLEST: f64 = 1.0 / (1u64 << 50) as f64;
    const LARGEST: f64 = (1u64 << 50) as f64;
    let longest_loop = pair.a.longest_loop().max(pair.b.longest_loop());
    let lengths = [scales.search, scales.territory, scales.penetration].map(|l| l.0);
    let [size, within] = [joint_extent(pair.a, pair.b), joint_extent(pair.a, pair.a).max(joint_extent(pair.b, pair.b))]
        .map(|extent| lengths.into_iter().fold(extent, f64::max) * (1.0 + 1e-12));
    let ratios = [scales.overlap, scales.parallel, scales.equal].map(|r| r.0);
    let coordinate = pair.a.errors.coordinate.max(pair.b.errors.coordinate);
    // Half, for the roundings in this very comparison; nothing is nothing.
    let bounds = BOUNDS.iter().find(|b| longest_loop <= b.longest_loop && coordinate <= size * b.coordinate * 0.5);
    // Written so that NaN anywhere ends as "does not apply".
    let applies = bounds.is_some() && (SMALLEST..=LARGEST).contains(&size) && ratios.into_iter().all(|r| r <= 1.0);
    let bounds = bounds.unwrap_or(&BOUNDS[0]);
    if !applies {
        let infinite = [f64::INFINITY; LARGEST_DEGREE + 1];
        return (bounds, SizePowers { joint: infinite, within: infinite });
    }
    let within = if within >= SMALLEST && coordinate <= within * bounds.coordinate * 0.5 { within } else { size };
    (bounds, SizePowers::of_sizes(size, within))
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
        let (bounds, powers) = bounds_and_powers(blocks, lengths, ratios);
        if powers.joint.iter().all(|power| power.is_infinite()) {
            assert!(!powers.apply() && powers.within.iter().all(|power| power.is_infinite()));
            return None;
        }
        Some(([bounds.longest_loop as f64, bounds.coordinate], powers.joint.to_vec()))
    }

    fn bounds_and_powers(
        blocks: &[Block; 2],
        lengths: [f64; 3],
        ratios: [f64; 3],
    ) -> (&'static UnitBounds, SizePowers) {
        let [a, b] = [0, 1].map(|k: usize| PreparedBlock::new(&blocks[k]));
        let ([search, territory, penetration], [overlap, parallel, equal]) = (lengths.map(Approx), ratios.map(Approx));
        let (unit, whole, one) = (Approx(1.0), Approx(1.0), Approx(1.0));
        let scales = Scales { unit, search, territory, penetration, one, overlap, parallel, whole, equal };
        unit_bounds_for(&Pair::new(&a, &b), &scales)
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
    fn within_blocks_the_size_is_that_of_the_larger_block() {
        let powers = |cubes: &[Block; 2], lengths| bounds_and_powers(cubes, lengths, NO_RATIOS).1;
        let near = |power: f64, exact: f64| (exact..=exact * (1.0 + 2e-11)).contains(&power);
        let of_one = powers(&cubes(&whole(0), &whole(1)), NO_LENGTHS);
        assert!(near(of_one.joint[3], 8.0) && near(of_one.within[3], 1.0), "{of_one:?}");
        // Tolerances enter there, too.
        let of_tolerance = powers(&cubes(&whole(0), &whole(1)), [0.0, 1.5, 0.0]);
        assert!(near(of_tolerance.joint[3], 8.0) && near(of_tolerance.within[3], 3.375), "{of_tolerance:?}");
        // Fractions that are held within eight sizes of the pair, but not of a block.
        let third = BigRational::new(1.into(), 3.into());
        for (x, held) in [(1, true), (4, false)] {
            let of_thirds = powers(&cubes(&whole(x), &third), NO_LENGTHS);
            assert!(
                of_thirds.apply() && near(of_thirds.within[1], if held { 1.0 } else { 2.0 } / 3.0),
                "at {x}: {of_thirds:?}"
            );
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
