//! A scalar that stands for every value which a float may come to while the points it is worked out of stay near where they are.
//!
//! Code over [`Real`] that runs in [`MotionInterval`] makes the operations that it makes in f32 or f64, in the same order; so each result holds what either
//! float comes to, wherever the coordinates that it began with stand in their range: the ranges allow for the roundings of f32, far more than f64 makes.
//! A comparison answers whether it is *possible*, within [`certainly`] whether it is certain; [`is_open`] tells whether a choice was open that is neither.

#[cfg(test)]
mod tests;

use crate::contact::{
    ClassificationRequest, Collapsed, CompiledContacts, ComputedContact, PreparedBlock, prepared_block::CollapsedPart,
};
use crate::real::Real;
use rockproof_model::decision::Decision;
use rockproof_model::{Block, Number, VertexId};
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// More than one rounding of f32 takes of a value (2⁻²⁴), and than the few of f64 with which middle and radius are worked out.
const ROUNDING: f64 = 1.0 / 4_194_304.0;
/// More than underflow of f32 takes.
const UNDERFLOW: f64 = 1e-38;
/// Lengths (m) and quotients beyond this are not calculated with: products of four must not overflow in f32.
const MAX_MAGNITUDE: f64 = 1e9;

thread_local! {
    static OPEN: Cell<bool> = const { Cell::new(false) };
    static CERTAINLY: Cell<bool> = const { Cell::new(false) };
}

/// What `work` answers where a comparison says yes only if that is certain.
pub(crate) fn certainly<T>(work: impl FnOnce() -> T) -> T {
    asking(true, work)
}

/// What `work` answers where a comparison says yes if that is possible.
pub(crate) fn possibly<T>(work: impl FnOnce() -> T) -> T {
    asking(false, work)
}

/// What `work` answers where a comparison says yes if that is certain, when possible was asked; and the other way round.
pub(crate) fn the_other_way<T>(work: impl FnOnce() -> T) -> T {
    asking(!CERTAINLY.get(), work)
}

fn asking<T>(certainly: bool, work: impl FnOnce() -> T) -> T {
    let before = CERTAINLY.replace(certainly);
    let answer = work();
    CERTAINLY.set(before);
    answer
}

/// Says what `work` answers, and whether a choice on the way was open: then the answer means nothing.
pub(crate) fn is_open<T>(work: impl FnOnce() -> T) -> (T, bool) {
    let before = OPEN.replace(false);
    let answer = work();
    (answer, OPEN.replace(before))
}

/// Takes note that a choice was open.
pub(crate) fn leave_open() {
    OPEN.set(true);
}

/// Any number within `radius` of `middle`. A radius that is infinite says nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionInterval {
    middle: f64,
    radius: f64,
}

impl MotionInterval {
    const UNKNOWN: MotionInterval = MotionInterval { middle: 0.0, radius: f64::INFINITY };

    /// This very number.
    pub(crate) fn exact(middle: f64) -> MotionInterval {
        MotionInterval::within(middle, 0.0)
    }

    /// Any number within `radius` of `middle`.
    pub(crate) fn within(middle: f64, radius: f64) -> MotionInterval {
        if middle.abs() + radius < MAX_MAGNITUDE { MotionInterval { middle, radius } } else { MotionInterval::UNKNOWN }
    }

    /// What a rounded operation gives whose exact result is within `error` of the middle.
    #[inline]
    fn rounded(middle: f64, error: f64) -> MotionInterval {
        MotionInterval { middle, radius: error + (error + middle.abs()) * ROUNDING + UNDERFLOW }
    }

    /// Certainly less, or possibly if that is asked.
    #[inline]
    fn may_be_less(self, other: MotionInterval) -> bool {
        if CERTAINLY.get() { self.is_less(other) } else { !other.is_less(self) }
    }

    /// Certainly less.
    #[inline]
    fn is_less(self, other: MotionInterval) -> bool {
        // The middles' difference is rounded, as are the sums of radii; both by far less than the allowance in every radius that is not zero.
        let apart = other.middle - self.middle;
        apart > (self.radius + other.radius) * (1.0 + ROUNDING) + apart.abs() * (ROUNDING * ROUNDING)
    }

    /// The highest value that it stands for.
    pub(crate) fn highest(self) -> f64 {
        self.middle + self.radius
    }

    fn bounds(self) -> [f64; 2] {
        [self.middle - self.radius, self.middle + self.radius]
    }

    fn between(low: f64, high: f64) -> MotionInterval {
        let middle = low / 2.0 + high / 2.0;
        MotionInterval::rounded(middle, high / 2.0 - low / 2.0)
    }
}

/// Comparisons say what is possible: a number may be both less and greater than another, or neither than itself.
impl PartialEq for MotionInterval {
    fn eq(&self, other: &MotionInterval) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for MotionInterval {
    fn partial_cmp(&self, other: &MotionInterval) -> Option<Ordering> {
        if self.is_less(*other) {
            Some(Ordering::Less)
        } else if other.is_less(*self) {
            Some(Ordering::Greater)
        } else {
            None
        }
    }
    #[inline]
    fn lt(&self, other: &MotionInterval) -> bool {
        self.may_be_less(*other)
    }
    #[inline]
    fn le(&self, other: &MotionInterval) -> bool {
        self.may_be_less(*other)
    }
    #[inline]
    fn gt(&self, other: &MotionInterval) -> bool {
        other.may_be_less(*self)
    }
    #[inline]
    fn ge(&self, other: &MotionInterval) -> bool {
        other.may_be_less(*self)
    }
}

impl Neg for MotionInterval {
    type Output = MotionInterval;
    #[inline]
    fn neg(self) -> MotionInterval {
        MotionInterval { middle: -self.middle, ..self }
    }
}

impl Add for MotionInterval {
    type Output = MotionInterval;
    #[inline]
    fn add(self, other: MotionInterval) -> MotionInterval {
        MotionInterval::rounded(self.middle + other.middle, self.radius + other.radius)
    }
}

impl Sub for MotionInterval {
    type Output = MotionInterval;
    #[inline]
    fn sub(self, other: MotionInterval) -> MotionInterval {
        self + -other
    }
}

impl Mul for MotionInterval {
    type Output = MotionInterval;
    #[inline]
    fn mul(self, other: MotionInterval) -> MotionInterval {
        let (one, two) = (self.middle.abs(), other.middle.abs());
        MotionInterval::rounded(
            self.middle * other.middle,
            one * other.radius + two * self.radius + self.radius * other.radius,
        )
    }
}

impl Div for MotionInterval {
    type Output = MotionInterval;
    #[inline]
    fn div(self, other: MotionInterval) -> MotionInterval {
        let least = other.middle.abs() - other.radius;
        // As good as zero: the bounds below would be lost to underflow.
        if least.is_nan() || least < UNDERFLOW * 4.0 {
            return MotionInterval::UNKNOWN;
        }
        let quotient = self.middle / other.middle;
        // |x/y − a/b| ≤ (|x − a| + |a/b|·|y − b|) / |y|.
        let found = MotionInterval::rounded(quotient, (self.radius + quotient.abs() * other.radius) / least);
        MotionInterval::within(found.middle, found.radius)
    }
}

impl Real for MotionInterval {
    const ZERO: Self = MotionInterval { middle: 0.0, radius: 0.0 };

    fn from_f64(value: f64) -> Self {
        MotionInterval::rounded(value, 0.0)
    }
    fn from_number(number: &Number) -> Option<Self> {
        Some(MotionInterval::rounded(number.approximate(), 0.0))
    }
    fn to_number(self) -> Option<Number> {
        Number::from_f64(self.middle).ok()
    }
    fn to_f64(self) -> f64 {
        self.middle
    }
    /// Of what no float has below zero: sums of squares.
    fn sqrt(self) -> Self {
        let [low, high] = self.bounds();
        if !self.radius.is_finite() {
            MotionInterval::UNKNOWN
        } else if low > 0.0 {
            let root = self.middle.sqrt();
            // |√x − √a| = |x − a| / (√x + √a).
            MotionInterval::rounded(root, self.radius / (root + low.sqrt()))
        } else {
            MotionInterval::between(0.0, high.max(0.0).sqrt())
        }
    }
    fn abs(self) -> Self {
        let [low, high] = self.bounds();
        if low >= 0.0 {
            self
        } else if high <= 0.0 {
            -self
        } else {
            MotionInterval::between(0.0, high.max(-low))
        }
    }
    fn smaller(self, other: Self) -> Self {
        if self.is_less(other) {
            return self;
        }
        if other.is_less(self) {
            return other;
        }
        if !(self.radius.is_finite() && other.radius.is_finite()) {
            return MotionInterval::UNKNOWN;
        }
        let ([low, high], [least, most]) = (self.bounds(), other.bounds());
        MotionInterval::between(low.min(least), high.min(most))
    }
    fn larger(self, other: Self) -> Self {
        -(-self).smaller(-other)
    }
    fn below(self, other: Self) -> bool {
        let less = self.is_less(other);
        if !less && possibly(|| self < other) {
            leave_open();
        }
        less
    }
    fn surely_below(self, other: Self) -> bool {
        self.below(other)
    }
    fn is_finite(self) -> bool {
        // Some f32 has overflowed before.
        let fits = self.middle.abs() + self.radius < f64::from(f32::MAX) / 2.0;
        if !fits {
            leave_open();
        }
        true
    }
    fn is_same(self, _: Self) -> bool {
        false
    }
}

/// Where it stands for points that are given, a block is prepared by [`PreparedBlock::with_points`]; and which contacts there are is not to be told.
impl CompiledContacts for MotionInterval {
    fn prepare(_: &Block) -> Result<PreparedBlock<Self>, Collapsed> {
        Err(Collapsed { what: CollapsedPart::Vertex(VertexId(0)) })
    }
    fn contacts(_: ClassificationRequest<'_, Self>) -> Vec<ComputedContact<Self>> {
        leave_open();
        Vec::new()
    }
    fn traced(_: ClassificationRequest<'_, Self>) -> (Vec<ComputedContact<Self>>, Vec<(Decision, i8)>) {
        leave_open();
        (Vec::new(), Vec::new())
    }
}
