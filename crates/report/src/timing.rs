//! Run time against error: what `bench` measured.

use super::error::ReportError;
use super::load::name_of;
use super::rows::CsvTable;
use std::path::{Path, PathBuf};

/// The table of `bench --error` (docs/bench.md).
pub(super) const FILE: &str = "bench.csv";

const COLUMNS: [&str; 10] =
    ["kind", "subject", "engine", "tolerances", "time_step_s", "units", "us_per_unit", "error", "error_of", "note"];

/// One measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The scene or family of pairs, and what the error is of.
    pub case: String,
    /// The engine.
    pub engine: String,
    /// The tolerance set; empty where none matters.
    pub tolerances: String,
    /// Δt (s), where there is one.
    pub time_step_s: Option<f64>,
    /// How long a step or a pair took (s).
    pub seconds: f64,
    /// How wrong it was.
    pub error: f64,
    /// What `error` is of.
    pub error_of: String,
    /// Whether no other measurement of the case is both faster and less wrong.
    pub efficient: bool,
}

/// The measurements of one directory.
#[derive(Clone, Debug, PartialEq)]
pub struct TimingRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// The name of the directory.
    pub name: String,
    /// In the order of the file.
    pub measurements: Vec<Measurement>,
    /// Rows without figures: what stopped, and why, stands in the file.
    pub blank: u64,
}

impl TimingRun {
    pub(super) fn read(dir: &Path) -> Result<TimingRun, ReportError> {
        let mut rows = CsvTable::open_wider(dir.join(FILE), &COLUMNS)?;
        let mut measurements = Vec::new();
        let mut blank = 0;
        while let Some(row) = rows.next(&COLUMNS)? {
            // A run that stopped has a note and no figures.
            let (Some(micros), Some(error)) = (row.number(6)?, row.number(7)?) else {
                blank += 1;
                continue;
            };
            if micros < 0.0 || error < 0.0 {
                return Err(row.invalid_row("a negative time or error", "neither below 0"));
            }
            let (kind, subject, error_of) = (row.name(0)?, row.name(1)?, row.text(8));
            measurements.push(Measurement {
                case: format!("{kind} {subject}, {error_of}"),
                engine: row.name(2)?.to_owned(),
                tolerances: row.text(3).to_owned(),
                time_step_s: row.number(4)?,
                seconds: micros * 1e-6,
                error,
                error_of: error_of.to_owned(),
                efficient: false,
            });
        }
        mark_efficient(&mut measurements);
        Ok(TimingRun { dir: dir.to_owned(), name: name_of(dir), measurements, blank })
    }

    /// The cases, in order.
    pub fn cases(&self) -> Vec<&str> {
        let mut cases: Vec<&str> = self.measurements.iter().map(|m| &*m.case).collect();
        cases.sort_unstable();
        cases.dedup();
        cases
    }
}

fn mark_efficient(measurements: &mut [Measurement]) {
    let mut order: Vec<usize> = (0..measurements.len()).collect();
    let key = |i: &usize| (&measurements[*i].case, measurements[*i].seconds, measurements[*i].error);
    order.sort_by(|i, j| {
        let ((c, s, e), (d, t, f)) = (key(i), key(j));
        c.cmp(d).then(s.total_cmp(&t)).then(e.total_cmp(&f))
    });
    let mut front: Vec<usize> = Vec::new();
    for i in order {
        let last = front.last().filter(|last| measurements[**last].case == measurements[i].case);
        if last.is_none_or(|last| measurements[i].error < measurements[*last].error) {
            front.push(i);
        }
    }
    for i in front {
        measurements[i].efficient = true;
    }
}

#[cfg(test)]
mod tests {
    use super::{Measurement, mark_efficient};

    #[test]
    fn only_what_nothing_beats_is_efficient() {
        let measured = |case: &str, seconds, error| Measurement {
            case: case.to_owned(),
            engine: "e".to_owned(),
            tolerances: String::new(),
            time_step_s: None,
            seconds,
            error,
            error_of: String::new(),
            efficient: false,
        };
        let mut all = [("a", 2.0, 1.0), ("a", 1.0, 2.0), ("a", 3.0, 1.0), ("a", 1.0, 3.0), ("b", 9.0, 9.0)]
            .map(|(case, seconds, error)| measured(case, seconds, error));
        mark_efficient(&mut all);
        assert_eq!(all.map(|m| m.efficient), [true, true, false, false, true]);
    }
}
