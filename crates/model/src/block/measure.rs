//! Lengths, volume and centroid of a block, exactly, and blocks that are made to measure.

use crate::block::{Block, BlockError, BlockOptions, Point};
use crate::lattice::Lattice;
use crate::number::Number;
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::Zero;
use std::sync::OnceLock;

/// The axis-parallel box of a block, in metres.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounds<'a> {
    /// The least coordinate along each axis.
    pub min: Vec3<&'a Number>,
    /// The greatest coordinate along each axis.
    pub max: Vec3<&'a Number>,
}

/// Six times the volume, and the centroid as `sum / (4 · six_volumes)`, in units of the block's lattice relative to its first vertex.
#[derive(Clone, Debug)]
pub(crate) struct Moments {
    pub(crate) lattice: Lattice,
    pub(crate) six_volumes: BigInt,
    pub(crate) sum: Vec3<BigInt>,
}

/// The moments of a block, calculated when they are first asked for. They follow from its vertices and faces, so they take no part in comparisons of blocks.
#[derive(Clone, Debug, Default)]
pub(super) struct LazyMoments(OnceLock<Box<Moments>>);

impl PartialEq for LazyMoments {
    fn eq(&self, _: &LazyMoments) -> bool {
        true
    }
}

impl Eq for LazyMoments {}

impl Block {
    /// The box `min` to `max`, its vertices the lower face counter-clockwise seen from above, then the upper one; its
    /// faces lower, upper, then the sides from −y counter-clockwise.
    ///
    /// # Errors
    /// When `min` is not below `max` along every axis.
    pub fn cuboid(min: &Point, max: &Point) -> Result<Block, BlockError> {
        let (vertices, faces) = cuboid_mesh(min, max);
        Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO })
    }

    /// The block's axis-parallel box, exactly.
    pub fn bounds(&self) -> Bounds<'_> {
        let first = &self.vertices()[0];
        let corner = || Vec3::new(&first.x, &first.y, &first.z);
        let mut bounds = Bounds { min: corner(), max: corner() };
        for v in &self.vertices()[1..] {
            bounds.min = Vec3::new(bounds.min.x.min(&v.x), bounds.min.y.min(&v.y), bounds.min.z.min(&v.z));
            bounds.max = Vec3::new(bounds.max.x.max(&v.x), bounds.max.y.max(&v.y), bounds.max.z.max(&v.z));
        }
        bounds
    }

    /// The volume in m³, exactly; each face as the triangles from the first vertex of its loop.
    pub fn volume(&self) -> BigRational {
        let moments = self.moments();
        let (numerator, denominator) = moments.lattice.units_per_metre();
        in_lowest_terms(&moments.six_volumes * denominator.pow(3), numerator.pow(3) * BigInt::from(6))
    }

    /// The centroid in metres, exactly; each face as the triangles from the first vertex of its loop. A block
    /// moved by [`Block::with_vertices`] into a shape without volume has none; the mean of its vertices is answered.
    pub fn centroid(&self) -> Vec3<BigRational> {
        let (lattice, points) = self.lattice_points();
        let (numerator, denominator) = lattice.units_per_metre();
        let moments = self.moments();
        let (sum, weight) = if moments.six_volumes.is_zero() {
            let sum = points.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, p| sum.plus(&p.minus(&points[0])));
            (sum, BigInt::from(points.len()))
        } else {
            (moments.sum.clone(), &moments.six_volumes * BigInt::from(4))
        };
        let place = |sum: &BigInt, origin: &BigInt| {
            BigRational::new((sum + origin * &weight) * &denominator, &weight * &numerator)
        };
        let origin = &points[0];
        Vec3::new(place(&sum.x, &origin.x), place(&sum.y, &origin.y), place(&sum.z, &origin.z))
    }

    /// The lattice of the coordinates, and the vertices on it.
    pub(crate) fn lattice_points(&self) -> (Lattice, Vec<Vec3<BigInt>>) {
        let lattice = Lattice::covering(self.coordinates());
        let points = self.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect();
        (lattice, points)
    }

    /// The block's moments; calculated once.
    pub(crate) fn moments(&self) -> &Moments {
        self.moments.0.get_or_init(|| {
            let (lattice, points) = self.lattice_points();
            let relative = from_first(&points);
            let mut moments = Moments { lattice, six_volumes: BigInt::ZERO, sum: Vec3::zero() };
            for [a, b, c] in self.fans(&relative) {
                let six_volumes = a.dot(&b.cross(c));
                moments.sum = moments.sum.plus(&a.plus(b).plus(c).scaled(&six_volumes));
                moments.six_volumes += six_volumes;
            }
            Box::new(moments)
        })
    }

    /// The triangles from the first vertex of each face's loop.
    fn fans<'p>(&'p self, points: &'p [Vec3<BigInt>]) -> impl Iterator<Item = [&'p Vec3<BigInt>; 3]> {
        self.topology().faces().iter().flat_map(move |face| {
            let corners = face[1..].windows(2).map(move |pair| [face[0], pair[0], pair[1]]);
            corners.map(move |corners| corners.map(|v| &points[v.index()]))
        })
    }
}

fn from_first(points: &[Vec3<BigInt>]) -> Vec<Vec3<BigInt>> {
    points.iter().map(|p| p.minus(&points[0])).collect()
}

/// A fraction whose denominator is above zero, in lowest terms. Where coordinates are f64 the denominator is six times a power
/// of two, of which only twos and a three can cancel: a greatest common divisor of long numbers would cost more than all else.
fn in_lowest_terms(numerator: BigInt, denominator: BigInt) -> BigRational {
    let twos = denominator.trailing_zeros().unwrap_or(0);
    let odd = &denominator >> twos;
    let three = BigInt::from(3);
    if numerator.is_zero() || odd != three {
        return BigRational::new(numerator, denominator);
    }
    let shared = twos.min(numerator.trailing_zeros().unwrap_or(0));
    let (numerator, twos) = (numerator >> shared, twos - shared);
    match numerator.div_rem(&three) {
        (third, rest) if rest.is_zero() => BigRational::new_raw(third, BigInt::from(1) << twos),
        _ => BigRational::new_raw(numerator, three << twos),
    }
}

/// Vertices and faces of [`Block::cuboid`].
pub(crate) fn cuboid_mesh(min: &Point, max: &Point) -> (Vec<Point>, Vec<Vec<u32>>) {
    let corner = |right: bool, back: bool, up: bool| {
        let pick = |far: bool, a: &Number, b: &Number| if far { b.clone() } else { a.clone() };
        Vec3::new(pick(right, &min.x, &max.x), pick(back, &min.y, &max.y), pick(up, &min.z, &max.z))
    };
    let ground = [(false, false), (true, false), (true, true), (false, true)];
    let vertices = [false, true].iter().flat_map(|&up| ground.map(|(x, y)| corner(x, y, up))).collect();
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    (vertices, faces.map(Vec::from).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twos_and_a_three_are_all_that_cancels_of_six_times_a_power_of_two() {
        for numerator in [0i64, 1, -1, 2, -3, 6, 12, 9, -24, 35, 96, 1 << 40, 3 << 50] {
            for denominator in [1i64, 2, 3, 6, 12, 48, 9, 18, 15, 3 << 41, 5 << 20] {
                let [n, d] = [numerator, denominator].map(BigInt::from);
                let (found, expected) = (in_lowest_terms(n.clone(), d.clone()), BigRational::new(n, d));
                // Equal fractions are equal whatever their terms.
                assert_eq!((found.numer(), found.denom()), (expected.numer(), expected.denom()));
            }
        }
    }
}
