use crate::field::{DoubleBall, Field};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use rockproof_model::number::{Precision, round_rational};
use rockproof_model::{Ring, Sign};

/// An exact value together with the sum of the magnitudes of the terms it is the sum of.
///
/// The quotient of the two is the relative margin of a predicate: 1 where nothing cancels, 0 at a tie. The sum stays within the
/// bits that [`super::Bits`] counts: its own sum and product are those of magnitudes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Magnitude<T> {
    /// The exact value.
    pub(crate) value: T,
    /// The value with every term counted positive.
    pub(crate) terms: T,
}

impl Magnitude<DoubleBall> {
    /// A term.
    pub(crate) fn of_ball(value: DoubleBall) -> Self {
        Magnitude { value, terms: if value.high < 0.0 { value.negated() } else { value } }
    }

    /// [`Magnitude::relative`], where the balls tell what it is once it is rounded.
    pub(crate) fn certain_relative(&self) -> Option<(Sign, f64)> {
        let sign = self.value.certain_sign()?;
        let size = if sign.is_negative() { self.value.negated() } else { self.value };
        Some((sign, size.over(&self.terms)?.certain_rounding()?))
    }
}

impl<T: Into<BigInt>> Magnitude<T> {
    /// The value's sign, and its size over that of its terms, at most 1; 0 where there are none.
    pub(crate) fn relative(self) -> (Sign, f64) {
        let (value, terms) = (self.value.into(), self.terms.into());
        if terms.is_zero() {
            return (Sign::Zero, 0.0);
        }
        let sign = Sign::of_ordering(value.cmp(&BigInt::ZERO));
        // At most 1, so rounding cannot overflow.
        (sign, round_rational(&BigRational::new_raw(value.abs(), terms), Precision::F64).unwrap_or(1.0))
    }
}

impl<T: Ring> Ring for Magnitude<T> {
    fn from_i32(value: i32) -> Self {
        Magnitude { value: T::from_i32(value), terms: T::from_i32(value.abs()) }
    }
    fn plus(&self, other: &Self) -> Self {
        Magnitude { value: self.value.plus(&other.value), terms: self.terms.plus(&other.terms) }
    }
    fn minus(&self, other: &Self) -> Self {
        Magnitude { value: self.value.minus(&other.value), terms: self.terms.plus(&other.terms) }
    }
    fn times(&self, other: &Self) -> Self {
        Magnitude { value: self.value.times(&other.value), terms: self.terms.times(&other.terms) }
    }
    fn negated(&self) -> Self {
        Magnitude { value: self.value.negated(), terms: self.terms.clone() }
    }
}
