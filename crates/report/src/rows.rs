//! Reads the tables of runs, a row at a time, and says where one is damaged.

use super::error::{ReportError, at};
use rockproof_model::bounded_rows::BoundedRows;
use rockproof_model::files::open_table;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// A table on disk.
pub(super) struct CsvTable {
    file: PathBuf,
    reader: csv::Reader<BoundedRows<File>>,
    record: csv::StringRecord,
    header: csv::StringRecord,
    /// Where the columns asked for are.
    places: Vec<usize>,
}

/// One row of it.
pub(super) struct CsvRow<'r> {
    file: &'r Path,
    names: &'r [&'static str],
    record: &'r csv::StringRecord,
    places: &'r [usize],
}

impl CsvTable {
    /// Opens a table that must have these columns in this order.
    pub(super) fn open(file: PathBuf, columns: &[&str]) -> Result<CsvTable, ReportError> {
        let opened = open_table(&file).map_err(at(&file))?;
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(opened);
        let places = (0..columns.len()).collect();
        let header = reader.headers().map_err(|e| damaged(&file, &e))?.clone();
        if header.iter().ne(columns.iter().copied()) {
            let found = header.iter().take(columns.len() + 3).collect::<Vec<_>>().join(",");
            return Err(ReportError::Damaged {
                file,
                line: 1,
                found: format!("the columns are \"{}\"", shortened(&found, 200)),
                expected: format!("\"{}\" (another version of rockproof may have written it)", columns.join(",")),
            });
        }
        Ok(CsvTable { file, reader, header, record: csv::StringRecord::new(), places })
    }

    /// Opens a table that must have these columns, in any order and beside others.
    pub(super) fn open_wider(file: PathBuf, columns: &[&str]) -> Result<CsvTable, ReportError> {
        let opened = open_table(&file).map_err(at(&file))?;
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(opened);
        let header = reader.headers().map_err(|e| damaged(&file, &e))?.clone();
        let mut places = Vec::new();
        for column in columns {
            let Some(place) = header.iter().position(|name| name == *column) else {
                let found = format!("there is no column \"{column}\"");
                let expected = format!("the columns {}", columns.join(","));
                return Err(ReportError::Damaged { file, line: 1, found, expected });
            };
            places.push(place);
        }
        Ok(CsvTable { file, reader, header, record: csv::StringRecord::new(), places })
    }

    /// The next row. `names` are the columns given to [`CsvTable::open`].
    pub(super) fn next<'r>(&'r mut self, names: &'r [&'static str]) -> Result<Option<CsvRow<'r>>, ReportError> {
        if !self.reader.read_record(&mut self.record).map_err(|e| damaged(&self.file, &e))? {
            return Ok(None);
        }
        let row = CsvRow { file: &self.file, names, record: &self.record, places: &self.places };
        if self.record.len() != self.header.len() {
            let found = format!("{} fields", self.record.len());
            return Err(row.damaged(found, format!("{}", self.header.len())));
        }
        Ok(Some(row))
    }
}

fn damaged(file: &Path, error: &csv::Error) -> ReportError {
    if let csv::ErrorKind::Io(source) = error.kind() {
        return at(file)(io::Error::new(source.kind(), source.to_string()));
    }
    let line = error.position().map_or(1, csv::Position::line);
    ReportError::Damaged {
        file: file.to_owned(),
        line,
        found: error.to_string(),
        expected: "a row of a table".to_owned(),
    }
}

fn shortened(text: &str, length: usize) -> String {
    match text.char_indices().nth(length) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

impl CsvRow<'_> {
    fn damaged(&self, found: String, expected: String) -> ReportError {
        let line = self.record.position().map_or(1, csv::Position::line);
        ReportError::Damaged { file: self.file.to_owned(), line, found, expected }
    }

    /// The whole row of a table that was opened with the columns in the order of the fields of `T`.
    pub(super) fn parsed<T: DeserializeOwned>(&self) -> Result<T, ReportError> {
        self.record.deserialize(None).map_err(|error| match error.kind() {
            csv::ErrorKind::Deserialize { err, .. } => match err.field().and_then(|at| usize::try_from(at).ok()) {
                Some(column) => match err.kind() {
                    csv::DeserializeErrorKind::ParseInt(_) => self.wrong(column, "a count"),
                    other => self.wrong(column, &other.to_string()),
                },
                None => self.damaged(err.kind().to_string(), "what a campaign writes there".to_owned()),
            },
            _ => damaged(self.file, &error),
        })
    }

    /// A field as text.
    pub(super) fn text(&self, column: usize) -> &str {
        self.places.get(column).and_then(|&place| self.record.get(place)).unwrap_or("")
    }

    fn wrong(&self, column: usize, expected: &str) -> ReportError {
        let name = self.names.get(column).copied().unwrap_or("");
        self.damaged(format!("{name} is \"{}\"", shortened(self.text(column), 60)), expected.to_owned())
    }

    /// A field that `read` understands.
    pub(super) fn of<T>(
        &self,
        column: usize,
        expected: &str,
        read: impl FnOnce(&str) -> Option<T>,
    ) -> Result<T, ReportError> {
        read(self.text(column)).ok_or_else(|| self.wrong(column, expected))
    }

    /// A count.
    pub(super) fn count(&self, column: usize) -> Result<u64, ReportError> {
        self.of(column, "a count", |text| text.parse().ok())
    }

    /// A finite number, or `None` where the field is empty.
    pub(super) fn number(&self, column: usize) -> Result<Option<f64>, ReportError> {
        if self.text(column).is_empty() {
            return Ok(None);
        }
        self.of(column, "a finite number or nothing", |text| f64::from_str(text).ok().filter(|n| n.is_finite()))
            .map(Some)
    }

    /// A field that may not be empty.
    pub(super) fn name(&self, column: usize) -> Result<&str, ReportError> {
        match self.text(column) {
            "" => Err(self.wrong(column, "a name")),
            name => Ok(name),
        }
    }

    /// An error about the whole row.
    pub(super) fn invalid_row(&self, found: &str, expected: &str) -> ReportError {
        self.damaged(found.to_owned(), expected.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[cfg(unix)]
    #[test]
    fn a_row_without_end_is_refused() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("findings.csv");
        fs::write(&file, "a,b\n1,2\n\"").expect("write");
        // Sparse: it takes no room on the disk.
        File::options().write(true).open(&file).expect("a file").set_len(3 << 30).expect("a sparse file");
        let text = "findings.csv: the row that begins in line 3 has more than 16777216 bytes; at most so many are read";
        for open in [CsvTable::open, CsvTable::open_wider] {
            let mut table = open(file.clone(), &["a", "b"]).expect("a header");
            assert_eq!(table.next(&["a", "b"]).expect("a row").map(|row| row.count(1).expect("a count")), Some(2));
            let error = table.next(&["a", "b"]).err().expect("no row").to_string();
            assert!(error.ends_with(text), "{error}");
        }
    }
}
