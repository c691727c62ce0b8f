//! The values of a scene file with the lines they stand on: what every part of the reader asks of them.

use crate::number::{Number, NumberError, Precision};
use crate::number_text::{decimal, shown};
use crate::scene::error::SceneProblem;
use crate::scene::tokens::Located;
use crate::vector::Vec3;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

pub(super) type Value<'i> = Spanned<DeValue<'i>>;

/// What a number may be.
#[derive(Clone, Copy)]
pub(super) enum Allowed {
    Positive,
    NotNegative,
    /// 0 to 1, both ends allowed.
    Share,
    /// Above −1 and below 1/2.
    Poisson,
    /// Degrees, 0 to below 90.
    Angle,
}

impl Allowed {
    fn text(self) -> &'static str {
        match self {
            Allowed::Positive => "more than 0",
            Allowed::NotNegative => "0 or more",
            Allowed::Share => "0 to 1",
            Allowed::Poisson => "more than -1 and less than 1/2",
            Allowed::Angle => "0 to less than 90 degrees",
        }
    }

    fn holds(self, number: &Number) -> bool {
        let is_positive = !number.is_negative() && !number.is_zero();
        match self {
            Allowed::Positive => is_positive,
            Allowed::NotNegative => !number.is_negative(),
            Allowed::Share => !number.is_negative() && *number <= Number::from_integer(1),
            Allowed::Poisson => *number > Number::from_integer(-1) && number.plus(number) < Number::from_integer(1),
            Allowed::Angle => !number.is_negative() && *number < Number::from_integer(90),
        }
    }
}

/// Where the lines of a text begin.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn new(text: &str) -> Lines {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Lines(std::iter::once(0).chain(breaks).collect())
    }

    pub(super) fn of(&self, span: &Range<usize>) -> usize {
        self.0.partition_point(|&start| start <= span.start)
    }

    /// Where each of some values begins.
    pub(super) fn each(&self, values: &[Value<'_>]) -> Vec<usize> {
        values.iter().map(|value| self.of(&value.span())).collect()
    }

    pub(super) fn unexpected(&self, value: &Value<'_>, expected: &str) -> Located {
        let found = match value.get_ref() {
            DeValue::String(text) => format!("\"{}\"", shown(text)),
            DeValue::Integer(integer) => shown(integer.as_str()),
            DeValue::Float(float) => shown(float.as_str()),
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Array(array) => format!("an array of {}", array.len()),
            other => format!("a {}", other.type_str()),
        };
        (Some(self.of(&value.span())), SceneProblem::Unexpected { found, expected: expected.to_string() })
    }

    pub(super) fn not_allowed(&self, value: &Value<'_>, what: &str, found: &str, allowed: String) -> Located {
        let problem = SceneProblem::NotAllowed { what: what.to_string(), found: found.to_string(), allowed };
        (Some(self.of(&value.span())), problem)
    }

    pub(super) fn allow_only(&self, table: &DeTable<'_>, place: &str, known: &[&str]) -> Result<(), Located> {
        match table.keys().find(|key| !known.contains(&key.get_ref().as_ref())) {
            None => Ok(()),
            Some(key) => {
                let problem = SceneProblem::UnknownKey {
                    found: shown(key.get_ref()),
                    place: place.to_string(),
                    known: known.join(", "),
                };
                Err((Some(self.of(&key.span())), problem))
            }
        }
    }

    /// An error where both keys are in the table, though only one may be.
    pub(super) fn one_of(&self, table: &DeTable<'_>, place: &str, keys: [&str; 2]) -> Result<(), Located> {
        match keys.map(|key| table.get(key)) {
            [Some(_), Some(second)] => {
                let found = format!("`{}` beside `{}`", keys[1], keys[0]);
                let problem = SceneProblem::Unexpected { found, expected: format!("one of them in {place}") };
                Err((Some(self.of(&second.span())), problem))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn table<'v, 'i>(&self, value: &'v Value<'i>, what: &str) -> Result<&'v DeTable<'i>, Located> {
        value.get_ref().as_table().ok_or_else(|| self.unexpected(value, &format!("{what}, a table")))
    }

    /// The value of a key that must be there.
    pub(super) fn required<'v, 'i>(
        &self,
        whole: &Value<'i>,
        table: &'v DeTable<'i>,
        place: &str,
        key: &str,
    ) -> Result<&'v Value<'i>, Located> {
        table.get(key).ok_or_else(|| {
            let problem =
                SceneProblem::Unexpected { found: format!("no `{key}`"), expected: format!("a {place} with `{key}`") };
            (Some(self.of(&whole.span())), problem)
        })
    }

    /// The tables `[[key]]`.
    pub(super) fn tables<'v, 'i>(
        &self,
        document: &'v DeTable<'i>,
        key: &str,
    ) -> Result<Vec<(&'v Value<'i>, &'v DeTable<'i>)>, Located> {
        let Some(value) = document.get(key) else { return Ok(Vec::new()) };
        let entries = self.array(value, &format!("`{key}`, tables [[{key}]]"))?;
        entries.iter().map(|entry| Ok((entry, self.table(entry, &format!("[[{key}]]"))?))).collect()
    }

    pub(super) fn array<'v, 'i>(&self, value: &'v Value<'i>, what: &str) -> Result<&'v [Value<'i>], Located> {
        let array = value.get_ref().as_array().ok_or_else(|| self.unexpected(value, &format!("{what}, an array")))?;
        Ok(array)
    }

    pub(super) fn text<'v>(&self, value: &'v Value<'_>, what: &str) -> Result<&'v str, Located> {
        value.get_ref().as_str().ok_or_else(|| self.unexpected(value, &format!("{what}, a string")))
    }

    pub(super) fn flag(&self, value: &Value<'_>, what: &str) -> Result<bool, Located> {
        value.get_ref().as_bool().ok_or_else(|| self.unexpected(value, &format!("{what}, true or false")))
    }

    /// One line of text, so that every format can hold it.
    pub(super) fn name(&self, value: &Value<'_>, what: &str) -> Result<String, Located> {
        let name = self.text(value, what)?;
        if name.is_empty() || name.trim() != name || name.chars().any(char::is_control) || name.contains('#') {
            let expected = format!("{what}, one line of text without spaces around it and without #");
            return Err(self.unexpected(value, &expected));
        }
        Ok(name.to_string())
    }

    /// The place of a name among `known`.
    pub(super) fn known(&self, value: &Value<'_>, what: &str, known: &[String]) -> Result<usize, Located> {
        let name = self.text(value, what)?;
        known
            .iter()
            .position(|k| k == name)
            .ok_or_else(|| self.not_allowed(value, what, &format!("\"{}\"", shown(name)), listed(known)))
    }

    /// One of a few words.
    pub(super) fn word<T>(
        &self,
        value: &Value<'_>,
        what: &str,
        from_name: impl Fn(&str) -> Option<T>,
        allowed: &str,
    ) -> Result<T, Located> {
        let word = self.text(value, what)?;
        from_name(word)
            .ok_or_else(|| self.not_allowed(value, what, &format!("\"{}\"", shown(word)), allowed.to_string()))
    }

    /// A number is the f64 it parses to, a string is exact (SPEC section 1).
    pub(super) fn number(&self, value: &Value<'_>, what: &str) -> Result<Number, Located> {
        let refuse = |error| (Some(self.of(&value.span())), SceneProblem::Number { what: what.to_string(), error });
        let number = match value.get_ref() {
            DeValue::String(text) => Number::parse(text).map_err(refuse)?,
            DeValue::Integer(integer) => {
                let digits = integer.as_str();
                let magnitude = i128::from_str_radix(digits, integer.radix());
                let exact = magnitude.map_err(|_| self.unexpected(value, &format!("{what}, a number below 2^127")))?;
                Number::from_f64(exact as f64).map_err(refuse)?
            }
            DeValue::Float(float) => match float.as_str().parse::<f64>() {
                Ok(near) if near.is_finite() => Number::from_f64(near).map_err(refuse)?,
                _ => return Err(refuse(NumberError::NotFinite { found: shown(float.as_str()) })),
            },
            _ => return Err(self.unexpected(value, &format!("{what}, a number or an exact number as a string"))),
        };
        if number.rounded(Precision::F64).is_none() {
            let found = shown(&number.to_string());
            return Err(refuse(NumberError::Overflow { found, precision: Precision::F64 }));
        }
        Ok(number)
    }

    pub(super) fn number_in(&self, value: &Value<'_>, what: &str, allowed: Allowed) -> Result<Number, Located> {
        let number = self.number(value, what)?;
        if allowed.holds(&number) {
            return Ok(number);
        }
        Err(self.not_allowed(value, what, &decimal(&number), allowed.text().to_string()))
    }

    /// The number of a key, where it is there.
    pub(super) fn optional(
        &self,
        table: &DeTable<'_>,
        key: &str,
        place: &str,
        allowed: Allowed,
    ) -> Result<Option<Number>, Located> {
        table.get(key).map(|value| self.number_in(value, &format!("`{key}` of {place}"), allowed)).transpose()
    }

    /// A whole number from `least` to `most`.
    pub(super) fn whole(&self, value: &Value<'_>, what: &str, least: u64, most: u64) -> Result<u64, Located> {
        let digits = value.get_ref().as_integer().filter(|integer| integer.radix() == 10);
        let integer = digits.ok_or_else(|| self.unexpected(value, &format!("{what}, a whole number")))?;
        match integer.as_str().parse::<u64>() {
            Ok(number) if (least..=most).contains(&number) => Ok(number),
            _ => Err(self.not_allowed(value, what, &shown(integer.as_str()), format!("{least} to {most}"))),
        }
    }

    /// `N` numbers; `part` is what one of them is called.
    pub(super) fn numbers<const N: usize>(
        &self,
        value: &Value<'_>,
        what: &str,
        part: &str,
    ) -> Result<[Number; N], Located> {
        let all = self.array(value, what)?;
        let numbers: Vec<Number> =
            all.iter().map(|one| self.number(one, &format!("a {part} of {what}"))).collect::<Result<_, _>>()?;
        numbers.try_into().map_err(|_| self.unexpected(value, &format!("{what}, an array of {N} {part}s")))
    }

    pub(super) fn vector(&self, value: &Value<'_>, what: &str, part: &str) -> Result<Vec3<Number>, Located> {
        let [x, y, z] = self.numbers(value, what, part)?;
        Ok(Vec3::new(x, y, z))
    }
}

/// Names in a message, the first of them if they are many.
pub(super) fn listed(names: &[String]) -> String {
    const MAX_NAMES: usize = 12;
    let mut text: Vec<String> = names.iter().take(MAX_NAMES).map(|name| format!("\"{}\"", shown(name))).collect();
    if let Some(more) = names.len().checked_sub(MAX_NAMES).filter(|more| *more > 0) {
        text.push(format!("{more} more"));
    }
    text.join(", ")
}
