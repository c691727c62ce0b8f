//! What would satisfy a rule, in decimals on the safe side of its bound.

use crate::number::Number;
use num_rational::BigRational;

/// What a tolerance would have to be.
pub(super) enum RequiredValue {
    OrMore(BigRational),
    OrLess(BigRational),
    /// The square root or more.
    RootOrMore(BigRational),
    /// The square root or less.
    RootOrLess(BigRational),
}

impl RequiredValue {
    /// Six digits on the safe side of the bound.
    pub(super) fn text(&self, name: &str) -> String {
        let near = |value: &BigRational| Number::from_rational(value.clone()).approximate();
        match self {
            RequiredValue::OrMore(value) => {
                format!("{name} ≥ {}", six_digits(near(value), true, has_six_digits(value)))
            }
            RequiredValue::RootOrMore(value) => format!("{name} ≥ {}", six_digits(near(value).sqrt(), true, false)),
            RequiredValue::OrLess(value) => {
                format!("{name} ≤ {}", six_digits(near(value), false, has_six_digits(value)))
            }
            RequiredValue::RootOrLess(value) => format!("{name} ≤ {}", six_digits(near(value).sqrt(), false, false)),
        }
    }
}

/// Whether a bound is what its six digits say, read as the decimals that they are.
fn has_six_digits(value: &BigRational) -> bool {
    let text = format!("{:.5e}", Number::from_rational(value.clone()).approximate());
    Number::parse(&text).is_ok_and(|decimals| decimals.to_rational() == *value)
}

/// What is said in place of a number that f64 does not hold.
pub const BEYOND_F64: &str = "(beyond f64)";

/// The nearest number of six digits that is above `value` (`up`) or below it; `value` itself when that is the bound,
/// not a rounding of it.
pub(super) fn six_digits(value: f64, up: bool, is_bound: bool) -> String {
    if !value.is_finite() {
        return BEYOND_F64.to_owned();
    }
    let text = format!("{value:.5e}");
    let near: f64 = text.parse().unwrap_or(value);
    if near == value && (is_bound || value == 0.0) || (if up { near > value } else { near < value }) {
        return plain(near);
    }
    let exponent: i32 = text.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let unit: f64 = format!("1e{}", exponent - 5).parse().unwrap_or(0.0);
    let moved = if up { near + unit } else { near - unit };
    plain(format!("{moved:.5e}").parse().unwrap_or(moved))
}

fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) { format!("{value:e}") } else { value.to_string() }
}
