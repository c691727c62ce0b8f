//! The default backend: fractions of `num_rational`, with less work to reduce them.
//!
//! `num_rational` looks for the greatest common divisor of every result, and divides by it though it is one, which takes most of its time. Coordinates are binary fractions,
//! and so is what sums and products make of them: there a shift does. Elsewhere common divisors are those of parts (D. E. Knuth, The Art of Computer
//! Programming, volume 2, section 4.5.1). This uses nothing of [`rockproof_model::fraction`], with which the faster paths calculate: the plain path checks them.

use super::Rational;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{CheckedDiv, One, Zero};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Number, Sign};
use std::cmp::Ordering;

/// The exponent of a positive number that is a power of two.
fn exponent(number: &BigInt) -> Option<u64> {
    number.trailing_zeros().filter(|twos| number.bits() == twos + 1)
}

/// `numerator / 2^exponent` in lowest terms.
fn binary(numerator: BigInt, exponent: u64) -> BigRational {
    let Some(twos) = numerator.trailing_zeros() else { return Zero::zero() };
    let shared = twos.min(exponent);
    let numerator = if shared == 0 { numerator } else { numerator >> shared };
    BigRational::new_raw(numerator, BigInt::one() << (exponent - shared))
}

/// The greatest common divisor of two numbers that are not zero.
fn common(a: &BigInt, b: &BigInt) -> BigInt {
    let (twos_a, twos_b) = (a.trailing_zeros().unwrap_or(0), b.trailing_zeros().unwrap_or(0));
    if a.bits() == twos_a + 1 || b.bits() == twos_b + 1 { BigInt::one() << twos_a.min(twos_b) } else { a.gcd(b) }
}

/// `number / divisor`, which leaves nothing over.
fn divided(number: &BigInt, divisor: &BigInt) -> BigInt {
    if divisor.is_one() { number.clone() } else { number / divisor }
}

/// The sum or difference of two fractions.
fn combined(a: &BigRational, b: &BigRational, of: fn(&BigInt, &BigInt) -> BigInt) -> BigRational {
    let (below_a, below_b) = (a.denom(), b.denom());
    if let (Some(less_a), Some(less_b)) = (exponent(below_a), exponent(below_b)) {
        let numerator = match less_a.cmp(&less_b) {
            Ordering::Equal => of(a.numer(), b.numer()),
            Ordering::Less => of(&(a.numer() << (less_b - less_a)), b.numer()),
            Ordering::Greater => of(a.numer(), &(b.numer() << (less_a - less_b))),
        };
        return binary(numerator, less_a.max(less_b));
    }
    let shared = common(below_a, below_b);
    let (only_a, only_b) = (divided(below_a, &shared), divided(below_b, &shared));
    let numerator = of(&(a.numer() * &only_b), &(b.numer() * &only_a));
    if numerator.is_zero() {
        return Zero::zero();
    }
    // What is below one fraction alone has no divisor in common with the numerator.
    let again = if shared.is_one() { shared } else { common(&numerator, &shared) };
    BigRational::new_raw(divided(&numerator, &again), only_a * divided(below_b, &again))
}

/// The product of two fractions: only a numerator and the other's denominator have common divisors.
fn product(a: &BigRational, b: &BigRational) -> BigRational {
    if let (Some(less_a), Some(less_b)) = (exponent(a.denom()), exponent(b.denom())) {
        return binary(a.numer() * b.numer(), less_a + less_b);
    }
    if a.is_zero() || b.is_zero() {
        return Zero::zero();
    }
    let (one, other) = (common(a.numer(), b.denom()), common(b.numer(), a.denom()));
    BigRational::new_raw(
        divided(a.numer(), &one) * divided(b.numer(), &other),
        divided(a.denom(), &other) * divided(b.denom(), &one),
    )
}

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
        combined(self, other, |a, b| a + b)
    }

    fn minus(&self, other: &Self) -> Self {
        combined(self, other, |a, b| a - b)
    }

    fn times(&self, other: &Self) -> Self {
        product(self, other)
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
