use super::{INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use rockproof_model::{Ring, Sign};

/// A midpoint and a radius: the exact value is within `radius` of `middle`.
///
/// The second level of the cascade: its bound follows the values that actually occur, and operations that round nothing
/// add nothing, so that values of few binary digits stay exact and even ties are decided. Overflow gives an infinite or
/// NaN radius, which decides nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    /// The calculated value.
    pub(crate) middle: f64,
    /// Bounds the distance to the exact one.
    pub(crate) radius: f64,
}

impl Ball {
    /// The sign, if every value of the ball has the same one.
    #[inline]
    pub(crate) fn certain_sign(self) -> Option<Sign> {
        if self.middle > self.radius {
            Some(Sign::Positive)
        } else if self.middle < -self.radius {
            Some(Sign::Negative)
        } else if self.middle == 0.0 && self.radius == 0.0 {
            Some(Sign::Zero)
        } else {
            None
        }
    }

    /// At least the size of every value of the ball.
    #[inline]
    pub(crate) fn size(self) -> f64 {
        (self.middle.abs() + self.radius) * INFLATION
    }

    /// `middle` is one rounding away from a value that is off by `error`.
    ///
    /// Nothing is added for underflow when nothing was rounded at all, so that exact zeros stay exact.
    #[inline]
    fn rounded(middle: f64, error: f64) -> Ball {
        Ball { middle, radius: (error + middle.abs() * UNIT_ROUNDOFF) * INFLATION }
    }
}

/// Significant binary digits of a number, from the first to the last that is not zero; more than there are for zero and
/// subnormal numbers, which have no first digit that goes without saying. Means nothing of infinity and NaN.
#[inline]
fn digits(value: f64) -> u32 {
    let bits = value.to_bits();
    53 - (bits | 1 << 52).trailing_zeros()
}

/// Whether `product` is the product of the two and not a rounding of it. May say no of some that are.
#[inline]
fn product_is_exact(one: f64, other: f64, product: f64) -> bool {
    // Below, the last digit of the product might be lost to underflow.
    const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64;
    digits(one) + digits(other) <= 53 && product.abs() >= SAFE && product.is_finite()
}

/// Whether `sum` is the sum of the two and not a rounding of it: the error that two-sum (Knuth 1969) finds is zero. An
/// overflow leaves no number as error.
#[inline]
pub(crate) fn sum_is_exact(one: f64, other: f64, sum: f64) -> bool {
    let from_other = sum - one;
    (one - (sum - from_other)) + (other - from_other) == 0.0
}

impl Ring for Ball {
    #[inline]
    fn from_i32(value: i32) -> Self {
        Ball { middle: f64::from(value), radius: 0.0 }
    }
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        // A floating-point sum never underflows to something inexact. The radius may: its rounding error is below
        // 2⁻¹⁰⁷⁵, and a nonzero one is kept above that by UNDERFLOW in `times`.
        let (sum, error) = (self.middle + other.middle, self.radius + other.radius);
        if sum_is_exact(self.middle, other.middle, sum) {
            return Ball { middle: sum, radius: error * INFLATION };
        }
        Ball::rounded(sum, error)
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negated())
    }
    #[inline]
    fn times(&self, other: &Self) -> Self {
        let exact_zero = (self.middle == 0.0 && self.radius == 0.0) || (other.middle == 0.0 && other.radius == 0.0);
        if exact_zero {
            return Ball { middle: 0.0, radius: 0.0 };
        }
        let product = self.middle * other.middle;
        if self.radius == 0.0 && other.radius == 0.0 && product_is_exact(self.middle, other.middle, product) {
            return Ball { middle: product, radius: 0.0 };
        }
        let error = self.middle.abs() * other.radius + other.middle.abs() * self.radius + self.radius * other.radius;
        let product = Ball::rounded(product, error);
        Ball { middle: product.middle, radius: product.radius + UNDERFLOW }
    }
    #[inline]
    fn negated(&self) -> Self {
        Ball { middle: -self.middle, radius: self.radius }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    fn rational(value: f64) -> BigRational {
        BigRational::from_float(value).unwrap()
    }

    #[test]
    fn nothing_is_called_exact_that_was_rounded() {
        let tiny = f64::MIN_POSITIVE;
        let odd = [1.0, 3.0, 1.0 + f64::EPSILON, 0.1, 5e-324, tiny, tiny * 3.0, 1e300, 2f64.powi(-540), 67_108_863.0];
        let (mut exact, mut rounded) = (0, 0);
        for x in odd {
            for y in odd.into_iter().flat_map(|y| [y, -y, y * 2f64.powi(-30), y * 2f64.powi(27)]) {
                let (sum, product) = (x + y, x * y);
                if sum.is_finite() && sum_is_exact(x, y, sum) {
                    assert_eq!(rational(sum), rational(x) + rational(y), "{x} + {y}");
                    exact += 1;
                } else {
                    rounded += 1;
                }
                if product_is_exact(x, y, product) {
                    assert_eq!(rational(product), rational(x) * rational(y), "{x} * {y}");
                    exact += 1;
                } else {
                    rounded += 1;
                }
            }
        }
        assert!(exact > 100 && rounded > 100, "{exact} exact, {rounded} rounded");
        assert!(!sum_is_exact(f64::MAX, f64::MAX, f64::INFINITY));
    }

    #[test]
    fn a_sum_is_exact_just_where_nothing_was_lost() {
        // The loss of the larger part alone, of the smaller alone, and both at once; some add up to nothing by mistake.
        let mut pairs = vec![(2.0 - f64::EPSILON, 2.0 * f64::EPSILON), (3.0, 2f64.powi(54))];
        for k in -4..=4 {
            let one = 1.0 + f64::from(k) * f64::EPSILON;
            for j in 1..=9 {
                let far = (50..=56).map(|exponent| 2f64.powi(exponent)).chain([f64::EPSILON / 2.0]);
                pairs.extend(far.map(|unit| (one, f64::from(j) * unit)));
            }
        }
        for (x, y) in pairs {
            for (x, y) in [(x, y), (y, x), (x, -y), (-x, y), (y, -x), (-y, x), (-x, -y), (-y, -x)] {
                let exact = rational(x + y) == rational(x) + rational(y);
                assert_eq!(sum_is_exact(x, y, x + y), exact, "{x:e} + {y:e}");
            }
        }
    }

    #[test]
    fn a_sign_is_certain_beyond_the_radius_only() {
        let sign = |middle: f64, radius: f64| Ball { middle, radius }.certain_sign();
        for scale in [1.0, f64::MIN_POSITIVE, 1e300] {
            assert_eq!(sign(scale, scale), None);
            assert_eq!(sign(-scale, scale), None);
            assert_eq!(sign(scale, scale.next_down()), Some(Sign::Positive));
            assert_eq!(sign(-scale, scale.next_down()), Some(Sign::Negative));
            assert_eq!(sign(0.0, scale), None);
        }
        assert_eq!(sign(1.0, f64::NAN), None);
        assert_eq!(sign(0.0, 0.0), Some(Sign::Zero));
    }

    #[test]
    fn ties_of_few_digits_are_decided() {
        let ball = |middle| Ball { middle, radius: 0.0 };
        let (a, b) = (ball(1.25), ball(-3.75));
        assert_eq!(a.times(&ball(3.0)).plus(&b).certain_sign(), Some(Sign::Zero));
        let third = ball(1.0 + f64::EPSILON).times(&ball(1.0 + f64::EPSILON));
        assert_eq!(third.minus(&ball(1.0 + 2.0 * f64::EPSILON)).certain_sign(), None);
    }
}
