use super::{INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use rockproof_model::{Ring, Sign};

/// A midpoint and a radius: the exact value is within `radius` of `middle`.
///
/// The second level of the ladder: its bound follows the values that actually occur, at some four times the cost of
/// plain f64. Overflow gives an infinite or NaN radius, which decides nothing.
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

    /// `middle` is one rounding away from a value that is off by `error`.
    ///
    /// Nothing is added for underflow when nothing was rounded at all, so that exact zeros stay exact.
    #[inline]
    fn rounded(middle: f64, error: f64) -> Ball {
        Ball { middle, radius: (error + middle.abs() * UNIT_ROUNDOFF) * INFLATION }
    }
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
        Ball::rounded(self.middle + other.middle, self.radius + other.radius)
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Ball::rounded(self.middle - other.middle, self.radius + other.radius)
    }
    #[inline]
    fn times(&self, other: &Self) -> Self {
        let exact_zero = (self.middle == 0.0 && self.radius == 0.0) || (other.middle == 0.0 && other.radius == 0.0);
        if exact_zero {
            return Ball { middle: 0.0, radius: 0.0 };
        }
        let error = self.middle.abs() * other.radius + other.middle.abs() * self.radius + self.radius * other.radius;
        let product = Ball::rounded(self.middle * other.middle, error);
        Ball { middle: product.middle, radius: product.radius + UNDERFLOW }
    }
    #[inline]
    fn negated(&self) -> Self {
        Ball { middle: -self.middle, radius: self.radius }
    }
}
