//! The project's own scene files, in TOML.
//!
//! The document is walked with its spans rather than through serde, so that every message names a line.

use crate::block::Point;
use crate::number::{Number, NumberError, Precision};
use crate::number_text::shown;
use crate::scene::error::Problem;
use crate::scene::tokens::Located;
use crate::spec::{SpecError, ToleranceSpec};
use crate::vector::Vec3;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Value<'i> = Spanned<DeValue<'i>>;

/// A scene file.
pub(super) struct Document {
    pub(super) tolerances: Option<ToleranceSpec>,
    pub(super) planarity: Option<Number>,
    pub(super) entries: Vec<Entry>,
}

/// One `[[block]]`.
pub(super) struct Entry {
    pub(super) name: Option<String>,
    pub(super) fixed: Option<bool>,
    pub(super) planarity: Option<Number>,
    pub(super) content: Content,
    pub(super) line: usize,
}

/// Where the shape of a `[[block]]` comes from.
pub(super) enum Content {
    Mesh { vertices: Vec<Point>, faces: Vec<Vec<u32>> },
    File(String),
    Box { min: Point, max: Point },
}

/// Reads a scene.
pub(super) fn read(text: &str) -> Result<Document, Located> {
    let lines = Lines::new(text);
    let document = parse(text, &lines)?;
    let table = document.get_ref();
    lines.only(table, "the scene", &["tolerances", "planarity", "block", "case"])?;
    let tolerances = match table.get("tolerances") {
        Some(value) => Some(lines.tolerances(lines.table(value, "`tolerances`")?)?),
        None => None,
    };
    let planarity = table.get("planarity").map(|value| lines.planarity(value)).transpose()?;
    let entries = match table.get("block") {
        Some(value) => {
            let blocks = lines.array(value, "`block`, tables [[block]]")?;
            blocks.iter().map(|block| lines.entry(block)).collect::<Result<Vec<_>, _>>()?
        }
        None => Vec::new(),
    };
    Ok(Document { tolerances, planarity, entries })
}

/// Reads tolerances: the table `[tolerances]` of a file, or a file that is that table.
pub(super) fn read_tolerances(text: &str) -> Result<ToleranceSpec, Located> {
    let lines = Lines::new(text);
    let document = parse(text, &lines)?;
    match document.get_ref().get("tolerances") {
        Some(value) => lines.tolerances(lines.table(value, "`tolerances`")?),
        None => lines.tolerances(document.get_ref()),
    }
}

fn parse<'i>(text: &'i str, lines: &Lines) -> Result<Spanned<DeTable<'i>>, Located> {
    DeTable::parse(text).map_err(|error| {
        let line = error.span().map(|span| lines.of(&span));
        (line, Problem::Toml { message: error.message().lines().collect::<Vec<_>>().join(", ") })
    })
}

/// Where the lines of a text begin.
struct Lines(Vec<usize>);

impl Lines {
    fn new(text: &str) -> Lines {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Lines(std::iter::once(0).chain(breaks).collect())
    }

    fn of(&self, span: &Range<usize>) -> usize {
        self.0.partition_point(|&start| start <= span.start)
    }

    fn unexpected(&self, value: &Value<'_>, expected: &str) -> Located {
        let found = match value.get_ref() {
            DeValue::String(text) => format!("\"{}\"", shown(text)),
            DeValue::Integer(integer) => shown(integer.as_str()),
            DeValue::Float(float) => shown(float.as_str()),
            DeValue::Boolean(value) => value.to_string(),
            DeValue::Array(array) => format!("an array of {}", array.len()),
            other => format!("a {}", other.type_str()),
        };
        (Some(self.of(&value.span())), Problem::Unexpected { found, expected: expected.to_string() })
    }

    fn only(&self, table: &DeTable<'_>, place: &str, known: &[&str]) -> Result<(), Located> {
        match table.keys().find(|key| !known.contains(&key.get_ref().as_ref())) {
            None => Ok(()),
            Some(key) => {
                let problem = Problem::UnknownKey {
                    found: shown(key.get_ref()),
                    place: place.to_string(),
                    known: known.join(", "),
                };
                Err((Some(self.of(&key.span())), problem))
            }
        }
    }

    fn table<'v, 'i>(&self, value: &'v Value<'i>, what: &str) -> Result<&'v DeTable<'i>, Located> {
        value.get_ref().as_table().ok_or_else(|| self.unexpected(value, &format!("{what}, a table")))
    }

    fn array<'v, 'i>(&self, value: &'v Value<'i>, what: &str) -> Result<&'v [Value<'i>], Located> {
        let array = value.get_ref().as_array().ok_or_else(|| self.unexpected(value, &format!("{what}, an array")))?;
        Ok(array)
    }

    fn text<'v>(&self, value: &'v Value<'_>, what: &str) -> Result<&'v str, Located> {
        value.get_ref().as_str().ok_or_else(|| self.unexpected(value, &format!("{what}, a string")))
    }

    /// A number is the f64 it parses to, a string is exact (SPEC section 1).
    fn number(&self, value: &Value<'_>, what: &str) -> Result<Number, Located> {
        let refuse = |error| (Some(self.of(&value.span())), Problem::Number { what: what.to_string(), error });
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

    fn planarity(&self, value: &Value<'_>) -> Result<Number, Located> {
        let planarity = self.number(value, "`planarity`")?;
        if planarity.is_negative() {
            let problem = Problem::NotAllowed {
                what: "`planarity`".to_string(),
                found: planarity.to_string(),
                allowed: "0 or more".to_string(),
            };
            return Err((Some(self.of(&value.span())), problem));
        }
        Ok(planarity)
    }

    fn tolerances(&self, table: &DeTable<'_>) -> Result<ToleranceSpec, Located> {
        let mut spec = ToleranceSpec::empty();
        for (first, second) in [("overlap_angle", "overlap_sine"), ("parallel_angle", "parallel_sine")] {
            if let (Some(_), Some(value)) = (table.get(first), table.get(second)) {
                return Err((Some(self.of(&value.span())), SpecError::GivenTwice { first, second }.into()));
            }
        }
        for (key, value) in table {
            let name = key.get_ref().as_ref();
            let set = match value.get_ref() {
                DeValue::String(text) => spec.set_text(name, text),
                // An unknown name matters more than what stands behind it.
                _ if !crate::spec::NAMES.contains(&name) => spec.set_text(name, ""),
                _ => spec.set_number(name, self.number(value, &format!("tolerance `{name}`"))?),
            };
            set.map_err(|error| (Some(self.of(&key.span())), error.into()))?;
        }
        Ok(spec)
    }

    fn entry(&self, value: &Value<'_>) -> Result<Entry, Located> {
        let line = self.of(&value.span());
        let table = self.table(value, "a block")?;
        let keys = ["name", "fixed", "planarity", "vertices", "faces", "file", "box"];
        self.only(table, "[[block]]", &keys)?;
        let name = table.get("name").map(|value| self.name(value)).transpose()?;
        let fixed = table
            .get("fixed")
            .map(|value| value.get_ref().as_bool().ok_or_else(|| self.unexpected(value, "`fixed`, true or false")));
        let planarity = table.get("planarity").map(|value| self.planarity(value)).transpose()?;
        let shapes = ["vertices", "faces", "file", "box"].map(|key| table.get(key));
        let content = match shapes {
            [Some(vertices), Some(faces), None, None] => {
                Content::Mesh { vertices: self.vertices(vertices)?, faces: self.faces(faces)? }
            }
            [None, None, Some(file), None] => Content::File(self.text(file, "`file`")?.to_string()),
            [None, None, None, Some(corners)] => self.corners(corners)?,
            _ => {
                let given: Vec<&str> = keys[3..].iter().copied().filter(|key| table.get(*key).is_some()).collect();
                let found = if given.is_empty() { "a block without a shape".to_string() } else { given.join(" and ") };
                let expected = "`vertices` and `faces`, or `file`, or `box`".to_string();
                return Err((Some(line), Problem::Unexpected { found, expected }));
            }
        };
        Ok(Entry { name, fixed: fixed.transpose()?, planarity, content, line })
    }

    /// One line of text, so that every format can hold it.
    fn name(&self, value: &Value<'_>) -> Result<String, Located> {
        let name = self.text(value, "`name`")?;
        if name.is_empty() || name.trim() != name || name.chars().any(char::is_control) || name.contains('#') {
            return Err(self.unexpected(value, "`name`, one line of text without spaces around it and without #"));
        }
        Ok(name.to_string())
    }

    fn corners(&self, value: &Value<'_>) -> Result<Content, Located> {
        let table = self.table(value, "`box`")?;
        self.only(table, "`box`", &["min", "max"])?;
        let corner = |key: &str| match table.get(key) {
            Some(corner) => self.point(corner, &format!("`{key}`")),
            None => Err(self.unexpected(value, "`box` with `min` and `max`")),
        };
        Ok(Content::Box { min: corner("min")?, max: corner("max")? })
    }

    fn point(&self, value: &Value<'_>, what: &str) -> Result<Point, Located> {
        match self.array(value, what)? {
            [x, y, z] => {
                let coordinate = |value| self.number(value, &format!("a coordinate of {what}"));
                Ok(Vec3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?))
            }
            _ => Err(self.unexpected(value, &format!("{what}, an array of 3 coordinates"))),
        }
    }

    fn vertices(&self, value: &Value<'_>) -> Result<Vec<Point>, Located> {
        let vertices = self.array(value, "`vertices`")?;
        vertices.iter().enumerate().map(|(i, vertex)| self.point(vertex, &format!("vertex {i}"))).collect()
    }

    fn faces(&self, value: &Value<'_>) -> Result<Vec<Vec<u32>>, Located> {
        let faces = self.array(value, "`faces`")?;
        let index = |(face, value): (usize, &Value<'_>)| {
            let digits = value.get_ref().as_integer().filter(|integer| integer.radix() == 10);
            digits.and_then(|integer| integer.as_str().parse::<u32>().ok()).ok_or_else(|| {
                self.unexpected(value, &format!("a vertex number of face {face}, a whole number from 0"))
            })
        };
        let boundary = |(face, value): (usize, &Value<'_>)| {
            let vertices = self.array(value, &format!("face {face}"))?;
            vertices.iter().map(|v| index((face, v))).collect::<Result<Vec<u32>, _>>()
        };
        faces.iter().enumerate().map(boundary).collect()
    }
}
