//! Upper bounds: numbers of 32 bits with an exponent of their own, rounded up by every operation.

use num_bigint::BigInt;
use num_rational::BigRational;
use std::cmp::Ordering;

/// A bound `significand · 2^exponent`, at least zero. Each operation rounds up, so that a bound stays one; it loses
/// less than one part in 2³⁰.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct UpperBound {
    significand: u64,
    exponent: i64,
}

const WIDTH: u32 = 32;

impl UpperBound {
    /// Zero.
    pub(crate) const ZERO: UpperBound = UpperBound { significand: 0, exponent: 0 };

    /// `2^exponent`.
    pub(crate) fn power_of_two(exponent: i64) -> UpperBound {
        UpperBound { significand: 1, exponent }
    }

    /// At least `significand · 2^exponent`.
    fn fitted(significand: u128, exponent: i64) -> UpperBound {
        let excess = (128 - significand.leading_zeros()).saturating_sub(WIDTH);
        let kept = (significand >> excess) as u64;
        let lost = significand.trailing_zeros() < excess;
        UpperBound::canonical(kept + u64::from(lost), exponent + i64::from(excess))
    }

    /// One form for each value: the significand odd, the exponent of zero zero.
    fn canonical(significand: u64, exponent: i64) -> UpperBound {
        if significand == 0 {
            return UpperBound::ZERO;
        }
        let zeros = significand.trailing_zeros();
        UpperBound { significand: significand >> zeros, exponent: exponent + i64::from(zeros) }
    }

    /// At least `size · 2^exponent`: the same as of the integer.
    pub(crate) fn of_short(size: u128, exponent: i64) -> UpperBound {
        UpperBound::fitted(size, exponent)
    }

    /// At least `|value| · 2^exponent`.
    pub(crate) fn of_integer(value: &BigInt, exponent: i64) -> UpperBound {
        let bits = value.bits();
        let excess = bits.saturating_sub(u64::from(WIDTH));
        let mut digits = value.iter_u64_digits().rev();
        let (first, second) = (digits.next().unwrap_or(0), digits.next());
        // The first digits, of which `excess` are dropped with all that follow.
        let (two, below) = match second {
            Some(second) => ((u128::from(first) << 64) | u128::from(second), excess - (bits.div_ceil(64) - 2) * 64),
            None => (u128::from(first), excess),
        };
        let top = (two >> below) as u64;
        let lost = value.trailing_zeros().is_some_and(|zeros| zeros < excess);
        UpperBound::canonical(top + u64::from(lost), exponent + excess as i64)
    }

    /// At least a finite value of at least zero; `None` for anything else.
    pub(crate) fn of_f64(value: f64) -> Option<UpperBound> {
        if !(value >= 0.0 && value.is_finite()) {
            return None;
        }
        let (significand, exponent) = rockproof_model::number::split_f64(value);
        Some(UpperBound::fitted(u128::from(significand.unsigned_abs()), i64::from(exponent)))
    }

    /// At most a finite value above zero; `None` for anything else.
    pub(crate) fn floor_of_f64(value: f64) -> Option<UpperBound> {
        if !(value > 0.0 && value.is_finite()) {
            return None;
        }
        let (significand, exponent) = rockproof_model::number::split_f64(value);
        let excess = (64 - significand.leading_zeros()).saturating_sub(WIDTH);
        Some(UpperBound::canonical((significand >> excess) as u64, i64::from(exponent) + i64::from(excess)))
    }

    /// Whether it is zero.
    pub(crate) fn is_zero(self) -> bool {
        self.significand == 0
    }

    /// At least `self + other`.
    pub(crate) fn plus(self, other: UpperBound) -> UpperBound {
        if self.is_zero() {
            return other;
        }
        if other.is_zero() {
            return self;
        }
        let (high, low) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let apart = (high.exponent - low.exponent) as u64;
        if apart <= 64 {
            UpperBound::fitted((u128::from(high.significand) << apart) + u128::from(low.significand), low.exponent)
        } else {
            // Less than one unit of a significand that is first made 32 bits longer.
            UpperBound::fitted((u128::from(high.significand) << WIDTH) + 1, high.exponent - i64::from(WIDTH))
        }
    }

    /// At least `self · other`.
    pub(crate) fn times(self, other: UpperBound) -> UpperBound {
        UpperBound::fitted(u128::from(self.significand) * u128::from(other.significand), self.exponent + other.exponent)
    }

    /// At least `self / divisor`, where `divisor` is a **lower** bound above zero; `None` where it is zero.
    pub(crate) fn over(self, divisor: UpperBound) -> Option<UpperBound> {
        if divisor.is_zero() {
            return None;
        }
        let quotient = (u128::from(self.significand) << 64).div_ceil(u128::from(divisor.significand));
        Some(UpperBound::fitted(quotient, self.exponent - divisor.exponent - 64))
    }

    /// At least `√self`.
    pub(crate) fn root(self) -> UpperBound {
        let odd = self.exponent.rem_euclid(2);
        let widened = u128::from(self.significand) << (64 + odd);
        let root = widened.isqrt();
        let up = root + u128::from(root * root != widened);
        UpperBound::fitted(up, (self.exponent - odd - 64) / 2)
    }

    /// `self · 2^shift`, exactly.
    pub(crate) fn shifted(self, shift: i64) -> UpperBound {
        UpperBound::canonical(self.significand, self.exponent + shift)
    }

    /// The place of the leading bit: `2^(k−1) ≤ self < 2^k`; `None` for zero.
    pub(crate) fn top(self) -> Option<i64> {
        (!self.is_zero()).then(|| self.exponent + i64::from(64 - self.significand.leading_zeros()))
    }

    /// The bound counted in units of `2^exponent`, rounded up.
    pub(crate) fn in_units(self, exponent: i64) -> BigInt {
        let shift = self.exponent - exponent;
        if shift >= 0 {
            BigInt::from(self.significand) << shift as usize
        } else if shift < -64 {
            BigInt::from(u64::from(!self.is_zero()))
        } else {
            let down = -shift as u32;
            BigInt::from((u128::from(self.significand) + ((1u128 << down) - 1)) >> down)
        }
    }

    /// The bound as a fraction, exactly.
    pub(crate) fn to_rational(self) -> BigRational {
        super::dyadic(BigInt::from(self.significand), self.exponent)
    }

    /// An f64 that is at least the bound; infinite where none is.
    pub(crate) fn to_f64(self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        // The significand is exact in f64. Scaling in two halves keeps each power of two finite; the extra roundoff
        // makes up for a result that falls among the subnormals.
        let exponent = self.exponent.clamp(-4_000, 4_000) as i32;
        let half = exponent / 2;
        let value = self.significand as f64 * 2f64.powi(half) * 2f64.powi(exponent - half);
        value * (1.0 + f64::EPSILON) + f64::MIN_POSITIVE
    }
}

impl PartialOrd for UpperBound {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for UpperBound {
    /// By value; there is one form for each value.
    fn cmp(&self, other: &Self) -> Ordering {
        self.top().cmp(&other.top()).then_with(|| {
            let align = |m: &UpperBound| m.significand << (m.significand.leading_zeros() & 63);
            align(self).cmp(&align(other))
        })
    }
}
