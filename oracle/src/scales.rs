//! The tolerance set in each of the oracle's number types.

use crate::field::DoubleBall;
use crate::number::{Approx, Ball, Bits, Bound, INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use crate::pair::FromUnits;
use crate::view::Scales;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::One;
use rockproof_model::lattice::Lattice;
use rockproof_model::{Number, Ring, ToleranceSet};

impl Scales<Approx> {
    /// Lengths in metres, rounded.
    pub(crate) fn approximate(t: &ToleranceSet) -> Scales<Approx> {
        let near = |n: &Number| Approx(n.approximate());
        Scales {
            unit: Approx(1.0),
            search: near(&t.search),
            territory: near(&t.territory),
            penetration: near(&t.penetration),
            one: Approx(1.0),
            overlap: near(&t.overlap_sine),
            parallel: near(&t.parallel_sine),
            whole: Approx(1.0),
            equal: near(&t.equal),
        }
    }
}

fn rounding_of(n: &Number) -> f64 {
    if n.as_f64().is_some() { 0.0 } else { n.approximate().abs() * UNIT_ROUNDOFF * INFLATION + UNDERFLOW }
}

impl Scales<Bound> {
    /// Bounds on what [`Scales::approximate`] gives, as if it had been rounded.
    #[inline(always)]
    pub(crate) fn around(floats: &Scales<Approx>) -> Scales<Bound> {
        let bound = |n: Approx| Bound::around(n.0, n.0.abs() * UNIT_ROUNDOFF * INFLATION + UNDERFLOW);
        let exactly_one = Bound { magnitude: 1.0, error: 0.0 };
        Scales {
            unit: exactly_one,
            search: bound(floats.search),
            territory: bound(floats.territory),
            penetration: bound(floats.penetration),
            one: exactly_one,
            overlap: bound(floats.overlap),
            parallel: bound(floats.parallel),
            whole: exactly_one,
            equal: bound(floats.equal),
        }
    }

    /// Bounds on what [`Scales::approximate`] gives.
    pub(crate) fn bounds(t: &ToleranceSet) -> Scales<Bound> {
        let bound = |n: &Number| Bound::around(n.approximate(), rounding_of(n));
        let exactly_one = Bound { magnitude: 1.0, error: 0.0 };
        Scales {
            unit: exactly_one,
            search: bound(&t.search),
            territory: bound(&t.territory),
            penetration: bound(&t.penetration),
            one: exactly_one,
            overlap: bound(&t.overlap_sine),
            parallel: bound(&t.parallel_sine),
            whole: exactly_one,
            equal: bound(&t.equal),
        }
    }
}

impl Scales<Bound> {
    /// Any tolerances that are at most 1 in f64, each off by at most one roundoff.
    pub(crate) fn at_most_one() -> Scales<Bound> {
        let any = Bound { magnitude: 1.0 + f64::EPSILON, error: UNIT_ROUNDOFF };
        let exactly_one = Bound { magnitude: 1.0, error: 0.0 };
        Scales {
            unit: exactly_one,
            search: any,
            territory: any,
            penetration: any,
            one: exactly_one,
            overlap: any,
            parallel: any,
            whole: exactly_one,
            equal: any,
        }
    }
}

impl Scales<Ball> {
    /// Balls around what [`Scales::approximate`] gives.
    pub(crate) fn balls(t: &ToleranceSet) -> Scales<Ball> {
        let ball = |n: &Number| Ball { middle: n.approximate(), radius: rounding_of(n) };
        let exactly_one = Ball { middle: 1.0, radius: 0.0 };
        Scales {
            unit: exactly_one,
            search: ball(&t.search),
            territory: ball(&t.territory),
            penetration: ball(&t.penetration),
            one: exactly_one,
            overlap: ball(&t.overlap_sine),
            parallel: ball(&t.parallel_sine),
            whole: exactly_one,
            equal: ball(&t.equal),
        }
    }
}

impl<T: Ring> Scales<T> {
    /// For values that no tolerance enters.
    pub(crate) fn none() -> Scales<T> {
        let zero = || T::from_i32(0);
        Scales {
            unit: zero(),
            search: zero(),
            territory: zero(),
            penetration: zero(),
            one: zero(),
            overlap: zero(),
            parallel: zero(),
            whole: zero(),
            equal: zero(),
        }
    }
}

impl Scales<BigInt> {
    /// Lengths in lattice units over one common denominator, sines and ε over theirs.
    pub(crate) fn exact(t: &ToleranceSet, lattice: &Lattice) -> Scales<BigInt> {
        let ([search, territory, penetration], unit) =
            over_common_denominator([&t.search, &t.territory, &t.penetration], lattice);
        let unity = Lattice::unity();
        let ([overlap, parallel], one) = over_common_denominator([&t.overlap_sine, &t.parallel_sine], &unity);
        let ([equal], whole) = over_common_denominator([&t.equal], &unity);
        Scales { unit, search, territory, penetration, one, overlap, parallel, whole, equal }
    }

    pub(crate) fn converted<T: FromUnits>(&self) -> Scales<T> {
        self.map(T::from_big)
    }

    pub(crate) fn bits(&self) -> Scales<Bits> {
        self.map(|n| Bits(n.bits() as u32))
    }

    /// In balls of two f64, lengths in units of `2^bits` units of the lattice.
    pub(crate) fn double(&self, bits: Bits) -> Scales<DoubleBall> {
        let mut scales = self.map(|n| DoubleBall::of_integer(n, 0));
        let length = |n: &BigInt| DoubleBall::of_integer(n, -i64::from(bits.0));
        scales.search = length(&self.search);
        scales.territory = length(&self.territory);
        scales.penetration = length(&self.penetration);
        scales
    }
}

impl<T> Scales<T> {
    pub(crate) fn map<U>(&self, f: impl Fn(&T) -> U) -> Scales<U> {
        Scales {
            unit: f(&self.unit),
            search: f(&self.search),
            territory: f(&self.territory),
            penetration: f(&self.penetration),
            one: f(&self.one),
            overlap: f(&self.overlap),
            parallel: f(&self.parallel),
            whole: f(&self.whole),
            equal: f(&self.equal),
        }
    }
}

/// The numbers in lattice units, as integers over one denominator.
fn over_common_denominator<const N: usize>(numbers: [&Number; N], lattice: &Lattice) -> ([BigInt; N], BigInt) {
    of_few_digits(numbers, lattice).unwrap_or_else(|| of_any_digits(numbers, lattice))
}

fn of_any_digits<const N: usize>(numbers: [&Number; N], lattice: &Lattice) -> ([BigInt; N], BigInt) {
    let (numerator, denominator) = lattice.units_per_metre();
    let units_per_metre = BigRational::new_raw(numerator, denominator);
    let values = numbers.map(|n| n.to_rational() * &units_per_metre);
    let denominator = values.iter().fold(BigInt::one(), |all, v| all.lcm(v.denom()));
    (values.map(|v| v.numer() * (&denominator / v.denom())), denominator)
}

/// The same without fractions, for numbers and a lattice of few digits.
fn of_few_digits<const N: usize>(numbers: [&Number; N], lattice: &Lattice) -> Option<([BigInt; N], BigInt)> {
    let (odd, exponent) = lattice.small_factor()?;
    // Each number is p/m · 2^k units of the lattice over `odd`, p and m odd.
    let mut parts = [(0, 1, 0); N];
    let (mut common, mut shift) = (1u64, 0);
    for (part, number) in parts.iter_mut().zip(numbers) {
        let (p, m, k) = odd_fraction(number)?;
        if p != 0 {
            *part = (p, m, k + exponent);
            common = (common / common.gcd(&m)).checked_mul(m)?;
            shift = shift.max(-(k + exponent));
        }
    }
    let shared = common.gcd(&odd);
    let mut scaled = [const { BigInt::ZERO }; N];
    for (scaled, (p, m, k)) in scaled.iter_mut().zip(parts) {
        let whole = p.checked_mul(i128::from(odd / shared))?.checked_mul(i128::from(common / m))?;
        *scaled = shifted(whole, (k + shift) as u32);
    }
    Some((scaled, shifted(i128::from(common / shared), shift as u32)))
}

/// [`Number::small_fraction`] with an odd p, but for zero.
fn odd_fraction(number: &Number) -> Option<(i128, u64, i32)> {
    let (p, m, k) = number.small_fraction()?;
    let zeros = if p == 0 { 0 } else { p.trailing_zeros() };
    Some((p >> zeros, m, k + zeros as i32))
}

/// `value · 2^by`
fn shifted(value: i128, by: u32) -> BigInt {
    if value.unsigned_abs().leading_zeros() > by {
        return BigInt::from(value << by);
    }
    BigInt::from(value) << by
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::Signed;

    fn power(exponent: i32) -> BigRational {
        BigRational::from_integer(2.into()).pow(exponent)
    }

    fn rational(value: f64) -> BigRational {
        BigRational::from_float(value).unwrap()
    }

    /// A fraction that f64 rounds to 1, by as much as it may.
    fn above_one() -> BigRational {
        power(0) + power(-53) - power(-200)
    }

    /// Numbers of all kinds on lattices of all kinds: the short way and the long one agree, to the denominator.
    #[test]
    fn scales_of_few_digits_are_those_of_fractions() {
        let mut dice = crate::soundness::Dice(5);
        let mut number = || {
            let any = |dice: &mut crate::soundness::Dice, n: u64| dice.below(n) as i64;
            let numerator = BigInt::from(any(&mut dice, 3) * any(&mut dice, 1000)) << any(&mut dice, 70) as usize;
            let denominator =
                BigInt::from([1, 3, 7, 45, 10_000][any(&mut dice, 5) as usize]) << any(&mut dice, 70) as usize;
            Number::from_rational(BigRational::new(numerator, denominator))
        };
        let (mut short, mut fractions) = (0, 0);
        for _ in 0..500 {
            let (on, lengths) = ([number(), number(), number()], [number(), number(), number()]);
            let lengths = lengths.each_ref();
            let lattice = Lattice::covering(&on);
            let long = of_any_digits(lengths, &lattice);
            if let Some(scales) = of_few_digits(lengths, &lattice) {
                assert_eq!(scales, long, "{lengths:?} on {lattice:?}");
                short += 1;
                fractions += usize::from(lengths.iter().any(|length| length.as_f64().is_none()));
            }
        }
        assert!(short > 300 && fractions > 100, "{short} of few digits, {fractions} with fractions");
        let long = Number::from_rational(BigRational::new(1.into(), BigInt::from(3).pow(90)));
        assert!(of_few_digits([&long], &Lattice::unity()).is_none());
    }

    #[test]
    fn a_fraction_is_off_by_no_more_than_its_rounding() {
        let third = BigRational::new(1.into(), 3.into());
        for value in [third.clone(), &third * power(-1030), &third * power(1000), above_one()] {
            let number = Number::from_rational(value.clone());
            let (off, doubt) = ((rational(number.approximate()) - &value).abs(), rounding_of(&number));
            assert!(doubt >= 0.0 && off <= rational(doubt), "{value} is off by {off}, not {doubt}");
            assert!(rational(doubt) <= value * power(-52) + power(-1020), "{doubt} is far more than {off}");
        }
        for value in [0.0, 0.1, 1.0, 5e-324, f64::MAX] {
            assert_eq!(rounding_of(&Number::from_f64(value).unwrap()), 0.0, "f64 holds {value}");
        }
    }

    #[test]
    fn a_tolerance_that_f64_takes_for_one_is_among_those_of_at_most_one() {
        let number = Number::from_rational(above_one());
        assert_eq!(number.approximate(), 1.0);
        let any = Scales::at_most_one();
        for bound in [any.search, any.territory, any.penetration, any.overlap, any.parallel, any.equal] {
            assert!(above_one() <= rational(bound.magnitude), "{bound:?}");
            assert!(above_one() - power(0) <= rational(bound.error), "{bound:?}");
        }
    }
}
