//! A block as integers on a lattice of its own.
//!
//! The product of an edge of one block and a normal of another is homogeneous in the lengths of each block by itself, so its sign needs no lattice that
//! holds both. Where a block lies does not matter to it either: the lattice here is that of differences of vertices, often a much coarser one. It is made
//! when a sign first needs it, and then serves all pairs that the block is in.

use crate::number::Int128;
use crate::pair::{FromUnits, Int256};
use crate::sign_cascade::bits_within;
use num_integer::Integer;
use rockproof_model::block::face_normal;
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, FaceId, Sign, Vec3, VertexId};
use std::sync::OnceLock;

/// The widest coordinate, so that differences and their products by pairs stay within 128 and 256 bits.
pub(crate) const SMALL_BITS: u32 = 120;

/// The vertices and normals of a block as integers.
#[derive(Clone, Debug)]
pub(crate) struct OwnLattice {
    /// The lattice of the coordinates.
    pub(crate) lattice: Lattice,
    /// The first vertex in its units.
    pub(crate) first: Vec3<i128>,
    /// How many of its units a step is.
    pub(crate) step: i128,
    /// The vertices from the first one on, in steps.
    pub(crate) vertices: Vec<Vec3<i128>>,
    normals: Normals,
    /// Bits of any difference of two vertices, and of any normal.
    direction_bits: u32,
    normal_bits: u32,
    /// A k such that a metre is at most `2^k` steps.
    metre_bits: i64,
}

/// By face, in integers that hold them, each made when it is first asked for.
#[derive(Clone, Debug)]
enum Normals {
    Narrow(Vec<OnceLock<Vec3<Int128>>>),
    Wide(Vec<OnceLock<Vec3<Int256>>>),
}

/// Bits of the largest of these integers.
fn bits_of(vectors: impl Iterator<Item = Vec3<i128>>) -> u32 {
    let all = vectors.fold(0, |all, v| all | v.x.unsigned_abs() | v.y.unsigned_abs() | v.z.unsigned_abs());
    u128::BITS - all.leading_zeros()
}

impl OwnLattice {
    /// `None` where 120 bits do not hold the coordinates.
    pub(crate) fn of(block: &Block) -> Option<OwnLattice> {
        let (lattice, units) = Lattice::covering_points(block.vertices().iter(), SMALL_BITS)?;
        let first = units[0];
        let relative = |v: &Vec3<i128>| Vec3::new(v.x - first.x, v.y - first.y, v.z - first.z);
        let mut vertices: Vec<Vec3<i128>> = units.iter().map(relative).collect();
        let (odd, _) = lattice.small_factor()?;
        // Differences are multiples of what only the place of the block has made finer.
        let all = || vertices.iter().flat_map(|v| [v.x, v.y, v.z]);
        let odd = all().fold(i128::from(odd), |step, c| if step == 1 { 1 } else { step.gcd(&c) });
        let twos = all().fold(0, |all, c| all | c).trailing_zeros().min(SMALL_BITS);
        vertices.iter_mut().for_each(|v| *v = v.map(|c| c >> twos));
        if odd != 1 {
            vertices.iter_mut().for_each(|v| *v = v.map(|c| c / odd));
        }
        // Each difference of two that are both relative to the first one.
        let direction_bits = bits_of(vertices.iter().copied()) + 1;
        let topology = block.topology();
        let longest_loop = topology.faces().iter().map(Vec::len).max()?;
        // Sums of fewer products of two differences by pairs than there are corners.
        let normal_bits = 2 * direction_bits + 1 + (usize::BITS - longest_loop.leading_zeros());
        let faces = topology.faces().len();
        let normals = match normal_bits {
            ..128 => Normals::Narrow(vec![OnceLock::new(); faces]),
            128..256 => Normals::Wide(vec![OnceLock::new(); faces]),
            _ => return None,
        };
        let metre_bits = lattice.metre_bits() - i64::from(twos) - i64::from(odd.ilog2());
        let step = odd << twos;
        Some(OwnLattice { lattice, first, step, vertices, normals, direction_bits, normal_bits, metre_bits })
    }

    /// The first vertex, and the length of a step, in units of which one of the lattice is so many; `None` where 120 bits do not hold them or a difference.
    pub(crate) fn scaled(&self, factor: i128) -> Option<(Vec3<i128>, i128)> {
        let width = |c: i128| i128::BITS - c.unsigned_abs().leading_zeros();
        let step = self.step.checked_mul(factor)?;
        let held = bits_of([self.first].into_iter()) + width(factor) <= SMALL_BITS
            && self.direction_bits + width(step) <= SMALL_BITS;
        held.then(|| (self.first.map(|c| c * factor), step))
    }

    /// Whether two edges, given by their ends, are parallel, or one of them is a point.
    pub(crate) fn are_parallel(&self, ends: Ends, other: &OwnLattice, other_ends: Ends) -> bool {
        fn crossed<T: FromUnits + ExactRing>([d, e]: [Vec3<i128>; 2]) -> bool {
            let [d, e] = [d, e].map(|v| v.map(|&c| T::from_small(c)));
            d.cross(&e).components().into_iter().all(|c| c.sign().is_zero())
        }
        let directions = [self.direction(ends), other.direction(other_ends)];
        // A difference of two products.
        let short = self.direction_bits + other.direction_bits + 1 < i128::BITS;
        if short { crossed::<Int128>(directions) } else { crossed::<Int256>(directions) }
    }

    /// The normal of a face with these corners, of which it may be known.
    fn normal<T: FromUnits>(&self, known: &OnceLock<Vec3<T>>, corners: &[VertexId]) -> Vec3<T> {
        let make = || {
            let points: Vec<Vec3<T>> =
                corners.iter().map(|v| self.vertices[v.index()].map(|&c| T::from_small(c))).collect();
            face_normal(&points, &(0..points.len()).map(VertexId::at).collect::<Vec<_>>())
        };
        known.get_or_init(make).clone()
    }

    fn direction(&self, ends: Ends) -> Vec3<i128> {
        let [p, q] = [ends.0, ends.1].map(|v| &self.vertices[v.index()]);
        Vec3::new(q.x - p.x, q.y - p.y, q.z - p.z)
    }
}

/// The vertices that an edge starts and ends at.
type Ends = (VertexId, VertexId);

/// `e·N` of an edge and a face of two blocks; with `own`, an edge of the block of the face, `|d|²(e·N) − (d·N)(d·e)`, d its direction.
pub(crate) struct ProductAlongNormal<'p> {
    pub(crate) edge: (&'p OwnLattice, Ends),
    /// With its corners.
    pub(crate) face: (&'p OwnLattice, FaceId, &'p [VertexId]),
    pub(crate) own: Option<Ends>,
}

impl ProductAlongNormal<'_> {
    /// Its sign, and how many bits tell it; `None` where 256 do not. In metres it is at most `size`.
    pub(crate) fn sign(&self, size: f64) -> Option<(Sign, u32)> {
        let ((of_edge, ends), (of_face, face, corners)) = (self.edge, self.face);
        // A sum of three products.
        let (mut most, mut metre_bits) =
            (of_edge.direction_bits + of_face.normal_bits + 2, of_edge.metre_bits + 2 * of_face.metre_bits);
        if self.own.is_some() {
            // A difference of two products of three such sums, two of whose factors are of one direction.
            most += 2 * of_face.direction_bits + 3;
            metre_bits += 2 * of_face.metre_bits;
        }
        let bits = bits_within(size, metre_bits).map_or(most, |held| most.min(held.0));
        let direction = of_edge.direction(ends);
        let own = self.own.map(|own| of_face.direction(own));
        match &of_face.normals {
            Normals::Narrow(normals) if bits < 256 => {
                let normal = of_face.normal(&normals[face.index()], corners);
                if bits < i128::BITS {
                    return Some((sign_modulo(&direction, normal, own), i128::BITS));
                }
                Some((sign_modulo(&direction, normal.map(|c| Int256::from_small(c.0)), own), 256))
            }
            Normals::Wide(normals) if bits < 256 => {
                Some((sign_modulo(&direction, of_face.normal(&normals[face.index()], corners), own), 256))
            }
            _ => None,
        }
    }
}

/// The sign modulo a power of two, which is that of the value where the power is above twice its size.
fn sign_modulo<T: FromUnits + ExactRing>(e: &Vec3<i128>, normal: Vec3<T>, own: Option<Vec3<i128>>) -> Sign {
    let e = e.map(|&c| T::from_small(c));
    let along = e.dot(&normal);
    let Some(d) = own.map(|own| own.map(|&c| T::from_small(c))) else { return along.sign() };
    d.norm_squared().times(&along).minus(&d.dot(&normal).times(&d.dot(&e))).sign()
}
