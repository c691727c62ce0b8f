//! How far a face is from its plane, measured on the block's size.

use crate::block::BlockOptions;
use crate::block::certain_sign::{Coordinates, Filtered, Surface};
use crate::block::polynomials::{Area, Height};
use crate::ring::Ring;
use crate::topology::VertexId;
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Signed;
use std::cell::OnceCell;

/// The planarity asked for, over the coordinates of one block.
pub(super) struct Planarity<'a> {
    coordinates: &'a Coordinates<'a>,
    options: &'a BlockOptions,
    /// Allowed distance in metres, rounded down; zero where the filter cannot tell.
    allowed_at_least: f64,
    /// The same rounded up; infinite where the filter cannot tell.
    allowed_at_most: f64,
    exact: OnceCell<(BigInt, BigInt)>,
}

/// The vertices of a face furthest from its plane: several where they are equally far.
pub(super) struct FurthestVertices {
    pub(super) vertices: Vec<VertexId>,
    /// Their distance over the longest side of the block's box.
    pub(super) deviation: f64,
}

impl<'a> Planarity<'a> {
    pub(super) fn new(coordinates: &'a Coordinates<'a>, options: &'a BlockOptions) -> Planarity<'a> {
        // Rounding to f64 and the product are each within 2^−52, far inside 1e-9.
        let share = options.planarity.approximate();
        let [least, most] = coordinates.filtered().map_or([0.0, f64::INFINITY], sizes);
        let allowed = share * (1.0 - 1e-9) * least;
        let allowed_at_least = if allowed.is_finite() && allowed > 0.0 { allowed } else { 0.0 };
        let allowed_at_most = match options.planarity.is_zero() {
            true => 0.0,
            // What underflows is no more than the least normal number.
            false if share >= f64::MIN_POSITIVE => (share * (1.0 + 1e-9) * most).max(f64::MIN_POSITIVE),
            false => f64::INFINITY,
        };
        Planarity { coordinates, options, allowed_at_least, allowed_at_most, exact: OnceCell::new() }
    }

    /// Allowed distance in metres, near enough for culling; infinite where unknown.
    pub(super) fn slack(&self) -> f64 {
        if self.options.planarity.is_zero() {
            0.0
        } else if self.allowed_at_least > 0.0 {
            2.0 * self.allowed_at_least
        } else {
            f64::INFINITY
        }
    }

    /// The allowed distance in lattice units, as numerator and denominator.
    fn allowed(&self) -> &(BigInt, BigInt) {
        self.exact.get_or_init(|| {
            let (numerator, denominator) = self.options.planarity.to_rational().into_raw();
            (numerator * self.size(), denominator)
        })
    }

    /// The longest side of the block's box in lattice units.
    fn size(&self) -> BigInt {
        let points = self.coordinates.units();
        (0..3).map(|axis| extent(points, axis)).max().unwrap_or_default()
    }

    /// The vertices furthest from the face's plane, if that is further than allowed.
    pub(super) fn violation(&self, surface: &Surface<'_>, face: usize) -> Option<FurthestVertices> {
        let boundary = &surface.faces()[face];
        if boundary.len() == 3 || self.is_surely_planar(surface, face) {
            return None;
        }
        let heights: Vec<BigInt> = boundary
            .iter()
            .map(|&vertex| surface.exact_value(&Height { face, through: boundary[0], vertex }))
            .collect();
        let distances: Vec<BigInt> = from_mean(&heights).iter().map(BigInt::abs).collect();
        let distance = distances.iter().max()?.clone();
        // The distance is n·|N| times that of the vertex.
        let count = BigInt::from(boundary.len());
        let area = surface.exact_value(&Area { face });
        let (allowed, divisor) = self.allowed();
        let too_far = (&distance * divisor).squared() > (allowed * &count).squared() * &area;
        too_far.then(|| {
            let share = BigRational::new(distance.squared(), (count * self.size()).squared() * area);
            let furthest = boundary.iter().zip(&distances).filter(|(_, d)| **d == distance);
            FurthestVertices {
                vertices: furthest.map(|(&vertex, _)| vertex).collect(),
                deviation: crate::Number::from_rational(share).approximate().sqrt(),
            }
        })
    }

    /// Whether all of `vertices` are within the allowed distance, divided by `parts`, of the plane through `through`
    /// along the normal of `face`.
    pub(super) fn holds_all(
        &self,
        surface: &Surface<'_>,
        (face, through): (usize, VertexId),
        vertices: &[VertexId],
        parts: u32,
    ) -> bool {
        if self.surely_misses_one(surface, (face, through), vertices, parts) {
            return false;
        }
        let (allowed, divisor) = self.allowed();
        let allowed = allowed.squared() * surface.exact_value(&Area { face });
        let factor = divisor * BigInt::from(parts);
        vertices.iter().all(|&vertex| {
            let height = surface.exact_value(&Height { face, through, vertex });
            (height * &factor).squared() <= allowed
        })
    }

    /// Whether f64 shows that [`Planarity::holds_all`] is false.
    pub(super) fn surely_misses_one(
        &self,
        surface: &Surface<'_>,
        (face, through): (usize, VertexId),
        vertices: &[VertexId],
        parts: u32,
    ) -> bool {
        let Some(area) = surface.estimate(&Area { face }) else { return false };
        let allowed = self.allowed_at_most * area.at_most().sqrt() * (1.0 + 1e-9);
        vertices.iter().any(|&vertex| {
            let height = surface.estimate(&Height { face, through, vertex });
            height.is_some_and(|height| height.at_least() * f64::from(parts) > allowed)
        })
    }

    /// Whether the distance whose square is `squared / length_squared`, both in lattice units, is allowed.
    pub(super) fn allows(&self, squared: &BigInt, length_squared: &BigInt) -> bool {
        let (allowed, divisor) = self.allowed();
        squared * divisor.squared() <= allowed.squared() * length_squared
    }

    fn is_surely_planar(&self, surface: &Surface<'_>, face: usize) -> bool {
        let boundary = &surface.faces()[face];
        let Some(area) = surface.estimate(&Area { face }) else { return false };
        let mut heights: Vec<Filtered> = Vec::with_capacity(boundary.len());
        for &vertex in boundary {
            let Some(height) = surface.estimate(&Height { face, through: boundary[0], vertex }) else { return false };
            heights.push(height);
        }
        let allowed = self.allowed_at_least * boundary.len() as f64 * area.at_least().sqrt();
        from_mean(&heights).iter().all(|d| d.at_most() * (1.0 + 1e-9) <= allowed)
    }
}

/// `n·h_k − Σ h` for every height h_k.
fn from_mean<T: Ring>(heights: &[T]) -> Vec<T> {
    let count = T::from_i32(heights.len() as i32);
    let sum = heights.iter().fold(T::from_i32(0), |sum, h| sum.plus(h));
    heights.iter().map(|h| h.times(&count).minus(&sum)).collect()
}

fn extent(points: &[Vec3<BigInt>], axis: usize) -> BigInt {
    let along = |p: &Vec3<BigInt>| p.components()[axis].clone();
    let (least, most) = (points.iter().map(along).min(), points.iter().map(along).max());
    most.unwrap_or_default() - least.unwrap_or_default()
}

/// Lengths that the longest box side does not fall below and does not exceed.
fn sizes(points: &[Vec3<Filtered>]) -> [f64; 2] {
    let side = |axis: usize, sign: f64| {
        let all = points.iter().map(|p| p.components()[axis]);
        let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), c| {
            (least.min(c.value() + sign * c.error()), most.max(c.value() - sign * c.error()))
        });
        most - least
    };
    let longest = |sign: f64| (0..3).map(|axis| side(axis, sign)).fold(0.0, f64::max);
    [longest(1.0), longest(-1.0)]
}
