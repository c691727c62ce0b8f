//! Runs of `simulate`, audited or not.

use super::error::ReportError;
use super::load::{ended, name_of, read_json};
use super::rows::CsvTable;
use super::table::{counted, grouped, short};
use rockproof_model::simulation::step_in_words;
use rockproof_model::text::escaped;
use rockproof_simulate::worst_intrusions::INTRUSIONS;
use rockproof_simulate::{AuditTotals, IntrusionRow, Totals};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A file that every run of `simulate` has and nothing else.
pub(super) const FILE: &str = "checkpoint.jsonl";

/// How a run ended that came to where it was asked to.
pub(super) const FINISHED: &str = "finished";

const NO_STEP: &str = "no step was made, so nothing is known of overlaps";

/// A run of a scene over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// The name of the directory.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// How it ended, as `run.json` has it: `finished`, or anything else.
    pub ending: String,
    /// Steps that it was asked for, if it was.
    pub steps_asked: Option<u64>,
    /// The time that it was asked for (s), if it was.
    pub time_asked_s: Option<f64>,
    /// The time that it came to (s).
    pub time_s: f64,
    /// Why it could not go on; empty where it could.
    pub reason: String,
    /// The rules that its tolerances violate, as formulas: it was run by force.
    pub violated: Vec<String>,
    /// Sums over its steps.
    pub totals: Totals,
    /// Why blocks passed through one another or overlapped unseen, of the worst; empty where none did or nobody looked.
    pub intrusions: Vec<IntrusionRow>,
}

#[derive(Deserialize)]
struct RunFile {
    engine: String,
    ending: String,
    steps_asked: Option<u64>,
    time_asked_s: Option<f64>,
    #[serde(default)]
    time_s: f64,
    stopped: Option<StoppedBy>,
    unproved: Option<String>,
    #[serde(default)]
    violated: Vec<String>,
    totals: Totals,
}

#[derive(Deserialize)]
struct StoppedBy {
    message: String,
}

impl MotionRun {
    pub(super) fn read(dir: &Path) -> Result<MotionRun, ReportError> {
        let RunFile { engine, ending, steps_asked, time_asked_s, time_s, stopped, unproved, violated, totals } =
            read_json(&ended(dir, FILE)?)?;
        let reason = stopped.map(|stopped| stopped.message).or(unproved).unwrap_or_default();
        let file = dir.join(INTRUSIONS);
        let mut intrusions = Vec::new();
        if file.exists() {
            let mut rows = CsvTable::open(file, &IntrusionRow::COLUMNS)?;
            while let Some(row) = rows.next(&IntrusionRow::COLUMNS)? {
                intrusions.push(row.parsed()?);
            }
        }
        Ok(MotionRun {
            dir: dir.to_owned(),
            name: name_of(dir),
            engine,
            ending,
            steps_asked,
            time_asked_s,
            time_s,
            reason: escaped(&reason),
            violated: violated.iter().map(|rule| escaped(rule)).collect(),
            totals,
            intrusions,
        })
    }

    /// What the audit of its steps found; `None` where they were not audited.
    pub fn audit(&self) -> Option<&AuditTotals> {
        self.totals.audit.as_ref()
    }

    /// Steps that it made, settling ones too.
    pub fn steps(&self) -> u64 {
        self.totals.steps + self.totals.settling
    }

    /// Where it ended, and why, if not where it was asked to.
    pub fn cut_short(&self) -> Option<String> {
        if self.ending == FINISHED {
            return None;
        }
        let steps = self.totals.steps;
        // Which step it is, is said before.
        let reason =
            self.reason.strip_prefix(&format!("{}: ", step_in_words(steps as i64 + 1))).unwrap_or(&self.reason);
        let reason = if reason.is_empty() { String::new() } else { format!(": {reason}") };
        // Which step could not be made, where settling ones come first, is in the reason alone.
        let next = (self.totals.settling == 0 || steps > 0).then_some(steps + 1);
        let of = match (self.steps_asked, self.time_asked_s) {
            (Some(asked), _) => format!(" of {}", grouped(asked)),
            (None, Some(asked)) => format!(", at {} of {} s", short(self.time_s), short(asked)),
            (None, None) => String::new(),
        };
        Some(match (self.ending.as_str(), next) {
            ("stopped" | "unproved", Some(next)) => format!("stopped at step {}{of}{reason}", grouped(next)),
            ("stopped" | "unproved", None) => format!("stopped while it settled{reason}"),
            ("parted", _) => format!("ended at the first difference, after {}{of} steps", grouped(steps)),
            (ending, _) => {
                let ending = escaped(ending);
                match self.steps_asked {
                    Some(_) => format!("{ending} after {}{of} steps", grouped(steps)),
                    None => format!("{ending} after {}{of}", counted(steps, "step", "steps")),
                }
            }
        })
    }

    /// What is known of overlaps and passages, in one line.
    pub fn sentence(&self) -> String {
        match self.audit() {
            Some(audit) => audit.sentence(),
            None if self.steps() == 0 => NO_STEP.to_owned(),
            None => "not audited (--no-audit); nobody looked for overlaps that no contact sees".to_owned(),
        }
    }
}
