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

/// How far coordinates that are no f64s may be off, per size of the pair: they may lie sixteen sizes from the origin.
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
