//! A number in f64 with a bound on its error: what decides most comparisons of [`super::LazyWide`].
//!
//! Sums, products, quotients and roots that f64 holds exactly keep an exact operand's radius of nothing. The oracle has balls like these; neither
//! side uses the other's arithmetic, so there are two.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg};

/// Half the distance from 1 to the next f64: the relative error of one rounding to nearest.
const UNIT: f64 = f64::EPSILON / 2.0;
/// Makes up for the roundings made in calculating a radius: none below has more than ten operations, each off by at most [`UNIT`] of what it gives.
const MORE: f64 = 1.0 + 16.0 * f64::EPSILON;
/// More than underflow may take away: 2⁻¹⁰⁷⁵ from each of these operations and from each of the middle's.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;

/// The number meant lies within `radius` of `middle`. A radius that is not finite says nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub(super) middle: f64,
    pub(super) radius: f64,
}

impl Ball {
    pub(super) const UNKNOWN: Ball = Ball { middle: 0.0, radius: f64::NAN };

    /// This very number, if it is one.
    pub(super) fn exact(middle: f64) -> Ball {
        if middle.is_finite() { Ball { middle, radius: 0.0 } } else { Ball::UNKNOWN }
    }

    /// A number that was rounded to `middle` once.
    pub(super) fn nearest(middle: f64) -> Ball {
        Ball::rounded(middle, 0.0)
    }

    /// Whether the middle is the number meant. A ball of this radius was exact all along: every radius of a rounded value is positive.
    pub(super) fn is_exact(self) -> bool {
        self.radius == 0.0
    }

    pub(super) fn is_bounded(self) -> bool {
        self.radius.is_finite() && self.middle.is_finite()
    }

    /// The middle is one rounding away from a number that is within `error` of the one meant.
    fn rounded(middle: f64, error: f64) -> Ball {
        Ball { middle, radius: (error + middle.abs() * UNIT) * MORE + UNDERFLOW }
    }

    /// The order of the two, where it is certain. Two exact numbers are always ordered.
    pub(super) fn order(self, other: Ball) -> Option<Ordering> {
        if self.is_exact() && other.is_exact() {
            return self.middle.partial_cmp(&other.middle);
        }
        let difference = self.middle - other.middle;
        // The difference of the middles is rounded, too.
        let doubt = Ball::rounded(difference, self.radius + other.radius).radius;
        if difference > doubt {
            Some(Ordering::Greater)
        } else if difference < -doubt {
            Some(Ordering::Less)
        } else {
            None
        }
    }

    /// Holds both numbers.
    pub(super) fn covering(self, other: Ball) -> Ball {
        let apart = (self.middle - other.middle).abs();
        Ball { middle: self.middle, radius: (self.radius + other.radius + apart) * MORE + UNDERFLOW }
    }

    pub(super) fn magnitude(self) -> Ball {
        Ball { middle: self.middle.abs(), ..self }
    }

    pub(super) fn root(self) -> Ball {
        if self.is_exact() && self.middle == 0.0 {
            return self;
        }
        // What may be negative may have no root.
        if self.middle.is_nan() || self.radius.is_nan() || self.middle <= self.radius {
            return Ball::UNKNOWN;
        }
        let root = self.middle.sqrt();
        if self.is_exact() && product_is_exact(root, root, self.middle) {
            return Ball { middle: root, radius: 0.0 };
        }
        // |√y − √x| = |y − x| / (√y + √x) ≤ |y − x| / √x, and the root calculated is √x but for one rounding.
        Ball::rounded(root, self.radius / root)
    }
}

/// Binary digits from the first to the last that is not zero; at least so many. Means nothing of infinity and NaN.
fn digits(value: f64) -> u32 {
    53 - (value.to_bits() | 1 << 52).trailing_zeros()
}

/// Whether `product` is that of the two and not a rounding of it. May say no of some that are.
fn product_is_exact(one: f64, other: f64, product: f64) -> bool {
    // Below, the last digit might be lost to underflow.
    const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64;
    digits(one) + digits(other) <= 53 && product.abs() >= SAFE && product.is_finite() && one * other == product
}

impl Neg for Ball {
    type Output = Ball;
    fn neg(self) -> Ball {
        Ball { middle: -self.middle, ..self }
    }
}

impl Add for Ball {
    type Output = Ball;
    fn add(self, other: Ball) -> Ball {
        let (one, two) = (self.middle, other.middle);
        let (sum, error) = (one + two, self.radius + other.radius);
        // What the sum lost (Knuth's two-sum): it is no number where the sum is none.
        let from_two = sum - one;
        let lost = (one - (sum - from_two)) + (two - from_two);
        if lost == 0.0 && error == 0.0 {
            return Ball { middle: sum, radius: 0.0 };
        }
        Ball::rounded(sum, error)
    }
}

impl Mul for Ball {
    type Output = Ball;
    fn mul(self, other: Ball) -> Ball {
        let (one, two) = (self.middle, other.middle);
        let product = one * two;
        let is_zero = |ball: Ball| ball.is_exact() && ball.middle == 0.0;
        if (is_zero(self) && other.is_bounded()) || (is_zero(other) && self.is_bounded()) {
            return Ball { middle: 0.0, radius: 0.0 };
        }
        if self.is_exact() && other.is_exact() && product_is_exact(one, two, product) {
            return Ball { middle: product, radius: 0.0 };
        }
        let error = one.abs() * other.radius + two.abs() * self.radius + self.radius * other.radius;
        Ball::rounded(product, error)
    }
}

impl Div for Ball {
    type Output = Ball;
    fn div(self, other: Ball) -> Ball {
        let (one, two) = (self.middle, other.middle);
        let least = two.abs() - other.radius;
        if least.is_nan() || least <= 0.0 {
            return Ball::UNKNOWN;
        }
        let quotient = one / two;
        if self.is_exact() && other.is_exact() && (one == 0.0 || product_is_exact(quotient, two, one)) {
            return Ball { middle: quotient, radius: 0.0 };
        }
        // |(A+α)/(B+β) − A/B| ≤ (|α| + |A/B|·|β|) / (|B| − |β|); A/B is the quotient calculated, but for a rounding. What underflow takes from
        // the dividend counts as often as that is divided.
        let size = quotient.abs() * MORE + UNDERFLOW;
        Ball::rounded(quotient, (self.radius + size * other.radius + UNDERFLOW) / least)
    }
}
