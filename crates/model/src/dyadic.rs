//! Binary fractions: what sums and products of floats are. Only twos can cancel, so no greatest common divisor is needed.

use crate::number::{dyadic, exact_log2, split_f64};
use num_bigint::BigInt;
use num_rational::BigRational;
use std::cmp::Ordering;

/// The value `significand · 2^exponent`.
#[derive(Clone, Debug)]
pub(crate) struct Dyadic {
    significand: BigInt,
    exponent: i64,
}

impl Dyadic {
    pub(crate) fn of_f64(value: f64) -> Dyadic {
        let (significand, exponent) = split_f64(value);
        Dyadic { significand: BigInt::from(significand), exponent: i64::from(exponent) }
    }

    /// `None` for a fraction that is not over a power of two.
    pub(crate) fn of_ratio(value: &BigRational) -> Option<Dyadic> {
        let twos = exact_log2(value.denom())?;
        Some(Dyadic { significand: value.numer().clone(), exponent: -(twos as i64) })
    }

    /// Both significands under the lesser exponent.
    fn aligned(self, other: Dyadic) -> (BigInt, BigInt, i64) {
        let exponent = self.exponent.min(other.exponent);
        let shifted = |part: Dyadic| part.significand << part.exponent.abs_diff(exponent);
        (shifted(self), shifted(other), exponent)
    }

    pub(crate) fn plus(self, other: Dyadic) -> Dyadic {
        let (one, two, exponent) = self.aligned(other);
        Dyadic { significand: one + two, exponent }
    }

    pub(crate) fn times(self, other: Dyadic) -> Dyadic {
        Dyadic { significand: self.significand * other.significand, exponent: self.exponent + other.exponent }
    }

    pub(crate) fn cmp(self, other: Dyadic) -> Ordering {
        let (one, two, _) = self.aligned(other);
        one.cmp(&two)
    }

    /// The fraction, in lowest terms.
    pub(crate) fn into_rational(self) -> BigRational {
        dyadic(self.significand, self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_products_and_order_are_those_of_fractions() {
        let values: Vec<BigRational> =
            [(0, 1), (1, 1), (-3, 8), (3, 8), (5, 1 << 40), (-1 << 50, 1), (7, 2), (-7, 2), (1 << 20, 1)]
                .iter()
                .map(|&(n, d): &(i64, i64)| BigRational::new(n.into(), d.into()))
                .collect();
        let of = |value: &BigRational| Dyadic::of_ratio(value).expect("over a power of two");
        for a in &values {
            for b in &values {
                for (found, expected) in [(of(a).plus(of(b)), a + b), (of(a).times(of(b)), a * b)] {
                    let found = found.into_rational();
                    // Equal as they stand: in lowest terms.
                    assert_eq!((found.numer(), found.denom()), (expected.numer(), expected.denom()), "{a} {b}");
                }
                assert_eq!(of(a).cmp(of(b)), a.cmp(b), "{a} {b}");
            }
        }
        assert!(Dyadic::of_ratio(&BigRational::new(1.into(), 3.into())).is_none());
        assert!(Dyadic::of_ratio(&BigRational::new(1.into(), 6.into())).is_none());
        for float in [0.0, 1.5, -5e-324, 1e300] {
            assert_eq!(Dyadic::of_f64(float).into_rational(), BigRational::from_float(float).expect("finite"));
        }
    }
}
