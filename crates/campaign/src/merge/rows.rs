//! The rows of a table in all parts, one after the other.

use super::parts::{MergeError, OnePart};
use csv::ByteRecord;
use rockproof_model::bounded_rows::BoundedRows;
use rockproof_results::ResultsError;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::fs::File;
use std::io::Take;
use std::path::PathBuf;

/// A row about a pair.
pub(super) struct NumberedRow<R> {
    /// Its values.
    pub(super) row: R,
    /// How many rows of its pair are before it.
    pub(super) place: usize,
    /// The row as it was written.
    pub(super) record: ByteRecord,
}

/// Rows in the order of pairs, of parts in that order. One part's file is open at a time, and one row is read ahead.
pub(super) struct Rows<'p, R> {
    name: &'static str,
    parts: VecDeque<&'p OnePart>,
    open: Option<(PathBuf, csv::Reader<BoundedRows<Take<File>>>)>,
    ahead: Option<NumberedRow<R>>,
    index: fn(&R) -> u64,
    /// The pair of the last row read, and how many of its rows were read.
    last: Option<(u64, usize)>,
}

impl<'p, R: DeserializeOwned> Rows<'p, R> {
    /// The rows of the table `name`, each about the pair that `index` gives.
    pub(super) fn of(parts: &'p [OnePart], name: &'static str, index: fn(&R) -> u64) -> Result<Self, MergeError> {
        let parts = parts.iter().collect();
        let mut rows = Rows { name, parts, open: None, ahead: None, index, last: None };
        rows.ahead = rows.read()?;
        Ok(rows)
    }

    /// The next rows, of pairs before `end`.
    pub(super) fn until(&mut self, end: u64) -> Result<Vec<NumberedRow<R>>, MergeError> {
        let mut found = Vec::new();
        while let Some(row) = self.ahead.take_if(|ahead| (self.index)(&ahead.row) < end) {
            found.push(row);
            self.ahead = self.read()?;
        }
        Ok(found)
    }

    /// Leaves out the rows of pairs before `end`, and gives how many those were.
    pub(super) fn skip(&mut self, end: u64) -> Result<u64, MergeError> {
        let mut skipped = 0;
        while self.ahead.take_if(|ahead| (self.index)(&ahead.row) < end).is_some() {
            skipped += 1;
            self.ahead = self.read()?;
        }
        Ok(skipped)
    }

    fn read(&mut self) -> Result<Option<NumberedRow<R>>, MergeError> {
        loop {
            let Some((file, reader)) = &mut self.open else {
                let Some(part) = self.parts.pop_front() else { return Ok(None) };
                let seal = part.tables().into_iter().find_map(|(name, seal)| (name == self.name).then_some(seal));
                if let Some(seal) = seal {
                    let table = BoundedRows::new(part.view.table(self.name, seal)?);
                    self.open = Some((part.view.path().join(self.name), csv::Reader::from_reader(table)));
                }
                continue;
            };
            let mut record = ByteRecord::new();
            let bad = |file: &PathBuf, source| MergeError::Row { file: file.clone(), source };
            if !reader.read_byte_record(&mut record).map_err(|source| bad(file, source))? {
                self.open = None;
                continue;
            }
            let row: R = record.deserialize(None).map_err(|source| bad(file, source))?;
            let index = (self.index)(&row);
            let place = match self.last {
                Some((last, places)) if last == index => places,
                Some((last, _)) if last > index => {
                    return Err(ResultsError::damaged(file, format!("pair {index} comes after pair {last}")).into());
                }
                _ => 0,
            };
            self.last = Some((index, place + 1));
            return Ok(Some(NumberedRow { row, place, record }));
        }
    }
}
