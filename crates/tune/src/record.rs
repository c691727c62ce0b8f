//! The search on disk: one row for each candidate, so that it can be killed at any moment and go on.

use super::candidate::SetParameters;
use super::evaluator::Measurement;
use super::probes::Differences;
use super::search::{EvaluatedCandidate, PendingCandidate, Search};
use super::steps::{LockstepMeasures, Overlaps, StepMeasures};
use super::unseen_overlaps::UnseenOverlaps;
use rockproof_differential::row::written;
use rockproof_model::bounded_rows::BoundedRows;
use rockproof_model::files::read_limited;
use rockproof_model::tolerance_rules::{Rule, RuleSlack};
use rockproof_results::{Claim, Directory, FileKind, Owner, ResultsError, Start, digest, identity_differences};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::path::Path;

/// Why a search cannot be started, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The directory cannot be used.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The table cannot be read or written.
    #[error("candidates.csv: {0}")]
    Csv(#[from] csv::Error),
}

/// The columns of `candidates.csv`: number and origin, the set, then what was measured. Lengths in m. Those that begin with `lock_` are empty
/// for candidates whose steps the oracle was not asked about.
pub const COLUMNS: [&str; 50] = [
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
    "lost_pairs",
    "standing_pairs",
    "standing_differ",
    "moved_pairs",
    "moved_differ",
    "near_pairs",
    "near_differ",
    "boundary_pairs",
    "boundary_differ",
    "changed_contacts",
    "settled",
    "steps",
    "penetration_m",
    "sunk_m",
    "steps_deep",
    "steps_unseen",
    "unseen_pairs",
    "unseen_m",
    "unconverged",
    "steps_refused",
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
    "steps_explained",
    "explained_pairs",
    "explained_m",
];

const TABLE: &str = "candidates.csv";
const ABOUT: &str = "tune.json";
/// The files of a search.
const FILES: [&str; 5] = [TABLE, ABOUT, "tune.md", "tune.tex", "tolerances.toml"];

/// The content of `tune.json`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SearchDescription {
    #[serde(flatten)]
    identity: Map<String, Value>,
    /// SHA-256 of `candidates.csv`: of the table before the last change and of the one after it, for a kill may come between. Empty as
    /// long as there is none.
    candidates_sha256: Vec<String>,
}

/// A search on disk.
#[derive(Debug)]
pub struct SearchRecord {
    directory: Directory,
    about: SearchDescription,
}

impl SearchRecord {
    /// Opens the directory; where a search goes on, takes its candidates into `search`.
    ///
    /// # Errors
    /// When the directory holds something that may not be touched, or cannot be read or written.
    pub fn open(
        dir: &Path,
        identity: &Map<String, Value>,
        start: Start,
        search: &mut Search<'_>,
    ) -> Result<SearchRecord, RecordError> {
        let mut directory = Directory::claim(Claim { dir, owner: Owner::Tune, start, files: &FILES })?;
        if !directory.is_resumable(ABOUT, TABLE)? {
            let about = SearchDescription { identity: identity.clone(), candidates_sha256: Vec::new() };
            directory.write_sealed(ABOUT, &about)?;
            return Ok(SearchRecord { directory, about });
        }
        let about: SearchDescription = directory.read_sealed(ABOUT)?;
        let differences = identity_differences(&about.identity, identity);
        if !differences.is_empty() {
            let (dir, owner) = (directory.path().to_owned(), directory.owner());
            return Err(ResultsError::OtherIdentity { dir, owner, differences }.into());
        }
        let file = dir.join(TABLE);
        if directory.has(TABLE) {
            let table = read_limited(&file).map_err(ResultsError::at(&file))?;
            if !about.candidates_sha256.contains(&digest(&table)) {
                return Err(ResultsError::damaged(&file, "its rows are not as they were written").into());
            }
            restore_rows(&file, &table, search)?;
        } else if about.candidates_sha256.len() > 1 {
            return Err(ResultsError::damaged(&file, "it is missing").into());
        }
        Ok(SearchRecord { directory, about })
    }

    /// The steps of the search that a directory holds, if it holds one.
    pub fn steps(dir: &Path) -> Option<u64> {
        let text = read_limited(dir.join(ABOUT)).ok()?;
        let about: Map<String, Value> = serde_json::from_slice(&text).ok()?;
        about.get("steps")?.as_u64()
    }

    /// Writes all candidates so far.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn commit(&mut self, search: &Search<'_>) -> Result<(), RecordError> {
        let best = search.best();
        let tried = search.tried().iter().enumerate();
        let bytes = written(&COLUMNS, tried.map(|(number, one)| row(number, one, best == Some(number))))?;
        let seals = &mut self.about.candidates_sha256;
        seals.drain(..seals.len().saturating_sub(1));
        seals.push(digest(&bytes));
        self.directory.write_sealed(ABOUT, &self.about)?;
        Ok(self.directory.write(TABLE, FileKind::Table, &bytes)?)
    }

    /// Writes `tune.md`, `tune.tex` or `tolerances.toml`, beside its final name first.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), RecordError> {
        let kind = if name.ends_with(".toml") { FileKind::Input } else { FileKind::Text };
        Ok(self.directory.write(name, kind, bytes)?)
    }
}

fn row(number: usize, evaluated: &EvaluatedCandidate, best: bool) -> Vec<String> {
    let m = &evaluated.measurement;
    let d = &m.differences;
    let mut row = vec![number.to_string(), evaluated.origin.name().to_owned()];
    row.extend(evaluated.set.numbers().map(|(_, value)| value.to_string()));
    row.push(evaluated.set.criteria.name().to_owned());
    row.push(m.violated.iter().map(|rule| (*rule as usize).to_string()).collect::<Vec<_>>().join(" "));
    row.extend([format!("{:?}", m.tightest.factor), (m.tightest.rule as usize).to_string()]);
    row.push(m.lost_pairs.to_string());
    row.extend([d.standing, d.moved, d.near, d.boundary].into_iter().flatten().map(|count| count.to_string()));
    let s = &m.steps_measured;
    row.extend([d.changed, s.settled, s.steps].map(|count| count.to_string()));
    row.extend([format!("{:?}", s.overlaps.deepest), format!("{:?}", s.overlaps.sunk)]);
    row.extend([s.deep, s.unseen.steps, s.unseen.most_pairs].map(|count| count.to_string()));
    row.push(format!("{:?}", s.unseen.deepest));
    row.extend([s.unconverged, s.refused, s.retries].map(|count| count.to_string()));
    row.push(s.stopped.clone().unwrap_or_default());
    let lockstep = m.lockstep.as_ref();
    let counts =
        lockstep.map(|l| [l.steps, l.differ, l.found, l.contacts, l.modes, l.failed].map(|count| count.to_string()));
    row.extend(counts.unwrap_or_default());
    row.push(lockstep.and_then(|lockstep| lockstep.deepest).map(|depth| format!("{depth:?}")).unwrap_or_default());
    row.extend([evaluated.parameters.map_or(String::new(), SetParameters::text), u8::from(best).to_string()]);
    row.extend([s.explained.steps, s.explained.most_pairs].map(|count| count.to_string()));
    row.push(format!("{:?}", s.explained.deepest));
    row
}

/// Takes the candidates of a table into a search that has none. Each must be the one that the search would try.
fn restore_rows(file: &Path, table: &[u8], search: &mut Search<'_>) -> Result<(), RecordError> {
    let damaged = |number: usize, what: &str| ResultsError::damaged(file, format!("candidate {number} {what}"));
    let mut reader = csv::Reader::from_reader(BoundedRows::new(table));
    // A version with other columns measured or ranked otherwise.
    if reader.headers().map_err(|error| ResultsError::damaged(file, error))? != COLUMNS[..] {
        return Err(ResultsError::damaged(file, "its columns are those of another version of Rockproof").into());
    }
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|error| ResultsError::damaged(file, error))?;
        let next = search.candidate();
        let measurement = parsed(&record).ok_or_else(|| damaged(number, "cannot be read"))?;
        if !is_same(&record, &next) {
            return Err(damaged(number, "is not the one that this seed tries there").into());
        }
        search.add(next, measurement);
    }
    Ok(())
}

/// Whether a row is about a candidate.
fn is_same(record: &csv::StringRecord, next: &PendingCandidate) -> bool {
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
    let lockstep = match is_there("lock_steps") {
        true => Some(LockstepMeasures {
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
        tightest: RuleSlack { rule: rule(field("tightest")?)?, factor: number("slack")? },
        lost_pairs: count("lost_pairs")?,
        differences: Differences {
            standing: pair("standing")?,
            moved: pair("moved")?,
            near: pair("near")?,
            boundary: pair("boundary")?,
            changed: count("changed_contacts")?,
        },
        steps_measured: StepMeasures {
            settled: count("settled")?,
            steps: count("steps")?,
            overlaps: Overlaps { deepest: number("penetration_m")?, sunk: number("sunk_m")? },
            deep: count("steps_deep")?,
            unseen: UnseenOverlaps {
                steps: count("steps_unseen")?,
                most_pairs: count("unseen_pairs")?,
                deepest: number("unseen_m")?,
            },
            explained: UnseenOverlaps {
                steps: count("steps_explained")?,
                most_pairs: count("explained_pairs")?,
                deepest: number("explained_m")?,
            },
            unconverged: count("unconverged")?,
            refused: count("steps_refused")?,
            retries: count("retries")?,
            stopped: Some(field("stopped")?.to_owned()).filter(|text| !text.is_empty()),
        },
        lockstep,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Evaluator;
    use rockproof_bench::stepping::wall;
    use rockproof_model::{Precision, ToleranceSpec};

    #[test]
    fn a_table_of_another_version_is_not_gone_on_from() {
        let scene = wall(4).expect("a wall");
        let evaluator = Evaluator::new(&scene, Precision::F64, 1, Some(1), 0).expect("an evaluator");
        let mut search = Search::new(&evaluator, &ToleranceSpec::default(), 1).expect("a search");
        search.step().expect("measures");
        let rows: Vec<Vec<String>> = search.tried().iter().map(|one| row(0, one, true)).collect();
        let table = written(&COLUMNS, rows.clone()).expect("a table");
        let mut again = Search::new(&evaluator, &ToleranceSpec::default(), 1).expect("a search");
        restore_rows(Path::new(TABLE), &table, &mut again).expect("goes on");
        assert_eq!(again.tried(), search.tried());
        // As it was before unseen overlaps were looked for.
        let kept: Vec<usize> =
            (0..COLUMNS.len()).filter(|&at| !COLUMNS[at].contains("unseen") && COLUMNS[at] != "settled").collect();
        let names: Vec<&str> = kept.iter().map(|&at| COLUMNS[at]).collect();
        let rows = rows.iter().map(|row| kept.iter().map(|&at| row[at].clone()).collect::<Vec<_>>());
        let table = written(&names, rows).expect("a table");
        let mut none = Search::new(&evaluator, &ToleranceSpec::default(), 1).expect("a search");
        let told = restore_rows(Path::new(TABLE), &table, &mut none).expect_err("refused").to_string();
        assert!(told.starts_with("candidates.csv: its columns are those of another version of Rockproof;"), "{told}");
        assert!(none.tried().is_empty());
    }
}
