//! What external engines were put through, over all sessions of a run and all parts of a campaign.

use rockproof_differential::answer_detail::{AnswerDetail, StateDetail};
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::engine::EngineCounts;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The table of what external engines were put through; only where there are any.
pub const ENGINES: &str = "engines.csv";

/// A row of it; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EngineRow {
    /// The engine.
    pub engine: String,
    /// Questions asked.
    pub asked: u64,
    /// Processes started.
    pub processes_started: u64,
    /// Failures that a fresh process did not repeat.
    pub recovered: u64,
    /// Answers that nothing exact stands against.
    pub not_compared: u64,
    /// What the first failures were that a fresh process did not repeat, with ` | ` between them; empty in tables of earlier versions too.
    #[serde(default)]
    pub first_failures: String,
    /// Contacts in its answers; 0 in tables of earlier versions too.
    #[serde(default)]
    pub contacts: u64,
    /// Those of them with an entrance and the sign of the gap.
    #[serde(default)]
    pub entrances: u64,
    /// Those of them with `gap_m`.
    #[serde(default)]
    pub gap_m: u64,
    /// Answers that blocks are apart; this and all behind it are 0 in tables of earlier versions.
    #[serde(default)]
    pub apart: u64,
    /// Those of them with `gap_m`.
    #[serde(default)]
    pub apart_gaps: u64,
    /// Those of them with `normal`.
    #[serde(default)]
    pub apart_normals: u64,
    /// Answers that blocks touch.
    #[serde(default)]
    pub touching: u64,
    /// Those of them with `gap_m`.
    #[serde(default)]
    pub touching_gaps: u64,
    /// Those of them with `normal`.
    #[serde(default)]
    pub touching_normals: u64,
    /// Answers that blocks overlap.
    #[serde(default)]
    pub overlapping: u64,
    /// Those of them with `gap_m`.
    #[serde(default)]
    pub overlapping_gaps: u64,
    /// Those of them with `normal`.
    #[serde(default)]
    pub overlapping_normals: u64,
    /// Answers that named contacts, or that there are none.
    #[serde(default)]
    pub contact_answers: u64,
}

impl EngineRow {
    /// How much the engine said in its answers.
    pub fn detail(&self) -> AnswerDetail {
        let EngineRow { contacts, entrances, gap_m, contact_answers, .. } = *self;
        let state = |answers, gaps, normals| StateDetail { answers, gaps, normals };
        AnswerDetail {
            contacts,
            entrances,
            gap_m,
            contact_answers,
            apart: state(self.apart, self.apart_gaps, self.apart_normals),
            touching: state(self.touching, self.touching_gaps, self.touching_normals),
            overlapping: state(self.overlapping, self.overlapping_gaps, self.overlapping_normals),
        }
    }
}

/// What stands between two failures in a row.
const BETWEEN_FAILURES: &str = " | ";

/// The columns that every `engines.csv` has; `first_failures` and all behind it came after these.
pub const ENGINE_COLUMNS: [&str; 5] = ["engine", "asked", "processes_started", "recovered", "not_compared"];

/// The counts of earlier sessions or of parts, and those that the engines of a panel had when this session began.
pub(super) struct EngineSums {
    before: BTreeMap<String, EngineCounts>,
    at_start: BTreeMap<String, EngineCounts>,
}

impl EngineSums {
    /// Begins a session after what was counted before.
    pub(super) fn begin(panel: &EnginePanel, before: &BTreeMap<String, EngineCounts>) -> EngineSums {
        EngineSums { before: before.clone(), at_start: counts(panel) }
    }

    /// The sums of what was counted before and in this session.
    pub(super) fn totals(&self, panel: &EnginePanel) -> BTreeMap<String, EngineCounts> {
        let mut sums = self.before.clone();
        for (name, now) in counts(panel) {
            let since = self.at_start.get(&name).map_or_else(|| now.clone(), |start| now.since(start));
            add(&mut sums, name, &since);
        }
        sums
    }
}

/// Tells what engines were put through since it was asked last.
pub(super) struct EngineMeter<'p> {
    panel: &'p EnginePanel,
    told: Mutex<BTreeMap<String, EngineCounts>>,
}

impl<'p> EngineMeter<'p> {
    pub(super) fn new(panel: &'p EnginePanel) -> EngineMeter<'p> {
        EngineMeter { panel, told: Mutex::new(counts(panel)) }
    }

    pub(super) fn since_last(&self) -> BTreeMap<String, EngineCounts> {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let now = counts(self.panel);
        let before = std::mem::replace(&mut *told, now.clone());
        now.into_iter()
            .map(|(name, now)| {
                let since = before.get(&name).map_or_else(|| now.clone(), |before| now.since(before));
                (name, since)
            })
            .collect()
    }
}

/// Adds the counts of an engine.
pub(super) fn add(sums: &mut BTreeMap<String, EngineCounts>, name: String, counts: &EngineCounts) {
    let sum = sums.entry(name).or_default();
    *sum = sum.plus(counts);
}

/// Since the program began.
fn counts(panel: &EnginePanel) -> BTreeMap<String, EngineCounts> {
    panel.engines.iter().filter_map(|engine| Some((engine.name().to_owned(), engine.counts()?))).collect()
}

/// `engines.csv`: a row for each external engine.
pub(super) fn to_csv(engines: &BTreeMap<String, EngineCounts>) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (name, counts) in engines {
        let EngineCounts { asked, processes_started, recovered, not_compared, first_failures, detail, .. } = counts;
        let AnswerDetail { contacts, entrances, gap_m, contact_answers, apart, touching, overlapping } = *detail;
        writer.serialize(EngineRow {
            engine: name.clone(),
            asked: *asked,
            processes_started: *processes_started,
            recovered: *recovered,
            not_compared: *not_compared,
            first_failures: first_failures.join(BETWEEN_FAILURES),
            contacts,
            entrances,
            gap_m,
            apart: apart.answers,
            apart_gaps: apart.gaps,
            apart_normals: apart.normals,
            touching: touching.answers,
            touching_gaps: touching.gaps,
            touching_normals: touching.normals,
            overlapping: overlapping.answers,
            overlapping_gaps: overlapping.gaps,
            overlapping_normals: overlapping.normals,
            contact_answers,
        })?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}
