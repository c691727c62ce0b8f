//! Tolerances as users ask for them: a preset, values over it, or both.

use crate::block::Block;
use crate::number::{Number, NumberError, Precision};
use crate::number_text::{decimal, shown};
use crate::preset::{self, Preset, PresetError, sine_of_degrees};
use crate::tolerance::{Criteria, ToleranceSet};

/// Names that may be set, as in SPEC section 3.
pub const NAMES: [&str; 14] = [
    "preset",
    "search",
    "territory",
    "penetration",
    "overlap_angle",
    "overlap_sine",
    "parallel_angle",
    "parallel_sine",
    "equal",
    "open",
    "close",
    "max_displacement",
    "max_rotation",
    "criteria",
];

/// A preset and the values that override it. [`ToleranceSpec::default`] is `auto` as it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ToleranceSpec {
    preset: Option<Preset>,
    numbers: Vec<(&'static str, Number)>,
    criteria: Option<Criteria>,
}

/// Why tolerances cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// A name that is none.
    #[error("unknown tolerance `{found}`; known are {}", NAMES.join(", "))]
    UnknownName {
        /// What was found.
        found: String,
    },
    /// Not of the form `NAME=VALUE`.
    #[error("\"{found}\" is not of the form NAME=VALUE")]
    NotAnAssignment {
        /// What was found.
        found: String,
    },
    /// A value that is no number.
    #[error("tolerance `{name}`: {error}")]
    Number {
        /// The tolerance.
        name: &'static str,
        /// Why the value is none.
        error: NumberError,
    },
    /// A value out of range.
    #[error("tolerance `{name}` is {found}; allowed is {allowed}")]
    NotAllowed {
        /// The tolerance.
        name: &'static str,
        /// The value.
        found: String,
        /// The range.
        allowed: &'static str,
    },
    /// An angle given twice.
    #[error("`{first}` and `{second}` are both given; one of them says the angle")]
    GivenTwice {
        /// One name.
        first: &'static str,
        /// The other name.
        second: &'static str,
    },
    /// Values missing, and no preset to take them from.
    #[error("no preset is named and there is no value of {}; name a preset (auto, shi, zero) or every tolerance", missing.join(", "))]
    Missing {
        /// The tolerances without a value.
        missing: Vec<&'static str>,
    },
    /// The preset cannot be derived.
    #[error(transparent)]
    Preset(#[from] PresetError),
}

impl Default for ToleranceSpec {
    fn default() -> ToleranceSpec {
        ToleranceSpec::from(Preset::Auto)
    }
}

impl From<Preset> for ToleranceSpec {
    fn from(preset: Preset) -> ToleranceSpec {
        ToleranceSpec { preset: Some(preset), ..ToleranceSpec::empty() }
    }
}

impl From<ToleranceSet> for ToleranceSpec {
    fn from(set: ToleranceSet) -> ToleranceSpec {
        ToleranceSpec {
            preset: None,
            numbers: set.numbers().map(|(name, number)| (name, number.clone())).into(),
            criteria: Some(set.criteria),
        }
    }
}

impl ToleranceSpec {
    /// Nothing: no preset and no value.
    pub fn empty() -> ToleranceSpec {
        ToleranceSpec { preset: None, numbers: Vec::new(), criteria: None }
    }

    /// The preset, if one is named.
    pub fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// The criteria, if they are given.
    pub fn criteria(&self) -> Option<Criteria> {
        self.criteria
    }

    /// The values given, by the names of [`ToleranceSet::numbers`].
    pub fn numbers(&self) -> &[(&'static str, Number)] {
        &self.numbers
    }

    /// Sets `NAME=VALUE`, as on the command line; the value is exact text (`0.1` is 1/10), and replaces an earlier one.
    ///
    /// # Errors
    /// When the name is unknown or the value not allowed.
    pub fn assign(&mut self, assignment: &str) -> Result<(), SpecError> {
        match assignment.split_once('=') {
            Some((name, value)) => self.set_text(name.trim(), value.trim()),
            None => Err(SpecError::NotAnAssignment { found: shown(assignment) }),
        }
    }

    /// Sets a tolerance to the value of a text: an exact number, the name of a preset or of criteria.
    ///
    /// # Errors
    /// When the name is unknown or the value not allowed.
    pub fn set_text(&mut self, name: &str, text: &str) -> Result<(), SpecError> {
        match known(name)? {
            "preset" => {
                self.preset = Some(Preset::from_name(text).ok_or_else(|| SpecError::NotAllowed {
                    name: "preset",
                    found: format!("\"{}\"", shown(text)),
                    allowed: "\"auto\", \"shi\" or \"zero\"",
                })?);
                Ok(())
            }
            "criteria" => {
                let all = [Criteria::Classic, Criteria::Revised];
                self.criteria =
                    Some(all.into_iter().find(|c| c.name() == text).ok_or_else(|| SpecError::NotAllowed {
                        name: "criteria",
                        found: format!("\"{}\"", shown(text)),
                        allowed: "\"classic\" or \"revised\"",
                    })?);
                Ok(())
            }
            name => {
                let number = Number::parse(text).map_err(|error| SpecError::Number { name, error })?;
                self.set_number(name, number)
            }
        }
    }

    /// Sets a tolerance to a number: metres, radians for `max_rotation`, degrees for `…_angle`.
    ///
    /// # Errors
    /// When the name is unknown or the value not allowed.
    pub fn set_number(&mut self, name: &str, number: Number) -> Result<(), SpecError> {
        let name = known(name)?;
        let refuse = |allowed| SpecError::NotAllowed { name, found: decimal(&number), allowed };
        let one = Number::from_integer(1);
        let overflow = NumberError::Overflow { found: shown(&number.to_string()), precision: Precision::F64 };
        if number.rounded(Precision::F64).is_none() {
            return Err(SpecError::Number { name, error: overflow });
        }
        let (field, number) = match name {
            "preset" => return Err(refuse("\"auto\", \"shi\" or \"zero\"")),
            "criteria" => return Err(refuse("\"classic\" or \"revised\"")),
            "overlap_angle" | "parallel_angle" => {
                if number.is_negative() || number > Number::from_integer(90) {
                    return Err(refuse("0 to 90 degrees"));
                }
                let sine = Number::from_f64(sine_of_degrees(number.approximate()));
                let field = if name == "overlap_angle" { "overlap_sine" } else { "parallel_sine" };
                (field, sine.map_err(|error| SpecError::Number { name, error })?)
            }
            "overlap_sine" | "parallel_sine" if number.is_negative() || number > one => {
                return Err(refuse("0 to 1"));
            }
            _ if number.is_negative() => return Err(refuse("0 or more")),
            _ => (name, number),
        };
        match self.numbers.iter_mut().find(|(n, _)| *n == field) {
            Some((_, value)) => *value = number,
            None => self.numbers.push((field, number)),
        }
        Ok(())
    }

    /// The set for these blocks in this precision. `auto` on its own must meet the rules; once a value overrides it,
    /// the rules are a matter for [`crate::tolerance_rules::check`].
    ///
    /// # Errors
    /// When values are missing and no preset is named, or the preset fails.
    pub fn resolve(&self, blocks: &[&Block], precision: Precision) -> Result<ToleranceSet, SpecError> {
        match self.preset {
            Some(preset) if self.numbers.is_empty() && self.criteria.is_none() => {
                Ok(preset::derive_checked(preset, blocks, precision)?)
            }
            _ => self.derive(blocks, precision),
        }
    }

    /// As [`ToleranceSpec::resolve`], without regard to the rules.
    ///
    /// # Errors
    /// When values are missing and no preset is named, or the preset cannot be derived.
    pub fn derive(&self, blocks: &[&Block], precision: Precision) -> Result<ToleranceSet, SpecError> {
        let given = |name: &str| self.numbers.iter().find(|(n, _)| *n == name).map(|(_, value)| value);
        let mut set = ToleranceSet::ZERO;
        let mut missing: Vec<&'static str> =
            set.numbers().iter().map(|(name, _)| *name).filter(|name| given(name).is_none()).collect();
        if self.criteria.is_none() {
            missing.push("criteria");
        }
        if !missing.is_empty() {
            let preset = self.preset.ok_or(SpecError::Missing { missing })?;
            set = preset::derive(preset, blocks, precision)?;
        }
        for (name, number) in set.numbers_mut() {
            if let Some(value) = given(name) {
                *number = value.clone();
            }
        }
        set.criteria = self.criteria.unwrap_or(set.criteria);
        Ok(set)
    }
}

/// The name as it is known.
fn known(name: &str) -> Result<&'static str, SpecError> {
    NAMES.into_iter().find(|n| *n == name).ok_or_else(|| SpecError::UnknownName { found: shown(name) })
}
