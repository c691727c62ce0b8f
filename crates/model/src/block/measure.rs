//! Lengths, volume and centroid of a block, exactly, and blocks that are made to measure.

use crate::block::{Block, BlockError, BlockOptions, Point};
use crate::lattice::Lattice;
use crate::number::Number;
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;

/// The axis-parallel box of a block, in metres.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bounds<'a> {
    /// The least coordinate along each axis.
    pub min: Vec3<&'a Number>,
    /// The greatest coordinate along each axis.
    pub max: Vec3<&'a Number>,
}

/// Six times the volume, and the centroid as `sum / (4 · six_volumes)`, in units of the lattice relative to `origin`.
pub(crate) struct Moments {
    pub(crate) six_volumes: BigInt,
    pub(crate) sum: Vec3<BigInt>,
}

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
        let (lattice, points) = self.lattice_points();
        let (numerator, denominator) = lattice.units_per_metre();
        let moments = self.moments(&points);
        BigRational::new(moments.six_volumes * denominator.pow(3), numerator.pow(3) * BigInt::from(6))
    }

    /// The centroid in metres, exactly; each face as the triangles from the first vertex of its loop. A block
    /// moved by [`Block::with_vertices`] into a shape without volume has none; the mean of its vertices is answered.
    pub fn centroid(&self) -> Vec3<BigRational> {
        let (lattice, points) = self.lattice_points();
        let (numerator, denominator) = lattice.units_per_metre();
        let moments = self.moments(&points);
        let (sum, weight) = if moments.six_volumes.is_zero() {
            let sum = points.iter().fold(Vec3::zero(), |sum: Vec3<BigInt>, p| sum.plus(&p.minus(&points[0])));
            (sum, BigInt::from(points.len()))
        } else {
            (moments.sum, moments.six_volumes * BigInt::from(4))
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

    /// The block's moments on a lattice, relative to its first vertex.
    pub(crate) fn moments(&self, points: &[Vec3<BigInt>]) -> Moments {
        let relative: Vec<Vec3<BigInt>> = points.iter().map(|p| p.minus(&points[0])).collect();
        let mut moments = Moments { six_volumes: BigInt::ZERO, sum: Vec3::zero() };
        for face in self.topology().faces() {
            let a = &relative[face[0].index()];
            for pair in face[1..].windows(2) {
                let [b, c] = [pair[0], pair[1]].map(|v| &relative[v.index()]);
                let six_volumes = a.dot(&b.cross(c));
                moments.sum = moments.sum.plus(&a.plus(b).plus(c).scaled(&six_volumes));
                moments.six_volumes += six_volumes;
            }
        }
        moments
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
