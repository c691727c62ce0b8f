//! The counts of several directories added up: of parts, finished or not, of one comparison or of several.

use super::disagreement::{DISAGREEMENT_COLUMNS, DisagreementRow};
use super::record::{ComparisonPlan, ComparisonProgress, GENERATOR, STATE, TABLE, VERSION};
use super::tally::Totals;
use rockproof_differential::row::typed_rows;
use rockproof_model::bounded_rows::BoundedRows;
use rockproof_pairs::batch::BATCH;
use rockproof_results::{Owner, ResultsError, View};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Why directories do not add up.
#[derive(Debug, thiserror::Error)]
pub enum TotalError {
    /// A directory cannot be read, or is damaged.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// Comparisons by different programs.
    #[error("{dir} and {first} are by different programs: {what}; a total is of one program's comparisons")]
    Programs {
        /// The directory.
        dir: PathBuf,
        /// The first directory.
        first: PathBuf,
        /// What differs.
        what: String,
    },
    /// The same pairs in two directories.
    #[error("{} and {} hold the same pairs: {} to {} of seed {seed}; each pair counts once", dirs[0].display(), dirs[1].display(), pairs.start, pairs.end - 1)]
    Twice {
        /// Where they are.
        dirs: [PathBuf; 2],
        /// Their seed.
        seed: u64,
        /// Their numbers.
        pairs: Range<u64>,
    },
}

/// What one directory holds.
#[derive(Clone, Debug, Serialize)]
pub struct DirectoryCount {
    /// The directory.
    pub dir: PathBuf,
    /// What it was asked to compare.
    pub plan: ComparisonPlan,
    /// Pairs of its share.
    pub pairs: u64,
    /// Those that are done.
    pub pairs_done: u64,
    /// Disagreements.
    pub disagreements: u64,
    /// Seconds of work.
    pub seconds: f64,
}

/// Disagreements that a total tells of by their rows.
pub const LISTED: usize = 10;

/// The counts of several directories.
#[derive(Clone, Debug, Serialize)]
pub struct Total {
    /// The directories, in the order in which they were named.
    pub directories: Vec<DirectoryCount>,
    /// Their counts.
    pub totals: Totals,
    /// The first disagreements; the paths of their cases lead to the files.
    pub first_disagreements: Vec<DisagreementRow>,
}

impl Total {
    /// Adds directories up. They may be those of runs under way: what is committed counts.
    ///
    /// # Errors
    /// When one is no directory of a comparison, or damaged; when two hold the same pairs, or are by different programs.
    pub fn of(dirs: &[PathBuf]) -> Result<Total, TotalError> {
        let mut total = Total { directories: Vec::new(), totals: Totals::default(), first_disagreements: Vec::new() };
        let mut first: Option<Map<String, Value>> = None;
        for dir in dirs {
            let view = View::open(dir, Owner::SelfComparison)?;
            let any: AnyVersion = view.read_sealed(STATE)?;
            let first = first.get_or_insert_with(|| any.configuration.clone());
            total.is_by_the_same(dir, &any.configuration, first)?;
            let (progress, plan) = read(&view)?;
            let room = LISTED.saturating_sub(total.first_disagreements.len());
            total.first_disagreements.extend(rows(&view, &progress, room)?);
            total.totals += &progress.totals;
            let share = plan.share();
            total.directories.push(DirectoryCount {
                dir: dir.clone(),
                plan,
                pairs: share.end - share.start,
                pairs_done: progress.pairs_done,
                disagreements: progress.totals.all().disagreements,
                seconds: progress.seconds,
            });
        }
        total.refuse_twice()?;
        Ok(total)
    }

    fn is_by_the_same(
        &self,
        dir: &Path,
        found: &Map<String, Value>,
        first: &Map<String, Value>,
    ) -> Result<(), TotalError> {
        let what = match (found.get(VERSION) == first.get(VERSION), found.get(GENERATOR) == first.get(GENERATOR)) {
            (true, true) => return Ok(()),
            (false, _) => {
                let shown = |map: &Map<String, Value>| map.get(VERSION).map_or("none".to_owned(), Value::to_string);
                format!("version {} and {}", shown(found), shown(first))
            }
            (true, false) => "they make other pairs of the same seed".to_owned(),
        };
        let first = self.directories.first().map_or_else(PathBuf::new, |count| count.dir.clone());
        Err(TotalError::Programs { dir: dir.to_owned(), first, what })
    }

    fn refuse_twice(&self) -> Result<(), TotalError> {
        let mut done: Vec<(u64, Range<u64>, &Path)> = Vec::new();
        for count in self.directories.iter().filter(|count| count.pairs_done > 0) {
            let start = count.plan.share().start;
            done.push((count.plan.seed, start..start + count.pairs_done, &count.dir));
        }
        done.sort_by_key(|(seed, pairs, _)| (*seed, pairs.start));
        // In this order, if any two overlap, some two neighbours do.
        let mut before: Option<&(u64, Range<u64>, &Path)> = None;
        for this in &done {
            let (seed, pairs, dir) = this;
            let held = before.filter(|(other, held, _)| other == seed && held.end > pairs.start);
            if let Some((_, held, other)) = held {
                let dirs = [other.to_path_buf(), dir.to_path_buf()];
                let pairs = pairs.start..pairs.end.min(held.end);
                return Err(TotalError::Twice { dirs, seed: *seed, pairs });
            }
            before = Some(this);
        }
        Ok(())
    }

    /// Pairs of all directories, and those of them that are done.
    pub fn pairs(&self) -> (u64, u64) {
        self.directories.iter().fold((0, 0), |(pairs, done), count| (pairs + count.pairs, done + count.pairs_done))
    }

    /// Seconds of work, over all directories.
    pub fn seconds(&self) -> f64 {
        self.directories.iter().map(|count| count.seconds).sum()
    }
}

/// What any version writes.
#[derive(Deserialize)]
struct AnyVersion {
    configuration: Map<String, Value>,
}

/// The state of a directory, whose table is as it was written.
fn read(view: &View) -> Result<(ComparisonProgress, ComparisonPlan), ResultsError> {
    let damaged = |what: &dyn std::fmt::Display| ResultsError::damaged(&view.path().join(STATE), what);
    let progress: ComparisonProgress = view.read_sealed(STATE)?;
    let plan = progress.plan().map_err(|error| damaged(&error))?;
    let share = plan.share();
    if progress.pairs_done > share.end - share.start || !progress.pairs_done.is_multiple_of(BATCH) {
        return Err(damaged(&format_args!("{} pairs are done of {}", progress.pairs_done, share.end - share.start)));
    }
    view.check_table(TABLE, &progress.disagreements)?;
    Ok((progress, plan))
}

/// The first rows of a directory's table, at most so many.
fn rows(view: &View, progress: &ComparisonProgress, most: usize) -> Result<Vec<DisagreementRow>, ResultsError> {
    let path = view.path().join(TABLE);
    let table = BoundedRows::new(view.table(TABLE, &progress.disagreements)?);
    let rows = typed_rows(table, &DISAGREEMENT_COLUMNS).map_err(|error| ResultsError::damaged(&path, error))?;
    let rows = rows.take(most).map(|row: Result<DisagreementRow, csv::Error>| {
        let mut row = row.map_err(|error| ResultsError::damaged(&path, error))?;
        if !row.case.is_empty() {
            row.case = view.path().join(&row.case).display().to_string();
        }
        Ok(row)
    });
    rows.collect()
}
