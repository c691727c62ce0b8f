//! A block on an integer lattice: moved, turned and stretched without a fraction, turned into a [`Block`] at the end.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use rockproof_model::number::power_of_two;
use rockproof_model::{Block, Number, Vec3};

/// A point or vector in units of one lattice.
pub type Units = [i128; 3];

/// A block whose vertices are `points / denominator` metres.
///
/// Only affine maps that keep orientation are offered, and these keep the convexity of every feature. So the flags of
/// the shape are decided once, when it is first built, and a moved copy costs its coordinates alone.
#[derive(Clone, Debug)]
pub struct LatticeSolid {
    shape: Block,
    points: Vec<Units>,
    denominator: i128,
}

impl LatticeSolid {
    /// The block `shape`, placed at `points / denominator`: an orientation-keeping affine image of it.
    pub(crate) fn new(shape: Block, points: Vec<Units>, denominator: i128) -> LatticeSolid {
        debug_assert!(denominator > 0, "a lattice has a positive denominator");
        LatticeSolid { shape, points, denominator }
    }

    /// The vertices in lattice units.
    pub fn points(&self) -> &[Units] {
        &self.points
    }

    /// Lattice units per metre.
    pub fn denominator(&self) -> i128 {
        self.denominator
    }

    /// Combinatorics and convexity flags; its coordinates are not this solid's.
    pub fn shape(&self) -> &Block {
        &self.shape
    }

    /// The same solid on a lattice `factor` times as fine.
    #[must_use]
    pub fn refined(&self, factor: i128) -> LatticeSolid {
        let points = self.points.iter().map(|p| p.map(|c| c * factor)).collect();
        LatticeSolid { shape: self.shape.clone(), points, denominator: self.denominator * factor }
    }

    /// Both solids on one lattice, the coarsest that holds both.
    #[must_use]
    pub fn on_one_lattice(a: &LatticeSolid, b: &LatticeSolid) -> (LatticeSolid, LatticeSolid) {
        let common = a.denominator.lcm(&b.denominator);
        (a.refined(common / a.denominator), b.refined(common / b.denominator))
    }

    /// Moved by `offset` lattice units.
    #[must_use]
    pub fn moved(&self, offset: Units) -> LatticeSolid {
        let points = self.points.iter().map(|p| [p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]]).collect();
        LatticeSolid { shape: self.shape.clone(), points, denominator: self.denominator }
    }

    /// The image under `matrix / denominator`. The determinant must be positive.
    #[must_use]
    pub fn mapped(&self, matrix: &[[i64; 3]; 3], denominator: i64) -> LatticeSolid {
        let image = |p: &Units| {
            matrix.map(|row| i128::from(row[0]) * p[0] + i128::from(row[1]) * p[1] + i128::from(row[2]) * p[2])
        };
        LatticeSolid {
            shape: self.shape.clone(),
            points: self.points.iter().map(image).collect(),
            denominator: self.denominator * i128::from(denominator),
        }
    }

    /// Stretched along each axis by `factors`, which must be positive, over `denominator`.
    #[must_use]
    pub fn stretched(&self, factors: Units, denominator: i128) -> LatticeSolid {
        let points = self.points.iter().map(|p| [p[0] * factors[0], p[1] * factors[1], p[2] * factors[2]]).collect();
        LatticeSolid { shape: self.shape.clone(), points, denominator: self.denominator * denominator }
    }

    /// The number of the vertex furthest along `direction`, the first of several.
    pub fn furthest(&self, direction: Units) -> usize {
        let along = |p: &Units| direction[0] * p[0] + direction[1] * p[1] + direction[2] * p[2];
        let mut best = 0;
        for (i, p) in self.points.iter().enumerate() {
            if along(p) > along(&self.points[best]) {
                best = i;
            }
        }
        best
    }

    /// Smallest and largest coordinate along an axis, in lattice units.
    pub fn extent(&self, axis: usize) -> (i128, i128) {
        let along = || self.points.iter().map(|p| p[axis]);
        (along().min().unwrap_or(0), along().max().unwrap_or(0))
    }

    /// The block, scaled by `2^exponent` (of small magnitude, so that nothing leaves the range of f64).
    pub fn block(&self, exponent: i32) -> Block {
        let number = |c: &i128| number_of(*c, self.denominator, exponent);
        self.shape
            .with_vertices(self.points.iter().map(|[x, y, z]| Vec3::new(number(x), number(y), number(z))).collect())
    }
}

/// The exact number `numerator / denominator · 2^exponent`.
pub fn number_of(numerator: i128, denominator: i128, exponent: i32) -> Number {
    if numerator == 0 {
        return Number::ZERO;
    }
    let common = if denominator & (denominator - 1) == 0 {
        1 << numerator.trailing_zeros().min(denominator.trailing_zeros())
    } else {
        numerator.gcd(&denominator)
    };
    let (numerator, denominator) = (numerator / common, denominator / common);
    let scale = exponent - denominator.trailing_zeros() as i32;
    if denominator & (denominator - 1) == 0
        && numerator.unsigned_abs() < 1 << 53
        && (-900..900).contains(&scale)
        && let Ok(number) = Number::from_f64(numerator as f64 * power_of_two(scale))
    {
        return number;
    }
    let two = BigInt::from(1) << exponent.unsigned_abs() as usize;
    let fraction = BigRational::new_raw(BigInt::from(numerator), BigInt::from(denominator));
    Number::from_rational(match exponent {
        0 => fraction,
        1.. => fraction * two,
        _ => fraction / two,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_fractions_they_name() {
        for (n, d, e) in
            [(6, 4, 0), (-9, 8, 3), (1, 3, -5), (1 << 60, 1 << 10, 2), ((1 << 60) + 1, 1 << 10, 0), (10, 35, 4)]
        {
            let two = BigRational::from_integer(2.into());
            let expected = BigRational::new(BigInt::from(n), BigInt::from(d)) * two.pow(e);
            assert_eq!(number_of(n, d, e).to_rational(), expected, "{n}/{d}·2^{e}");
        }
    }
}
