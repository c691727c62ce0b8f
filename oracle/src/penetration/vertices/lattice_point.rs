//! Points with coordinates in fractions of lattice units, and distances from them.

use crate::penetration::compare;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::One;
use rockproof_model::Vec3;

/// The point `numerators / denominator` in lattice units, the denominator above zero.
#[derive(Clone)]
pub(super) struct Fraction {
    pub(super) numerators: Vec3<BigInt>,
    pub(super) denominator: BigInt,
}

impl Fraction {
    pub(super) fn whole(numerators: Vec3<BigInt>) -> Fraction {
        Fraction { numerators, denominator: BigInt::one() }
    }

    /// The point `p + share·d`.
    pub(super) fn between(p: &Vec3<BigInt>, d: &Vec3<BigInt>, share: &BigRational) -> Fraction {
        Fraction {
            numerators: p.scaled(share.denom()).plus(&d.scaled(share.numer())),
            denominator: share.denom().clone(),
        }
    }

    /// The same with the least denominator.
    pub(super) fn reduced(self) -> Fraction {
        if self.denominator.is_one() {
            return self;
        }
        let common = self.numerators.components().into_iter().fold(self.denominator.clone(), |all, c| all.gcd(c));
        Fraction { numerators: self.numerators.map(|c| c / &common), denominator: self.denominator / common }
    }

    /// The way from it to a lattice point, in units finer by its denominator.
    pub(super) fn way_to(&self, place: &Vec3<BigInt>) -> Vec3<BigInt> {
        if self.denominator.is_one() {
            return place.minus(&self.numerators);
        }
        place.scaled(&self.denominator).minus(&self.numerators)
    }

    pub(super) fn of(point: &Vec3<BigRational>) -> Fraction {
        let denominator = point.components().into_iter().fold(BigInt::one(), |all, c| all.lcm(c.denom()));
        Fraction { numerators: point.map(|c| c.numer() * (&denominator / c.denom())), denominator }
    }
}

/// The point of a surface next to a point: the squared distance as a fraction, and the way there times something above zero.
pub(super) struct NearestPoint {
    pub(super) numerator: BigInt,
    pub(super) denominator: BigInt,
    pub(super) way: Vec3<BigInt>,
}

impl NearestPoint {
    /// The same in units `factor` times as long.
    pub(super) fn on_coarser_lattice(&self, factor: &BigInt) -> NearestPoint {
        let denominator = &self.denominator * factor * factor;
        NearestPoint { numerator: self.numerator.clone(), denominator, way: self.way.clone() }
    }

    pub(super) fn cmp_square(&self, other: &NearestPoint) -> std::cmp::Ordering {
        compare((&self.numerator, &self.denominator), (&other.numerator, &other.denominator))
    }

    /// Whether it is no farther than the largest coordinate of a box over so much; **exactly so far is within**.
    pub(super) fn is_within(&self, bounds: &[Vec3<BigInt>; 2], share: u64) -> bool {
        let coordinates = bounds.iter().flat_map(|corner| corner.components());
        let largest = coordinates.map(BigInt::magnitude).max().cloned().unwrap_or_default();
        let limit = BigInt::from(largest.pow(2));
        compare((&self.numerator, &self.denominator), (&limit, &BigInt::from(share).pow(2))).is_le()
    }
}
