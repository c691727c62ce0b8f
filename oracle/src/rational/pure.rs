//! The default backend: `num_rational`.

use super::Rational;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{CheckedDiv, Zero};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Number, Sign};

impl Rational for BigRational {
    fn from_fraction(numerator: &BigInt, denominator: &BigInt) -> Option<Self> {
        (!denominator.is_zero()).then(|| BigRational::new(numerator.clone(), denominator.clone()))
    }

    fn from_number(number: &Number) -> Self {
        number.to_rational()
    }

    fn from_integer(value: i32) -> Self {
        BigRational::from_integer(BigInt::from(value))
    }

    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn minus(&self, other: &Self) -> Self {
        self - other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        self.checked_div(divisor)
    }

    fn negated(&self) -> Self {
        -self
    }

    fn sign(&self) -> Sign {
        ExactRing::sign(self)
    }

    fn numerator(&self) -> BigInt {
        self.numer().clone()
    }

    fn denominator(&self) -> BigInt {
        self.denom().clone()
    }
}
