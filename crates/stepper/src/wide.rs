//! A scalar of 512 bits that knows how far rounding may have moved it.
//!
//! Its digits are an array of its own (`wide/digits.rs`), so that `Wide` is `Copy` like f64 and the generic code reads the same for both; those of
//! `dashu-float` and `astro-float` are on the heap. Digits that are zero at the end are left out of all work: what comes of coordinates is short.
//!
//! A value is a middle and a radius: the number meant lies within the radius of the middle. Sums, differences, products,
//! quotients and roots that fit into 512 bits are exact and keep an exact operand's radius of nothing; all others round
//! towards zero and add what they lost. A comparison is **settled** when the two intervals do not meet, or when both
//! values are exact; every other comparison answers that they are equal and is counted, for a tie is what leaves 512 bits in doubt. So cancellation is judged by the
//! size of what cancelled, not by the size of what is left: where no comparison of a run was unsettled, each decision
//! is the one that exact arithmetic makes. ([`Wide::maximum`] and [`Wide::middle_below`] are not counted: they choose
//! between values that differ, if at all, by less than the radii.)
//!
//! All this is so of fewer bits, too, to which [`in_bits`] cuts what is calculated. What is settled is the same decision then; more is left unsettled.
//! Numbers of up to 128 bits are pairs of digits in the processor's own 128-bit integers, which is where most of the time is saved.

// Longer than 400 lines: one scalar, its arithmetic and its order.

mod digits;
mod radius;

use self::digits::{DIGIT, Fraction, Long, MAX_DIGITS};
use crate::dynamics::Enclosing;
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
    /// The significand's digits, the lowest first. The last ones are used, as many as `length` says; the others are zero.
    digits: [u64; MAX_DIGITS],
    /// The middle is ±(the digits used, after a binary point)·2^exponent. Of zero, what its radius is counted in.
    exponent: i64,
    /// The error is not above it, in units of 2^exponent. Unknown for a quotient by something that may be zero, and for the root of a negative number.
    radius: f64,
    /// None for zero. Else the highest bit of the digits used is set, and the lowest of these digits is not zero.
    length: u8,
    negative: bool,
}

thread_local! {
    static UNSETTLED: Cell<u64> = const { Cell::new(0) };
    /// Whether one unsettled comparison spoils the answer.
    static SETTLED_ONLY: Cell<bool> = const { Cell::new(false) };
    /// Digits to which results are cut.
    static KEPT: Cell<usize> = const { Cell::new(MAX_DIGITS) };
}

/// Cuts results to fewer digits until dropped.
struct Shorter {
    outside: usize,
}

impl Shorter {
    fn begin(digits: usize) -> Shorter {
        Shorter { outside: KEPT.replace(digits) }
    }
}

impl Drop for Shorter {
    fn drop(&mut self) {
        KEPT.set(self.outside);
    }
}

/// Runs `work` with results cut to fewer bits: a multiple of 128, and 128 at least. On this thread only.
pub fn in_bits<T>(bits: u32, work: impl FnOnce() -> T) -> T {
    let _shorter = Shorter::begin(2 * (bits / 128).clamp(1, MAX_DIGITS as u32 / 2) as usize);
    work()
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

/// Counts a comparison that another scalar leaves unsettled.
pub(crate) fn count_one_unsettled() {
    UNSETTLED.set(UNSETTLED.get() + 1);
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
    pub const EXACT_ZERO: Wide =
        Wide { digits: [0; MAX_DIGITS], exponent: 0, radius: radius::EXACT, length: 0, negative: false };

    const NOT_KNOWN: Wide = Wide { radius: radius::UNKNOWN, ..Wide::EXACT_ZERO };

    /// The number an f64 stands for, exactly; unknown for NaN and infinities.
    pub fn of_f64(value: f64) -> Wide {
        if !value.is_finite() {
            return Wide::NOT_KNOWN;
        }
        let (significand, exponent) = split_f64(value);
        Wide::rounded(
            significand < 0,
            &[significand.unsigned_abs()],
            i64::from(exponent) + i64::from(DIGIT),
            radius::EXACT,
        )
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
        let digits: Vec<u64> = value.iter_u64_digits().collect();
        let exponent = digits.len() as i64 * i64::from(DIGIT);
        Wide::rounded(value.sign() == BigSign::Minus, &digits, exponent, radius::EXACT)
    }

    /// The digits of the significand that are used.
    fn used(&self) -> &[u64] {
        &self.digits[MAX_DIGITS - usize::from(self.length)..]
    }

    fn is_zero(&self) -> bool {
        self.length == 0
    }

    /// The leading 64 bits of the middle's magnitude, which are those of a fraction.
    fn leading(&self) -> u64 {
        if self.is_zero() { 0 } else { self.digits[MAX_DIGITS - 1] }
    }

    /// Whether no operation that led here rounded.
    pub fn is_exact(self) -> bool {
        self.radius == radius::EXACT
    }

    /// Whether it is zero, and no operation that led here rounded.
    pub(crate) fn is_exact_zero(self) -> bool {
        self.is_exact() && self.is_zero()
    }

    /// Whether the value is a number at all.
    pub fn is_known(self) -> bool {
        self.radius < radius::UNKNOWN
    }

    /// The middle, exactly; `None` if unknown.
    pub fn middle(self) -> Option<Number> {
        if !self.is_known() {
            return None;
        }
        let sign = if self.negative { BigSign::Minus } else { BigSign::Plus };
        let bytes: Vec<u8> = self.used().iter().flat_map(|digit| digit.to_le_bytes()).collect();
        let significand = BigInt::from_bytes_le(sign, &bytes);
        let exponent = if self.is_zero() { 0 } else { self.exponent - i64::from(self.length) * i64::from(DIGIT) };
        let power = BigInt::from(1) << exponent.unsigned_abs();
        let ratio = match exponent.is_negative() {
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
        // Whose exponent says no more than how wide it is.
        if self.is_zero() {
            return 0.0;
        }
        // 64 bits to f64, then a power of two in two steps, so that neither of them overflows on its own.
        let exponent = (self.exponent - i64::from(DIGIT)).clamp(-4000, 4000) as i32;
        let half = exponent / 2;
        let size = self.leading() as f64 * 2f64.powi(half) * 2f64.powi(exponent - half);
        if self.negative { -size } else { size }
    }

    /// Whether it is the number an f64 stands for, and no operation that led here rounded.
    pub(crate) fn is_f64(self) -> bool {
        let value = Wide::of_f64(self.nearest_f64());
        self.is_exact() && self.digits == value.digits && (self.is_zero() || self.exponent == value.exponent)
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
            [self, other, difference].iter().fold(larger, |larger, ball| larger.widened(ball.radius, ball.exponent))
        }
    }

    /// Whether the middle is below the other's middle. Not counted.
    pub fn middle_below(self, other: Wide) -> bool {
        let difference = self - other;
        difference.is_known() && difference.negative && !difference.is_zero()
    }

    /// Whether the middle is above zero. Not counted, but where the middle is zero by rounding: it would go on as exact.
    pub fn middle_is_positive(self) -> bool {
        if self.is_zero() && !self.is_exact() {
            count_one_unsettled();
        }
        self.is_known() && !self.negative && !self.is_zero()
    }

    /// The order where the comparison is settled. Not counted.
    pub(crate) fn settled_order(self, other: Wide) -> Option<Ordering> {
        (self - other).settled_sign()
    }

    /// How it compares with zero, where that is certain.
    fn settled_sign(self) -> Option<Ordering> {
        self.is_settled().then_some(match (self.is_zero(), self.negative) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        })
    }

    /// Whether every value of the ball is below every value of the other's. Not counted.
    pub fn surely_below(self, other: Wide) -> bool {
        let difference = self - other;
        difference.middle_below(Wide::EXACT_ZERO) && difference.is_settled()
    }

    /// The square root; unknown for a negative number.
    #[must_use]
    pub fn root(self) -> Wide {
        let is_zero = self.is_zero();
        if !self.is_known() || (self.negative && !is_zero && self.is_settled()) {
            return Wide::NOT_KNOWN;
        }
        // An even exponent, and a quarter at least below the root, which is a half then.
        let shift = self.exponent.rem_euclid(2);
        let exponent = (self.exponent + shift) / 2;
        let own = self.radius * radius::power(-shift);
        // |√x − √y| ≤ √|x − y|
        let of_radius = radius::rounded_up(own.sqrt());
        if self.negative || is_zero {
            return Wide::around_zero(of_radius, exponent);
        }
        let count = KEPT.get();
        let (root, cut) = digits::root(Fraction(self.used()), shift as u32, count);
        let middle = Wide::cut(false, &root[..count], exponent, cut);
        // |√(x+δ) − √x| ≤ |δ| / √x
        let inherited = if self.is_settled() { radius::rounded_up(own / middle.at_least()) } else { of_radius };
        middle.widened(inherited, exponent)
    }

    /// The digits after a point times 2^exponent, as many as are kept of which the highest has its highest bit set, and whether more were cut off.
    fn cut(negative: bool, digits: &[u64], exponent: i64, cut: bool) -> Wide {
        let lost = radius::power(-(digits.len() as i64 * i64::from(DIGIT)));
        Wide::rounded(negative, digits, exponent, if cut { lost } else { radius::EXACT })
    }

    /// The digits after a point times 2^exponent, of which the radius is so many, cut to those that are kept.
    fn rounded(negative: bool, digits: &[u64], exponent: i64, radius: f64) -> Wide {
        let Some(highest) = digits.iter().rposition(|&digit| digit != 0) else {
            return Wide::around_zero(radius::rounded_up(radius), exponent);
        };
        let shift = digits[highest].leading_zeros();
        let down = (digits.len() - 1 - highest) as i64 * i64::from(DIGIT) + i64::from(shift);
        let (whole_radius, whole_exponent) = (radius, exponent);
        let exponent = exponent - down;
        let (count, available) = (KEPT.get(), highest + 1);
        let (rest, kept) = digits[..available].split_at(available.saturating_sub(count));
        let mut significand = [0; MAX_DIGITS];
        let into = &mut significand[MAX_DIGITS - kept.len()..];
        let below = rest.last().copied().unwrap_or(0);
        let mut cut = rest.iter().any(|&digit| digit != 0);
        if shift == 0 {
            into.copy_from_slice(kept);
        } else {
            let mut carried = below >> (DIGIT - shift);
            for (into, &digit) in into.iter_mut().zip(kept) {
                *into = digit << shift | carried;
                carried = digit >> (DIGIT - shift);
            }
            cut = cut && (below << shift != 0 || rest[..rest.len() - 1].iter().any(|&digit| digit != 0));
        }
        let zeros = into.iter().take_while(|&&digit| digit == 0).count();
        let length = (kept.len() - zeros) as u8;
        let lost = if cut { radius::power(-(count as i64 * i64::from(DIGIT))) } else { radius::EXACT };
        let radius = radius::rounded_up(radius::shifted(radius, down) + lost);
        Wide { digits: significand, exponent, radius, length, negative }.bounded(whole_radius, whole_exponent)
    }

    /// The same number where its radius is not too large. Else zero with a radius that covers what is below 2^exponent and was so many of these off, or
    /// unknown where that is.
    #[inline(always)]
    fn bounded(self, radius: f64, exponent: i64) -> Wide {
        if self.radius <= radius::LARGEST { self } else { Wide::covering(radius, exponent) }
    }

    #[cold]
    fn covering(radius: f64, exponent: i64) -> Wide {
        Wide::around_zero(radius::rounded_up(radius + 1.0), exponent)
    }

    /// Zero but for an error of so many 2^exponent, of which it takes another exponent, so that products of such numbers keep theirs.
    fn around_zero(radius: f64, exponent: i64) -> Wide {
        if radius == radius::EXACT {
            return Wide::EXACT_ZERO;
        }
        if !radius.is_finite() {
            return Wide::NOT_KNOWN;
        }
        let (radius, up) = radius::split(radius);
        Wide { radius, exponent: exponent + up, ..Wide::EXACT_ZERO }
    }

    /// The same middle with a radius to which so many 2^exponent are added.
    fn widened(self, by: f64, exponent: i64) -> Wide {
        if by == radius::EXACT {
            return self;
        }
        if self.is_exact_zero() {
            return Wide::around_zero(by, exponent);
        }
        let shift = exponent - self.exponent;
        let added = radius::shifted(radius::shifted(by, shift.min(1023)), (shift - 1023).max(0));
        let radius = radius::rounded_up(self.radius + added);
        if radius <= radius::LARGEST || shift < 0 {
            return Wide { radius, ..self }.bounded(radius, self.exponent);
        }
        // The middle is nothing beside it.
        let own = radius::shifted(radius::rounded_up(self.radius + 1.0), -shift);
        Wide::around_zero(radius::rounded_up(own + by), exponent)
    }

    /// The significand as a fraction of two digits, if it has no more.
    fn short(&self) -> Option<u128> {
        (self.length <= 2)
            .then(|| u128::from(self.digits[MAX_DIGITS - 1]) << DIGIT | u128::from(self.digits[MAX_DIGITS - 2]))
    }

    /// A fraction of four digits times 2^exponent, of which the radius is so many, cut to those that are kept.
    #[inline(always)]
    fn of_short(negative: bool, upper: u128, lower: u128, exponent: i64, radius: f64) -> Wide {
        if upper | lower == 0 {
            return Wide::around_zero(radius::rounded_up(radius), exponent);
        }
        let (upper, lower, down) = if upper == 0 { (lower, 0, 128) } else { (upper, lower, 0) };
        let shift = upper.leading_zeros();
        let down = down + i64::from(shift);
        let (upper, lower) = match shift {
            0 => (upper, lower),
            _ => (upper << shift | lower >> (128 - shift), lower << shift),
        };
        let mut digits = [0; MAX_DIGITS];
        (digits[MAX_DIGITS - 1], digits[MAX_DIGITS - 2]) = ((upper >> DIGIT) as u64, upper as u64);
        let mut length = if upper as u64 == 0 { 1 } else { 2 };
        let mut lost = radius::EXACT;
        if lower != 0 {
            if KEPT.get() > 2 {
                (digits[MAX_DIGITS - 3], digits[MAX_DIGITS - 4]) = ((lower >> DIGIT) as u64, lower as u64);
                length = if lower as u64 == 0 { 3 } else { 4 };
            } else {
                lost = radius::power(-128);
            }
        }
        let own = radius::rounded_up(radius * radius::power(down) + lost);
        Wide { digits, exponent: exponent - down, radius: own, length, negative }.bounded(radius, exponent)
    }

    /// The sum of two numbers of up to two digits that are not zero, where it needs no more than four.
    #[inline(always)]
    fn short_sum(&self, other: &Wide) -> Option<Wide> {
        let (one, two) = (self.short()?, other.short()?);
        let is_larger = (self.exponent, one) >= (other.exponent, two);
        let (large, small, high, low) = if is_larger { (self, other, one, two) } else { (other, self, two, one) };
        let shift = large.exponent - small.exponent;
        let keeps_more = KEPT.get() > 2;
        if shift >= if keeps_more { 128 } else { 127 } {
            return None;
        }
        let radius = large.radius + radius::shifted(small.radius, -shift);
        let (upper, lower) = if shift == 0 { (low, 0) } else { (low >> shift, low << (128 - shift)) };
        if large.negative != small.negative {
            let (lower, borrow) = 0u128.overflowing_sub(lower);
            let upper = high - upper - u128::from(borrow);
            return Some(Wide::of_short(large.negative, upper, lower, large.exponent, radius));
        }
        let (upper, carry) = high.overflowing_add(upper);
        if !carry {
            return Some(Wide::of_short(large.negative, upper, lower, large.exponent, radius));
        }
        if lower & 1 == 1 && keeps_more {
            return None;
        }
        // The last bit is kept as one that is cut.
        let (upper, lower) = (1 << 127 | upper >> 1, upper << 127 | lower >> 1 | lower & 1);
        Some(Wide::of_short(large.negative, upper, lower, large.exponent + 1, radius * 0.5))
    }

    /// The sum of two numbers that are not zero.
    #[inline(never)]
    fn long_sum(&self, other: &Wide) -> Wide {
        if !self.is_known() || !other.is_known() {
            return Wide::NOT_KNOWN;
        }
        let is_larger = match self.exponent.cmp(&other.exponent) {
            Ordering::Equal => Fraction(self.used()).order(Fraction(other.used())).is_ge(),
            order => order.is_gt(),
        };
        let (large, small) = if is_larger { (self, other) } else { (other, self) };
        let shift = large.exponent - small.exponent;
        if shift >= KEPT.get() as i64 * i64::from(DIGIT) - 1 {
            return large.widened(radius::rounded_up(small.radius + small.at_most()), small.exponent);
        }
        let radius = large.radius + radius::shifted(small.radius, -shift);
        // A digit for what is carried, and one at the end for what is shifted beyond the last.
        let (whole, shift) = ((shift / i64::from(DIGIT)) as usize, (shift % i64::from(DIGIT)) as u32);
        let below = usize::from(large.length).max(whole + usize::from(small.length) + 1);
        let (mut sum, mut shifted): (Long, Long) = ([0; 2 * MAX_DIGITS + 2], [0; 2 * MAX_DIGITS + 2]);
        sum[below - usize::from(large.length)..below].copy_from_slice(large.used());
        Fraction(small.used()).write(&mut shifted, below - whole, shift);
        let sum = &mut sum[..=below];
        if large.negative == small.negative {
            digits::add(sum, &shifted[..below - whole]);
        } else {
            digits::subtract(sum, &shifted[..below - whole]);
        }
        Wide::rounded(
            large.negative,
            sum,
            large.exponent + i64::from(DIGIT),
            radius::shifted(radius, -i64::from(DIGIT)),
        )
    }

    /// Not above the middle's magnitude, in units of 2^exponent.
    fn at_least(&self) -> f64 {
        radius::at_least(self.leading())
    }

    /// Not below it.
    fn at_most(&self) -> f64 {
        radius::at_most(self.leading())
    }

    /// Whether the sign is certain.
    fn is_settled(&self) -> bool {
        self.is_exact() || self.radius < self.at_least()
    }
}

impl Enclosing for Wide {
    fn radius_bound(self) -> f64 {
        radius::shifted(self.radius, self.exponent)
    }
    fn with_radius(self, radius: f64) -> Wide {
        let middle = if self.is_zero() { Wide::EXACT_ZERO } else { Wide { radius: radius::EXACT, ..self } };
        middle.widened(radius, 0)
    }
    fn is_exact_zero(self) -> bool {
        self.is_exact_zero()
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
    #[inline]
    fn add(self, other: Wide) -> Wide {
        if self.is_zero() {
            return other.widened(self.radius, self.exponent);
        }
        if other.is_zero() {
            return self.widened(other.radius, other.exponent);
        }
        self.short_sum(&other).unwrap_or_else(|| self.long_sum(&other))
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
    #[inline]
    fn mul(self, other: Wide) -> Wide {
        let inherited = (self.at_most() + self.radius) * other.radius + other.at_most() * self.radius;
        // Two radii may have a product that f64 has none of.
        let both = if self.is_exact() || other.is_exact() { radius::EXACT } else { f64::MIN_POSITIVE };
        let radius = radius::rounded_up(inherited + both);
        let (negative, exponent) = (self.negative != other.negative, self.exponent + other.exponent);
        if let (Some(one), Some(two)) = (self.short(), other.short()) {
            let (upper, lower) = digits::short_product(one, two);
            return Wide::of_short(negative, upper, lower, exponent, radius);
        }
        let digits = digits::product(self.used(), other.used());
        let digits = &digits[..usize::from(self.length + other.length)];
        Wide::rounded(negative, digits, exponent, radius)
    }
}

impl Div for Wide {
    type Output = Wide;
    fn div(self, other: Wide) -> Wide {
        if other.is_zero() || !self.is_known() || !other.is_settled() {
            return Wide::NOT_KNOWN;
        }
        let (dividend, divisor) = (Fraction(self.used()), Fraction(other.used()));
        // Half the dividend is below the divisor.
        let shift = u32::from(dividend.order(divisor).is_ge());
        let count = KEPT.get();
        let (quotient, cut) = digits::quotient(dividend, shift, other.used(), count);
        let exponent = self.exponent - other.exponent + i64::from(shift);
        let middle = Wide::cut(self.negative != other.negative, &quotient[..count], exponent, cut);
        if self.is_exact() && other.is_exact() {
            return middle;
        }
        // |(A+α)/(B+β) − A/B| ≤ (|α| + |A/B|·|β|) / (|B| − |β|), all in units of the powers of two that A and B have.
        let unit = self.exponent - other.exponent;
        let quotient = radius::shifted(radius::rounded_up(middle.at_most() + middle.radius), middle.exponent - unit);
        let divisor = radius::rounded_down(other.at_least() - other.radius);
        let inherited = radius::rounded_up((self.radius + quotient * other.radius) / divisor);
        middle.widened(inherited, unit)
    }
}

impl PartialOrd for Wide {
    /// The order; equal, and counted as unsettled, where the intervals meet; `None` if either is unknown.
    fn partial_cmp(&self, other: &Wide) -> Option<Ordering> {
        let difference = *self - *other;
        let order = difference.settled_sign();
        if order.is_none() {
            count_one_unsettled();
        }
        order.or(difference.is_known().then_some(Ordering::Equal))
    }
}

impl PartialEq for Wide {
    /// As [`Wide::partial_cmp`] says, and counted alike.
    fn eq(&self, other: &Wide) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}
