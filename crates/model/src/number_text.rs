//! Numbers as text: what users write, and the exact form that is written back.

use crate::number::{Number, NumberError, power_of_two, split_f64};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// Largest magnitude of an exponent. Every f64 is well inside; the cap keeps a few characters of input from asking for
/// gigabytes of digits.
pub const EXPONENT_LIMIT: u32 = 1200;

/// Largest number of digits in a numerator or denominator.
pub const DIGIT_LIMIT: usize = 10_000;

impl Number {
    /// The exact value of `text`: a decimal (`"0.1"`, `"-2.5e-3"`), a hexadecimal float (`"0x1.8p-3"`), or a quotient
    /// of two of them of which the second has no sign (`"1/3"`, `"-1.5/7"`). No spaces, no separators.
    ///
    /// # Errors
    /// When `text` is none of these, divides by zero, or has an exponent beyond [`EXPONENT_LIMIT`] or more than
    /// [`DIGIT_LIMIT`] digits. A value too large for f64 is no error here; [`Number::rounded`] tells.
    pub fn parse(text: &str) -> Result<Number, NumberError> {
        let (numerator, denominator) = match text.split_once('/') {
            None => (parse_simple(text, text, true)?, None),
            Some((above, below)) => (parse_simple(above, text, true)?, Some(parse_simple(below, text, false)?)),
        };
        match denominator {
            None => Ok(Number::from_rational(numerator.into_rational())),
            Some(denominator) if denominator.significand.is_zero() => {
                Err(NumberError::ZeroDenominator { found: shown(text) })
            }
            Some(denominator) => Ok(Number::from_rational(numerator.into_rational() / denominator.into_rational())),
        }
    }
}

/// `significand · base^exponent`.
struct Simple {
    significand: BigInt,
    base: u32,
    exponent: i64,
}

impl Simple {
    fn into_rational(self) -> BigRational {
        let power = BigInt::from(self.base).pow(self.exponent.unsigned_abs() as u32);
        if self.exponent >= 0 {
            BigRational::from_integer(self.significand * power)
        } else {
            BigRational::new(self.significand, power)
        }
    }
}

fn parse_simple(part: &str, whole: &str, signed: bool) -> Result<Simple, NumberError> {
    let malformed = || NumberError::NotANumber { found: shown(whole) };
    let (negative, body) = match part.as_bytes().first() {
        Some(b'-') if signed => (true, &part[1..]),
        Some(b'+') if signed => (false, &part[1..]),
        _ => (false, part),
    };
    let hexadecimal = body.strip_prefix("0x").or_else(|| body.strip_prefix("0X"));
    let (digits, radix, marks): (&str, u32, [char; 2]) = match hexadecimal {
        Some(rest) => (rest, 16, ['p', 'P']),
        None => (body, 10, ['e', 'E']),
    };
    let (mantissa, exponent) = match digits.split_once(marks) {
        None => (digits, 0),
        Some((mantissa, exponent)) => (mantissa, parse_exponent(exponent, whole)?),
    };
    let (integer, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if integer.is_empty() && fraction.is_empty() || !integer.chars().chain(fraction.chars()).all(|c| c.is_digit(radix))
    {
        return Err(malformed());
    }
    if integer.len() + fraction.len() > DIGIT_LIMIT {
        return Err(NumberError::TooManyDigits { found: shown(whole), limit: DIGIT_LIMIT });
    }
    let all = [integer, fraction].concat();
    let significand = BigInt::parse_bytes(all.as_bytes(), radix).ok_or_else(malformed)?;
    let places = fraction.len() as i64;
    let (base, exponent) = if radix == 16 { (2, exponent - 4 * places) } else { (10, exponent - places) };
    Ok(Simple { significand: if negative { -significand } else { significand }, base, exponent })
}

fn parse_exponent(text: &str, whole: &str) -> Result<i64, NumberError> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Err(NumberError::NotANumber { found: shown(whole) });
    }
    match text.parse::<i64>() {
        Ok(exponent) if exponent.unsigned_abs() <= u64::from(EXPONENT_LIMIT) => Ok(exponent),
        _ => Err(NumberError::ExponentTooLarge { found: shown(whole), limit: EXPONENT_LIMIT }),
    }
}

/// `text` short enough, and plain enough, to stand in a message.
pub(crate) fn shown(text: &str) -> String {
    const LONGEST: usize = 48;
    let mut short: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}

impl FromStr for Number {
    type Err = NumberError;

    fn from_str(text: &str) -> Result<Number, NumberError> {
        Number::parse(text)
    }
}

/// The exact value as text that [`Number::parse`] reads back: the shortest decimal where that is exact (`0.25`), a
/// hexadecimal float for other f64 (`0x1.999999999999ap-4`), a fraction for the rest (`1/3`).
impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.as_f64(), self.as_ratio()) {
            (Some(value), _) => f.pad(&text_of_f64(value)),
            (None, Some(ratio)) => f.pad(&ratio.to_string()),
            (None, None) => Ok(()),
        }
    }
}

/// For a message: the shortest decimal that rounds to the number where that is an f64, else the fraction that it is.
pub(crate) fn decimal(number: &Number) -> String {
    match number.as_f64() {
        Some(value) => format!("{value:?}").trim_end_matches(".0").to_owned(),
        None => shown(&number.to_string()),
    }
}

fn text_of_f64(value: f64) -> String {
    let decimal = format!("{value:?}");
    let decimal = decimal.strip_suffix(".0").unwrap_or(&decimal);
    if is_exact_decimal(value, decimal) { decimal.to_string() } else { hexadecimal(value) }
}

/// Whether `decimal`, the shortest text that rounds to `value`, is `value` exactly.
fn is_exact_decimal(value: f64, decimal: &str) -> bool {
    let (_, exponent) = split_f64(value);
    // Integers up to 2^53 print all their digits; m·2^−k needs k decimals, and 17 significant digits cannot hold
    // k > 56 of them.
    if (0..=53).contains(&exponent) && value.abs() <= power_of_two(53) {
        return true;
    }
    if exponent < -56 {
        return false;
    }
    Number::parse(decimal).is_ok_and(|n| n.as_f64() == Some(value))
}

fn hexadecimal(value: f64) -> String {
    let (significand, exponent) = split_f64(value);
    let magnitude = significand.unsigned_abs();
    let bits = 63 - magnitude.leading_zeros() as i32;
    let fraction = magnitude - (1 << bits);
    let places = (bits + 3).div_euclid(4);
    let aligned = fraction << (4 * places - bits);
    let sign = if value < 0.0 { "-" } else { "" };
    if places == 0 {
        format!("{sign}0x1p{}", exponent + bits)
    } else {
        format!("{sign}0x1.{aligned:0width$x}p{}", exponent + bits, width = places as usize)
    }
}

/// An f64 as a number, any other value as an exact string, so that a file keeps the value exactly.
impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.as_f64() {
            Some(value) => serializer.serialize_f64(value),
            None => serializer.serialize_str(&self.to_string()),
        }
    }
}

/// A number is the f64 it parses to, a string is exact (SPEC section 1).
impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Number, D::Error> {
        struct NumberVisitor;
        impl Visitor<'_> for NumberVisitor {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or an exact number as text")
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Number, E> {
                Number::from_f64(value).map_err(E::custom)
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Number, E> {
                self.visit_f64(value as f64)
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Number, E> {
                self.visit_f64(value as f64)
            }
            fn visit_str<E: de::Error>(self, text: &str) -> Result<Number, E> {
                Number::parse(text).map_err(E::custom)
            }
        }
        deserializer.deserialize_any(NumberVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ratio(n: i64, d: i64) -> Number {
        Number::from_rational(BigRational::new(n.into(), d.into()))
    }

    #[test]
    fn reads_every_form_exactly() {
        for (text, expected) in [
            ("0.1", ratio(1, 10)),
            ("1/3", ratio(1, 3)),
            ("-2.5e-3", ratio(-1, 400)),
            ("0x1.8p-3", ratio(3, 16)),
            ("-0X.8P1", ratio(-1, 1)),
            ("0xff", ratio(255, 1)),
            ("-1.5/7", ratio(-3, 14)),
            ("0x10/1e1", ratio(8, 5)),
            ("+5.", ratio(5, 1)),
            (".5", ratio(1, 2)),
            ("-0", Number::ZERO),
            ("1e0002", ratio(100, 1)),
        ] {
            assert_eq!(Number::parse(text), Ok(expected), "{text}");
        }
        assert_eq!(Number::parse("5e-324").unwrap().rounded(crate::Precision::F64), Some(f64::from_bits(1)));
        assert_eq!(Number::parse("1e400").unwrap().rounded(crate::Precision::F64), None);
    }

    #[test]
    fn refuses_what_is_no_number() {
        for text in [
            "", "-", ".", "e5", "1e", "1e+", "0x", "0x.p1", "1p3", "0x1e5p", "1/", "/3", "1/-3", "1/+3", "1/2/3",
            "--1", "1 ", " 1", "1,5", "1_000", "nan", "inf", "Infinity", "١", "0b1", "1f", "0x1.8e+3", "1e3.5", "1/ 3",
        ] {
            assert!(matches!(Number::parse(text), Err(NumberError::NotANumber { .. })), "{text}");
        }
        assert!(matches!(Number::parse("1/0.0"), Err(NumberError::ZeroDenominator { .. })));
        for text in ["1e1201", "1e-1201", "0x1p99999999999999999999", "0e1201", "1/1e9999999"] {
            assert!(matches!(Number::parse(text), Err(NumberError::ExponentTooLarge { .. })), "{text}");
        }
        let long = "7".repeat(DIGIT_LIMIT + 1);
        let error = Number::parse(&long).unwrap_err();
        assert!(matches!(error, NumberError::TooManyDigits { .. }));
        assert!(error.to_string().len() < 200, "{error}");
    }

    #[test]
    fn writes_the_plainest_exact_form() {
        for (value, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (-3.0, "-3"),
            (1e16, "1e16"),
            (9007199254740993.0, "9007199254740992"),
            (0.1, "0x1.999999999999ap-4"),
            (-1e23, "-0x1.52d02c7e14af6p76"),
            (f64::from_bits(1), "0x1p-1074"),
            (f64::MAX, "0x1.fffffffffffffp1023"),
        ] {
            assert_eq!(Number::from_f64(value).unwrap().to_string(), text);
        }
        assert_eq!(ratio(-1, 3).to_string(), "-1/3");
    }

    proptest! {
        #[test]
        fn text_keeps_every_f64(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            let number = Number::from_f64(value).unwrap();
            prop_assert_eq!(Number::parse(&number.to_string()), Ok(number));
        }

        #[test]
        fn text_keeps_short_f64(numerator in -100_000_i64..100_000, shift in 0_u32..60) {
            let number = Number::from_f64(numerator as f64 / (1_u64 << shift) as f64).unwrap();
            prop_assert_eq!(Number::parse(&number.to_string()), Ok(number));
        }

        #[test]
        fn text_keeps_every_fraction(numerator in any::<i64>(), denominator in 1..i64::MAX) {
            let number = ratio(numerator, denominator);
            prop_assert_eq!(Number::parse(&number.to_string()), Ok(number));
        }

        #[test]
        fn decimals_mean_what_they_say(integer in 0_u32..1_000_000, fraction in 0_u32..1000, exponent in -30_i32..30) {
            let text = format!("{integer}.{fraction:03}e{exponent}");
            let significand = BigRational::new((u64::from(integer) * 1000 + u64::from(fraction)).into(), 1000.into());
            let power = BigRational::from_integer(10.into()).pow(exponent);
            prop_assert_eq!(Number::parse(&text), Ok(Number::from_rational(significand * power)));
            prop_assert_eq!(Number::parse(&text).unwrap().approximate(), text.parse::<f64>().unwrap());
        }

        #[test]
        fn any_text_is_answered(text in "\\PC{0,40}") {
            let _ = Number::parse(&text);
        }
    }
}
