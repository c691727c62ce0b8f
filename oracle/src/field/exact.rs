//! The exact level: fractions.

use super::{Field, Halve, UpperBound};
use crate::mass::Integrals;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use rockproof_model::fraction::{self, common_multiple};
use rockproof_model::number::round_rational;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Number, Precision, Sign, Topology, Vec3};

impl Halve for BigRational {
    fn half(&self) -> Self {
        fraction::product(self, &BigRational::new_raw(1.into(), 2.into()))
    }
}

impl Field for BigRational {
    fn of_rational(value: &BigRational, _bits: u32) -> Self {
        value.clone()
    }

    fn of_number(value: &Number, _bits: u32) -> Self {
        value.to_rational()
    }

    fn over(&self, divisor: &Self) -> Option<Self> {
        fraction::quotient(self, divisor)
    }

    /// Only squares of fractions have a root here.
    fn root(&self) -> Option<Self> {
        Some(BigRational::new_raw(whole_root(self.numer())?, whole_root(self.denom())?))
    }

    fn certain_sign(&self) -> Option<Sign> {
        Some(ExactRing::sign(self))
    }

    /// In integers, with one common denominator: sums of fractions would take a greatest common divisor for each.
    fn integrals(points: &[Vec3<Self>], topology: &Topology) -> Integrals<Self> {
        let components = points.iter().flat_map(Vec3::components);
        let unit = components.fold(BigInt::from(1), |unit, value| common_multiple(&unit, value.denom()));
        let whole = |value: &BigRational| value.numer() * (&unit / value.denom());
        let points: Vec<Vec3<BigInt>> = points.iter().map(|point| point.map(whole)).collect();
        let Integrals { six_volumes, first, second } = Integrals::of(&points, topology);
        let over = |power: u32| {
            let divisor = unit.pow(power);
            move |sum: BigInt| fraction::lowest(sum, divisor.clone())
        };
        let [first_x, first_y, first_z] = [first.x, first.y, first.z].map(over(4));
        Integrals {
            six_volumes: over(3)(six_volumes),
            first: Vec3::new(first_x, first_y, first_z),
            second: second.map(|row| row.map(over(5))),
        }
    }

    fn middle(&self) -> BigRational {
        self.clone()
    }

    fn radius(&self) -> Option<UpperBound> {
        Some(UpperBound::ZERO)
    }

    fn magnitude_bound(&self) -> Option<UpperBound> {
        None
    }

    fn within(_size: UpperBound) -> Option<Self> {
        None
    }

    fn nearby(&self) -> (f64, f64) {
        match round_rational(self, Precision::F64) {
            Some(value) => (value, value.abs() * f64::EPSILON + f64::MIN_POSITIVE),
            None => (f64::NAN, f64::INFINITY),
        }
    }
}

/// The root of an integer that is a square.
fn whole_root(value: &BigInt) -> Option<BigInt> {
    if value.is_negative() {
        return None;
    }
    let root = value.sqrt();
    (&root * &root == *value).then_some(root)
}
