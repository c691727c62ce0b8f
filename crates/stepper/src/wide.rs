//! A scalar of 512 bits that knows how far rounding may have moved it.
//!
//! Backing: `crypto-bigint`'s fixed-size integers. They are pure Rust and quick to build, live on the stack, so that
//! `Wide` is `Copy` like f64 and the generic code reads the same for both, and are not the integers the oracle
//! uses. `dashu-float` and `astro-float` keep their digits on the heap and are not `Copy`.
//!
//! A value is a middle and a radius: the number meant lies within the radius of the middle. Sums, differences, products,
//! quotients and roots that fit into 512 bits are exact and keep an exact operand's radius of nothing; all others round
//! towards zero and add what they lost. A comparison is **settled** when the two intervals do not meet, or when both
//! values are exact; every other comparison answers that they are equal and is counted, for a tie is what leaves 512 bits in doubt. So cancellation is judged by the
//! size of what cancelled, not by the size of what is left: where no comparison of a run was unsettled, each decision
//! is the one that exact arithmetic makes. ([`Wide::maximum`] and [`Wide::middle_below`] are not counted: they choose
//! between values that differ, if at all, by less than the radii.)

// Longer than 400 lines: one scalar, its arithmetic and its order.

mod radius;

use self::radius::Radius;
use crypto_bigint::{Limb, NonZero, U64, U256, U512, U1024};
use num_bigint::{BigInt, Sign as BigSign};
use num_rational::BigRational;
use rockproof_model::Number;
use rockproof_model::number::split_f64;
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
    /// The error is not above it. Unknown for a quotient by something that may be zero, and for the root of a negative number.
    radius: Radius,
}

thread_local! {
    static UNSETTLED: Cell<u64> = const { Cell::new(0) };
    /// Whether one unsettled comparison spoils the answer.
    static SETTLED_ONLY: Cell<bool> = const { Cell::new(false) };
}

/// Counts from nothing; when dropped, adds what was counted outside. So nothing stays behind where a caller catches a panic of the work.
struct Count {
    outside: u64,
}

impl Count {
    fn begin() -> Count {
        Count { outside: UNSETTLED.replace(0) }
    }
}

impl Drop for Count {
    fn drop(&mut self) {
        UNSETTLED.set(self.outside + UNSETTLED.get());
    }
}

/// Wants settled answers alone until dropped.
struct SettledOnly {
    outside: bool,
}

impl SettledOnly {
    fn begin() -> SettledOnly {
        SettledOnly { outside: SETTLED_ONLY.replace(true) }
    }
}

impl Drop for SettledOnly {
    fn drop(&mut self) {
        SETTLED_ONLY.set(self.outside);
    }
}

/// Runs `work` and tells how many of its comparisons rounding left unsettled. Counts on this thread only.
pub fn count_unsettled<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let _count = Count::begin();
    let result = work();
    (result, UNSETTLED.get())
}

/// What `work` gives if all its comparisons are settled. It may end early once one is not. Counts on this thread only.
pub fn settled<T>(work: impl FnOnce() -> T) -> Option<T> {
    let _settled_only = SettledOnly::begin();
    let (result, unsettled) = count_unsettled(work);
    (unsettled == 0).then_some(result)
}

/// Whether only a settled answer is wanted, and a comparison was not.
pub(crate) fn is_given_up() -> bool {
    SETTLED_ONLY.get() && UNSETTLED.get() > 0
}

impl Wide {
    /// Zero, exactly.
    pub const EXACT_ZERO: Wide = Wide { negative: false, significand: U512::ZERO, exponent: 0, radius: Radius::EXACT };

    const NOT_KNOWN: Wide = Wide { radius: Radius::UNKNOWN, ..Wide::EXACT_ZERO };

    /// The number an f64 stands for, exactly; unknown for NaN and infinities.
    pub fn of_f64(value: f64) -> Wide {
        if !value.is_finite() {
            return Wide::NOT_KNOWN;
        }
        let (significand, exponent) = split_f64(value);
        let digits = U1024::from_u64(significand.unsigned_abs());
        Wide::rounded(significand < 0, digits, i64::from(exponent), Radius::EXACT)
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
        let exact = &kept << surplus == *value.magnitude();
        let radius = if exact { Radius::EXACT } else { Radius::power(surplus as i64) };
        let mut bytes = kept.to_bytes_le();
        bytes.resize(U1024::BYTES, 0);
        Wide::rounded(value.sign() == BigSign::Minus, U1024::from_le_slice(&bytes), surplus as i64, radius)
    }

    /// Whether no operation that led here rounded.
    pub fn is_exact(self) -> bool {
        self.radius.is_exact()
    }

    /// Whether it is zero, and no operation that led here rounded.
    pub(crate) fn is_exact_zero(self) -> bool {
        self.is_exact() && self.significand.is_zero_vartime()
    }

    /// Whether the value is a number at all.
    pub fn is_known(self) -> bool {
        self.radius.is_known()
    }

    /// The middle, exactly; `None` if unknown.
    pub fn middle(self) -> Option<Number> {
        if !self.is_known() {
            return None;
        }
        let sign = if self.negative { BigSign::Minus } else { BigSign::Plus };
        let significand = BigInt::from_bytes_le(sign, &self.significand.to_le_bytes());
        let power = BigInt::from(1) << self.exponent.unsigned_abs();
        let ratio = match self.exponent.is_negative() {
            true => BigRational::new(significand, power),
            false => BigRational::from_integer(significand * power),
        };
        Some(Number::from_rational(ratio))
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

    /// The larger of two numbers. Not a decision: where the intervals meet, the radius grows to cover both.
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
            Wide { radius: self.radius.plus(other.radius).plus(difference.radius), ..larger }
        }
    }

    /// Whether the middle is below the other's middle. Not counted.
    pub fn middle_below(self, other: Wide) -> bool {
        let difference = self - other;
        difference.is_known() && difference.negative && !difference.significand.is_zero_vartime()
    }

    /// Whether every value of the ball is below every value of the other's. Not counted.
    pub fn surely_below(self, other: Wide) -> bool {
        let difference = self - other;
        difference.middle_below(Wide::EXACT_ZERO) && difference.is_settled()
    }

    /// The square root; unknown for a negative number.
    #[must_use]
    pub fn root(self) -> Wide {
        let is_zero = self.significand.is_zero_vartime();
        if !self.is_known() || (self.negative && !is_zero && self.is_settled()) {
            return Wide::NOT_KNOWN;
        }
        // |√x − √y| ≤ √|x − y|
        if self.negative || is_zero {
            return Wide { radius: self.radius.root(), ..Wide::EXACT_ZERO };
        }
        // An even exponent, and 1023 or 1024 bits below the root, which then has 512.
        let shift = BITS - self.exponent.rem_euclid(2) as u32;
        let square = self.significand.resize::<{ U1024::LIMBS }>().shl_vartime(shift);
        let root = square.floor_sqrt_vartime();
        let exponent = (self.exponent - i64::from(shift)) / 2;
        let lost = if root.wrapping_mul(&root) == square { Radius::EXACT } else { Radius::power(exponent) };
        let middle = Wide::rounded(false, root, exponent, lost);
        let inherited = if self.is_settled() {
            // |√(x+δ) − √x| ≤ |δ| / √x
            self.radius.over(middle.at_least())
        } else {
            self.radius.root()
        };
        Wide { radius: middle.radius.plus(inherited), ..middle }
    }

    /// `digits·2^exponent`, cut to [`BITS`] bits.
    fn rounded(negative: bool, digits: U1024, exponent: i64, radius: Radius) -> Wide {
        let bits = digits.bits_vartime();
        if bits == 0 {
            return Wide { radius, ..Wide::EXACT_ZERO };
        }
        if bits <= BITS {
            let shift = BITS - bits;
            let significand = digits.resize::<{ U512::LIMBS }>().shl_vartime(shift);
            return Wide { negative, significand, exponent: exponent - i64::from(shift), radius };
        }
        let shift = bits - BITS;
        let exponent = exponent + i64::from(shift);
        let cut = digits.trailing_zeros_vartime() < shift;
        let lost = if cut { Radius::power(exponent) } else { Radius::EXACT };
        let significand = digits.shr_vartime(shift).resize::<{ U512::LIMBS }>();
        Wide { negative, significand, exponent, radius: radius.plus(lost) }
    }

    /// `digits·2^exponent`.
    fn normalized(negative: bool, digits: U512, exponent: i64, radius: Radius) -> Wide {
        let shift = digits.leading_zeros_vartime();
        if shift == BITS {
            return Wide { radius, ..Wide::EXACT_ZERO };
        }
        Wide { negative, significand: digits.shl_vartime(shift), exponent: exponent - i64::from(shift), radius }
    }

    /// The upper half of the significand, where the lower half is zero.
    fn upper_half(self) -> Option<U256> {
        let (lower, upper) = self.significand.split();
        lower.is_zero_vartime().then_some(upper)
    }

    /// The sum of two numbers where it fits into as many bits as the larger exponent leaves: where the one with the lesser exponent has
    /// zeros to be shifted out.
    fn short_sum(large: Wide, small: Wide, shift: u32, radius: Radius) -> Option<Wide> {
        if shift > 0 && small.significand.trailing_zeros_vartime() < shift {
            return None;
        }
        let (one, two) = (large.significand, small.significand.shr_vartime(shift));
        if large.negative != small.negative {
            let (negative, digits) = match one.cmp_vartime(&two) {
                Ordering::Less => (small.negative, two.wrapping_sub(&one)),
                _ => (large.negative, one.wrapping_sub(&two)),
            };
            return Some(Wide::normalized(negative, digits, large.exponent, radius));
        }
        let (sum, carry) = one.carrying_add(&two, Limb::ZERO);
        if carry == Limb::ZERO {
            return Some(Wide { negative: large.negative, significand: sum, exponent: large.exponent, radius });
        }
        if sum.as_limbs()[0].0 & 1 == 1 {
            return None;
        }
        let significand = sum.shr_vartime(1).bitor(&U512::ONE.shl_vartime(BITS - 1));
        Some(Wide { negative: large.negative, significand, exponent: large.exponent + 1, radius })
    }

    /// The leading 64 bits of the middle's magnitude, and their exponent.
    fn leading(self) -> (u64, i64) {
        let top = self.significand.shr_vartime(BITS - 64).resize::<{ U64::LIMBS }>();
        (u64::from(top), self.exponent + i64::from(BITS) - 64)
    }

    /// Not above the middle's magnitude.
    fn at_least(self) -> Radius {
        let (digits, exponent) = self.leading();
        Radius::below(digits, exponent)
    }

    /// Not below the middle's magnitude.
    fn at_most(self) -> Radius {
        let (digits, exponent) = self.leading();
        // The bits behind these are less than one of them.
        if digits == 0 { Radius::EXACT } else { Radius::above(digits, exponent).plus(Radius::power(exponent)) }
    }

    /// Whether the sign is certain.
    fn is_settled(self) -> bool {
        self.radius.is_exact() || self.radius < self.at_least()
    }
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
        let radius = self.radius.plus(other.radius);
        if self.significand.is_zero_vartime() {
            return Wide { radius, ..other };
        }
        if other.significand.is_zero_vartime() {
            return Wide { radius, ..self };
        }
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = large.exponent - small.exponent;
        if shift >= i64::from(BITS) - 1 {
            return Wide { radius: radius.plus(small.at_most()), ..large };
        }
        if let Some(sum) = Wide::short_sum(large, small, shift as u32, radius) {
            return sum;
        }
        let upper = large.significand.resize::<{ U1024::LIMBS }>().shl_vartime(shift as u32);
        let lower = small.significand.resize::<{ U1024::LIMBS }>();
        if large.negative == small.negative {
            return Wide::rounded(large.negative, upper.wrapping_add(&lower), small.exponent, radius);
        }
        match upper.cmp_vartime(&lower) {
            Ordering::Less => Wide::rounded(small.negative, lower.wrapping_sub(&upper), small.exponent, radius),
            _ => Wide::rounded(large.negative, upper.wrapping_sub(&lower), small.exponent, radius),
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
        let radius = if self.is_exact() && other.is_exact() {
            Radius::EXACT
        } else {
            let (own, foreign) = (self.at_most().plus(self.radius), other.at_most());
            own.times(other.radius).plus(foreign.times(self.radius))
        };
        let (negative, exponent) = (self.negative != other.negative, self.exponent + other.exponent);
        if let (Some(one), Some(two)) = (self.upper_half(), other.upper_half()) {
            let digits: U512 = one.concatenating_mul(&two);
            return Wide::normalized(negative, digits, exponent + i64::from(BITS), radius);
        }
        let digits: U1024 = self.significand.concatenating_mul(&other.significand);
        Wide::rounded(negative, digits, exponent, radius)
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
        let lost = if remainder.is_zero_vartime() { Radius::EXACT } else { Radius::power(exponent) };
        let middle = Wide::rounded(self.negative != other.negative, quotient, exponent, lost);
        if self.is_exact() && other.is_exact() {
            return middle;
        }
        // |(A+α)/(B+β) − A/B| ≤ (|α| + |A/B|·|β|) / (|B| − |β|)
        let quotient = middle.at_most().plus(middle.radius);
        let inherited = self.radius.plus(quotient.times(other.radius)).over(other.at_least().less(other.radius));
        Wide { radius: middle.radius.plus(inherited), ..middle }
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
