//! The GMP backend: `rug`.

use super::Rational;
use num_bigint::{BigInt, BigUint};
use num_traits::Zero;
use rockproof_model::{Number, Sign};
use rug::integer::Order;
use std::cmp::Ordering;

impl Rational for rug::Rational {
    fn from_fraction(numerator: &BigInt, denominator: &BigInt) -> Option<Self> {
        (!denominator.is_zero()).then(|| rug::Rational::from((integer_of(numerator), integer_of(denominator))))
    }

    fn from_number(number: &Number) -> Self {
        // A finite f64 converts exactly; whatever has no f64 is a fraction.
        number.as_f64().and_then(rug::Rational::from_f64).unwrap_or_else(|| {
            let ratio = number.to_rational();
            rug::Rational::from((integer_of(ratio.numer()), integer_of(ratio.denom())))
        })
    }

    fn from_integer(value: i32) -> Self {
        rug::Rational::from(value)
    }

    fn plus(&self, other: &Self) -> Self {
        rug::Rational::from(self + other)
    }

    fn minus(&self, other: &Self) -> Self {
        rug::Rational::from(self - other)
    }

    fn times(&self, other: &Self) -> Self {
        rug::Rational::from(self * other)
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        (divisor.cmp0() != Ordering::Equal).then(|| rug::Rational::from(self / divisor))
    }

    fn negated(&self) -> Self {
        rug::Rational::from(-self)
    }

    fn sign(&self) -> Sign {
        Sign::of_ordering(self.cmp0())
    }

    fn numerator(&self) -> BigInt {
        big_int_of(self.numer())
    }

    fn denominator(&self) -> BigInt {
        big_int_of(self.denom())
    }
}

fn integer_of(value: &BigInt) -> rug::Integer {
    let (sign, digits) = value.to_u32_digits();
    let magnitude = rug::Integer::from_digits(&digits, Order::Lsf);
    if sign == num_bigint::Sign::Minus { -magnitude } else { magnitude }
}

fn big_int_of(value: &rug::Integer) -> BigInt {
    let mut digits = vec![0u32; value.significant_digits::<u32>()];
    value.write_digits(&mut digits, Order::Lsf);
    let magnitude = BigInt::from(BigUint::new(digits));
    if value.cmp0() == Ordering::Less { -magnitude } else { magnitude }
}
