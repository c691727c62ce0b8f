use num_bigint::BigInt;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Ring, Sign};

/// A signed integer of 128 bits that wraps around, as [`super::Fixed`] does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Int128(pub(crate) i128);

impl From<Int128> for BigInt {
    fn from(value: Int128) -> BigInt {
        BigInt::from(value.0)
    }
}

impl Ring for Int128 {
    #[inline]
    fn from_i32(value: i32) -> Self {
        Int128(i128::from(value))
    }
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Int128(self.0.wrapping_add(other.0))
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Int128(self.0.wrapping_sub(other.0))
    }
    #[inline]
    fn times(&self, other: &Self) -> Self {
        Int128(self.0.wrapping_mul(other.0))
    }
    #[inline]
    fn negated(&self) -> Self {
        Int128(self.0.wrapping_neg())
    }
}

impl ExactRing for Int128 {
    #[inline]
    fn sign(&self) -> Sign {
        Sign::of_ordering(self.0.cmp(&0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_leaves_the_range_comes_back_with_the_difference() {
        let (most, one) = (Int128(i128::MAX), Int128::from_i32(1));
        let beyond = most.plus(&one);
        assert_eq!((ExactRing::sign(&beyond), ExactRing::sign(&beyond.minus(&one))), (Sign::Negative, Sign::Positive));
        let product = most.times(&most).minus(&most.times(&most.minus(&one)));
        assert_eq!(product, most);
        assert_eq!(beyond.negated(), beyond);
        assert_eq!(BigInt::from(Int128(-7)), BigInt::from(-7));
    }
}
