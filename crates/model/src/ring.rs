//! The few operations every exact (and filtered) number type offers, so that a predicate is written once.

use crate::fraction;
use crate::sign::Sign;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A commutative ring with small integer constants: all that a polynomial predicate needs.
pub trait Ring: Clone {
    /// The value of a small integer, exactly.
    fn from_i32(value: i32) -> Self;
    /// `self + other`.
    fn plus(&self, other: &Self) -> Self;
    /// `self − other`.
    fn minus(&self, other: &Self) -> Self;
    /// `self · other`.
    fn times(&self, other: &Self) -> Self;
    /// `−self`.
    fn negated(&self) -> Self;
    /// `self²`.
    fn squared(&self) -> Self {
        self.times(self)
    }
}

/// A ring whose elements have a sign that is known for certain.
pub trait ExactRing: Ring {
    /// The sign of the value, exactly.
    fn sign(&self) -> Sign;
}

macro_rules! ring_by_operators {
    ($(#[$inline:meta])? $type:ty, $from:expr) => {
        impl Ring for $type {
            $(#[$inline])?
            fn from_i32(value: i32) -> Self {
                $from(value)
            }
            $(#[$inline])?
            fn plus(&self, other: &Self) -> Self {
                self + other
            }
            $(#[$inline])?
            fn minus(&self, other: &Self) -> Self {
                self - other
            }
            $(#[$inline])?
            fn times(&self, other: &Self) -> Self {
                self * other
            }
            $(#[$inline])?
            fn negated(&self) -> Self {
                -self
            }
        }
    };
}

// Operations on the heap are compiled here, once, and not in every crate that asks for them; those of integers in a register are worth inlining.
ring_by_operators!(BigInt, BigInt::from);
// The caller has shown that no intermediate value leaves the range (see `lattice`).
ring_by_operators!(
    #[inline]
    i128,
    i128::from
);

/// With the divisors of [`fraction`], which are found in less time than those of `num_rational`.
impl Ring for BigRational {
    fn from_i32(value: i32) -> Self {
        BigRational::from_integer(BigInt::from(value))
    }
    fn plus(&self, other: &Self) -> Self {
        fraction::sum(self, other)
    }
    fn minus(&self, other: &Self) -> Self {
        fraction::difference(self, other)
    }
    fn times(&self, other: &Self) -> Self {
        fraction::product(self, other)
    }
    fn negated(&self) -> Self {
        -self
    }
}

impl ExactRing for i128 {
    #[inline]
    fn sign(&self) -> Sign {
        Sign::of_ordering(self.cmp(&0))
    }
}

impl ExactRing for BigInt {
    fn sign(&self) -> Sign {
        match self.sign() {
            num_bigint::Sign::Minus => Sign::Negative,
            num_bigint::Sign::NoSign => Sign::Zero,
            num_bigint::Sign::Plus => Sign::Positive,
        }
    }
}

impl ExactRing for BigRational {
    fn sign(&self) -> Sign {
        if self.is_zero() {
            Sign::Zero
        } else if self.is_negative() {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }
}
