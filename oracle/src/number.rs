//! The number types a predicate is evaluated in, cheapest first.
//!
//! One predicate, written once over [`rockproof_model::Ring`], runs in all of them:
//! [`Approx`] with a [`Bound`] on its error, then [`Ball`], then integers as wide as [`Bits`] says are needed.

mod approx;
mod ball;
mod bits;
mod bound;
mod fixed;
mod int128;
mod magnitude;

pub(crate) use approx::{Approx, larger, smaller};
pub(crate) use ball::{Ball, sum_is_exact};
pub(crate) use bits::Bits;
pub(crate) use bound::Bound;
pub(crate) use fixed::Fixed;
pub(crate) use int128::Int128;
pub(crate) use magnitude::Magnitude;

/// Half the distance from 1 to the next f64: the relative error of one rounding to nearest.
pub(crate) const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Makes up for the roundings made while an error bound itself is calculated: each of them loses at most
/// [`UNIT_ROUNDOFF`], and no formula below has more than 14 of them.
pub(crate) const INFLATION: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Above any error that gradual underflow adds to one operation (2⁻¹⁰⁷⁵), with room for the bound's own underflow.
pub(crate) const UNDERFLOW: f64 = f64::MIN_POSITIVE;
/// The least number above zero: twice what one product may lose to underflow.
pub(crate) const SMALLEST_POSITIVE: f64 = f64::from_bits(1);
