//! Names and options that several functions take.

use crate::InputError;
use pyo3::prelude::*;
use rockproof_model::text::{cut_in_the_middle, excerpt};
use rockproof_model::{LoadOptions, Precision};

/// Who classifies, or makes steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arithmetic {
    /// The oracle.
    Exact,
    /// The stepper in this precision.
    Float(Precision),
}

impl Arithmetic {
    /// The arithmetic of a name: `exact`, `f64` or `f32`; the stepper's names in tables as well.
    ///
    /// # Errors
    /// `InputError` for another name.
    pub(crate) fn named(name: &str, what: &str) -> PyResult<Arithmetic> {
        if name == "exact" {
            return Ok(Arithmetic::Exact);
        }
        match name.strip_prefix("stepper-").unwrap_or(name) {
            "f64" => Ok(Arithmetic::Float(Precision::F64)),
            "f32" => Ok(Arithmetic::Float(Precision::F32)),
            _ => Err(InputError::new_err(format!("{what} is \"{name}\"; allowed are \"exact\", \"f64\" and \"f32\""))),
        }
    }

    /// The precision that tolerances are derived for.
    pub(crate) fn precision(self) -> Precision {
        match self {
            Arithmetic::Exact => Precision::F64,
            Arithmetic::Float(precision) => precision,
        }
    }
}

/// `f32` or `f64`.
///
/// # Errors
/// `InputError` for another name.
pub(crate) fn precision(name: &str) -> PyResult<Precision> {
    match name {
        "f64" => Ok(Precision::F64),
        "f32" => Ok(Precision::F32),
        _ => Err(InputError::new_err(format!("precision is \"{name}\"; allowed are \"f64\" and \"f32\""))),
    }
}

/// How a file is read: how far faces may be from planar, how near vertices become one, and what lengths are multiplied by.
///
/// # Errors
/// `InputError` where one is no number of 0 or more, or the last not above 0.
pub(crate) fn load_options(
    planarity: Option<&Bound<'_, PyAny>>,
    weld: Option<&Bound<'_, PyAny>>,
    scale: Option<&Bound<'_, PyAny>>,
) -> PyResult<LoadOptions> {
    let at_least_zero = |value: Option<&Bound<'_, PyAny>>, name: &str, what: &str| {
        let number = value.map(|value| crate::number::number(value, || name.to_owned())).transpose()?;
        match number.as_ref().is_some_and(|number| number.is_negative()) {
            true => Err(InputError::new_err(format!("{name} is negative; allowed is 0 or more, {what}"))),
            false => Ok(number),
        }
    };
    let scale = scale.map(|scale| crate::number::number(scale, || "scale".to_owned())).transpose()?;
    if scale.as_ref().is_some_and(|scale| scale.is_negative() || scale.is_zero()) {
        return Err(InputError::new_err("scale is not above 0; \"1/1000\" is for a file in millimetres"));
    }
    Ok(LoadOptions {
        planarity: at_least_zero(planarity, "planarity", "a share of the block's size")?,
        weld: at_least_zero(weld, "weld", "a distance in the file's unit of length")?,
        scale,
    })
}

/// An error of the crates below, as Python sees it: long values cut, nothing in it a command to a terminal.
pub(crate) fn input_error(error: impl std::fmt::Display) -> PyErr {
    let lines: Vec<String> = error.to_string().split('\n').map(|line| excerpt(line, usize::MAX)).collect();
    InputError::new_err(cut_in_the_middle(&lines.join("\n")))
}
