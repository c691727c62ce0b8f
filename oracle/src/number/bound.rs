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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Approx;
    use num_rational::BigRational;
    use num_traits::Signed;

    fn rational(value: f64) -> BigRational {
        BigRational::from_float(value).unwrap()
    }

    /// Each operation by itself, on numbers whose rounding loses all that it may, and on inputs off by all that they may be.
    #[test]
    fn one_operation_is_never_further_off_than_its_bound() {
        let u = UNIT_ROUNDOFF;
        let values =
            [1.0, -1.0, u, 1.0 + 2.0 * u, 1.0 + f64::powi(2.0, -26), 3.0, 0.1, 1e-200, f64::MIN_POSITIVE, 1e-320];
        let errors = [0.0, u, 1e-3, 1e-210];
        let mut closest: f64 = 0.0;
        let mut check = |bound: Bound, calculated: Approx, exact: BigRational| {
            let off = (rational(calculated.0) - &exact).abs();
            assert!(off <= rational(bound.error), "{calculated:?} is off by {off} for {exact}, {bound:?}");
            assert!(
                rational(calculated.0).abs() <= rational(bound.magnitude) && exact.abs() <= rational(bound.magnitude)
            );
            closest = closest.max(calculated.0.abs() * u / bound.error);
        };
        let all = || values.into_iter().flat_map(move |v| errors.into_iter().map(move |e| (v, e)));
        for (x, e) in all() {
            for (y, d) in all() {
                let bounds = [Bound::around(x, e), Bound::around(y, d)];
                for sign in [1.0, -1.0] {
                    let (exact_x, exact_y) = (rational(x) + rational(sign * e), rational(y) + rational(d));
                    let (a, b) = (Approx(x), Approx(y));
                    check(bounds[0].plus(&bounds[1]), a.plus(&b), &exact_x + &exact_y);
                    check(bounds[0].minus(&bounds[1]), a.minus(&b), &exact_x - &exact_y);
                    check(bounds[0].times(&bounds[1]), a.times(&b), exact_x * exact_y);
                }
            }
        }
        assert!(closest > 0.9, "no bound is used up: {closest}");
    }
}
