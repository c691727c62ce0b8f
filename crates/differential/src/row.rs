//! A row of `findings.csv`, for whoever writes or reads one, and what rows of other tables have in common with it.

use super::compare::AnswerChange;
use super::finding::{Cause, FindingScope};
use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::Display;
use std::io::{self, Read};

/// The rows of a table, by the names of its columns, of which there must be these.
///
/// # Errors
/// When the header cannot be read or lacks a column: a table that was emptied, or of which nothing can be read, is none without rows.
pub fn typed_rows<T: DeserializeOwned, R: Read>(
    table: R,
    columns: &[&str],
) -> csv::Result<csv::DeserializeRecordsIntoIter<R, T>> {
    let mut reader = csv::Reader::from_reader(table);
    let header = reader.headers()?;
    if let Some(missing) = columns.iter().find(|column| !header.iter().any(|name| name == **column)) {
        let text = format!("there is no column \"{missing}\"; expected are {}", columns.join(","));
        return Err(io::Error::new(io::ErrorKind::InvalidData, text).into());
    }
    Ok(reader.into_deserialize())
}

/// One finding as `findings.csv` has it. The fields are its columns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FindingRow {
    /// The pair's number in the campaign.
    pub index: u64,
    /// The pair's family.
    #[serde(deserialize_with = "named")]
    pub family: String,
    /// The pair's form.
    pub form: String,
    /// The tolerance set.
    #[serde(deserialize_with = "named")]
    pub tolerances: String,
    /// Whom it is about.
    #[serde(serialize_with = "text", deserialize_with = "deserialize_scope")]
    pub engine: FindingScope,
    /// Why the answer changed.
    #[serde(serialize_with = "text", deserialize_with = "deserialize_cause")]
    pub cause: Cause,
    /// What changed.
    #[serde(serialize_with = "text", deserialize_with = "change")]
    pub change: AnswerChange,
    /// The contact's kind or the blocks' state before the change; empty where there is none.
    pub kind_before: String,
    /// The same after it.
    pub kind_after: String,
    /// What decided it; empty where no trace tells.
    pub predicate: String,
    /// The features it was asked of.
    pub features: String,
    /// The exact margin, **0 at a tie**.
    #[serde(serialize_with = "exponential", deserialize_with = "finite")]
    pub margin: Option<f64>,
    /// The margin in units of the engine's roundoff.
    #[serde(serialize_with = "exponential", deserialize_with = "finite")]
    pub margin_ulps: Option<f64>,
    /// The case file, in the directory of the run; empty where there is none.
    pub case: String,
}

/// A table of these rows, with its header also where there are none.
///
/// # Errors
/// Those of the CSV writer.
pub fn written<R: Serialize>(columns: &[&str], rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(columns)?;
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// A value by its name.
///
/// # Errors
/// Those of the writer.
pub fn text<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// A number as `1.5e-3`, or nothing.
///
/// # Errors
/// Those of the writer.
pub fn exponential<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => serializer.collect_str(&format_args!("{value:e}")),
        None => serializer.serialize_str(""),
    }
}

/// A finite number, or nothing.
///
/// # Errors
/// Where there is something else.
pub fn finite<'d, D: Deserializer<'d>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    let text = String::deserialize(deserializer)?;
    match text.parse::<f64>() {
        _ if text.is_empty() => Ok(None),
        Ok(number) if number.is_finite() => Ok(Some(number)),
        _ => Err(D::Error::custom(format!("a margin or depth is \"{text}\", which is no finite number"))),
    }
}

/// Whom a finding is about.
///
/// # Errors
/// Where nothing is named.
pub fn deserialize_scope<'d, D: Deserializer<'d>>(deserializer: D) -> Result<FindingScope, D::Error> {
    named(deserializer).map(|text| FindingScope::from_name(&text))
}

/// A cause.
///
/// # Errors
/// Where there is no such cause.
pub fn deserialize_cause<'d, D: Deserializer<'d>>(deserializer: D) -> Result<Cause, D::Error> {
    let text = String::deserialize(deserializer)?;
    Cause::from_name(&text).ok_or_else(|| D::Error::custom(format!("cause is \"{text}\"")))
}

/// A name of a family, a tolerance set or an engine.
///
/// # Errors
/// Where there is none.
pub fn named<'d, D: Deserializer<'d>>(deserializer: D) -> Result<String, D::Error> {
    let text = String::deserialize(deserializer)?;
    if text.is_empty() { Err(D::Error::custom("family, tolerance set or engine has no name")) } else { Ok(text) }
}

fn change<'d, D: Deserializer<'d>>(deserializer: D) -> Result<AnswerChange, D::Error> {
    let text = String::deserialize(deserializer)?;
    AnswerChange::from_name(&text).ok_or_else(|| D::Error::custom(format!("change is \"{text}\"")))
}

#[cfg(test)]
mod tests {
    use super::super::finding::FINDING_COLUMNS;
    use super::*;
    use rockproof_model::Precision;

    fn row() -> FindingRow {
        FindingRow {
            index: 7,
            family: "sliver".into(),
            form: "random".into(),
            tolerances: "auto".into(),
            engine: FindingScope::Rounded(Precision::F32),
            cause: Cause::Representation,
            change: AnswerChange::GapSign,
            kind_before: "v-f".into(),
            kind_after: String::new(),
            predicate: "gap".into(),
            features: "v0 f1".into(),
            margin: Some(1.5e-9),
            margin_ulps: None,
            case: String::new(),
        }
    }

    #[test]
    fn what_is_written_is_read_and_nothing_else() {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.serialize(row()).expect("a row");
        let text = String::from_utf8(writer.into_inner().expect("bytes")).expect("text");
        let line = "7,sliver,random,auto,f32,representation,gap-sign,v-f,,gap,v0 f1,1.5e-9,,";
        assert_eq!(text, format!("{}\n{line}\n", FINDING_COLUMNS.join(",")), "the fields are the columns, in order");
        let read = |text: &str| -> Result<Vec<FindingRow>, csv::Error> {
            csv::Reader::from_reader(text.as_bytes()).deserialize().collect()
        };
        assert_eq!(read(&text).expect("rows"), [row()]);
        for (from, to) in
            [("7,", "x,"), ("f32", ""), ("representation", "weather"), ("gap-sign", "?"), ("1.5e-9", "NaN")]
        {
            assert!(read(&text.replacen(from, to, 1)).is_err(), "{to}");
        }
    }
}
