use num_bigint::BigInt;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Ring, Sign};
use ruint::Uint;

/// A signed integer of `BITS` bits on the stack.
///
/// Two's complement over `ruint`'s unsigned integers, modulo `2^BITS`: a polynomial of wrapping sums and products is right
/// whenever its value fits, whatever happened on the way; [`super::Bits`] shows beforehand that it does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fixed<const BITS: usize, const LIMBS: usize>(Uint<BITS, LIMBS>);

impl<const BITS: usize, const LIMBS: usize> Fixed<BITS, LIMBS> {
    /// The integer `value`, which has fewer than `BITS` bits.
    pub(crate) fn from_i128(value: i128) -> Self {
        let magnitude = Fixed(Uint::from(value.unsigned_abs()));
        if value < 0 { magnitude.negated() } else { magnitude }
    }

    /// The integer `value`, modulo `2^BITS`.
    pub(crate) fn from_bigint(value: &BigInt) -> Self {
        let (sign, digits) = value.to_u64_digits();
        let mut limbs = [0u64; LIMBS];
        for (limb, digit) in limbs.iter_mut().zip(digits) {
            *limb = digit;
        }
        let magnitude = Fixed(Uint::from_limbs(limbs));
        if sign == num_bigint::Sign::Minus { magnitude.negated() } else { magnitude }
    }
}

impl<const BITS: usize, const LIMBS: usize> From<Fixed<BITS, LIMBS>> for BigInt {
    fn from(value: Fixed<BITS, LIMBS>) -> BigInt {
        let negative = value.0.bit(BITS - 1);
        let magnitude = if negative { value.negated() } else { value };
        let magnitude = BigInt::from_bytes_le(num_bigint::Sign::Plus, magnitude.0.as_le_slice());
        if negative { -magnitude } else { magnitude }
    }
}

impl<const BITS: usize, const LIMBS: usize> Ring for Fixed<BITS, LIMBS> {
    #[inline]
    fn from_i32(value: i32) -> Self {
        Self::from_i128(i128::from(value))
    }
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Fixed(self.0.wrapping_add(other.0))
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Fixed(self.0.wrapping_sub(other.0))
    }
    // Not inlined: dozens of wide multiplications in a row would crowd the f64 path out of the instruction cache.
    #[inline(never)]
    fn times(&self, other: &Self) -> Self {
        Fixed(self.0.wrapping_mul(other.0))
    }
    #[inline]
    fn negated(&self) -> Self {
        Fixed(self.0.wrapping_neg())
    }
}

impl<const BITS: usize, const LIMBS: usize> ExactRing for Fixed<BITS, LIMBS> {
    #[inline]
    fn sign(&self) -> Sign {
        if self.0.is_zero() {
            Sign::Zero
        } else if self.0.bit(BITS - 1) {
            Sign::Negative
        } else {
            Sign::Positive
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_integer_that_fits_has_its_sign() {
        type Int = Fixed<256, 4>;
        for bits in 0..255 {
            let value: BigInt = BigInt::from(1) << bits;
            assert_eq!(ExactRing::sign(&Int::from_bigint(&value)), Sign::Positive, "2^{bits}");
            assert_eq!(ExactRing::sign(&Int::from_bigint(&-value.clone())), Sign::Negative, "-2^{bits}");
            for integer in [value.clone(), -value] {
                assert_eq!(BigInt::from(Int::from_bigint(&integer)), integer);
            }
        }
        assert_eq!(ExactRing::sign(&Int::from_bigint(&BigInt::ZERO)), Sign::Zero);
        assert_eq!(Int::from_i128(-7), Int::from_bigint(&BigInt::from(-7)));
    }
}
