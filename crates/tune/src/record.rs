//! The search on disk: one row for each candidate, so that it can be killed at any moment and go on.

use super::candidate::Knobs;
use super::measure::Measurement;
use super::probes::Differences;
use super::search::{Next, Search, Tried};
use super::steps::{Locked, Overlaps, Stepped};
use rockproof_campaign::journal::Start;
use rockproof_model::files::write_atomically;
use rockproof_model::rules::{Rule, Slack};
use rockproof_results::identity_differences;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// Why a search cannot be started, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The directory holds another search.
    #[error("{dir} holds a search already; --resume goes on with it, --force begins again, --out DIR writes elsewhere")]
    Occupied {
        /// The directory.
        dir: PathBuf,
    },
    /// The search in the directory was started otherwise.
    #[error("{dir} holds another search, so it cannot go on:\n  {}\nrun it as it was started, or use --force or --out DIR", differences.join("\n  "))]
    Other {
        /// The directory.
        dir: PathBuf,
        /// One line for each key.
        differences: Vec<String>,
    },
    /// A file of the search is damaged.
    #[error("{file}: {what}; --force begins again")]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A file cannot be read or written.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The table cannot be written.
    #[error("cannot write candidates.csv: {0}")]
    Csv(#[from] csv::Error),
}

/// The columns of `candidates.csv`: number and origin, the set, then what was measured. Lengths in m. Those that begin with `lock_` are empty
/// for candidates whose steps the oracle was not asked about.
pub const COLUMNS: [&str; 40] = [
    "candidate",
    "origin",
    "search",
    "territory",
    "penetration",
    "overlap_sine",
    "parallel_sine",
    "equal",
    "open",
    "close",
    "max_displacement",
    "max_rotation",
    "criteria",
    "violated",
    "slack",
    "tightest",
    "standing_pairs",
    "standing_differ",
    "moved_pairs",
    "moved_differ",
    "near_pairs",
    "near_differ",
    "boundary_pairs",
    "boundary_differ",
    "changed_contacts",
    "steps",
    "penetration_m",
    "sunk_m",
    "unconverged",
    "retries",
    "stopped",
    "lock_steps",
    "lock_differ",
    "lock_found",
    "lock_contacts",
    "lock_modes",
    "lock_failed",
    "lock_penetration_m",
    "knobs",
    "best",
];

const TABLE: &str = "candidates.csv";
const ABOUT: &str = "tune.json";

/// A search on disk.
pub struct Record {
    dir: PathBuf,
}

impl Record {
    /// Opens the directory; where a search goes on, takes its candidates into `search`.
    ///
    /// # Errors
    /// When the directory holds a search that may not be touched, or cannot be read or written.
    pub fn open(
        dir: &Path,
        identity: &Map<String, Value>,
        start: Start,
        search: &mut Search<'_>,
    ) -> Result<Record, RecordError> {
        let record = Record { dir: dir.to_owned() };
        let (table, about) = (dir.join(TABLE), dir.join(ABOUT));
        let at = |file: &Path| {
            let file = file.to_owned();
            move |source| RecordError::Io { file, source }
        };
        let held = table.exists() || about.exists();
        if held && start == Start::Fresh {
            return Err(RecordError::Occupied { dir: record.dir });
        }
        if start == Start::Resume && about.exists() {
            let text = std::fs::read(&about).map_err(at(&about))?;
            let was: Map<String, Value> = serde_json::from_slice(&text).map_err(|e| RecordError::Damaged {
                file: about.clone(),
                what: format!("not what a search leaves ({e})"),
            })?;
            let differences = identity_differences(&was, identity);
            if !differences.is_empty() {
                return Err(RecordError::Other { dir: record.dir, differences });
            }
            if table.exists() {
                take_in(&table, search)?;
            }
            return Ok(record);
        }
        std::fs::create_dir_all(dir).map_err(at(dir))?;
        if table.exists() {
            std::fs::remove_file(&table).map_err(at(&table))?;
        }
        let text =
            serde_json::to_vec_pretty(identity).map_err(|e| RecordError::Io { file: about, source: e.into() })?;
        record.write(ABOUT, &text)?;
        Ok(record)
    }

    /// The steps of the search that a directory holds, if it holds one.
    pub fn steps(dir: &Path) -> Option<u64> {
        let text = std::fs::read(dir.join(ABOUT)).ok()?;
        let about: Map<String, Value> = serde_json::from_slice(&text).ok()?;
        about.get("steps")?.as_u64()
    }

    /// Writes all candidates so far.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn commit(&self, search: &Search<'_>) -> Result<(), RecordError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(COLUMNS)?;
        let best = search.best();
        for (number, tried) in search.tried().iter().enumerate() {
            writer.write_record(row(number, tried, best == Some(number)))?;
        }
        let bytes = writer.into_inner().map_err(|e| csv::Error::from(e.into_error()))?;
        self.write(TABLE, &bytes)
    }

    /// Writes a file beside its final name and renames it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), RecordError> {
        let file = self.dir.join(name);
        write_atomically(&file, bytes).map_err(|source| RecordError::Io { file, source })
    }
}

fn row(number: usize, tried: &Tried, best: bool) -> Vec<String> {
    let m = &tried.measurement;
    let d = &m.differences;
    let mut row = vec![number.to_string(), tried.origin.name().to_owned()];
    row.extend(tried.set.numbers().map(|(_, value)| value.to_string()));
    row.push(tried.set.criteria.name().to_owned());
    row.push(m.violated.iter().map(|rule| (*rule as usize).to_string()).collect::<Vec<_>>().join(" "));
    row.extend([format!("{:?}", m.tightest.factor), (m.tightest.rule as usize).to_string()]);
    row.extend([d.standing, d.moved, d.near, d.boundary].into_iter().flatten().map(|count| count.to_string()));
    let s = &m.stepped;
    row.extend([d.changed.to_string(), s.steps.to_string()]);
    row.extend([format!("{:?}", s.overlaps.deepest), format!("{:?}", s.overlaps.sunk)]);
    row.extend([s.unconverged.to_string(), s.retries.to_string(), s.stopped.clone().unwrap_or_default()]);
    let locked = m.locked.as_ref();
    let counts =
        locked.map(|l| [l.steps, l.differ, l.found, l.contacts, l.modes, l.failed].map(|count| count.to_string()));
    row.extend(counts.unwrap_or_default());
    row.push(locked.and_then(|locked| locked.deepest).map(|depth| format!("{depth:?}")).unwrap_or_default());
    row.extend([tried.knobs.map_or(String::new(), Knobs::text), u8::from(best).to_string()]);
    row
}

/// Takes the candidates of a table into a search that has none. Each must be the one that the search would try.
fn take_in(file: &Path, search: &mut Search<'_>) -> Result<(), RecordError> {
    let damaged = |number: usize, what: &str| RecordError::Damaged {
        file: file.to_owned(),
        what: format!("candidate {number} {what}"),
    };
    let mut reader = csv::Reader::from_path(file)?;
    for (number, record) in reader.records().enumerate() {
        let record = record?;
        let next = search.candidate();
        let measurement = parsed(&record).ok_or_else(|| damaged(number, "cannot be read"))?;
        if !is_same(&record, &next) {
            return Err(damaged(number, "is not the one that this seed tries there"));
        }
        search.add(next, measurement);
    }
    Ok(())
}

/// Whether a row is about a candidate.
fn is_same(record: &csv::StringRecord, next: &Next) -> bool {
    let numbers = next.set.numbers();
    record.get(1) == Some(next.origin.name())
        && numbers.iter().enumerate().all(|(k, (_, value))| record.get(2 + k) == Some(&value.to_string()))
        && record.get(12) == Some(next.set.criteria.name())
}

fn parsed(record: &csv::StringRecord) -> Option<Measurement> {
    let field = |name: &str| record.get(COLUMNS.iter().position(|column| *column == name)?);
    let count = |name: &str| field(name)?.parse::<u64>().ok();
    let pair = |sort: &str| Some([count(&format!("{sort}_pairs"))?, count(&format!("{sort}_differ"))?]);
    let rule = |text: &str| Rule::ALL.get(text.parse::<usize>().ok()?).copied();
    let number = |name: &str| field(name)?.parse::<f64>().ok();
    let is_there = |name: &str| field(name).is_some_and(|text| !text.is_empty());
    let deepest = match is_there("lock_penetration_m") {
        true => Some(number("lock_penetration_m")?),
        false => None,
    };
    let locked = match is_there("lock_steps") {
        true => Some(Locked {
            steps: count("lock_steps")?,
            differ: count("lock_differ")?,
            found: count("lock_found")?,
            contacts: count("lock_contacts")?,
            modes: count("lock_modes")?,
            failed: count("lock_failed")?,
            deepest,
        }),
        false => None,
    };
    Some(Measurement {
        violated: field("violated")?.split_whitespace().map(rule).collect::<Option<_>>()?,
        tightest: Slack { rule: rule(field("tightest")?)?, factor: number("slack")? },
        differences: Differences {
            standing: pair("standing")?,
            moved: pair("moved")?,
            near: pair("near")?,
            boundary: pair("boundary")?,
            changed: count("changed_contacts")?,
        },
        stepped: Stepped {
            steps: count("steps")?,
            overlaps: Overlaps { deepest: number("penetration_m")?, sunk: number("sunk_m")? },
            unconverged: count("unconverged")?,
            retries: count("retries")?,
            stopped: Some(field("stopped")?.to_owned()).filter(|text| !text.is_empty()),
        },
        locked,
    })
}
