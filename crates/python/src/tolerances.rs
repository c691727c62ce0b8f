//! Tolerances: a preset and values, or a complete set.

use crate::InputError;
use crate::arguments::{input_error, precision};
use crate::block::PyBlock;
use crate::number::number;
use num_rational::BigRational;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use rockproof_model::{Block, Precision, Preset, ToleranceSet, ToleranceSpec};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Tolerances of contact classification: a preset, and values that replace some of its own.
///
/// The preset is "auto" (meets every rule), "shi" (customary shares of the model's height) or "zero" (auto without angles and territory). Values by name:
/// search, territory, penetration, open, close, max_displacement in metres; overlap_angle, parallel_angle in degrees, or overlap_sine, parallel_sine;
/// max_rotation in radians; equal; criteria ("revised" or "classic"). Numbers are taken exactly, as vertices of a Block are.
///
/// A preset's numbers depend on the blocks: `derive` tells them.
#[pyclass(frozen, module = "rockproof", eq, from_py_object)]
#[derive(Clone, PartialEq)]
pub(crate) struct Tolerances(pub(crate) ToleranceSpec);

#[pymethods]
impl Tolerances {
    #[new]
    #[pyo3(signature = (preset=Some("auto"), **values))]
    fn new(preset: Option<&str>, values: Option<&Bound<'_, PyDict>>) -> PyResult<Tolerances> {
        let mut spec = ToleranceSpec::empty();
        if let Some(preset) = preset {
            spec.set_text("preset", preset).map_err(input_error)?;
        }
        if let Some(values) = values {
            set_all(&mut spec, values)?;
        }
        Ok(Tolerances(spec))
    }

    /// Reads tolerances from a TOML file: a table [tolerances], or the bare values.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Tolerances> {
        Ok(Tolerances(py.detach(|| ToleranceSpec::load(path)).map_err(input_error)?))
    }

    /// The name of the preset, or None.
    #[getter]
    fn preset(&self) -> Option<&'static str> {
        self.0.preset().map(Preset::name)
    }

    /// The criteria given, "revised" or "classic"; None where the preset's apply.
    #[getter]
    fn criteria(&self) -> Option<&'static str> {
        self.0.criteria().map(|criteria| criteria.name())
    }

    /// The values given, by name, exactly (angles as sines).
    #[getter]
    fn values(&self) -> BTreeMap<&'static str, BigRational> {
        self.0.numbers().iter().map(|(name, number)| (*name, number.to_rational())).collect()
    }

    /// The complete set for some blocks in "f64" or "f32": every value is then given.
    #[pyo3(signature = (blocks, precision="f64"))]
    fn derive(&self, blocks: Vec<PyBlock>, precision: &str) -> PyResult<Tolerances> {
        let precision = self::precision(precision)?;
        let blocks: Vec<&Block> = blocks.iter().map(|block| &block.0).collect();
        Ok(Tolerances(self.0.derive(&blocks, precision).map_err(input_error)?.into()))
    }

    /// A value that is given, exactly.
    fn __getitem__(&self, name: &str) -> PyResult<BigRational> {
        let found = self.0.numbers().iter().find(|(known, _)| *known == name);
        found.map(|(_, number)| number.to_rational()).ok_or_else(|| PyKeyError::new_err(name.to_owned()))
    }

    fn __repr__(&self) -> String {
        let preset = self.0.preset().map(|preset| format!("\"{}\"", preset.name()));
        let values = self.0.numbers().iter().map(|(name, number)| format!("{name}={:e}", number.approximate()));
        let criteria = self.0.criteria().map(|criteria| format!("criteria=\"{}\"", criteria.name()));
        let all: Vec<String> =
            std::iter::once(preset.unwrap_or_else(|| "None".to_owned())).chain(values).chain(criteria).collect();
        format!("Tolerances({})", all.join(", "))
    }
}

fn set_all(spec: &mut ToleranceSpec, values: &Bound<'_, PyDict>) -> PyResult<()> {
    for (name, value) in values {
        let name: String = name.extract().map_err(|_| InputError::new_err("names of tolerances are texts"))?;
        if let Ok(text) = value.cast::<PyString>() {
            spec.set_text(&name, &text.to_cow()?).map_err(input_error)?;
        } else {
            spec.set_number(&name, number(&value, || format!("tolerance `{name}`"))?).map_err(input_error)?;
        }
    }
    Ok(())
}

/// What an argument `tolerances` means: `None` what `otherwise` says, or `auto`; a text the preset of that name; a dict values over `auto`.
///
/// # Errors
/// `InputError` where it means nothing.
pub(crate) fn spec_of(
    tolerances: Option<&Bound<'_, PyAny>>,
    otherwise: Option<&ToleranceSpec>,
) -> PyResult<ToleranceSpec> {
    let Some(tolerances) = tolerances else { return Ok(otherwise.cloned().unwrap_or_default()) };
    if let Ok(given) = tolerances.cast::<Tolerances>() {
        return Ok(given.get().0.clone());
    }
    let mut spec = ToleranceSpec::default();
    if let Ok(preset) = tolerances.cast::<PyString>() {
        spec.set_text("preset", &preset.to_cow()?).map_err(input_error)?;
    } else if let Ok(values) = tolerances.cast::<PyDict>() {
        set_all(&mut spec, values)?;
    } else {
        let found = crate::number::kind(tolerances);
        return Err(InputError::new_err(format!(
            "tolerances are {found}; allowed are Tolerances, a preset's name, and a dict of values"
        )));
    }
    Ok(spec)
}

/// The set that a spec means for blocks, which a precision can hold.
///
/// # Errors
/// `InputError` where it cannot be derived, or a value overflows.
pub(crate) fn set_for(spec: &ToleranceSpec, blocks: &[&Block], precision: Precision) -> PyResult<ToleranceSet> {
    let set = spec.derive(blocks, precision).map_err(input_error)?;
    match set.rounded(precision) {
        Ok(_) => Ok(set),
        Err(name) => Err(InputError::new_err(format!("tolerance `{name}` overflows when rounded to {precision}"))),
    }
}
