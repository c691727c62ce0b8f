//! A scalar of 512 bits that knows how far rounding may have moved it.
//!
//! Backing: `crypto-bigint`'s fixed-size integers. They are pure Rust and quick to build, live on the stack, so that
//! `Wide` is `Copy` like f64 and the generic code reads the same for both, and are not the integers the oracle
//! uses. `dashu-float` and `astro-float` keep their digits on the heap and are not `Copy`.
//!
//! A value is a middle and a bound: the number meant lies within `2^bound` of the middle. Sums, differences, products,
//! quotients and roots that fit into 512 bits are exact and keep an exact operand's bound of nothing; all others round
//! towards zero and add what they lost. A comparison is **settled** when the two intervals do not meet, or when both
//! values are exact; every other comparison answers that they are equal and is counted, for a tie is what leaves 512 bits in doubt. So cancellation is judged by the
//! size of what cancelled, not by the size of what is left: where no comparison of a run was unsettled, each decision
//! is the one that exact arithmetic makes. ([`Wide::maximum`] and [`Wide::middle_below`] are not counted: they choose
//! between values that differ, if at all, by less than the bounds.)

use crate::model::number::split_f64;
use crate::model::{Block, Contact, Number, ToleranceSet};
use crate::stepper::contact::Rules;
use crate::stepper::engine::{EngineError, contacts_in};
use crypto_bigint::{NonZero, U64, U512, U1024};
use num_bigint::{BigInt, Sign as BigSign};
use std::cell::Cell;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Bits of the significand.
pub const BITS: u32 = 512;

/// A number of [`BITS`] bits with a bound on its error.
#[derive(Clone, Copy, Debug)]
pub struct Wide {
    negative: bool,
    /// Zero, or with the top bit set: the middle is ±significand·2^exponent.
    significand: U512,
    exponent: i64,
    /// The error is below 2^bound.
    bound: i64,
}

/// The bound of a value without error.
const EXACT: i64 = i64::MIN;
/// The bound of a value nothing is known about: a quotient by something that may be zero, the root of a negative number.
const UNKNOWN: i64 = i64::MAX;

thread_local! {
    static UNSETTLED: Cell<u64> = const { Cell::new(0) };
}

/// Runs `work` and tells how many of its comparisons rounding left unsettled. Counts on this thread only.
pub fn counting<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = UNSETTLED.replace(0);
    let result = work();
    let count = UNSETTLED.replace(before);
    UNSETTLED.set(before + count);
    (result, count)
}

/// The contacts of a pair in [`Wide`] by the rules `M`, preparation of both blocks included, and the number of unsettled
/// comparisons. Where that is 0, each decision is the exact one.
///
/// # Errors
/// When a block collapses; with exact coordinates of a canonical block it does not.
pub fn classify<M: Rules>(a: &Block, b: &Block, t: &ToleranceSet) -> Result<(Vec<Contact>, u64), EngineError> {
    let (contacts, unsettled) = counting(|| contacts_in::<Wide, M>(a, b, t));
    Ok((contacts?, unsettled))
}

impl Wide {
    /// Zero, exactly.
    pub const EXACT_ZERO: Wide = Wide { negative: false, significand: U512::ZERO, exponent: 0, bound: EXACT };

    const NOT_KNOWN: Wide = Wide { bound: UNKNOWN, ..Wide::EXACT_ZERO };

    /// The number an f64 stands for, exactly; unknown for NaN and infinities.
    pub fn of_f64(value: f64) -> Wide {
        if !value.is_finite() {
            return Wide::NOT_KNOWN;
        }
        let (significand, exponent) = split_f64(value);
        let digits = U1024::from_u64(significand.unsigned_abs());
        Wide::rounded(significand < 0, digits, i64::from(exponent), EXACT)
    }

    /// An exact number, rounded where 512 bits cannot hold it.
    pub fn of_number(number: &Number) -> Wide {
        match (number.as_f64(), number.as_ratio()) {
            (Some(value), _) => Wide::of_f64(value),
            (None, Some(ratio)) => Wide::of_integer(ratio.numer()) / Wide::of_integer(ratio.denom()),
            (None, None) => Wide::EXACT_ZERO,
        }
    }

    /// An integer, rounded where 512 bits cannot hold it.
    pub fn of_integer(value: &BigInt) -> Wide {
        let surplus = value.bits().saturating_sub(u64::from(BITS));
        let kept = value.magnitude() >> surplus;
        let bound = if &kept << surplus == *value.magnitude() { EXACT } else { surplus as i64 };
        let mut bytes = kept.to_bytes_le();
        bytes.resize(U1024::BYTES, 0);
        Wide::rounded(value.sign() == BigSign::Minus, U1024::from_le_slice(&bytes), surplus as i64, bound)
    }

    /// Whether no operation that led here rounded.
    pub fn is_exact(self) -> bool {
        self.bound == EXACT
    }

    /// Whether the value is a number at all.
    pub fn is_known(self) -> bool {
        self.bound != UNKNOWN
    }

    /// The middle, rounded to f64; NaN if unknown.
    pub fn nearest_f64(self) -> f64 {
        if !self.is_known() {
            return f64::NAN;
        }
        // 64 bits to f64, then a power of two in two steps, so that neither of them overflows on its own.
        let top = u64::from(self.significand.shr_vartime(BITS - 64).resize::<{ U64::LIMBS }>());
        let exponent = (self.exponent + i64::from(BITS) - 64).clamp(-4000, 4000) as i32;
        let half = exponent / 2;
        let size = top as f64 * 2f64.powi(half) * 2f64.powi(exponent - half);
        if self.negative { -size } else { size }
    }

    /// The magnitude.
    #[must_use]
    pub fn magnitude(self) -> Wide {
        Wide { negative: false, ..self }
    }

    /// The larger of two numbers. Not a decision: where the intervals meet, the bound grows to cover both.
    #[must_use]
    pub fn maximum(self, other: Wide) -> Wide {
        let difference = self - other;
        if !difference.is_known() {
            return Wide::NOT_KNOWN;
        }
        let larger = if difference.negative { other } else { self };
        if difference.is_settled() {
            larger
        } else {
            Wide { bound: total(&[self.bound, other.bound, difference.bound]), ..larger }
        }
    }

    /// Whether the middle is below the other's middle. Not counted.
    pub fn middle_below(self, other: Wide) -> bool {
        let difference = self - other;
        difference.is_known() && difference.negative && !difference.significand.is_zero_vartime()
    }

    /// The square root; unknown for a negative number.
    #[must_use]
    pub fn root(self) -> Wide {
        if !self.is_known() || (self.negative && self.is_settled()) {
            return Wide::NOT_KNOWN;
        }
        if self.negative || self.significand.is_zero_vartime() {
            return Wide { bound: root_bound(self.bound), ..Wide::EXACT_ZERO };
        }
        // An even exponent, and 1023 or 1024 bits below the root, which then has 512.
        let shift = BITS - self.exponent.rem_euclid(2) as u32;
        let square = self.significand.resize::<{ U1024::LIMBS }>().shl_vartime(shift);
        let root = square.floor_sqrt_vartime();
        let exponent = (self.exponent - i64::from(shift)) / 2;
        let lost = if root.wrapping_mul(&root) == square { EXACT } else { exponent };
        let inherited = match self.top() {
            _ if self.bound == EXACT => EXACT,
            // |√(x+δ) − √x| ≤ |δ| / √x, and √x ≥ 2^⌊(top − 1)/2⌋
            top if self.is_settled() => self.bound - (top - 1).div_euclid(2),
            _ => root_bound(self.bound),
        };
        Wide::rounded(false, root, exponent, total(&[lost, inherited]))
    }

    /// `digits·2^exponent`, cut to [`BITS`] bits.
    fn rounded(negative: bool, digits: U1024, exponent: i64, bound: i64) -> Wide {
        let bits = digits.bits_vartime();
        if bits == 0 {
            return Wide { bound, ..Wide::EXACT_ZERO };
        }
        if bits <= BITS {
            let shift = BITS - bits;
            let significand = digits.resize::<{ U512::LIMBS }>().shl_vartime(shift);
            return Wide { negative, significand, exponent: exponent - i64::from(shift), bound };
        }
        let shift = bits - BITS;
        let exponent = exponent + i64::from(shift);
        let lost = if digits.trailing_zeros_vartime() < shift { exponent } else { EXACT };
        let significand = digits.shr_vartime(shift).resize::<{ U512::LIMBS }>();
        Wide { negative, significand, exponent, bound: total(&[bound, lost]) }
    }

    /// The middle is below 2^top, and at least 2^(top − 1); [`EXACT`] for zero.
    fn top(self) -> i64 {
        if self.significand.is_zero_vartime() { EXACT } else { self.exponent + i64::from(BITS) }
    }

    /// Whether the sign is certain.
    fn is_settled(self) -> bool {
        self.bound == EXACT || (self.is_known() && self.top() != EXACT && self.top() - 1 > self.bound)
    }
}

/// An exponent that bounds the sum of powers of two; [`EXACT`] terms are nothing.
fn total(exponents: &[i64]) -> i64 {
    let largest = exponents.iter().copied().max().unwrap_or(EXACT);
    if largest == EXACT || largest == UNKNOWN {
        return largest;
    }
    match exponents.iter().filter(|&&e| e != EXACT).count() {
        1 => largest,
        2 => largest + 1,
        _ => largest + 2,
    }
}

/// The exponent of a product of two bounded magnitudes.
fn product(a: i64, b: i64) -> i64 {
    if a == EXACT || b == EXACT { EXACT } else { a + b }
}

/// A bound for the root of a number that is zero within 2^bound: |√x − √y| ≤ √|x − y|, and |x|, |y| ≤ 2^(bound + 2).
fn root_bound(bound: i64) -> i64 {
    if bound == EXACT { EXACT } else { (bound + 3).div_euclid(2) + 1 }
}

impl Neg for Wide {
    type Output = Wide;
    fn neg(self) -> Wide {
        Wide { negative: !self.negative, ..self }
    }
}

impl Add for Wide {
    type Output = Wide;
    fn add(self, other: Wide) -> Wide {
        if !self.is_known() || !other.is_known() {
            return Wide::NOT_KNOWN;
        }
        let bound = total(&[self.bound, other.bound]);
        if self.significand.is_zero_vartime() {
            return Wide { bound, ..other };
        }
        if other.significand.is_zero_vartime() {
            return Wide { bound, ..self };
        }
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = large.exponent - small.exponent;
        if shift >= i64::from(BITS) - 1 {
            return Wide { bound: total(&[bound, small.top()]), ..large };
        }
        let upper = large.significand.resize::<{ U1024::LIMBS }>().shl_vartime(shift as u32);
        let lower = small.significand.resize::<{ U1024::LIMBS }>();
        if large.negative == small.negative {
            return Wide::rounded(large.negative, upper.wrapping_add(&lower), small.exponent, bound);
        }
        match upper.cmp_vartime(&lower) {
            Ordering::Less => Wide::rounded(small.negative, lower.wrapping_sub(&upper), small.exponent, bound),
            _ => Wide::rounded(large.negative, upper.wrapping_sub(&lower), small.exponent, bound),
        }
    }
}

impl Sub for Wide {
    type Output = Wide;
    fn sub(self, other: Wide) -> Wide {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Wide;
    fn mul(self, other: Wide) -> Wide {
        if !self.is_known() || !other.is_known() {
            return Wide::NOT_KNOWN;
        }
        let bound = total(&[
            product(self.top(), other.bound),
            product(other.top(), self.bound),
            product(self.bound, other.bound),
        ]);
        let digits: U1024 = self.significand.concatenating_mul(&other.significand);
        Wide::rounded(self.negative != other.negative, digits, self.exponent + other.exponent, bound)
    }
}

impl Div for Wide {
    type Output = Wide;
    fn div(self, other: Wide) -> Wide {
        let divisor = NonZero::new(other.significand).into_option();
        let (Some(divisor), true, true) = (divisor, self.is_known(), other.is_settled()) else {
            return Wide::NOT_KNOWN;
        };
        let dividend = self.significand.resize::<{ U1024::LIMBS }>().shl_vartime(BITS);
        let (quotient, remainder) = dividend.div_rem_vartime(&divisor);
        let exponent = self.exponent - i64::from(BITS) - other.exponent;
        let lost = if remainder.is_zero_vartime() { EXACT } else { exponent };
        let middle = Wide::rounded(self.negative != other.negative, quotient, exponent, lost);
        // The divisor is at least 2^(top − 1) and its error at most half of that, so 1/divisor ≤ 2^(2 − top).
        let inverse = 2 - other.top();
        let inherited = total(&[product(self.bound, inverse), product(product(middle.top(), other.bound), inverse)]);
        Wide { bound: total(&[middle.bound, inherited]), ..middle }
    }
}

impl PartialOrd for Wide {
    /// The order; equal, and counted as unsettled, where the intervals meet; `None` if either is unknown.
    fn partial_cmp(&self, other: &Wide) -> Option<Ordering> {
        let difference = *self - *other;
        if !difference.is_settled() {
            UNSETTLED.set(UNSETTLED.get() + 1);
        }
        if !difference.is_known() {
            return None;
        }
        if !difference.is_settled() {
            return Some(Ordering::Equal);
        }
        Some(match (difference.significand.is_zero_vartime(), difference.negative) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        })
    }
}

impl PartialEq for Wide {
    /// As [`Wide::partial_cmp`] says, and counted alike.
    fn eq(&self, other: &Wide) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}
