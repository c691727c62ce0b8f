//! How two blocks lie to one another, exactly.

use crate::InputError;
use crate::block::PyBlock;
use crate::number::{exact_root, fractions};
use num_rational::BigRational;
use num_traits::Zero;
use pyo3::prelude::*;
use rockproof_differential::collision::separation::Separation;
use rockproof_differential::separation_state::SeparationState;
use rockproof_model::{Number, Vec3};
use rockproof_oracle::penetration::{self as depth, Penetration};

/// How two convex blocks lie to one another.
#[pyclass(frozen, name = "Separation", module = "rockproof")]
pub(crate) struct PySeparation(Separation);

#[pymethods]
impl PySeparation {
    /// "apart", "touching" or "overlapping".
    #[getter]
    fn state(&self) -> &'static str {
        self.0.state.name()
    }

    /// The distance in metres, or minus the depth, to the nearest float.
    #[getter]
    fn gap_m(&self) -> f64 {
        self.0.gap_m()
    }

    /// The distance in metres, or minus the depth, as a Fraction; None where it is irrational.
    #[getter]
    fn gap(&self) -> Option<BigRational> {
        let size = exact_root(&self.0.squared)?;
        Some(if self.0.state == SeparationState::Overlapping { -size } else { size })
    }

    /// The square of the distance or depth in m², exactly.
    #[getter]
    fn gap_squared(&self) -> BigRational {
        self.0.squared.clone()
    }

    fn __repr__(&self) -> String {
        format!("<Separation: {}, {:?} m>", self.0.state, self.0.gap_m())
    }
}

/// How two convex blocks lie to one another, exactly: apart, touching or overlapping, with the distance, or the length of the shortest translation
/// that parts them.
///
/// Raises InputError where a block is concave, or has more vertices than this is worked out for.
#[pyfunction]
pub(crate) fn separation(py: Python<'_>, a: &PyBlock, b: &PyBlock) -> PyResult<PySeparation> {
    for (name, block) in [("a", &a.0), ("b", &b.0)] {
        if !block.is_convex() {
            return Err(InputError::new_err(format!(
                "block {name} is concave; the separation is worked out for convex blocks, the penetration for all"
            )));
        }
    }
    py.detach(|| Separation::of(&a.0, &b.0)).map(PySeparation).ok_or_else(|| {
        let count = |block: &PyBlock| block.0.vertices().len();
        InputError::new_err(format!(
            "the separation of blocks of {} and {} vertices is not worked out; allowed are 48, and points that do not lie in one plane",
            count(a),
            count(b)
        ))
    })
}

/// How deep two blocks overlap.
#[pyclass(frozen, name = "Penetration", module = "rockproof")]
pub(crate) struct PyPenetration(Penetration);

#[pymethods]
impl PyPenetration {
    /// Whether the blocks overlap.
    #[getter]
    fn overlaps(&self) -> bool {
        self.0.gap.sign.is_negative()
    }

    /// The depth in metres to the nearest float; 0.0 where the blocks do not overlap.
    #[getter]
    fn depth_m(&self) -> f64 {
        self.0.depth_m().unwrap_or(f64::INFINITY)
    }

    /// The depth in metres as a Fraction; None where it is irrational.
    #[getter]
    fn depth(&self) -> Option<BigRational> {
        exact_root(&self.depth_squared())
    }

    /// The square of the depth in m², exactly.
    #[getter]
    fn depth_squared(&self) -> BigRational {
        if self.overlaps() { self.0.gap.squared.clone() } else { BigRational::zero() }
    }

    /// The direction in which A moves to get free, not of unit length.
    #[getter]
    fn direction(&self) -> (BigRational, BigRational, BigRational) {
        triple(&self.0.direction)
    }

    fn __repr__(&self) -> String {
        format!("<Penetration: {:?} m>", self.depth_m())
    }
}

/// A direction as fractions.
pub(crate) fn triple(direction: &Vec3<BigRational>) -> (BigRational, BigRational, BigRational) {
    fractions(&direction.map(|c| Number::from_rational(c.clone())))
}

/// How deep two blocks overlap, exactly. Of two convex blocks the length of the shortest translation that parts them; of others the distance
/// from the other's surface of the deepest vertex, or of the deepest middle of an edge within the other.
///
/// Raises InputError where a block has no face with an area.
#[pyfunction]
pub(crate) fn penetration(py: Python<'_>, a: &PyBlock, b: &PyBlock) -> PyResult<PyPenetration> {
    py.detach(|| depth::penetration(&a.0, &b.0))
        .map(PyPenetration)
        .ok_or_else(|| InputError::new_err("a block has no face with an area, so there is no depth"))
}
