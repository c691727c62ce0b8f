//! Balls of as many bits as asked for: a binary number and an upper bound of its distance from the exact value.

mod significand;
#[cfg(test)]
mod unit_tests;

use self::significand::{Significand, Uncut};
use super::{DoubleBall, Field, Halve, UpperBound, dyadic};
use crate::number::INFLATION;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use rockproof_model::number::{power_of_two, split_f64};
use rockproof_model::{Number, Ring, Sign};

/// All values within `radius` of `significand · 2^exponent`.
///
/// A result that has more than `bits` bits is cut, and the radius takes up what was lost; results that fit are exact,
/// so sums and products of short numbers keep the radius zero.
#[derive(Clone, Debug)]
pub(crate) struct WideBall {
    significand: Significand,
    exponent: i64,
    radius: UpperBound,
    bits: u32,
}

/// Bits kept of a middle below the leading bit of its radius: more would say nothing.
const GUARD: i64 = 24;
/// Bits of a middle of which two f64 are made.
const LEADING_BITS: i64 = 119;
/// Integers of [`LEADING_BITS`] bits times powers of two from minus this to this are finite, and their last bits normal, in f64.
const REACH: i64 = 800;
/// Bits of a quotient of constants, which have no precision of their own.
const LEAST_BITS: u32 = 64;

impl WideBall {
    /// The number `significand · 2^exponent` itself.
    pub(crate) fn exactly(significand: BigInt, exponent: i64, bits: u32) -> WideBall {
        WideBall { significand: Significand::from(significand), exponent, radius: UpperBound::ZERO, bits }
    }

    /// The f64 itself; it must be finite.
    pub(crate) fn of_f64(value: f64, bits: u32) -> WideBall {
        let (significand, exponent) = split_f64(value);
        WideBall::exactly(BigInt::from(significand), i64::from(exponent), bits)
    }

    /// The values of a ball of two f64 times `2^exponent`; `None` where the ball knows nothing: its radius is infinite, or a part is no number.
    pub(crate) fn of_double(ball: &DoubleBall, exponent: i64, bits: u32) -> Option<WideBall> {
        let radius = Field::radius(ball)?;
        let sum = WideBall::of_parts(ball, bits)?.widened(radius);
        Some(WideBall { exponent: sum.exponent + exponent, radius: sum.radius.shifted(exponent), ..sum })
    }

    /// The sum of both parts of a ball of two f64 without its radius: what is cut of the sum is in the result's. `None` where a part is no number.
    pub(crate) fn of_parts(ball: &DoubleBall, bits: u32) -> Option<WideBall> {
        let part = |value: f64| value.is_finite().then(|| WideBall::of_f64(value, bits));
        Some(part(ball.high)?.plus(&part(ball.low)?))
    }

    /// The values times `2^exponent` in a ball of two f64, with an infinite radius where f64 does not reach.
    pub(crate) fn in_double(&self, exponent: i64) -> DoubleBall {
        let excess = (self.significand.bits() - LEADING_BITS).max(0);
        let unit = self.exponent + exponent + excess;
        let radius = self.radius.shifted(exponent);
        if self.significand.is_zero() || unit < -REACH {
            let size = self.significand.upper_bound(self.exponent + exponent);
            return DoubleBall { high: 0.0, low: 0.0, radius: radius.plus(size).to_f64() };
        }
        if unit > REACH {
            return DoubleBall { high: 0.0, low: 0.0, radius: f64::INFINITY };
        }
        let cut = if excess > 0 { UpperBound::power_of_two(unit) } else { UpperBound::ZERO };
        let DoubleBall { high, low, radius: rest } = DoubleBall::of_units(self.significand.leading(excess), 1.0);
        let (scale, radius) = (power_of_two(unit as i32), radius.plus(cut).to_f64());
        DoubleBall { high: high * scale, low: low * scale, radius: (radius + rest * scale) * INFLATION }
    }

    /// Cuts a result to its bits.
    fn cut(uncut: Uncut, mut exponent: i64, mut radius: UpperBound, bits: u32) -> WideBall {
        let length = uncut.bits();
        let mut excess = length - i64::from(bits.max(LEAST_BITS));
        if let Some(top) = radius.top() {
            excess = excess.max(top - GUARD - exponent);
        }
        excess = if length > 0 { excess.clamp(0, length) } else { 0 };
        if excess > 0 {
            if uncut.ends_in_ones(excess) {
                radius = radius.plus(UpperBound::power_of_two(exponent + excess));
            }
            exponent += excess;
        }
        WideBall { significand: uncut.without(excess), exponent, radius, bits }
    }

    /// The same, of a middle that is there already.
    fn shortened(self) -> WideBall {
        let WideBall { significand, exponent, radius, bits } = self;
        WideBall::cut(significand.sum(0, &Significand::ZERO, 0, false), exponent, radius, bits)
    }

    /// The exact number in the middle.
    pub(crate) fn without_radius(&self) -> WideBall {
        WideBall { radius: UpperBound::ZERO, ..self.clone() }
    }

    /// The same number in the middle as one of so many bits, exactly.
    pub(crate) fn with_bits(&self, bits: u32) -> WideBall {
        WideBall { bits, ..self.without_radius() }
    }

    /// The ball with a radius larger by `more`.
    pub(crate) fn widened(&self, more: UpperBound) -> WideBall {
        WideBall { radius: self.radius.plus(more), ..self.clone() }
    }

    /// At least the size of every value enclosed.
    pub(crate) fn size(&self) -> UpperBound {
        self.significand.upper_bound(self.exponent).plus(self.radius)
    }

    /// The radius alone.
    pub(crate) fn spread(&self) -> UpperBound {
        self.radius
    }

    /// The place of the middle's leading bit; `None` for a middle of zero.
    pub(crate) fn top(&self) -> Option<i64> {
        (!self.significand.is_zero()).then(|| self.exponent + self.significand.bits())
    }

    /// The middle divided by `2^scale`, as the nearest f64 or one beside it; it must be within f64's range.
    pub(crate) fn scaled_f64(&self, scale: i64) -> f64 {
        let excess = (self.significand.bits() - 62).max(0);
        let short = (self.significand.integer().as_ref() >> excess as usize).to_i64().unwrap_or(0);
        let exponent = (self.exponent + excess - scale).clamp(-2_000, 2_000) as i32;
        let half = exponent / 2;
        short as f64 * 2f64.powi(half) * 2f64.powi(exponent - half)
    }

    /// The middle's size less the radius in units of `2^exponent`, with that exponent. The units are far below the middle, however
    /// few its bits: rounding the radius up to a whole one must not use a short middle up.
    fn least(&self) -> (BigInt, i64) {
        let shift = (i64::from(LEAST_BITS) - self.significand.bits()).max(0);
        let exponent = self.exponent - shift;
        let size = BigInt::from(self.significand.integer().magnitude() << shift as usize);
        (size - self.radius.in_units(exponent), exponent)
    }

    fn bits_with(&self, other: &WideBall) -> u32 {
        self.bits.max(other.bits)
    }

    fn is_exact_zero(&self) -> bool {
        self.significand.is_zero() && self.radius.is_zero()
    }

    fn sum(&self, other: &WideBall, negate: bool) -> WideBall {
        let bits = self.bits_with(other);
        let signed = |v: &Significand| if negate { v.negated() } else { v.clone() };
        if other.is_exact_zero() {
            return WideBall { bits, ..self.clone() };
        }
        if self.is_exact_zero() {
            return WideBall { significand: signed(&other.significand), bits, ..other.clone() };
        }
        let radius = self.radius.plus(other.radius);
        // An addend far below the other's last bit only adds to the radius.
        let reach = 2 * i64::from(bits.max(LEAST_BITS)) + 64;
        match (self.top(), other.top()) {
            (Some(mine), Some(theirs)) if mine - theirs > reach && self.exponent > theirs => {
                let lost = other.significand.upper_bound(other.exponent);
                return WideBall { radius: radius.plus(lost), bits, ..self.clone() }.shortened();
            }
            (Some(mine), Some(theirs)) if theirs - mine > reach && other.exponent > mine => {
                let lost = self.significand.upper_bound(self.exponent);
                let significand = signed(&other.significand);
                return WideBall { significand, exponent: other.exponent, radius: radius.plus(lost), bits }.shortened();
            }
            _ => {}
        }
        let exponent = match (self.significand.is_zero(), other.significand.is_zero()) {
            (true, false) => other.exponent,
            (false, true) => self.exponent,
            _ => self.exponent.min(other.exponent),
        };
        let shifts = [self.exponent - exponent, other.exponent - exponent];
        let uncut = self.significand.sum(shifts[0], &other.significand, shifts[1], negate);
        WideBall::cut(uncut, exponent, radius, bits)
    }
}

impl Ring for WideBall {
    fn from_i32(value: i32) -> Self {
        WideBall::exactly(BigInt::from(value), 0, 0)
    }

    fn plus(&self, other: &Self) -> Self {
        self.sum(other, false)
    }

    fn minus(&self, other: &Self) -> Self {
        self.sum(other, true)
    }

    fn times(&self, other: &Self) -> Self {
        let bits = self.bits_with(other);
        if self.is_exact_zero() || other.is_exact_zero() {
            return WideBall::exactly(BigInt::zero(), 0, bits);
        }
        let size = |ball: &WideBall| ball.significand.upper_bound(ball.exponent);
        let mut radius = self.radius.times(other.radius);
        if !other.radius.is_zero() {
            radius = radius.plus(size(self).times(other.radius));
        }
        if !self.radius.is_zero() {
            radius = radius.plus(size(other).times(self.radius));
        }
        WideBall::cut(self.significand.times(&other.significand), self.exponent + other.exponent, radius, bits)
    }

    fn negated(&self) -> Self {
        WideBall { significand: self.significand.negated(), ..self.clone() }
    }
}

impl Halve for WideBall {
    fn half(&self) -> Self {
        WideBall { exponent: self.exponent - 1, radius: self.radius.shifted(-1), ..self.clone() }
    }
}

impl Field for WideBall {
    fn of_rational(value: &BigRational, bits: u32) -> Self {
        let part = |n: &BigInt| WideBall::exactly(n.clone(), 0, u32::MAX);
        quotient(&part(value.numer()), &part(value.denom()), bits).unwrap_or_else(|| Self::from_i32(0))
    }

    fn of_number(value: &Number, bits: u32) -> Self {
        match value.as_f64() {
            Some(float) => WideBall::of_f64(float, bits),
            None => Self::of_rational(&value.to_rational(), bits),
        }
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        quotient(self, divisor, self.bits_with(divisor))
    }

    fn root(&self) -> Option<Self> {
        if self.is_exact_zero() {
            return Some(self.clone());
        }
        if !(self.significand.sign().is_positive() && self.least().0.is_positive()) {
            return None;
        }
        let wanted = 2 * i64::from(self.bits.max(LEAST_BITS)) + 4;
        let mut shift = (wanted - self.significand.bits()).max(0);
        shift += (self.exponent - shift).rem_euclid(2);
        let widened = self.significand.integer().as_ref() << shift as usize;
        let root = widened.sqrt();
        let exponent = (self.exponent - shift) / 2;
        let mut radius = UpperBound::ZERO;
        if &root * &root != widened {
            radius = UpperBound::power_of_two(exponent);
        }
        if !self.radius.is_zero() {
            // |√x − √m| ≤ r/√m; the integer root, above zero, bounds √m from below.
            radius = radius.plus(self.radius.over(floor(&root, exponent))?);
        }
        Some(WideBall::cut(Uncut::Long(root), exponent, radius, self.bits))
    }

    fn certain_sign(&self) -> Option<Sign> {
        if self.radius.is_zero() || self.least().0.is_positive() {
            return Some(self.significand.sign());
        }
        None
    }

    fn middle(&self) -> BigRational {
        dyadic(self.significand.integer().into_owned(), self.exponent)
    }

    fn radius(&self) -> Option<UpperBound> {
        Some(self.radius)
    }

    fn magnitude_bound(&self) -> Option<UpperBound> {
        Some(self.size())
    }

    fn within(size: UpperBound) -> Option<Self> {
        Some(WideBall::exactly(BigInt::zero(), 0, 0).widened(size))
    }

    fn nearby(&self) -> (f64, f64) {
        if self.size().top().is_some_and(|top| top > 1_000) {
            return (f64::NAN, f64::INFINITY);
        }
        let middle = self.scaled_f64(0);
        (middle, self.radius.to_f64() + middle.abs() * f64::EPSILON * 4.0 + f64::MIN_POSITIVE)
    }
}

/// At most `|value| · 2^exponent`: the leading 32 bits.
fn floor(value: &BigInt, exponent: i64) -> UpperBound {
    let excess = value.bits().saturating_sub(32) as usize;
    let whole: BigInt = BigInt::from(value.magnitude().clone()) >> excess << excess;
    UpperBound::of_integer(&whole, exponent)
}

/// `a / b` to `bits` bits; `None` where b may be zero.
fn quotient(a: &WideBall, b: &WideBall, bits: u32) -> Option<WideBall> {
    // At most |b| − ρ.
    let (least, unit) = b.least();
    if !least.is_positive() {
        return None;
    }
    if a.is_exact_zero() {
        return Some(WideBall::exactly(BigInt::zero(), 0, bits));
    }
    let wanted = i64::from(bits.max(LEAST_BITS)) + 2;
    let shift = (wanted + b.significand.bits() - a.significand.bits()).max(0);
    let numerator = a.significand.integer().as_ref() << shift as usize;
    let (significand, rest) = numerator.div_rem(b.significand.integer().as_ref());
    let exponent = a.exponent - shift - b.exponent;
    let mut radius = if rest.is_zero() { UpperBound::ZERO } else { UpperBound::power_of_two(exponent) };
    if !a.radius.is_zero() || !b.radius.is_zero() {
        // |x/y − m/w| ≤ (r + |m/w|·ρ) / (|w| − ρ), with one unit more for the quotient that was cut.
        let size = UpperBound::of_integer(&significand, exponent).plus(UpperBound::power_of_two(exponent));
        radius = radius.plus(a.radius.plus(size.times(b.radius)).over(floor(&least, unit))?);
    }
    Some(WideBall::cut(Uncut::Long(significand), exponent, radius, bits))
}
