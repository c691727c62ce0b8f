//! Exact input numbers (SPEC section 1): every value a user writes is a rational, and stays one.

// Longer than 400 lines: one type, how it is read, rounded and calculated with.

use num_bigint::BigInt;
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
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Precision::F32 => "f32",
            Precision::F64 => "f64",
        })
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
        // In lowest terms only a power of two under the bar can be a float; most fractions end here, without a division.
        if value.denom().trailing_zeros().map_or(0, |twos| twos + 1) != value.denom().bits() {
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
        match (&self.0, &other.0) {
            (NumberForm::Ratio(ratio), NumberForm::Float(float))
            | (NumberForm::Float(float), NumberForm::Ratio(ratio)) => {
                Number::from_rational(ratio_plus_float(ratio, *float))
            }
            _ => Number::from_rational(self.to_rational() + other.to_rational()),
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
        Number::from_rational(self.to_rational() * other.to_rational())
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
            _ => self.to_rational().cmp(&other.to_rational()),
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
    let significand = BigInt::from(significand);
    if exponent >= 0 {
        BigRational::from_integer(significand << exponent as usize)
    } else {
        BigRational::new_raw(significand, BigInt::one() << exponent.unsigned_abs() as usize)
    }
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

/// The nearest number of the precision, ties to even; `None` when it overflows.
pub fn round_rational(value: &BigRational, precision: Precision) -> Option<f64> {
    if value.is_zero() {
        return Some(0.0);
    }
    let digits = i64::from(precision.digits());
    let (numerator, denominator) = (value.numer().abs(), value.denom());
    // 2^(magnitude − 1) < |value| < 2^(magnitude + 1)
    let magnitude = numerator.bits() as i64 - denominator.bits() as i64;
    let mut unit = (magnitude - digits).max(precision.smallest_exponent());
    let (mut quotient, mut remainder, mut divisor) = divide_by_unit(&numerator, denominator, unit);
    if quotient.bits() as i64 > digits {
        unit += 1;
        (quotient, remainder, divisor) = divide_by_unit(&numerator, denominator, unit);
    }
    let up = match (remainder << 1u32).cmp(&divisor) {
        Ordering::Greater => true,
        Ordering::Equal => quotient.is_odd(),
        Ordering::Less => false,
    };
    if up {
        quotient += 1;
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

/// Quotient and remainder of `numerator / (denominator · 2^unit)`, and the divisor used.
fn divide_by_unit(numerator: &BigInt, denominator: &BigInt, unit: i64) -> (BigInt, BigInt, BigInt) {
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
