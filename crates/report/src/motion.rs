//! Runs of `simulate`, audited or not.

use super::error::ReportError;
use super::load::{name_of, read_json};
use super::rows::CsvTable;
use rockproof_simulate::kept::INTRUSIONS;
use rockproof_simulate::{AuditTotals, IntrusionRow, Totals};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A file that every run of `simulate` has and nothing else.
pub(super) const FILE: &str = "checkpoint.jsonl";

/// A run of a scene over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// The name of the directory.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// How it ended.
    pub ending: String,
    /// Sums over its steps.
    pub totals: Totals,
    /// Why blocks passed through one another or overlapped unseen, of the worst; empty where none did or nobody looked.
    pub intrusions: Vec<IntrusionRow>,
}

#[derive(Deserialize)]
struct RunFile {
    engine: String,
    ending: String,
    totals: Totals,
}

impl MotionRun {
    pub(super) fn read(dir: &Path) -> Result<MotionRun, ReportError> {
        let RunFile { engine, ending, totals } = read_json(&dir.join("run.json"))?;
        let file = dir.join(INTRUSIONS);
        let mut intrusions = Vec::new();
        if file.exists() {
            let mut rows = CsvTable::open(file, &IntrusionRow::COLUMNS)?;
            while let Some(row) = rows.next(&IntrusionRow::COLUMNS)? {
                intrusions.push(row.parsed()?);
            }
        }
        Ok(MotionRun { dir: dir.to_owned(), name: name_of(dir), engine, ending, totals, intrusions })
    }

    /// What the audit of its steps found; `None` where they were not audited.
    pub fn audit(&self) -> Option<&AuditTotals> {
        self.totals.audit.as_ref()
    }

    /// What is known of overlaps and passages, in one line.
    pub fn sentence(&self) -> String {
        match self.audit() {
            Some(audit) => audit.sentence(),
            None => "not audited (--no-audit); nobody looked for overlaps that no contact sees".to_owned(),
        }
    }
}
