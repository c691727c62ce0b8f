//! Exact points in integers over one denominator each, and what several of them span.

use num_bigint::BigInt;
use num_traits::{One, Zero};
use rockproof_model::Vec3;

/// A vector in lattice units.
pub(super) type Units = Vec3<BigInt>;

/// A point in lattice units: `numerators / denominator`.
#[derive(Clone, Debug)]
pub(super) struct HomogeneousPoint {
    numerators: Units,
    /// Above zero.
    denominator: BigInt,
}

impl HomogeneousPoint {
    /// A vertex.
    pub(super) fn whole(point: &Units) -> HomogeneousPoint {
        HomogeneousPoint { numerators: point.clone(), denominator: BigInt::one() }
    }

    /// `start + direction·(share / whole)`; `None` where `whole`, which is no less than zero, is zero.
    pub(super) fn along(start: &Units, direction: &Units, share: &BigInt, whole: BigInt) -> Option<HomogeneousPoint> {
        let numerators = start.scaled(&whole).plus(&direction.scaled(share));
        (!whole.is_zero()).then_some(HomogeneousPoint { numerators, denominator: whole })
    }

    /// The way here from another point, times both denominators.
    fn from(&self, other: &HomogeneousPoint) -> Units {
        self.numerators.scaled(&other.denominator).minus(&other.numerators.scaled(&self.denominator))
    }
}

/// Of which dimension it is what points span.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Span {
    /// All coincide.
    Point,
    /// They lie on one line.
    Line,
    /// They lie on no line.
    Plane,
}

/// What points span.
pub(super) fn span<'p>(mut points: impl Iterator<Item = &'p HomogeneousPoint>) -> Span {
    let Some(first) = points.next() else { return Span::Point };
    let is_zero = |vector: &Units| vector.components().into_iter().all(Zero::is_zero);
    let mut direction: Option<Units> = None;
    for point in points {
        let offset = point.from(first);
        match &direction {
            None if is_zero(&offset) => {}
            None => direction = Some(offset),
            Some(d) if is_zero(&d.cross(&offset)) => {}
            Some(_) => return Span::Plane,
        }
    }
    if direction.is_some() { Span::Line } else { Span::Point }
}
