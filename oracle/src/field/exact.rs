//! The exact level: fractions.

use super::{Field, UpperBound};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{CheckedDiv, Signed};
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Number, Precision, Sign};

impl Field for BigRational {
    fn of_rational(value: &BigRational, _bits: u32) -> Self {
        value.clone()
    }

    fn of_number(value: &Number, _bits: u32) -> Self {
        value.to_rational()
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        self.checked_div(divisor)
    }

    /// Only squares of fractions have a root here.
    fn root(&self) -> Option<Self> {
        Some(BigRational::new_raw(whole_root(self.numer())?, whole_root(self.denom())?))
    }

    fn half(&self) -> Self {
        self / BigInt::from(2)
    }

    fn certain_sign(&self) -> Option<Sign> {
        Some(ExactRing::sign(self))
    }

    fn middle(&self) -> BigRational {
        self.clone()
    }

    fn radius(&self) -> Option<UpperBound> {
        Some(UpperBound::ZERO)
    }

    fn magnitude_bound(&self) -> Option<UpperBound> {
        None
    }

    fn within(_size: UpperBound) -> Option<Self> {
        None
    }

    fn nearby(&self) -> (f64, f64) {
        match round_rational(self, Precision::F64) {
            Some(value) => (value, value.abs() * f64::EPSILON + f64::MIN_POSITIVE),
            None => (f64::NAN, f64::INFINITY),
        }
    }
}

/// The root of an integer that is a square.
fn whole_root(value: &BigInt) -> Option<BigInt> {
    if value.is_negative() {
        return None;
    }
    let root = value.sqrt();
    (&root * &root == *value).then_some(root)
}
