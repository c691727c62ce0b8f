//! Exact input numbers (SPEC section 1): every value a user writes is a rational, and stays one.

// Longer than 400 lines: one type, how it is read, rounded and calculated with.

use crate::dyadic::Dyadic;
use crate::fraction;
use num_bigint::{BigInt, BigUint};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::fmt;

/// An exact number: an f64 where one represents it, a fraction otherwise.
///
/// The two forms never overlap, so equality of the representation is equality of the value.
#[derive(Clone, Debug, PartialEq)]
pub struct Number(NumberForm);

#[derive(Clone, Debug, PartialEq)]
enum NumberForm {
    /// Finite, never −0.
    Float(f64),
    /// Not representable as f64.
    Ratio(Box<BigRational>),
}

impl Eq for Number {}

/// Why a value is not a usable number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// NaN or infinite.
    #[error("{found} is not a finite number")]
    NotFinite {
        /// What was found.
        found: String,
    },
    /// Text that is no number.
    #[error(
        "\"{found}\" is not a number; allowed are decimals (\"0.1\"), fractions (\"1/3\") and hexadecimal floats (\"0x1.8p-3\")"
    )]
    NotANumber {
        /// What was found.
        found: String,
    },
    /// A fraction over zero.
    #[error("\"{found}\" divides by zero")]
    ZeroDenominator {
        /// What was found.
        found: String,
    },
    /// An exponent so large that the exact value would not fit in memory.
    #[error("\"{found}\" has an exponent outside ±{limit}")]
    ExponentTooLarge {
        /// What was found.
        found: String,
        /// Largest magnitude allowed.
        limit: u32,
    },
    /// More digits than any number in use has.
    #[error("\"{found}\" has more than {limit} digits")]
    TooManyDigits {
        /// What was found, shortened.
        found: String,
        /// Most digits allowed.
        limit: usize,
    },
    /// A value whose rounding to the engine's precision overflows.
    #[error("{found} overflows when rounded to {precision}")]
    Overflow {
        /// The value, in decimal.
        found: String,
        /// The precision asked for.
        precision: Precision,
    },
}

/// The floating-point format an engine calculates in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Precision {
    /// IEEE 754 binary32.
    F32,
    /// IEEE 754 binary64.
    F64,
}

impl Precision {
    /// Bits of the significand, the hidden one included.
    pub fn digits(self) -> u32 {
        match self {
            Precision::F32 => f32::MANTISSA_DIGITS,
            Precision::F64 => f64::MANTISSA_DIGITS,
        }
    }

    /// The distance from 1 to the next larger number, `eps` in SPEC section 3.
    pub fn epsilon(self) -> f64 {
        match self {
            Precision::F32 => f64::from(f32::EPSILON),
            Precision::F64 => f64::EPSILON,
        }
    }

    /// Exponent of the smallest positive (subnormal) number.
    fn smallest_exponent(self) -> i64 {
        match self {
            Precision::F32 => -149,
            Precision::F64 => -1074,
        }
    }

    fn largest(self) -> f64 {
        match self {
            Precision::F32 => f64::from(f32::MAX),
            Precision::F64 => f64::MAX,
        }
    }

    /// The name in files and tables: `f32` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Number {
    /// Zero.
    pub const ZERO: Number = Number(NumberForm::Float(0.0));

    /// The number a finite f64 stands for.
    ///
    /// # Errors
    /// When `value` is NaN or infinite.
    pub fn from_f64(value: f64) -> Result<Number, NumberError> {
        if value.is_finite() {
            Ok(Number(NumberForm::Float(value + 0.0)))
        } else {
            Err(NumberError::NotFinite { found: value.to_string() })
        }
    }

    /// The number an integer stands for.
    pub fn from_integer(value: i32) -> Number {
        Number(NumberForm::Float(f64::from(value)))
    }

    /// The number a fraction stands for.
    pub fn from_rational(value: BigRational) -> Number {
        // In lowest terms only a power of two under the bar and as many digits above it as fit can be a float; most fractions end
        // here, without a division.
        let digits = value.numer().bits() - value.numer().trailing_zeros().unwrap_or(0);
        if exact_log2(value.denom()).is_none() || digits > u64::from(f64::MANTISSA_DIGITS) {
            return Number(NumberForm::Ratio(Box::new(value)));
        }
        match round_rational(&value, Precision::F64) {
            Some(float) if rational_of_f64(float) == value => Number(NumberForm::Float(float + 0.0)),
            _ => Number(NumberForm::Ratio(Box::new(value))),
        }
    }

    /// The value as a fraction in lowest terms.
    pub fn to_rational(&self) -> BigRational {
        match &self.0 {
            NumberForm::Float(value) => rational_of_f64(*value),
            NumberForm::Ratio(value) => (**value).clone(),
        }
    }

    /// The f64 that represents the value exactly, if one does.
    #[inline]
    pub fn as_f64(&self) -> Option<f64> {
        match self.0 {
            NumberForm::Float(value) => Some(value),
            NumberForm::Ratio(_) => None,
        }
    }

    /// The fraction, for a value no f64 represents.
    #[inline]
    pub fn as_ratio(&self) -> Option<&BigRational> {
        match &self.0 {
            NumberForm::Float(_) => None,
            NumberForm::Ratio(value) => Some(value),
        }
    }

    /// The value as p/m · 2^k with odd m; `None` where p or m has many digits.
    #[inline]
    pub fn small_fraction(&self) -> Option<(i128, u64, i32)> {
        match &self.0 {
            NumberForm::Float(value) => {
                let (significand, exponent) = split_f64(*value);
                Some((i128::from(significand), 1, exponent))
            }
            NumberForm::Ratio(value) => small_fraction_of_ratio(value),
        }
    }

    /// The nearest value of the precision, ties to even, or `None` if that overflows.
    pub fn rounded(&self, precision: Precision) -> Option<f64> {
        match (&self.0, precision) {
            (NumberForm::Float(value), Precision::F64) => Some(*value),
            (NumberForm::Float(value), Precision::F32) => {
                let near = *value as f32;
                near.is_finite().then(|| f64::from(near) + 0.0)
            }
            (NumberForm::Ratio(value), precision) => round_rational(value, precision).map(|v| v + 0.0),
        }
    }

    /// The nearest f64, infinite where that overflows: for showing to people, never for deciding.
    pub fn approximate(&self) -> f64 {
        self.rounded(Precision::F64).unwrap_or(match &self.0 {
            NumberForm::Ratio(value) if value.is_negative() => f64::NEG_INFINITY,
            _ => f64::INFINITY,
        })
    }

    /// Whether the precision represents the value exactly.
    pub fn is_exact_in(&self, precision: Precision) -> bool {
        match (&self.0, precision) {
            (NumberForm::Float(_), Precision::F64) => true,
            (NumberForm::Float(value), Precision::F32) => f64::from(*value as f32) == *value,
            (NumberForm::Ratio(_), _) => false,
        }
    }

    /// `self + other`, exactly.
    #[must_use]
    pub fn plus(&self, other: &Number) -> Number {
        if other.is_zero() {
            return self.clone();
        }
        if let (NumberForm::Float(a), NumberForm::Float(b)) = (&self.0, &other.0) {
            // Knuth's two-sum: the sum is exact when the error term is zero.
            let sum = a + b;
            let b_part = sum - a;
            let error = (a - (sum - b_part)) + (b - b_part);
            if error == 0.0 && sum.is_finite() {
                return Number(NumberForm::Float(sum + 0.0));
            }
        }
        if let (Some(a), Some(b)) = (self.dyadic(), other.dyadic()) {
            return Number::from_rational(a.plus(b).into_rational());
        }
        match (&self.0, &other.0) {
            (NumberForm::Ratio(ratio), NumberForm::Float(float))
            | (NumberForm::Float(float), NumberForm::Ratio(ratio)) => {
                Number::from_rational(ratio_plus_float(ratio, *float))
            }
            _ => Number::from_rational(fraction::sum(&self.to_rational(), &other.to_rational())),
        }
    }

    /// The value as a binary fraction, if it is one.
    fn dyadic(&self) -> Option<Dyadic> {
        match &self.0 {
            NumberForm::Float(value) => Some(Dyadic::of_f64(*value)),
            NumberForm::Ratio(value) => Dyadic::of_ratio(value),
        }
    }

    /// `self · other`, exactly.
    #[must_use]
    pub fn times(&self, other: &Number) -> Number {
        if let (NumberForm::Float(a), NumberForm::Float(b)) = (&self.0, &other.0) {
            // The fused product tells what the rounded one lost; well above underflow it loses nothing itself.
            let product = a * b;
            if product.is_finite() && product.abs() > 1e-250 && a.mul_add(*b, -product) == 0.0 {
                return Number(NumberForm::Float(product));
            }
        }
        match (self.dyadic(), other.dyadic()) {
            (Some(a), Some(b)) => Number::from_rational(a.times(b).into_rational()),
            _ => Number::from_rational(fraction::product(&self.to_rational(), &other.to_rational())),
        }
    }

    /// `−self`.
    #[must_use]
    pub fn negated(&self) -> Number {
        match &self.0 {
            NumberForm::Float(value) => Number(NumberForm::Float(0.0 - value)),
            NumberForm::Ratio(value) => Number(NumberForm::Ratio(Box::new(-(**value).clone()))),
        }
    }

    /// Whether the value is exactly zero.
    pub fn is_zero(&self) -> bool {
        self.0 == NumberForm::Float(0.0)
    }

    /// Whether the value is below zero.
    pub fn is_negative(&self) -> bool {
        match &self.0 {
            NumberForm::Float(value) => *value < 0.0,
            NumberForm::Ratio(value) => value.is_negative(),
        }
    }
}

impl Ord for Number {
    fn cmp(&self, other: &Self) -> Ordering {
        match (&self.0, &other.0) {
            (NumberForm::Float(a), NumberForm::Float(b)) => a.total_cmp(b),
            _ => match (self.dyadic(), other.dyadic()) {
                (Some(a), Some(b)) => a.cmp(b),
                _ => self.to_rational().cmp(&other.to_rational()),
            },
        }
    }
}

impl PartialOrd for Number {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The significand and exponent of a finite f64: `value = significand · 2^exponent`, exactly; the significand of a
/// nonzero value is odd.
#[inline]
pub fn split_f64(value: f64) -> (i64, i32) {
    if value == 0.0 {
        return (0, 0);
    }
    let bits = value.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (significand, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | (1 << 52), biased - 1075) };
    let shift = significand.trailing_zeros();
    let odd = significand >> shift;
    (if value < 0.0 { -odd } else { odd }, exponent + shift as i32)
}

fn rational_of_f64(value: f64) -> BigRational {
    let (significand, exponent) = split_f64(value);
    dyadic(BigInt::from(significand), i64::from(exponent))
}

/// The fraction `significand · 2^exponent`, in lowest terms without a greatest common divisor: only twos can cancel.
pub fn dyadic(significand: BigInt, exponent: i64) -> BigRational {
    if exponent >= 0 {
        return BigRational::from_integer(significand << exponent.unsigned_abs());
    }
    let Some(zeros) = significand.trailing_zeros() else { return BigRational::default() };
    let below = exponent.unsigned_abs();
    let cancelled = zeros.min(below);
    BigRational::new_raw(significand >> cancelled, BigInt::one() << (below - cancelled))
}

/// The exact sum, in lowest terms without a greatest common divisor: only twos can cancel.
fn ratio_plus_float(ratio: &BigRational, float: f64) -> BigRational {
    let (significand, exponent) = split_f64(float);
    let below = (-exponent).max(0) as usize;
    let twos = ratio.denom().trailing_zeros().unwrap_or(0) as usize;
    let common = twos.max(below);
    let odd = ratio.denom() >> twos;
    let term = (BigInt::from(significand) << (common + exponent.max(0) as usize - below)) * &odd;
    let numerator = (ratio.numer() << (common - twos)) + term;
    let cancelled = (numerator.trailing_zeros().unwrap_or(common as u64) as usize).min(common);
    BigRational::new_raw(numerator >> cancelled, odd << (common - cancelled))
}

/// The k of an integer 2^k; `None` for any other, zero among them.
pub fn exact_log2(integer: &BigInt) -> Option<u64> {
    let twos = integer.trailing_zeros()?;
    (integer.is_positive() && twos + 1 == integer.bits()).then_some(twos)
}

fn small_fraction_of_ratio(value: &BigRational) -> Option<(i128, u64, i32)> {
    let (odd, twos) = odd_and_twos(value.denom())?;
    Some((value.numer().to_i128()?, odd, -(twos as i32)))
}

/// The p and k of a positive integer `p · 2^k` with odd p, where few digits hold it.
fn odd_and_twos(integer: &BigInt) -> Option<(u64, u32)> {
    let value = integer.to_u128()?;
    let twos = value.trailing_zeros();
    Some((u64::try_from(value.checked_shr(twos)?).ok()?, twos))
}

/// The nearest number of the precision, ties to even; `None` when it overflows.
pub fn round_rational(value: &BigRational, precision: Precision) -> Option<f64> {
    if value.is_zero() {
        return Some(0.0);
    }
    let digits = i64::from(precision.digits());
    let (numerator, denominator) = (value.numer().magnitude(), value.denom().magnitude());
    if let Some(near) = rounded_quotient(numerator, denominator, precision) {
        return Some(if value.is_negative() { -near } else { near });
    }
    // 2^(magnitude − 1) < |value| < 2^(magnitude + 1)
    let magnitude = numerator.bits() as i64 - denominator.bits() as i64;
    let mut unit = (magnitude - digits).max(precision.smallest_exponent());
    let (mut quotient, up) = if let Some(twos) = exact_log2(value.denom()) {
        // Its first digit is known, so the unit is the right one at once.
        unit = (magnitude + 1 - digits).max(precision.smallest_exponent());
        shifted(numerator, unit + twos as i64)
    } else {
        let mut divided = divide_by_unit(numerator, denominator, unit);
        if divided.0.bits() as i64 > digits {
            unit += 1;
            divided = divide_by_unit(numerator, denominator, unit);
        }
        let (quotient, remainder, divisor) = divided;
        let up = match (remainder << 1u32).cmp(&divisor) {
            Ordering::Greater => true,
            Ordering::Equal => quotient.is_odd(),
            Ordering::Less => false,
        };
        (quotient, up)
    };
    if up {
        quotient += 1u32;
    }
    if unit > 1023 {
        return None;
    }
    let near = quotient.to_f64()? * power_of_two(unit as i32);
    if near > precision.largest() {
        return None;
    }
    Some(if value.is_negative() { -near } else { near })
}

/// The nearest number to a quotient, by the first 64 digits of both where these tell, and where it is far from the ends of the precision's range.
fn rounded_quotient(numerator: &BigUint, denominator: &BigUint, precision: Precision) -> Option<f64> {
    let ([least, most], one) = leading(numerator)?;
    let ([at_least, at_most], two) = leading(denominator)?;
    let exponent = one - two - 63;
    // A quotient has 63 or 64 digits before the exponent; it must not be subnormal, nor the power of two.
    let range = match precision {
        Precision::F32 => -126 - 62..126 - 64,
        Precision::F64 => -1022..1022 - 64,
    };
    if !range.contains(&exponent) {
        return None;
    }
    let [low, high] = [(least << 63) / at_most, (most << 63).div_ceil(at_least)];
    let nearest = |quotient: u128| match precision {
        Precision::F32 => f64::from(quotient as f32),
        Precision::F64 => quotient as f64,
    };
    let near = nearest(low);
    (near == nearest(high)).then(|| near * power_of_two(exponent as i32))
}

/// Between which two integers of 64 digits (or which is it) a number above zero is, in units of 2 to the exponent that comes with them.
fn leading(value: &BigUint) -> Option<([u128; 2], i64)> {
    let mut digits = value.iter_u64_digits().rev();
    let (first, second) = (digits.next()?, digits.next());
    let shift = first.leading_zeros();
    let exponent = value.bits() as i64 - 64;
    let Some(second) = second else { return Some(([u128::from(first << shift); 2], exponent)) };
    let both = ((u128::from(first) << 64) | u128::from(second)) << shift;
    let top = both >> 64;
    let is_exact = both as u64 == 0 && digits.all(|digit| digit == 0);
    Some(([top, top + u128::from(!is_exact)], exponent))
}

/// The quotient of `numerator / 2^places`, cut, and whether the nearest number is one more, ties to even.
fn shifted(numerator: &BigUint, places: i64) -> (BigUint, bool) {
    if places <= 0 {
        return (numerator << places.unsigned_abs(), false);
    }
    let (places, quotient) = (places.unsigned_abs(), numerator >> places);
    let (is_half_or_more, rest) = (numerator.bit(places - 1), numerator.trailing_zeros() < Some(places - 1));
    let up = is_half_or_more && (rest || quotient.is_odd());
    (quotient, up)
}

/// Quotient and remainder of `numerator / (denominator · 2^unit)`, and the divisor used.
fn divide_by_unit(numerator: &BigUint, denominator: &BigUint, unit: i64) -> (BigUint, BigUint, BigUint) {
    let (numerator, divisor) = if unit >= 0 {
        (numerator.clone(), denominator << unit as usize)
    } else {
        (numerator << unit.unsigned_abs() as usize, denominator.clone())
    };
    let (quotient, remainder) = numerator.div_rem(&divisor);
    (quotient, remainder, divisor)
}

/// `2^exponent` for −1074 ≤ exponent ≤ 1023, exactly.
pub fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1074..=1023).contains(&exponent), "2^{exponent} is no f64");
    if exponent >= -1022 {
        f64::from_bits(((exponent + 1023) as u64) << 52)
    } else {
        f64::from_bits(1u64 << (exponent + 1074))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(n: i64, d: i64) -> BigRational {
        BigRational::new(n.into(), d.into())
    }

    #[test]
    fn forms_never_overlap() {
        assert_eq!(Number::from_rational(ratio(1, 4)).as_f64(), Some(0.25));
        assert!(Number::from_rational(ratio(1, 3)).as_f64().is_none());
        assert_eq!(Number::from_f64(-0.0).unwrap(), Number::ZERO);
    }

    #[test]
    fn rounds_to_nearest_even() {
        assert_eq!(round_rational(&ratio(1, 3), Precision::F64), Some(1.0 / 3.0));
        assert_eq!(round_rational(&ratio(1, 3), Precision::F32), Some(f64::from(1.0f32 / 3.0f32)));
        let half_way = ratio((1 << 25) + 1, 1 << 25);
        assert_eq!(round_rational(&half_way, Precision::F32), Some(1.0));
        let odd_half_way = ratio((1 << 24) + 3, 1 << 24);
        assert_eq!(round_rational(&odd_half_way, Precision::F32), Some(1.0 + 4.0 / f64::from(1 << 24)));
        let tiny = rational_of_f64(f64::from_bits(1)) / BigInt::from(2);
        assert_eq!(round_rational(&tiny, Precision::F64), Some(0.0));
        let above = tiny * ratio(1_000_001, 1_000_000);
        assert_eq!(round_rational(&above, Precision::F64), Some(f64::from_bits(1)));
        assert_eq!(round_rational(&BigRational::from_integer(BigInt::one() << 1024usize), Precision::F64), None);
        assert_eq!(round_rational(&rational_of_f64(1e39), Precision::F32), None);
    }

    /// Over a power of two nothing is divided; an integer of the language, which rounds alike, tells what is right.
    #[test]
    fn binary_fractions_round_as_integers_do() {
        let mut numerators =
            vec![1i128, (1 << 53) - 1, (1 << 53) + 1, (1 << 54) + 2, (1 << 54) + 6, i128::MAX, i128::MIN + 1];
        // Digits beyond the half of the last place, at it and before it, in every length.
        let near_half = [(1i128 << 60) + 1, 3 << 59, (5 << 59) + 1, (1 << 59) - 1];
        numerators.extend((0..60).flat_map(|k| near_half.map(|n| (1i128 << (60 + k % 61)) + (n << 3) - (1 << k))));
        for n in numerators.into_iter().flat_map(|n| [n, -n]) {
            for twos in [0, 1, 52, 130] {
                let value = BigRational::new(n.into(), BigInt::one() << twos as usize);
                let unit = power_of_two(-twos);
                assert_eq!(round_rational(&value, Precision::F64), Some(n as f64 * unit), "{n} / 2^{twos}");
                // In f32 far below its least normal number at 130 places.
                let near = round_rational(&value, Precision::F32).unwrap();
                assert!(twos > 100 || near == f64::from(n as f32) * unit, "{n} / 2^{twos} in f32");
                let is_float = rational_of_f64(n as f64 * unit) == value;
                assert_eq!(Number::from_rational(value).as_f64().is_some(), is_float);
            }
        }
        // The last place below the least normal number is twice as far away.
        let least = BigRational::new(BigInt::from(-3), BigInt::one() << 1075usize);
        assert_eq!(round_rational(&least, Precision::F64), Some(-f64::from_bits(2)));
        assert_eq!(round_rational(&(least / BigInt::from(3)), Precision::F64), Some(-0.0));
    }

    /// By the first digits or by all of them: no neighbour is nearer, and of two as near it is the even one.
    #[test]
    fn quotients_round_to_the_nearest_number() {
        let mut seed = 1u64;
        let mut long = |digits: u32| {
            let mut value = BigInt::one();
            for _ in 0..digits {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                value = (value << 11) + (seed >> 53);
            }
            value
        };
        let mut values = Vec::new();
        for k in 0..400 {
            let (n, d) = (long(k % 23), long(k % 17));
            values.push(BigRational::new(n.clone(), d.clone()));
            // Halfway between two floats, and next to that.
            let odd = (BigInt::one() << 53usize) + 2 * (k / 2) + 1;
            let nudge = [BigInt::zero(), BigInt::one(), BigInt::from(-1)][k as usize % 3].clone();
            values.push(BigRational::new(((odd * &d) << 90usize) + nudge, d << (90 + k as usize % 40)));
        }
        for value in values {
            for (value, negate) in [(value.clone(), false), (-value, true)] {
                let near = round_rational(&value, Precision::F64).unwrap();
                assert_eq!(near < 0.0, negate);
                let off = |float: f64| (rational_of_f64(float) - &value).abs();
                for neighbour in [near.next_up(), near.next_down()] {
                    let is_even = near.to_bits() & 1 == 0;
                    assert!(off(near) < off(neighbour) || (off(near) == off(neighbour) && is_even), "{value}: {near}");
                }
                let Some(short) = round_rational(&value, Precision::F32) else { continue };
                let off_by = |float: f32| off(f64::from(float));
                let float = short as f32;
                assert_eq!(f64::from(float), short);
                for neighbour in [float.next_up(), float.next_down()] {
                    let is_even = float.to_bits() & 1 == 0;
                    let ties = off_by(float) == off_by(neighbour) && is_even;
                    assert!(off_by(float) < off_by(neighbour) || ties, "{value}: {short} in f32");
                }
            }
        }
    }

    #[test]
    fn sums_of_fractions_and_floats_are_in_lowest_terms() {
        for (n, d) in [(1, 3), (-5, 6), (7, 12), (1 << 40, 3 << 20), (-11, 1 << 60)] {
            for float in [0.5, -3.0, 12.0, 0.1, 1e20, -1e-20, 2f64.powi(-60), 1.0 / 3.0] {
                let (ratio, float) = (Number::from_rational(ratio(n, d)), Number::from_f64(float).unwrap());
                let expected = Number::from_rational(ratio.to_rational() + float.to_rational());
                assert_eq!((ratio.plus(&float), float.plus(&ratio)), (expected.clone(), expected));
            }
        }
    }

    #[test]
    fn products_stay_exact() {
        let float = |x: f64| Number::from_f64(x).unwrap();
        assert_eq!(float(0.1).times(&float(8.0)).as_f64(), Some(0.8));
        assert_eq!(float(0.1).times(&float(-0.0)), Number::ZERO);
        for (a, b) in [(0.1, 0.1), (3e-200, 7e-200), (1e300, 1e300), (0.1, 3.0), (1.5, 1.25), (5e-324, 0.5)] {
            assert_eq!(float(a).times(&float(b)).to_rational(), rational_of_f64(a) * rational_of_f64(b), "{a} {b}");
        }
    }

    #[test]
    fn sums_stay_exact() {
        let third = Number::from_rational(ratio(1, 3));
        let sixth = Number::from_rational(ratio(1, 6));
        assert_eq!(third.plus(&sixth).as_f64(), Some(0.5));
        let tiny = Number::from_f64(1e-30).unwrap();
        let one = Number::from_integer(1);
        assert!(one.plus(&tiny).as_f64().is_none());
        assert_eq!(one.plus(&tiny).plus(&one.negated()), tiny);
    }
}
