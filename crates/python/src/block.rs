//! Blocks.

use crate::InputError;
use crate::arguments::{input_error, load_options, precision};
use crate::number::{fractions, kind, near, plain, point};
use num_rational::BigRational;
use pyo3::prelude::*;
use rockproof_differential::hull::convex_hull;
use rockproof_model::{Block, BlockOptions, Point};

/// A closed polyhedron with exact vertices in metres.
///
/// `vertices` is a NumPy array of shape (n, 3) or a sequence of triples. A float counts as exactly the binary number it is; an int, a
/// `fractions.Fraction`, a `decimal.Decimal` and a text such as "0.1" or "1/3" count as exactly that number. `faces` are loops of vertex numbers from 0,
/// counter-clockwise seen from outside. `planarity` is how far a face may be from planar, as a share of the block's size; 1e-9 if it is not given.
///
/// Coplanar neighbouring faces become one, and vertices in line between two edges are dropped; `vertices` and `faces` tell what is left.
///
/// Raises InputError where they are no block, naming the vertex or face.
#[pyclass(frozen, name = "Block", module = "rockproof", eq, from_py_object)]
#[derive(Clone, PartialEq)]
pub(crate) struct PyBlock(pub(crate) Block);

/// Exact coordinates in metres.
type Fractions = (BigRational, BigRational, BigRational);

#[pymethods]
impl PyBlock {
    #[new]
    #[pyo3(signature = (vertices, faces, *, planarity=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        planarity: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyBlock> {
        let vertices = points(vertices)?;
        let faces = loops(faces)?;
        let options = load_options(planarity, None, None)?
            .planarity
            .map_or_else(BlockOptions::default, |planarity| BlockOptions { planarity });
        Ok(PyBlock(Block::new(vertices, faces, &options).map_err(input_error)?))
    }

    /// The box with edges along the axes between two corners, in metres.
    #[staticmethod]
    fn cuboid(min: &Bound<'_, PyAny>, max: &Bound<'_, PyAny>) -> PyResult<PyBlock> {
        let (min, max) = (point(min, || "min".to_owned())?, point(max, || "max".to_owned())?);
        Ok(PyBlock(Block::cuboid(&min, &max).map_err(input_error)?))
    }

    /// The convex hull of some points, in metres. Points inside it, inside a face or inside an edge are dropped.
    #[staticmethod]
    fn hull(py: Python<'_>, vertices: &Bound<'_, PyAny>) -> PyResult<PyBlock> {
        let vertices = points(vertices)?;
        Ok(PyBlock(py.detach(|| convex_hull(&vertices)).map_err(input_error)?))
    }

    /// The vertices in metres, to the nearest float.
    #[getter]
    fn vertices(&self) -> Vec<(f64, f64, f64)> {
        self.0.vertices().iter().map(near).collect()
    }

    /// The vertices in metres, exactly: triples of Fraction.
    #[getter]
    fn exact_vertices(&self) -> Vec<Fractions> {
        self.0.vertices().iter().map(fractions).collect()
    }

    /// The edges, each by its two vertices. A contact names an edge by its place in this list.
    #[getter]
    fn edges(&self) -> Vec<(u32, u32)> {
        self.0.topology().edges().iter().map(|edge| (edge.p.0, edge.q.0)).collect()
    }

    /// The faces: loops of vertex numbers, counter-clockwise seen from outside.
    #[getter]
    fn faces(&self) -> Vec<Vec<u32>> {
        self.0.topology().faces().iter().map(|face| face.iter().map(|vertex| vertex.0).collect()).collect()
    }

    /// Whether all edges are convex.
    #[getter]
    fn is_convex(&self) -> bool {
        self.0.is_convex()
    }

    /// The volume in m³, exactly.
    #[getter]
    fn volume(&self) -> BigRational {
        self.0.volume()
    }

    /// The two corners of its box, in metres, exactly.
    #[getter]
    fn bounds(&self) -> (Fractions, Fractions) {
        let bounds = self.0.bounds();
        let [min, max] = [bounds.min, bounds.max].map(|end| end.map(|c| (*c).clone()));
        (fractions(&min), fractions(&max))
    }

    /// The block moved by an offset in metres, exactly.
    fn translated(&self, offset: &Bound<'_, PyAny>) -> PyResult<PyBlock> {
        Ok(PyBlock(self.0.translated(&point(offset, || "offset".to_owned())?)))
    }

    /// The block as a program in "f64" or "f32" sees it: every coordinate rounded to the nearest number of that precision.
    #[pyo3(signature = (precision="f64"))]
    fn rounded(&self, precision: &str) -> PyResult<PyBlock> {
        let precision = self::precision(precision)?;
        let rounded = self.0.rounded(precision);
        rounded
            .map(PyBlock)
            .ok_or_else(|| InputError::new_err(format!("a coordinate overflows when rounded to {precision}")))
    }

    /// Whether "f64" or "f32" represents every coordinate exactly.
    #[pyo3(signature = (precision="f64"))]
    fn is_exact_in(&self, precision: &str) -> PyResult<bool> {
        Ok(self.0.is_exact_in(self::precision(precision)?))
    }

    fn __repr__(&self) -> String {
        let topology = self.0.topology();
        let (vertices, faces) = (self.0.vertices().len(), topology.faces().len());
        let shape = if self.0.is_convex() { "convex" } else { "concave" };
        format!("<Block: {vertices} vertices, {} edges, {faces} faces, {shape}>", topology.edges().len())
    }
}

/// Points in metres from a NumPy array or a sequence.
fn points(vertices: &Bound<'_, PyAny>) -> PyResult<Vec<Point>> {
    let vertices = plain(vertices)?;
    let rows = vertices
        .try_iter()
        .map_err(|_| InputError::new_err(format!("vertices are {}; expected a sequence of points", kind(&vertices))))?;
    rows.enumerate().map(|(number, row)| point(&row?, || format!("vertex {number}"))).collect()
}

/// Loops of vertex numbers.
fn loops(faces: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<u32>>> {
    let faces = plain(faces)?;
    let rows = faces
        .try_iter()
        .map_err(|_| InputError::new_err(format!("faces are {}; expected a sequence of loops", kind(&faces))))?;
    let face = |(number, row): (usize, PyResult<Bound<'_, PyAny>>)| {
        let row = plain(&row?)?;
        let numbers: PyResult<Vec<u32>> = row.try_iter().and_then(|all| all.map(|v| v?.extract::<u32>()).collect());
        numbers.map_err(|error| {
            InputError::new_err(format!("face {number}: expected a loop of vertex numbers from 0 ({error})"))
        })
    };
    rows.enumerate().map(face).collect()
}
