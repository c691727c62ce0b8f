use num_bigint::BigInt;
use num_traits::Signed;
use rockproof_model::Ring;

/// An exact value together with the sum of the magnitudes of the terms it is the sum of.
///
/// The quotient of the two is the relative margin of a predicate: 1 where nothing cancels, 0 at a tie.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Magnitude {
    /// The exact value.
    pub(crate) value: BigInt,
    /// The value with every term counted positive.
    pub(crate) terms: BigInt,
}

impl From<BigInt> for Magnitude {
    fn from(value: BigInt) -> Self {
        Magnitude { terms: value.abs(), value }
    }
}

impl Ring for Magnitude {
    fn from_i32(value: i32) -> Self {
        Magnitude::from(BigInt::from(value))
    }
    fn plus(&self, other: &Self) -> Self {
        Magnitude { value: &self.value + &other.value, terms: &self.terms + &other.terms }
    }
    fn minus(&self, other: &Self) -> Self {
        Magnitude { value: &self.value - &other.value, terms: &self.terms + &other.terms }
    }
    fn times(&self, other: &Self) -> Self {
        Magnitude { value: &self.value * &other.value, terms: &self.terms * &other.terms }
    }
    fn negated(&self) -> Self {
        Magnitude { value: -&self.value, terms: self.terms.clone() }
    }
}
