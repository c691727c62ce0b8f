//! A bound on an error: 32 bits and an exponent, always rounded up. The oracle has bounds like it (`UpperBound`); neither side uses the other's
//! arithmetic, so there are two.

use std::cmp::Ordering;

const BITS: u32 = 32;
/// The exponent of a bound of nothing, and of no bound at all.
const NOTHING: i64 = i64::MIN;
const ANYTHING: i64 = i64::MAX;

/// A magnitude that is not below the one meant, by a share of at most 2⁻³¹ for each operation. Powers of two alone would do as well, but double
/// with every term of a sum, and a system of a hundred unknowns would be lost in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Radius {
    /// Zero, or with its top bit set.
    digits: u32,
    exponent: i64,
}

impl Radius {
    /// The bound of a value without error.
    pub(super) const EXACT: Radius = Radius { digits: 0, exponent: NOTHING };
    /// The bound of a value nothing is known about.
    pub(super) const UNKNOWN: Radius = Radius { digits: 0, exponent: ANYTHING };

    /// 2^exponent.
    pub(super) fn power(exponent: i64) -> Radius {
        Radius { digits: 1 << (BITS - 1), exponent: exponent - i64::from(BITS - 1) }
    }

    /// Not below `digits·2^exponent`.
    pub(super) fn above(digits: u64, exponent: i64) -> Radius {
        let Some(surplus) = Radius::surplus(digits) else { return Radius::EXACT };
        if surplus <= 0 {
            return Radius { digits: (digits << -surplus) as u32, exponent: exponent + i64::from(surplus) };
        }
        let cut = (digits >> surplus) + u64::from(digits.trailing_zeros() < surplus.unsigned_abs());
        if cut >> BITS == 0 {
            Radius { digits: cut as u32, exponent: exponent + i64::from(surplus) }
        } else {
            Radius::power(exponent + i64::from(surplus) + i64::from(BITS))
        }
    }

    /// Not above `digits·2^exponent`.
    pub(super) fn below(digits: u64, exponent: i64) -> Radius {
        let Some(surplus) = Radius::surplus(digits) else { return Radius::EXACT };
        let cut = if surplus <= 0 { digits << -surplus } else { digits >> surplus };
        Radius { digits: cut as u32, exponent: exponent + i64::from(surplus) }
    }

    /// Above `digits·2^exponent` with whatever follows these digits, of which the highest has its highest bit set.
    pub(super) fn beyond(digits: u64, exponent: i64) -> Radius {
        match ((digits >> BITS) as u32).checked_add(1) {
            Some(digits) => Radius { digits, exponent: exponent + i64::from(BITS) },
            None => Radius::power(exponent + 2 * i64::from(BITS)),
        }
    }

    /// The bits of a number beyond those kept; `None` for zero.
    fn surplus(digits: u64) -> Option<i32> {
        (digits != 0).then(|| 32 - digits.leading_zeros() as i32)
    }

    /// Whether there is no error.
    pub(super) fn is_exact(self) -> bool {
        self.exponent == NOTHING
    }

    /// Whether there is a bound.
    pub(super) fn is_known(self) -> bool {
        self.exponent != ANYTHING
    }

    fn is_number(self) -> bool {
        self.digits != 0
    }

    /// Not below the sum of two.
    #[must_use]
    pub(super) fn plus(self, other: Radius) -> Radius {
        if !self.is_number() || !other.is_number() {
            return if self.exponent == ANYTHING || other.is_exact() { self } else { other };
        }
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        // Beyond 31 places nothing is left but the unit added for what is cut.
        let shift = large.exponent.abs_diff(small.exponent);
        let digits = if shift < 31 { u64::from(large.digits) << 31 } else { 0 };
        if shift < 31 {
            let sum = digits + (u64::from(small.digits) << (31 - shift));
            return Radius::above(sum, large.exponent - 31);
        }
        Radius::above(u64::from(large.digits) + 2, large.exponent)
    }

    /// Not below the product of two; nothing if either is nothing.
    #[must_use]
    pub(super) fn times(self, other: Radius) -> Radius {
        if self.is_exact() || other.is_exact() {
            return Radius::EXACT;
        }
        if !self.is_known() || !other.is_known() {
            return Radius::UNKNOWN;
        }
        Radius::above(u64::from(self.digits) * u64::from(other.digits), self.exponent + other.exponent)
    }

    /// Not below the quotient by a magnitude that is not above the divisor meant; unknown if that may be zero.
    #[must_use]
    pub(super) fn over(self, divisor: Radius) -> Radius {
        if !self.is_known() || !divisor.is_number() {
            return Radius::UNKNOWN;
        }
        if self.is_exact() {
            return Radius::EXACT;
        }
        let dividend = u64::from(self.digits) << BITS;
        Radius::above(dividend.div_ceil(u64::from(divisor.digits)), self.exponent - divisor.exponent - i64::from(BITS))
    }

    /// Not above the difference of a magnitude that is not above the one meant, and a smaller bound; nothing if it is not smaller.
    #[must_use]
    pub(super) fn less(self, other: Radius) -> Radius {
        if other.is_exact() {
            return self;
        }
        if other.partial_cmp(&self) != Some(Ordering::Less) {
            return Radius::EXACT;
        }
        let shift = self.exponent.abs_diff(other.exponent);
        if shift < 31 {
            let difference = (u64::from(self.digits) << shift) - u64::from(other.digits);
            return Radius::below(difference, other.exponent);
        }
        Radius::below(u64::from(self.digits) - 2, self.exponent)
    }

    /// Not below the square root.
    #[must_use]
    pub(super) fn root(self) -> Radius {
        if !self.is_number() {
            return self;
        }
        let odd = self.exponent.rem_euclid(2);
        let square = u64::from(self.digits) << (30 + odd);
        let root = square.isqrt();
        Radius::above(root + u64::from(root * root < square), (self.exponent - 30 - odd) / 2)
    }
}

impl PartialOrd for Radius {
    /// By size; a bound that is not there is above all others.
    fn partial_cmp(&self, other: &Radius) -> Option<Ordering> {
        // With the top bit set, the exponents decide first; nothing and anything have the extreme ones.
        Some(self.exponent.cmp(&other.exponent).then(self.digits.cmp(&other.digits)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{One, Zero, pow};
    use proptest::prelude::*;

    fn value(radius: Radius) -> BigRational {
        if radius.is_exact() {
            return BigRational::zero();
        }
        let two = BigRational::from_integer(2.into());
        let scale = pow(two, radius.exponent.unsigned_abs() as usize);
        let digits = BigRational::from_integer(radius.digits.into());
        if radius.exponent < 0 { digits / scale } else { digits * scale }
    }

    /// The value holds, and by no more than some units in its last place.
    fn is_just_above(found: Radius, exact: &BigRational) {
        let found = value(found);
        assert!(found >= *exact);
        assert!(found <= exact * (BigRational::one() + BigRational::new(8.into(), (1u64 << 31).into())));
    }

    fn radii() -> impl Strategy<Value = Radius> {
        (any::<u64>(), 0u32..64, -60i64..60).prop_map(|(digits, cut, exponent)| Radius::above(digits >> cut, exponent))
    }

    proptest! {
        #[test]
        fn every_operation_rounds_up_and_by_little(a in radii(), b in radii(), digits in any::<u64>(), cut in 0u32..64) {
            let exact = BigRational::from_integer((digits >> cut).into());
            is_just_above(Radius::above(digits >> cut, 0), &exact);
            let below = value(Radius::below(digits >> cut, 0));
            prop_assert!(below <= exact);
            is_just_above(a.plus(b), &(value(a) + value(b)));
            is_just_above(a.times(b), &(value(a) * value(b)));
            if b.is_exact() {
                prop_assert!(!a.over(b).is_known());
            } else {
                is_just_above(a.over(b), &(value(a) / value(b)));
            }
            let root = value(a.root());
            is_just_above(a.root().times(a.root()), &value(a));
            prop_assert!(&root * &root >= value(a));
            prop_assert_eq!(a < b, value(a) < value(b));
            if b < a {
                let exact = value(a) - value(b);
                prop_assert!(value(a.less(b)) <= exact);
                prop_assert!(value(a.less(b)) >= exact - value(a) / BigRational::from_integer((1u64 << 29).into()));
            }
        }
    }

    /// Digits that are all ones, but for some that are cut, round up to a power of two.
    #[test]
    fn rounding_up_carries_into_the_exponent() {
        let two = BigRational::from_integer(2.into());
        for exponent in [-1000, 0, 1000] {
            let scale = pow(two.clone(), 1000);
            let scale = match exponent {
                0 => BigRational::one(),
                e if e < 0 => scale.recip(),
                _ => scale,
            };
            for (digits, power) in [(u64::MAX, 64), ((1 << 33) - 1, 33), (u64::MAX << 31, 64)] {
                let found = Radius::above(digits, exponent);
                is_just_above(found, &(BigRational::from_integer(digits.into()) * &scale));
                assert_eq!(value(found), pow(two.clone(), power) * &scale);
            }
        }
    }
}
