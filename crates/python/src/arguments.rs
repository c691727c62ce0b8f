//! Names and options that several functions take.

use crate::InputError;
use crate::number::kind;
use num_bigint::BigInt;
use pyo3::prelude::*;
use rockproof_model::text::{cut_in_the_middle, excerpt};
use rockproof_model::{LoadOptions, Precision};
use std::ops::RangeInclusive;

/// The most worker threads; more of them than cores gain nothing.
const MAX_THREADS: u64 = 1024;

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
        _ => Err(no_precision(&format!("\"{name}\""))),
    }
}

/// What is said of a precision that is none.
pub(crate) fn no_precision(found: &str) -> PyErr {
    InputError::new_err(format!("precision is {found}; allowed are \"f64\" and \"f32\""))
}

/// A whole number of a range, of any type that Python counts with; `name` is that of the argument, and `allowed` what messages say of the range.
///
/// # Errors
/// `InputError` where it is none, or outside.
pub(crate) fn whole_number(
    value: &Bound<'_, PyAny>,
    name: &str,
    range: RangeInclusive<u64>,
    allowed: &str,
) -> PyResult<u64> {
    let number = value.extract::<BigInt>().ok().and_then(|number| u64::try_from(number).ok());
    number
        .filter(|number| range.contains(number))
        .ok_or_else(|| InputError::new_err(format!("{name} is {}; allowed are {allowed}", shown(value))))
}

/// A number of worker threads; 0 for one a core.
///
/// # Errors
/// As [`whole_number`].
pub(crate) fn threads(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    let allowed = format!("1 to {MAX_THREADS}, and 0 for one a core");
    Ok(whole_number(value, "threads", 0..=MAX_THREADS, &allowed)? as usize)
}

/// A value as Python writes it, for messages. Python writes no integer of thousands of digits.
pub(crate) fn shown(value: &Bound<'_, PyAny>) -> String {
    match value.repr() {
        Ok(text) => excerpt(&text.to_string_lossy(), MAX_SHOWN),
        Err(_) => format!("a value {} that is too long to show", kind(value)),
    }
}

/// Characters of a value that are shown.
const MAX_SHOWN: usize = 60;

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
