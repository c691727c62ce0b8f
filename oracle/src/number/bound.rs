use super::{INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use rockproof_model::Ring;

/// A static error bound: what is known about a value before it is calculated.
///
/// Stands for every pair of an exact value x and a calculated one y with |x|, |y| ≤ `magnitude` and
/// |x − y| ≤ `error`. Evaluating a predicate on bounds gives a bound that holds for every evaluation in
/// [`super::Approx`] whose inputs are within the bounds of the inputs (in the manner of Shewchuk 1997 and of
/// Mehlhorn and Näher's static filters). Overflow makes a bound infinite or NaN, and no value is above that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bound {
    /// Bounds the exact and the calculated value.
    pub(crate) magnitude: f64,
    /// Bounds their distance.
    pub(crate) error: f64,
}

impl Bound {
    /// A value calculated as `value` with at most `error` of error.
    pub(crate) fn around(value: f64, error: f64) -> Bound {
        Bound { magnitude: (value.abs() + error) * INFLATION, error }
    }

    /// The result of rounding once a value that is at most `magnitude` and already off by `error`.
    #[inline]
    fn rounded(magnitude: f64, error: f64) -> Bound {
        Bound {
            magnitude: magnitude * INFLATION + UNDERFLOW,
            error: (error + magnitude * UNIT_ROUNDOFF) * INFLATION + UNDERFLOW,
        }
    }
}

impl Ring for Bound {
    #[inline]
    fn from_i32(value: i32) -> Self {
        Bound { magnitude: f64::from(value).abs(), error: 0.0 }
    }
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        // `rounded` allows one unit of roundoff of `magnitude`; a computed sum may exceed the sum of the magnitudes by
        // that unit, which INFLATION covers.
        Bound::rounded(self.magnitude + other.magnitude, self.error + other.error)
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(other)
    }
    #[inline]
    fn times(&self, other: &Self) -> Self {
        // |xy − x'y'| ≤ |x||y − y'| + |y'||x − x'|
        Bound::rounded(self.magnitude * other.magnitude, self.magnitude * other.error + other.magnitude * self.error)
    }
    #[inline]
    fn negated(&self) -> Self {
        *self
    }
}
