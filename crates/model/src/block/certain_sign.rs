//! Signs of polynomials in the coordinates of one block, decided for certain: by floating point where a bound on its
//! error allows, by integers on the block's lattice otherwise.

use crate::block::{Point, face_normal};
use crate::lattice::Lattice;
use crate::number::{Number, power_of_two};
use crate::ring::{ExactRing, Ring};
use crate::sign::Sign;
use crate::topology::VertexId;
use crate::vector::Vec3;
use num_bigint::BigInt;
use std::cell::OnceCell;

/// A polynomial in the coordinates of a block, written once for every number type.
pub(super) trait BlockPolynomial {
    /// The value; its degree in the coordinates is at most 6.
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T;
}

/// A polynomial in the coordinates of a few vertices alone, written once for every number type.
pub(super) trait PointPolynomial {
    /// The value; its degree in the coordinates is at most 6.
    fn value<T: Ring>(&self, points: &[Vec3<T>]) -> T;
}

/// What a question may look at. Points are relative to the block's first vertex.
pub(super) struct CoordinateView<'a, T> {
    /// The vertices.
    pub(super) points: &'a [Vec3<T>],
    /// `N` of every face.
    pub(super) normals: &'a [Vec3<T>],
    /// The face loops.
    pub(super) faces: &'a [Vec<VertexId>],
}

/// An f64 with the sum of the magnitudes of the terms it was made from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Filtered {
    value: f64,
    magnitude: f64,
}

/// Loops up to this length, and this many faces, keep the roundings on the way to any term of any question below 500.
const LONGEST_FILTERED_LOOP: usize = 128;
const MAX_FILTERED_FACES: usize = 256;

impl Filtered {
    /// With at most 500 roundings of 2^−53 on the way to any term, the error is below 512 · 2^−53 of the magnitude;
    /// the rest covers the rounding of the magnitude itself.
    const ERROR: f64 = 1.0 / (1u64 << 44) as f64;

    /// The sign of the exact value, where the error bound allows to tell.
    pub(super) fn sign(&self) -> Option<Sign> {
        if self.magnitude == 0.0 {
            Some(Sign::Zero)
        } else if self.value > self.error() {
            Some(Sign::Positive)
        } else if self.value < -self.error() {
            Some(Sign::Negative)
        } else {
            None
        }
    }

    /// How far the exact value may be from the value seen.
    pub(super) fn error(&self) -> f64 {
        self.magnitude * Self::ERROR
    }

    /// A bound that the true magnitude does not exceed.
    pub(super) fn at_most(&self) -> f64 {
        self.value.abs() + self.error()
    }

    /// A bound that the true magnitude does not fall below.
    pub(super) fn at_least(&self) -> f64 {
        (self.value.abs() - self.error()).max(0.0)
    }

    /// The nearest value seen.
    pub(super) fn value(&self) -> f64 {
        self.value
    }
}

impl Ring for Filtered {
    #[inline]
    fn from_i32(value: i32) -> Self {
        Filtered { value: f64::from(value), magnitude: f64::from(value).abs() }
    }
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Filtered { value: self.value + other.value, magnitude: self.magnitude + other.magnitude }
    }
    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Filtered { value: self.value - other.value, magnitude: self.magnitude + other.magnitude }
    }
    #[inline]
    fn times(&self, other: &Self) -> Self {
        Filtered { value: self.value * other.value, magnitude: self.magnitude * other.magnitude }
    }
    #[inline]
    fn negated(&self) -> Self {
        Filtered { value: -self.value, magnitude: self.magnitude }
    }
}

/// The vertices of a block, relative to the first one.
pub(super) struct Coordinates<'a> {
    source: &'a [Point],
    filtered: Option<Vec<Vec3<Filtered>>>,
    lattice: OnceCell<Lattice>,
    small: OnceCell<Option<Vec<Vec3<i128>>>>,
    large: OnceCell<Vec<Vec3<BigInt>>>,
}

impl<'a> Coordinates<'a> {
    pub(super) fn new(source: &'a [Point], approximate: &[[f64; 3]]) -> Coordinates<'a> {
        Coordinates {
            source,
            filtered: filtered(source, approximate),
            lattice: OnceCell::new(),
            small: OnceCell::new(),
            large: OnceCell::new(),
        }
    }

    /// The filtered vertices, where the coordinates are in the filter's range.
    pub(super) fn filtered(&self) -> Option<&[Vec3<Filtered>]> {
        self.filtered.as_deref()
    }

    /// The sign of the value where floating point can tell it for certain, or where only integers can.
    pub(super) fn cheap_sign(&self, question: &impl PointPolynomial) -> Option<Sign> {
        match self.filtered() {
            Some(points) => question.value(points).sign(),
            None => Some(self.exact_sign(question)),
        }
    }

    /// The sign of the value, for certain.
    pub(super) fn sign(&self, question: &impl PointPolynomial) -> Sign {
        let estimate = self.filtered().map(|points| question.value(points));
        estimate.and_then(|estimate| estimate.sign()).unwrap_or_else(|| self.exact_sign(question))
    }

    fn exact_sign(&self, question: &impl PointPolynomial) -> Sign {
        match self.small_units() {
            Some(points) => question.value(points).sign(),
            None => ExactRing::sign(&question.value(self.units())),
        }
    }

    /// The lattice of exact values.
    pub(super) fn lattice(&self) -> &Lattice {
        self.lattice.get_or_init(|| Lattice::covering(self.source.iter().flat_map(|v| v.components())))
    }

    /// The vertices in lattice units.
    pub(super) fn units(&self) -> &[Vec3<BigInt>] {
        self.large.get_or_init(|| {
            let points: Vec<Vec3<BigInt>> = self.source.iter().map(|v| v.map(|c| self.lattice().units(c))).collect();
            points.iter().map(|p| p.minus(&points[0])).collect()
        })
    }

    fn small_units(&self) -> Option<&[Vec3<i128>]> {
        let units = |v: &Point| {
            let [x, y, z] = v.components().map(|c| self.lattice().small_units(c, 120));
            Some(Vec3::new(x?, y?, z?))
        };
        let compute = || {
            let origin = units(self.source.first()?)?;
            let relative = |v: &Point| {
                let relative = units(v)?.minus(&origin);
                relative.components().iter().all(|c| c.unsigned_abs() < 1 << SMALL_BITS).then_some(relative)
            };
            self.source.iter().map(relative).collect()
        };
        self.small.get_or_init(compute).as_deref()
    }
}

fn filtered(source: &[Point], approximate: &[[f64; 3]]) -> Option<Vec<Vec3<Filtered>>> {
    // Within these bounds nothing underflows or overflows: differences of two coordinates are multiples of 2^−152, so
    // products of six of them are at least 2^−912.
    let (least, most) = (power_of_two(-100), power_of_two(100));
    let usable = |exact: &Number, near: f64| (near == 0.0 && exact.is_zero()) || (least..=most).contains(&near.abs());
    for (vertex, near) in source.iter().zip(approximate) {
        if !vertex.components().iter().zip(near).all(|(exact, &near)| usable(exact, near)) {
            return None;
        }
    }
    let origin = approximate.first()?;
    let is_exact: [bool; 3] = std::array::from_fn(|axis| source[0].components()[axis].as_f64().is_some());
    let difference = |vertex: usize, axis: usize| {
        let (a, b) = (approximate[vertex][axis], origin[axis]);
        let value = a - b;
        let rounded_once = is_exact[axis] && source[vertex].components()[axis].as_f64().is_some();
        Filtered { value, magnitude: if rounded_once { value.abs() } else { a.abs() + b.abs() } }
    };
    Some((0..source.len()).map(|v| Vec3::new(difference(v, 0), difference(v, 1), difference(v, 2))).collect())
}

/// Bits of a coordinate, and vertices of a loop, with which no question leaves i128: `N` has 2·17 + 1 + 4 bits, and
/// the largest question multiplies two vectors `u × N` of 17 + 39 + 1 bits.
const SMALL_BITS: u32 = 16;
const LONGEST_SMALL_LOOP: usize = 16;

/// A set of face loops over some coordinates, to be asked about.
pub(super) struct Surface<'a> {
    coordinates: &'a Coordinates<'a>,
    faces: &'a [Vec<VertexId>],
    filtered: Option<Vec<Vec3<Filtered>>>,
    exact: OnceCell<ExactCoordinates<'a>>,
}

/// Points and normals in lattice units.
enum ExactCoordinates<'a> {
    Small(&'a [Vec3<i128>], Vec<Vec3<i128>>),
    Large(&'a [Vec3<BigInt>], Vec<Vec3<BigInt>>),
}

impl<'a> Surface<'a> {
    pub(super) fn new(coordinates: &'a Coordinates<'a>, faces: &'a [Vec<VertexId>]) -> Surface<'a> {
        let short = faces.len() <= MAX_FILTERED_FACES && faces.iter().all(|f| f.len() <= LONGEST_FILTERED_LOOP);
        let filtered = coordinates.filtered().filter(|_| short).map(|points| normals(points, faces));
        Surface { coordinates, faces, filtered, exact: OnceCell::new() }
    }

    pub(super) fn faces(&self) -> &'a [Vec<VertexId>] {
        self.faces
    }

    pub(super) fn coordinates(&self) -> &'a Coordinates<'a> {
        self.coordinates
    }

    /// The value in floating point, with its error bound.
    pub(super) fn estimate(&self, question: &impl BlockPolynomial) -> Option<Filtered> {
        let points = self.coordinates.filtered()?;
        let normals = self.filtered.as_ref()?;
        Some(question.value(&CoordinateView { points, normals, faces: self.faces }))
    }

    /// The sign of the value, for certain.
    pub(super) fn sign(&self, question: &impl BlockPolynomial) -> Sign {
        if let Some(sign) = self.estimate(question).and_then(|estimate| estimate.sign()) {
            return sign;
        }
        match self.exact() {
            ExactCoordinates::Small(points, normals) => {
                question.value(&CoordinateView { points, normals, faces: self.faces }).sign()
            }
            ExactCoordinates::Large(points, normals) => {
                ExactRing::sign(&question.value(&CoordinateView { points, normals, faces: self.faces }))
            }
        }
    }

    /// The value in units of the block's lattice.
    pub(super) fn exact_value(&self, question: &impl BlockPolynomial) -> BigInt {
        match self.exact() {
            ExactCoordinates::Small(points, normals) => {
                question.value(&CoordinateView { points, normals, faces: self.faces }).into()
            }
            ExactCoordinates::Large(points, normals) => {
                question.value(&CoordinateView { points, normals, faces: self.faces })
            }
        }
    }

    fn exact(&self) -> &ExactCoordinates<'a> {
        self.exact.get_or_init(|| {
            let short = self.faces.iter().all(|f| f.len() <= LONGEST_SMALL_LOOP);
            match self.coordinates.small_units().filter(|_| short) {
                Some(points) => {
                    let normals = normals(points, self.faces);
                    ExactCoordinates::Small(points, normals)
                }
                None => {
                    let points = self.coordinates.units();
                    let normals = normals(points, self.faces);
                    ExactCoordinates::Large(points, normals)
                }
            }
        })
    }
}

fn normals<T: Ring>(points: &[Vec3<T>], faces: &[Vec<VertexId>]) -> Vec<Vec3<T>> {
    faces.iter().map(|f| face_normal(points, f)).collect()
}
