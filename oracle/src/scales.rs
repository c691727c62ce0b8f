//! The tolerance set in each of the oracle's number types.

use crate::field::{DoubleBall, Field};
use crate::number::{Approx, Ball, Bits, Bound, INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use crate::pair::FromUnits;
use crate::view::Scales;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::One;
use rockproof_model::lattice::Lattice;
use rockproof_model::number::split_f64;
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

impl Scales<DoubleBall> {
    /// Lengths in metres, in balls of two f64.
    pub(crate) fn double(t: &ToleranceSet) -> Scales<DoubleBall> {
        let ball = |n: &Number| DoubleBall::of_number(n, DoubleBall::BITS);
        Scales {
            unit: DoubleBall::from_i32(1),
            search: ball(&t.search),
            territory: ball(&t.territory),
            penetration: ball(&t.penetration),
            one: DoubleBall::from_i32(1),
            overlap: ball(&t.overlap_sine),
            parallel: ball(&t.parallel_sine),
            whole: DoubleBall::from_i32(1),
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
}

impl<T> Scales<T> {
    fn map<U>(&self, f: impl Fn(&T) -> U) -> Scales<U> {
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
    if let Some(shared) = powers_of_two(numbers, lattice) {
        return shared;
    }
    let (numerator, denominator) = lattice.units_per_metre();
    let units_per_metre = BigRational::new_raw(numerator, denominator);
    let values = numbers.map(|n| n.to_rational() * &units_per_metre);
    let denominator = values.iter().fold(BigInt::one(), |all, v| all.lcm(v.denom()));
    (values.map(|v| v.numer() * (&denominator / v.denom())), denominator)
}

/// The same without fractions, for f64s on a lattice whose unit is a power of two.
fn powers_of_two<const N: usize>(numbers: [&Number; N], lattice: &Lattice) -> Option<([BigInt; N], BigInt)> {
    let units = lattice.binary_exponent()?;
    let mut parts = [(0i64, 0i32); N];
    for (part, number) in parts.iter_mut().zip(numbers) {
        let (significand, exponent) = split_f64(number.as_f64()?);
        *part = (significand, if significand == 0 { 0 } else { exponent + units });
    }
    let shift = parts.iter().map(|&(_, exponent)| -exponent).max()?.max(0);
    let scaled = parts.map(|(significand, exponent)| BigInt::from(significand) << (exponent + shift) as usize);
    Some((scaled, BigInt::one() << shift as usize))
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
