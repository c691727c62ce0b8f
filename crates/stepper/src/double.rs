//! A scalar of two f64 with a bound on its error: what most comparisons of a step in [`Wide`](crate::wide::Wide) are settled with.
//!
//! It answers as `Wide` does, and counts what it leaves unsettled where that does, in [`crate::wide::count_unsettled`]. It also counts choices that `Wide`
//! makes by middles (`below`): where nothing was counted, every comparison and every choice is the one that `Wide` makes in 512 bits, and `Wide` counts
//! nothing either. Where something was, the work is of no use and has to be done in `Wide`.
//!
//! Why `Wide` counts nothing then: both balls hold the number meant, a comparison is settled here with some 2⁻⁴⁸ of the number to spare, and the radius in
//! `Wide` is smaller by far. For a rounding there adds 2⁻⁵¹⁰ of the result at most, whereas every radius here that is not zero is at least [`LEAST_SHARE`] of
//! its number when an operation ends; and what is exact here has no more than 453 digits, so it is exact there. Solutions of large systems are not covered by
//! that (`dynamics/enclosed_solve.rs`): there a radius is a share of the largest unknown, some 2⁻⁴⁸⁰ in 512 bits, and `Wide` may count a comparison that is settled here.
//! What is settled is the decision of exact arithmetic all the same.

#[cfg(test)]
mod tests;

use crate::dynamics::Enclosing;
use crate::real::Real;
use crate::wide::{Wide, count_one_unsettled, is_given_up};
use rockproof_model::Number;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Makes up for the roundings made in calculating a radius: none below has more than fourteen operations, each off by at most half of [`f64::EPSILON`],
/// and sums below the normal numbers are exact.
const MORE: f64 = 1.0 + 16.0 * f64::EPSILON;
/// Likewise, downwards.
const LESS: f64 = 1.0 - 16.0 * f64::EPSILON;
/// More than underflow may take away in a few operations.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;
/// A product of this size or more, and what rounding takes from it, are normal numbers.
const SAFE: f64 = f64::MIN_POSITIVE * (1u64 << 60) as f64 * (1u64 << 60) as f64;

/// The least radius of what is not exact, as a share of its number, and the least share that the lower part of an exact number may have. Two f64 may
/// hold a number whose digits are further apart than 512 bits reach; `Wide` rounds such a number, so it must not pass for exact, or for better known, here.
const LEAST_SHARE: f64 = f64::from_bits((1023 - 400) << 52);

/// The number meant lies within `radius` of `high` + `low`, where `high` is the f64 nearest to that sum. A radius that is not finite says nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Double {
    high: f64,
    low: f64,
    radius: f64,
}

/// The nearest sum, and what it lost (Knuth), exactly; the latter is no number where the sum is none.
#[inline(always)]
fn two_sum(one: f64, two: f64) -> (f64, f64) {
    let sum = one + two;
    let from_two = sum - one;
    (sum, (one - (sum - from_two)) + (two - from_two))
}

/// Two parts of a number, of at most 26 binary digits each (Veltkamp); no numbers where it is near the largest f64.
#[inline(always)]
fn split(value: f64) -> (f64, f64) {
    let large = value * ((1u64 << 27) + 1) as f64;
    let upper = large - (large - value);
    (upper, value - upper)
}

/// The nearest product, and what it lost (Dekker): exactly where the product is [`SAFE`] or more.
#[inline(always)]
fn two_product(one: f64, two: f64) -> (f64, f64) {
    let product = one * two;
    let ((a, b), (c, d)) = (split(one), split(two));
    (product, ((a * c - product) + a * d + b * c) + b * d)
}

impl Double {
    const UNKNOWN: Double = Double { high: 0.0, low: 0.0, radius: f64::NAN };

    const fn exact(high: f64) -> Double {
        Double { high, low: 0.0, radius: 0.0 }
    }

    /// Whether no operation that led here rounded.
    fn is_exact(self) -> bool {
        self.radius == 0.0
    }

    /// Whether it is zero, and no operation that led here rounded.
    pub(crate) fn is_exact_zero(self) -> bool {
        self.is_exact() && self.high == 0.0
    }

    fn is_known(self) -> bool {
        self.radius + self.high.abs() < f64::INFINITY
    }

    /// The sum of two f64, exactly, as a number that is off by so much, or by [`LEAST_SHARE`] if that is more; by nothing where so much is nothing.
    #[inline(always)]
    fn around((high, low): (f64, f64), error: f64) -> Double {
        let least = high.abs() * LEAST_SHARE;
        let is_rounded = || error != 0.0 || (low != 0.0 && low.abs() < least);
        Double { high, low, radius: if error < least && is_rounded() { least } else { error } }
    }

    /// Not below its magnitude and radius together, but for a few roundings.
    fn size(self) -> f64 {
        self.high.abs() + self.low.abs() + self.radius
    }

    /// How it compares with zero, where that is certain.
    fn settled_sign(self) -> Option<Ordering> {
        if self.is_exact() {
            return self.high.partial_cmp(&0.0);
        }
        // The middle is within half a unit in the last place of its upper part.
        let certain = self.high.abs() * LESS > self.radius;
        certain.then_some(if self.high > 0.0 { Ordering::Greater } else { Ordering::Less })
    }

    /// How it compares with zero; where that is not certain it is counted, and `None`.
    fn counted_sign(self) -> Option<Ordering> {
        let sign = self.settled_sign();
        if sign.is_none() {
            count_one_unsettled();
        }
        sign
    }
}

impl Enclosing for Double {
    fn radius_bound(self) -> f64 {
        self.radius
    }
    fn with_radius(self, radius: f64) -> Double {
        Double::around((self.high, self.low), radius)
    }
    fn is_exact_zero(self) -> bool {
        self.is_exact_zero()
    }
}

impl Neg for Double {
    type Output = Double;
    #[inline]
    fn neg(self) -> Double {
        Double { high: -self.high, low: -self.low, radius: self.radius }
    }
}

impl Add for Double {
    type Output = Double;
    #[inline]
    fn add(self, other: Double) -> Double {
        let (sum, lost) = two_sum(self.high, other.high);
        let (lower, lost_below) = two_sum(self.low, other.low);
        let (lower, lost_lower) = two_sum(lost, lower);
        let error = (self.radius + other.radius) + (lost_below.abs() + lost_lower.abs());
        // Sums of f64 that are below the normal numbers are exact, so nothing underflows.
        Double::around(two_sum(sum, lower), error * MORE)
    }
}

impl Sub for Double {
    type Output = Double;
    #[inline]
    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;
    #[inline]
    fn mul(self, other: Double) -> Double {
        if (self.is_exact_zero() && other.is_known()) || (other.is_exact_zero() && self.is_known()) {
            return Double::exact(0.0);
        }
        let (product, lost) = two_product(self.high, other.high);
        if product.abs() < SAFE {
            // All of the product is counted as lost.
            let error = (self.size() * MORE) * other.size();
            return Double::around((0.0, 0.0), error * MORE + UNDERFLOW);
        }
        let (one, two) = (self.high * other.low, self.low * other.high);
        let (lower, lost_lower) = two_sum(lost, one + two);
        // Then nothing is left out, and nothing more lost, unless the product is too large.
        let is_whole = self.low == 0.0 && other.low == 0.0 && self.radius == 0.0 && other.radius == 0.0;
        // Of `one`, `two` and their sum each rounding takes half a unit in the last place at most; the product of the lower parts is left out.
        let rounded = (one.abs() + two.abs()) * f64::EPSILON + (self.low * other.low).abs();
        let inherited = self.high.abs() * other.radius + (other.high.abs() + other.radius) * self.radius;
        let error = (rounded + inherited) + lost_lower.abs();
        Double::around(two_sum(product, lower), if is_whole { lost_lower.abs() } else { error * MORE + UNDERFLOW })
    }
}

impl Div for Double {
    type Output = Double;
    fn div(self, other: Double) -> Double {
        let least = other.high.abs() * LESS - other.radius;
        if least.is_nan() || least <= 0.0 {
            return Double::UNKNOWN;
        }
        let first = self.high / other.high;
        let rest = self - Double::exact(first) * other;
        let second = rest.high / other.high;
        let rest = rest - Double::exact(second) * other;
        // a/b − q = (a − q·b)/b, and what is left holds a − q·b for all that both balls hold.
        let error = if rest.is_exact_zero() { 0.0 } else { rest.size() / least * MORE + UNDERFLOW };
        Double::around(two_sum(first, second), error)
    }
}

impl PartialOrd for Double {
    /// The order; equal, and counted as unsettled, where the balls meet; `None` if either is unknown.
    fn partial_cmp(&self, other: &Double) -> Option<Ordering> {
        let difference = *self - *other;
        difference.counted_sign().or(difference.is_known().then_some(Ordering::Equal))
    }
}

impl PartialEq for Double {
    fn eq(&self, other: &Double) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl Real for Double {
    const ZERO: Self = Double::exact(0.0);
    const DOUBTS_CHOICES: bool = true;

    fn from_f64(value: f64) -> Self {
        if value.is_finite() { Double::exact(value) } else { Double::UNKNOWN }
    }
    fn from_number(number: &Number) -> Option<Self> {
        if let Some(value) = number.as_f64() {
            return Some(Double::from_f64(value));
        }
        let high = number.approximate();
        let Ok(part) = Number::from_f64(high) else { return Some(Double::UNKNOWN) };
        let low = number.plus(&part.negated()).approximate();
        // The nearest f64 to what the upper part leaves.
        Some(Double::around(two_sum(high, low), low.abs() * f64::EPSILON + UNDERFLOW))
    }
    fn to_number(self) -> Option<Number> {
        let part = |value| Number::from_f64(value).ok();
        if self.is_known() { Some(part(self.high)?.plus(&part(self.low)?)) } else { None }
    }
    /// The f64 that `Wide` gives, of the leading 64 bits: it may be the other neighbour of a number that is all but midway between two.
    fn to_f64(self) -> f64 {
        if !self.is_known() {
            return f64::NAN;
        }
        let is_nearly_midway = self.high + self.low * (1.0 + 1.0 / 256.0) != self.high;
        if is_nearly_midway { (Wide::of_f64(self.high) + Wide::of_f64(self.low)).nearest_f64() } else { self.high }
    }
    fn sqrt(self) -> Self {
        if self.is_exact_zero() {
            return self;
        }
        match self.settled_sign() {
            Some(Ordering::Less) => return Double::UNKNOWN,
            // |√x − 0| ≤ √(|middle| + radius). Of a number below zero `Wide` may know that it has no root: the generic code takes roots of squares and
            // their sums alone.
            None => return Double::around((0.0, 0.0), (self.size() * MORE).sqrt() * MORE + UNDERFLOW),
            Some(_) => {}
        }
        let first = self.high.sqrt();
        let rest = self - Double::exact(first) * Double::exact(first);
        let second = rest.high / (first + first);
        let (high, low) = two_sum(first, second);
        let root = Double { high, low, radius: 0.0 };
        let rest = self - root * root;
        // |√x − s| = |x − s²| / (√x + s) ≤ |x − s²| / s
        let error = if rest.is_exact_zero() { 0.0 } else { rest.size() / (high * LESS) * MORE + UNDERFLOW };
        Double::around((high, low), error)
    }
    fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }
    fn smaller(self, other: Self) -> Self {
        -(-self).larger(-other)
    }
    fn larger(self, other: Self) -> Self {
        let difference = self - other;
        let larger = if difference.high < 0.0 { other } else { self };
        if difference.settled_sign().is_some() {
            return larger;
        }
        let covering = (self.radius + other.radius + difference.size()) * MORE;
        Double::around((larger.high, larger.low), covering)
    }
    fn below(self, other: Self) -> bool {
        (self - other).counted_sign() == Some(Ordering::Less)
    }
    fn surely_below(self, other: Self) -> bool {
        self.below(other)
    }
    fn surely_below_uncounted(self, other: Self) -> bool {
        (self - other).settled_sign() == Some(Ordering::Less)
    }
    fn count_doubtful_choice() {
        count_one_unsettled();
    }
    fn is_finite(self) -> bool {
        self.is_known()
    }
    fn is_same(self, _: Self) -> bool {
        false
    }
    fn is_given_up() -> bool {
        is_given_up()
    }
}
