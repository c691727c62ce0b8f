//! Exact rational numbers behind one trait: the published values and the plain path are written over it.
//!
//! Two backends, which must give identical results: [`num_rational::BigRational`] (pure Rust, the default) and
//! `rug::Rational` (GMP, feature `gmp`).

#[cfg(feature = "gmp")]
mod gmp;
mod pure;

use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::number::round_rational;
use rockproof_model::{Number, Precision, Sign};
use std::fmt;

/// An exact rational number. Ordering and equality are those of the values.
pub trait Rational: Clone + Ord + fmt::Debug {
    /// The value `numerator / denominator`, or `None` when the denominator is zero.
    fn from_fraction(numerator: &BigInt, denominator: &BigInt) -> Option<Self>;

    /// The value of an exact number.
    fn from_number(number: &Number) -> Self;

    /// The value of a small integer.
    fn from_integer(value: i32) -> Self;

    /// `self + other`.
    #[must_use]
    fn plus(&self, other: &Self) -> Self;

    /// `self − other`.
    #[must_use]
    fn minus(&self, other: &Self) -> Self;

    /// `self · other`.
    #[must_use]
    fn times(&self, other: &Self) -> Self;

    /// `self / divisor`, or `None` when the divisor is zero.
    fn over(&self, divisor: &Self) -> Option<Self>;

    /// `−self`.
    #[must_use]
    fn negated(&self) -> Self;

    /// The sign of the value, exactly.
    fn sign(&self) -> Sign;

    /// The numerator of the fraction in lowest terms; it carries the sign.
    fn numerator(&self) -> BigInt;

    /// The denominator of the fraction in lowest terms; above zero.
    fn denominator(&self) -> BigInt;

    /// Zero.
    fn zero() -> Self {
        Self::from_integer(0)
    }

    /// `self²`.
    #[must_use]
    fn squared(&self) -> Self {
        self.times(self)
    }

    /// `self·|self|`: the square with the sign of the value, so that comparing two such squares compares the values.
    #[must_use]
    fn signed_square(&self) -> Self {
        if self.sign().is_negative() { self.squared().negated() } else { self.squared() }
    }

    /// `|self|`.
    #[must_use]
    fn magnitude(&self) -> Self {
        if self.sign().is_negative() { self.negated() } else { self.clone() }
    }

    /// The value as the default backend's number.
    fn to_big_rational(&self) -> BigRational {
        BigRational::new_raw(self.numerator(), self.denominator())
    }

    /// The nearest f64, ties to even, or `None` when that overflows.
    fn rounded(&self) -> Option<f64> {
        round_rational(&self.to_big_rational(), Precision::F64)
    }

    /// The f64 nearest to the square root, ties to even, or `None` when the value is negative or the root overflows.
    ///
    /// Integer arithmetic throughout. A root can lie exactly half way between two f64 (the root of `(1 + 2⁻⁵³)²`
    /// does); it then goes to the even one, as the nearest f64 of any exact value does.
    fn sqrt_rounded(&self) -> Option<f64> {
        if self.sign().is_negative() {
            return None;
        }
        root_with_sticky_bit(&self.numerator(), &self.denominator())
            .and_then(|root| round_rational(&root, Precision::F64))
    }
}

/// A rational that rounds to f64 as `√(numerator / denominator)` does; `None` only for a zero denominator.
///
/// With `s = ⌊√(4^k · value)⌋` of at least 55 bits, the root lies in `[s, s + 1)·2⁻ᵏ`. Every f64 and every point half
/// way between two of them is a multiple of `2⁻ᵏ` there, so all that rounding needs is `s` and whether the root is more
/// than `s·2⁻ᵏ`: half a unit added, which reaches no such point, says that.
fn root_with_sticky_bit(numerator: &BigInt, denominator: &BigInt) -> Option<BigRational> {
    const ROOT_BITS: i64 = 64;
    let magnitude = numerator.bits() as i64 - denominator.bits() as i64;
    let k = (ROOT_BITS - magnitude / 2).max(0) as usize;
    let scaled: BigInt = numerator << (2 * k);
    let whole = scaled.checked_div(denominator)?;
    let root = whole.sqrt();
    let exact = &root * &root * denominator == scaled;
    let doubled: BigInt = root << 1u32;
    let sticky = if exact { doubled } else { doubled + 1 };
    Some(BigRational::new(sticky, BigInt::from(1) << (k + 1)))
}
