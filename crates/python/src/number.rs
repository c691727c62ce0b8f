//! Numbers between Python and the exact ones of the model.

use crate::InputError;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyString};
use rockproof_model::number_text::DIGIT_LIMIT;
use rockproof_model::{Number, Vec3};

/// Bits of a numerator or denominator of [`DIGIT_LIMIT`] decimal digits.
const MAX_BITS: u64 = DIGIT_LIMIT as u64 * 3322 / 1000;

/// The exact value of a Python number: float (also NumPy's, of any width), int, `Fraction`, `Decimal`, or a text such as `"0.1"` and `"1/3"`.
/// `what` names it in messages.
///
/// # Errors
/// `InputError` where it is none.
pub(crate) fn number(value: &Bound<'_, PyAny>, what: impl Fn() -> String) -> PyResult<Number> {
    let refuse = |why: String| InputError::new_err(format!("{}: {why}", what()));
    if let Ok(float) = value.cast::<PyFloat>() {
        return Number::from_f64(float.extract()?).map_err(|error| refuse(error.to_string()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Number::parse(&text.to_cow()?).map_err(|error| refuse(error.to_string()));
    }
    let no_number = || {
        let name = value.get_type().name().map_or_else(|_| "an object".to_owned(), |name| name.to_string());
        refuse(format!(
            "{name} is no number; allowed are float, int, Fraction, Decimal and text such as \"0.1\" or \"1/3\""
        ))
    };
    if value.is_instance_of::<PyBool>() {
        return Err(no_number());
    }
    // Of a Decimal its text, for a fraction of 1e999999 would fill the memory.
    if value.hasattr("as_tuple")? {
        return Number::parse(&value.str()?.to_cow()?).map_err(|error| refuse(error.to_string()));
    }
    let parts = if value.hasattr("numerator")? && value.hasattr("denominator")? {
        Some((value.getattr("numerator")?, value.getattr("denominator")?))
    } else if value.hasattr("as_integer_ratio")? {
        let ratio = value.call_method0("as_integer_ratio").map_err(|error| refuse(error.to_string()))?;
        Some(ratio.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>()?)
    } else {
        None
    };
    let (numerator, denominator) = parts.ok_or_else(no_number)?;
    let integer = |part: &Bound<'_, PyAny>| part.extract::<BigInt>().map_err(|_| no_number());
    let (numerator, denominator) = (integer(&numerator)?, integer(&denominator)?);
    if denominator.is_zero() {
        return Err(refuse("it divides by zero".to_owned()));
    }
    if numerator.bits().max(denominator.bits()) > MAX_BITS {
        return Err(refuse(format!("it has more than {DIGIT_LIMIT} digits")));
    }
    Ok(Number::from_rational(BigRational::new(numerator, denominator)))
}

/// Rows of a NumPy array or another sequence as Python's own lists and numbers, whose values are the same.
///
/// # Errors
/// What NumPy raises.
pub(crate) fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if value.hasattr("tolist")? { value.call_method0("tolist") } else { Ok(value.clone()) }
}

/// A point of three numbers in metres.
///
/// # Errors
/// `InputError` where it is none.
pub(crate) fn point(value: &Bound<'_, PyAny>, what: impl Fn() -> String) -> PyResult<Vec3<Number>> {
    let refuse =
        |found: String| InputError::new_err(format!("{} {found}; allowed are 3 coordinates in metres", what()));
    let value = plain(value)?;
    if value.is_instance_of::<PyString>() {
        return Err(refuse("is a text".to_owned()));
    }
    let all: Vec<Bound<'_, PyAny>> =
        value.try_iter().map_err(|_| refuse(format!("is {}", kind(&value))))?.collect::<PyResult<_>>()?;
    let [x, y, z] = all.as_slice() else {
        return Err(refuse(format!("has {} coordinates", all.len())));
    };
    let coordinate = |value, axis| number(value, || format!("{}, coordinate {axis}", what()));
    Ok(Vec3::new(coordinate(x, "x")?, coordinate(y, "y")?, coordinate(z, "z")?))
}

/// A Python object's type, for messages.
pub(crate) fn kind(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "an object".to_owned(), |name| format!("of type {name}"))
}

/// The coordinates nearest to a point's in f64.
pub(crate) fn near(point: &Vec3<Number>) -> (f64, f64, f64) {
    (point.x.approximate(), point.y.approximate(), point.z.approximate())
}

/// Coordinates as fractions.
pub(crate) fn fractions(point: &Vec3<Number>) -> (BigRational, BigRational, BigRational) {
    (point.x.to_rational(), point.y.to_rational(), point.z.to_rational())
}

/// The square root of a fraction that is not negative, where it is a fraction.
pub(crate) fn exact_root(square: &BigRational) -> Option<BigRational> {
    if square.is_negative() {
        return None;
    }
    let root = |n: &BigInt| Some(n.sqrt()).filter(|root| root * root == *n);
    Some(BigRational::new(root(square.numer())?, root(square.denom())?))
}
