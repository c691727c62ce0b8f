//! The points that are separated from others: as they are, as f64, in some 100 bits, as integers.

use crate::PreparedBlock;
use crate::field::{DoubleBall, Field};
use crate::number::{Approx, UNDERFLOW, UNIT_ROUNDOFF};
use num_bigint::BigInt;
use rockproof_model::Vec3;
use rockproof_model::block::Point;
use rockproof_model::lattice::Lattice;

/// Points and the f64 next to them.
#[derive(Clone, Copy)]
pub(crate) struct PointSet<'p> {
    /// The points in m.
    pub(crate) exact: &'p [Point],
    /// Each within `error` of the exact one along every axis.
    pub(crate) near: &'p [Vec3<Approx>],
    /// Zero where every coordinate is an f64 (m).
    pub(crate) error: f64,
}

impl<'p> PointSet<'p> {
    /// The vertices of a block.
    pub(crate) fn of(prepared: &'p PreparedBlock) -> PointSet<'p> {
        PointSet { exact: prepared.block().vertices(), near: &prepared.vertices, error: prepared.errors.coordinate }
    }

    /// The points in some 100 bits. Where every coordinate is an f64 this costs nothing and their differences are exact.
    pub(crate) fn doubles(&self) -> Vec<Vec3<DoubleBall>> {
        if self.error == 0.0 {
            self.near.iter().map(|p| p.map(|c| DoubleBall::exactly(c.0, 0.0))).collect()
        } else {
            // A number of bits has no meaning for sums of two f64.
            self.exact.iter().map(|p| p.map(|c| DoubleBall::of_number(c, 0))).collect()
        }
    }
}

/// Points made ready to be separated from others.
#[derive(Debug)]
pub(crate) struct SeparablePoints {
    exact: Vec<Point>,
    near: Vec<Vec3<Approx>>,
    error: f64,
}

impl SeparablePoints {
    /// The points, in m.
    pub(crate) fn new(exact: Vec<Point>) -> SeparablePoints {
        let near: Vec<Vec3<Approx>> = exact.iter().map(|p| p.map(|c| Approx(c.approximate()))).collect();
        let is_exact = exact.iter().flat_map(|p| p.components()).all(|c| c.as_f64().is_some());
        let size = near.iter().flat_map(|p| p.components()).fold(0.0f64, |most, c| most.max(c.0.abs()));
        let error = if is_exact { 0.0 } else { size * UNIT_ROUNDOFF + UNDERFLOW };
        SeparablePoints { exact, near, error }
    }

    pub(crate) fn set(&self) -> PointSet<'_> {
        PointSet { exact: &self.exact, near: &self.near, error: self.error }
    }
}

/// Points of two sets as integers, on one lattice.
pub(crate) fn on_lattice(sets: [&[Point]; 2]) -> [Vec<Vec3<BigInt>>; 2] {
    let coordinates = sets.iter().flat_map(|set| set.iter()).flat_map(|p| p.components());
    let lattice = Lattice::covering(coordinates);
    sets.map(|set| set.iter().map(|p| p.map(|c| lattice.units(c))).collect())
}
