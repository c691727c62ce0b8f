//! The common lattice of a set of numbers.
//!
//! Every predicate of SPEC is homogeneous in length, so multiplying all coordinates and lengths by one positive
//! factor changes no sign. The factor chosen here makes every one of them an integer; on that lattice exact arithmetic
//! needs integers only.

use crate::number::{Number, split_f64};
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, ToPrimitive};

/// A factor `odd · 2^exponent` that turns every number it was made for into an integer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lattice {
    exponent: i32,
    odd: BigInt,
}

impl Lattice {
    /// The coarsest lattice that holds all `numbers`.
    pub fn covering<'a>(numbers: impl IntoIterator<Item = &'a Number>) -> Lattice {
        let mut exponent = i32::MIN;
        let mut odd = BigInt::one();
        for number in numbers {
            if let Some(value) = number.as_f64() {
                if value != 0.0 {
                    exponent = exponent.max(-split_f64(value).1);
                }
            } else if let Some(ratio) = number.as_ratio() {
                let twos = ratio.denom().trailing_zeros().unwrap_or(0);
                exponent = exponent.max(twos as i32);
                let odd_part = ratio.denom() >> twos;
                if !odd_part.is_one() && !odd.is_multiple_of(&odd_part) {
                    odd = odd.lcm(&odd_part);
                }
            }
        }
        Lattice { exponent: if exponent == i32::MIN { 0 } else { exponent }, odd }
    }

    /// The lattice of the integers.
    pub fn unity() -> Lattice {
        Lattice { exponent: 0, odd: BigInt::one() }
    }

    /// The k of a lattice with `2^k` units per metre; `None` where the factor is no power of two.
    pub fn binary_exponent(&self) -> Option<i32> {
        self.odd.is_one().then_some(self.exponent)
    }

    /// `number` in lattice units. The number must be one of those the lattice was made for.
    pub fn units(&self, number: &Number) -> BigInt {
        if let Some(value) = number.as_f64() {
            let (significand, exponent) = split_f64(value);
            let shift = exponent + self.exponent;
            let scaled = BigInt::from(significand) * &self.odd;
            if significand == 0 || shift >= 0 { scaled << shift.max(0) as usize } else { scaled >> (-shift) as usize }
        } else if let Some(ratio) = number.as_ratio() {
            ((ratio.numer() * &self.odd) << self.exponent.max(0) as usize) / ratio.denom()
        } else {
            BigInt::ZERO
        }
    }

    /// `number` in lattice units if that has at most `bits` bits (at most 126).
    pub fn small_units(&self, number: &Number, bits: u32) -> Option<i128> {
        let units = match (number.as_f64(), self.odd.is_one()) {
            (Some(value), true) => {
                let (significand, exponent) = split_f64(value);
                let shift = exponent + self.exponent;
                let width = 64 - significand.unsigned_abs().leading_zeros() as i32;
                if significand != 0 && shift + width > bits as i32 {
                    return None;
                }
                i128::from(significand) << shift.clamp(0, 126)
            }
            _ => self.units(number).to_i128()?,
        };
        (128 - units.unsigned_abs().leading_zeros() <= bits).then_some(units)
    }

    /// Lattice units per metre, as a fraction `(numerator, denominator)`.
    pub fn units_per_metre(&self) -> (BigInt, BigInt) {
        if self.exponent >= 0 {
            (&self.odd << self.exponent as usize, BigInt::one())
        } else {
            (self.odd.clone(), BigInt::one() << (-self.exponent) as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn makes_every_number_an_integer() {
        let ratio = |n: i64, d: i64| Number::from_rational(BigRational::new(n.into(), d.into()));
        let numbers = [ratio(1, 3), ratio(-5, 14), ratio(3, 8), ratio(0, 1), ratio(1 << 40, 1)];
        let lattice = Lattice::covering(&numbers);
        let (numerator, denominator) = lattice.units_per_metre();
        for number in &numbers {
            let expected = number.to_rational() * BigRational::new(numerator.clone(), denominator.clone());
            assert!(expected.is_integer());
            assert_eq!(lattice.units(number), expected.to_integer());
            assert_eq!(lattice.small_units(number, 120).map(BigInt::from), Some(expected.to_integer()));
        }
        let coarse = [ratio(1 << 40, 1), ratio(3 << 41, 1)];
        let lattice = Lattice::covering(&coarse);
        assert_eq!(lattice.small_units(&coarse[1], 4), Some(6));
        assert_eq!(lattice.small_units(&coarse[1], 2), None);
    }
}
