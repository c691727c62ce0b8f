//! The number types in which a step is calculated: each quantity is written once, over [`Field`], and evaluated in
//! whichever type is asked for, so that the cheap levels and the exact one cannot drift apart.
//!
//! | type | what it knows | level |
//! | --- | --- | --- |
//! | [`Ball`](crate::number::Ball) | an f64 and a radius | `f64` |
//! | [`DoubleBall`] | the sum of two f64 and a radius | some 100 bits |
//! | [`WideBall`] | a binary number of as many bits as asked for, and a radius | 128 bits to the cap |
//! | `BigRational` | the value itself | exact |

mod double;
mod exact;
mod float;
#[cfg(test)]
mod operation_tests;
mod packed;
#[cfg(test)]
mod tests;
mod upper_bound;
mod wide;

pub(crate) use double::DoubleBall;
pub(crate) use packed::{LANES, Packed, PackedBalls, PackedDoubleBalls, packed_vector, single_vector};
pub(crate) use upper_bound::UpperBound;
pub(crate) use wide::WideBall;

use crate::mass::Integrals;
use num_bigint::BigInt;
use num_rational::BigRational;
pub(crate) use rockproof_model::number::dyadic;
use rockproof_model::number::exact_log2;
use rockproof_model::{Number, Ring, Sign, Topology, Vec3};

/// A ring in which numbers can be halved.
pub(crate) trait Halve: Ring {
    /// `self / 2`.
    fn half(&self) -> Self;
}

/// Real numbers, known exactly or within an enclosure that always holds the exact value.
///
/// Every operation on enclosures gives an enclosure of the result for all values the operands may have. `None` says
/// that this type cannot tell, never that no result exists.
pub(crate) trait Field: Halve {
    /// The enclosure of a fraction to `bits` significant bits, as far as the type goes.
    fn of_rational(value: &BigRational, bits: u32) -> Self;

    /// The enclosure of an exact number.
    fn of_number(value: &Number, bits: u32) -> Self {
        Self::of_rational(&value.to_rational(), bits)
    }

    /// The enclosure of `a − b`: formed before anything is rounded, so that a far origin costs nothing.
    fn of_difference(a: &Number, b: &Number, bits: u32) -> Self {
        Self::of_number(&a.plus(&b.negated()), bits)
    }

    /// `self / divisor`; `None` where the divisor may be zero.
    fn over(&self, divisor: &Self) -> Option<Self>;

    /// `√self`; `None` where the value may be negative, or where the type has no such number.
    fn root(&self) -> Option<Self>;

    /// The sign, where all values enclosed have the same.
    fn certain_sign(&self) -> Option<Sign>;

    /// The fraction this is, or lies next to: the middle of the enclosure, exactly.
    fn middle(&self) -> BigRational;

    /// At least the distance of the value from [`Field::middle`]; `None` where nothing is known.
    fn radius(&self) -> Option<UpperBound>;

    /// An f64 near the value and at least its distance from it; infinite or NaN where f64 does not reach.
    fn nearby(&self) -> (f64, f64);

    /// At least the size of every value enclosed; `None` where nothing is known, or where values are known exactly.
    fn magnitude_bound(&self) -> Option<UpperBound>;

    /// All values no larger than `size`; `None` where this type has no such enclosure.
    fn within(size: UpperBound) -> Option<Self>;

    /// The lesser of the two, of equal ones either. Where this type cannot tell which is less, an enclosure of both answers.
    fn lesser(&self, other: &Self) -> Option<Self> {
        let excess = self.minus(other);
        match excess.certain_sign() {
            Some(Sign::Positive) => Some(other.clone()),
            Some(_) => Some(self.clone()),
            // min(a, b) = a − max(0, a − b).
            None => Some(self.plus(&Self::within(excess.magnitude_bound()?)?)),
        }
    }

    /// `√self` of a value known to be a square: also where its enclosure reaches zero or below.
    fn root_of_square(&self) -> Option<Self> {
        self.root().or_else(|| Self::within(self.magnitude_bound()?.root()))
    }

    /// The integrals of a block whose vertices are at these points.
    fn integrals(points: &[Vec3<Self>], topology: &Topology) -> Integrals<Self> {
        Integrals::of(points, topology)
    }

    /// Whether the value is certainly zero: it may be left out of sums.
    fn is_zero(&self) -> bool {
        self.certain_sign() == Some(Sign::Zero)
    }
}

/// The integer nearest to `value · 2^exponent`, halves away from zero.
pub(crate) fn nearest_units(value: &BigRational, exponent: i64) -> BigInt {
    let Some(twos) = exact_log2(value.denom()) else {
        return (value * dyadic(BigInt::from(1), exponent)).round().to_integer();
    };
    let numerator = value.numer().magnitude();
    // Over a power of two no division is needed.
    let places = twos as i64 - exponent;
    let units = match places {
        ..=0 => numerator << places.unsigned_abs(),
        _ => ((numerator >> (places - 1)) + 1u32) >> 1,
    };
    BigInt::from_biguint(value.numer().sign(), units)
}
