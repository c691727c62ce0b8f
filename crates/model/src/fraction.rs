//! Sums, differences, products and quotients of fractions in lowest terms, as `num_rational` has them, in less time where numbers are long.
//!
//! *Fewer divisors*: `num_rational` reduces each result by the greatest common divisor of its whole numerator and denominator. Where the operands are in lowest terms, so is the
//! result after common divisors of parts of them are taken out (D. E. Knuth, The Art of Computer Programming, volume 2, section 4.5.1), which are shorter.
//! *Shorter work on each*: [`greatest_common_divisor`] takes several steps of Euclid's algorithm at once (D. H. Lehmer, 1938; Knuth, section 4.5.2, algorithm L), where
//! `num_integer` takes a pass through both numbers for each binary digit or two.
//!
//! Every result is the one fraction in lowest terms with the value, its denominator above zero. Operands must be such fractions.

use crate::number::exact_log2;
use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::mem;

/// `numerator / denominator` in lowest terms.
///
/// # Panics
///
/// Where the denominator is zero, as `BigRational::new` does.
pub fn lowest(numerator: BigInt, denominator: BigInt) -> BigRational {
    assert!(!denominator.is_zero(), "a denominator is zero");
    let common = common_divisor(&numerator, &denominator);
    below_positive(without(numerator, &common), without(denominator, &common))
}

/// `a + b`.
pub fn sum(a: &BigRational, b: &BigRational) -> BigRational {
    combined(a, b, |a, b| a + b)
}

/// `a − b`.
pub fn difference(a: &BigRational, b: &BigRational) -> BigRational {
    combined(a, b, |a, b| a - b)
}

/// `a · b`.
pub fn product(a: &BigRational, b: &BigRational) -> BigRational {
    crosswise([a.numer(), a.denom()], [b.numer(), b.denom()])
}

/// `a / b`; `None` where b is zero.
pub fn quotient(a: &BigRational, b: &BigRational) -> Option<BigRational> {
    if b.is_zero() {
        return None;
    }
    let (numerator, denominator) = crosswise([a.numer(), a.denom()], [b.denom(), b.numer()]).into_raw();
    Some(below_positive(numerator, denominator))
}

/// The fraction, with the sign in its numerator.
fn below_positive(numerator: BigInt, denominator: BigInt) -> BigRational {
    if denominator.is_negative() {
        BigRational::new_raw(-numerator, -denominator)
    } else {
        BigRational::new_raw(numerator, denominator)
    }
}

/// The least common multiple of two integers above zero.
pub fn common_multiple(a: &BigInt, b: &BigInt) -> BigInt {
    without(a.clone(), &common_divisor(a, b)) * b
}

/// The sum or difference. A divisor of the numerator over the common denominator divides what the denominators have in common: each prime
/// power of either that is not in the other divides one of the two terms and not the other.
fn combined(a: &BigRational, b: &BigRational, combine: impl Fn(BigInt, BigInt) -> BigInt) -> BigRational {
    let (below_a, below_b) = (a.denom(), b.denom());
    let shared = if below_a == below_b { below_a.clone() } else { common_divisor(below_a, below_b) };
    // By what is below the other and not shared.
    let [only_a, only_b] = [below_a, below_b].map(|below| without(below.clone(), &shared));
    let numerator = combine(a.numer() * &only_b, b.numer() * &only_a);
    if numerator.is_zero() {
        return BigRational::zero();
    }
    let common = common_divisor(&numerator, &shared);
    BigRational::new_raw(without(numerator, &common), only_a * without(below_b.clone(), &common))
}

/// The product of two fractions, given as numerator and denominator each: only a numerator and the other denominator can have common divisors.
fn crosswise([a, below_a]: [&BigInt; 2], [b, below_b]: [&BigInt; 2]) -> BigRational {
    if a.is_zero() || b.is_zero() {
        return BigRational::zero();
    }
    let (one, other) = (common_divisor(a, below_b), common_divisor(b, below_a));
    let numerator = without(a.clone(), &one) * without(b.clone(), &other);
    BigRational::new_raw(numerator, without(below_a.clone(), &other) * without(below_b.clone(), &one))
}

/// The greatest common divisor, above zero unless both are zero.
fn common_divisor(a: &BigInt, b: &BigInt) -> BigInt {
    greatest_common_divisor(a.magnitude(), b.magnitude()).into()
}

/// `number / divisor` where nothing is left over.
fn without(number: BigInt, divisor: &BigInt) -> BigInt {
    match exact_log2(divisor) {
        Some(0) => number,
        Some(twos) => number >> twos,
        None => number / divisor,
    }
}

/// The greatest common divisor; that of zero and a number is the number.
///
/// Divisors of both numbers are divisors of what any matrix of integers with determinant ±1 makes of them, and the other way round. So a wrong quotient
/// in the leading digits could cost time, never the result.
pub fn greatest_common_divisor(a: &BigUint, b: &BigUint) -> BigUint {
    let (Some(twos_a), Some(twos_b)) = (a.trailing_zeros(), b.trailing_zeros()) else {
        return if a.is_zero() { b.clone() } else { a.clone() };
    };
    let twos = twos_a.min(twos_b);
    // A power of two has no odd divisor.
    if a.bits() == twos_a + 1 || b.bits() == twos_b + 1 {
        return BigUint::one() << twos;
    }
    odd_common_divisor(a >> twos_a, b >> twos_b) << twos
}

/// The greatest common divisor of numbers that are not zero, at least one of them odd.
fn odd_common_divisor(mut a: BigUint, mut b: BigUint) -> BigUint {
    if a < b {
        mem::swap(&mut a, &mut b);
    }
    while b.bits() > 64 {
        match leading_steps(&a, &b) {
            Some(steps) => (a, b) = steps.applied(&a, &b),
            None => {
                a %= &b;
                mem::swap(&mut a, &mut b);
            }
        }
        if a < b {
            mem::swap(&mut a, &mut b);
        }
    }
    match b.to_u64() {
        None | Some(0) => a,
        Some(small) => {
            let (mut x, mut y) = (small, (a % small).to_u64().unwrap_or(0));
            while y != 0 {
                (x, y) = (y, x % y);
            }
            x.into()
        }
    }
}

/// What some steps of Euclid's algorithm make of a and b: `(p·a + q·b, r·a + s·b)`, the matrix of determinant ±1.
struct Steps {
    p: i64,
    q: i64,
    r: i64,
    s: i64,
}

impl Steps {
    fn applied(&self, a: &BigUint, b: &BigUint) -> (BigUint, BigUint) {
        // Of two terms of opposite signs, the lesser from the greater: the sign does not matter to divisors.
        let of = |of_a: i64, of_b: i64| {
            let (one, other) = (a * of_a.unsigned_abs(), b * of_b.unsigned_abs());
            match (of_a.signum() * of_b.signum() < 0, one < other) {
                (false, _) => one + other,
                (true, false) => one - other,
                (true, true) => other - one,
            }
        };
        (of(self.p, self.q), of(self.r, self.s))
    }
}

/// Binary digits of a that are looked at: sums with coefficients stay within 63.
const LEADING: u64 = 62;

/// The steps of Euclid's algorithm that the leading digits of a ≥ b decide; `None` where they decide none.
fn leading_steps(a: &BigUint, b: &BigUint) -> Option<Steps> {
    let below = a.bits().saturating_sub(LEADING);
    let leading = |number: &BigUint| (number >> below).to_i64();
    let (mut x, mut y) = (leading(a)?, leading(b)?);
    let mut steps = Steps { p: 1, q: 0, r: 0, s: 1 };
    loop {
        // The quotient lies between these two, whatever the digits below are.
        let (low, high) = (y + steps.r, y + steps.s);
        if low == 0 || high == 0 {
            break;
        }
        let quotient = (x + steps.p) / low;
        if quotient != (x + steps.q) / high {
            break;
        }
        let Steps { p, q, r, s } = steps;
        let next = |before: i64, last: i64| Some((last, before.checked_sub(quotient.checked_mul(last)?)?));
        let (Some((p, r)), Some((q, s))) = (next(p, r), next(q, s)) else { break };
        steps = Steps { p, q, r, s };
        (x, y) = (y, x - quotient * y);
    }
    (steps.q != 0).then_some(steps)
}

#[cfg(test)]
mod tests;
