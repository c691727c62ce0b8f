//! What ranks of a campaign tell one another, after their introductions.

use super::DistributeError;
use super::ranks::{Report, encoded, taken};
use crate::examiner::Counts;
use crate::journal::CampaignProgress;
use crate::run::RunError;
use crate::steps::StepSummary;
use crate::summary::Summary;
use rockproof_differential::agreement::Agreement;
use rockproof_differential::engine::{EngineCounts, Levels};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// How many case files there are: what decides which findings may still get one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct CaseState {
    pub(super) alike: BTreeMap<String, u64>,
    pub(super) of_cause: BTreeMap<String, u64>,
    pub(super) steps_alike: BTreeMap<String, u64>,
    pub(super) steps_of_cause: BTreeMap<String, u64>,
}

impl CaseState {
    pub(super) fn of(progress: &CampaignProgress) -> CaseState {
        CaseState {
            alike: progress.fingerprints.clone(),
            of_cause: progress.cases.clone(),
            steps_alike: progress.step_fingerprints.clone(),
            steps_of_cause: progress.step_cases.clone(),
        }
    }
}

/// A case file to be made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct CaseTask {
    /// Whether the finding is about a step.
    pub(super) about_step: bool,
    /// Its row, as in the table.
    pub(super) row: Vec<u8>,
    /// How many rows of its pair are before it.
    pub(super) place: usize,
}

/// What came of a case file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum CaseReply {
    Made(Vec<u8>),
    /// It cannot be made.
    Impossible,
    /// The pair does not show the finding again.
    Unseen,
    Failed(String),
}

/// What rank 0 orders.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum CampaignOrder {
    /// How many case files there are, for units from now on.
    Cases(CaseState),
    Unit {
        number: u64,
        pairs: Range<u64>,
    },
    Case {
        number: u64,
        task: CaseTask,
    },
}

/// What a worker reports. The [`UnitResult`] follows upon a unit.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum CampaignReport {
    Unit {
        number: u64,
        /// From the first of its batches to the last.
        seconds: f64,
        findings: u64,
        engines: BTreeMap<String, EngineCounts>,
    },
    Case {
        number: u64,
        reply: CaseReply,
        engines: BTreeMap<String, EngineCounts>,
    },
}

/// A row that may get a case file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Candidate {
    /// Where it stands among the bytes of the rows, with its end of line.
    pub(super) bytes: Range<usize>,
    /// How many rows of its pair are before it.
    pub(super) place: usize,
}

/// Rows of a table, without case files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct FoundRows {
    pub(super) bytes: Vec<u8>,
    pub(super) candidates: Vec<Candidate>,
}

impl FoundRows {
    /// Appends rows of later pairs.
    pub(super) fn append(&mut self, other: FoundRows) {
        let before = self.bytes.len();
        let moved = |Candidate { bytes, place }| Candidate { bytes: bytes.start + before..bytes.end + before, place };
        self.candidates.extend(other.candidates.into_iter().map(moved));
        self.bytes.extend(other.bytes);
    }
}

/// What a unit of pairs brought.
pub(super) struct UnitResult {
    pub(super) counts: Counts,
    pub(super) findings: FoundRows,
    pub(super) steps: FoundRows,
}

/// All of it but the bytes of the rows, which follow.
#[derive(Serialize, Deserialize)]
struct UnitHead {
    summary: Summary,
    levels: [u64; Levels::NAMES.len()],
    contacts: u64,
    metamorphic_checks: u64,
    agreement: Agreement,
    steps: StepSummary,
    candidates: [Vec<Candidate>; 2],
    bytes: [usize; 2],
}

impl UnitResult {
    /// The message of a unit: a report, and this.
    pub(super) fn message(self, report: CampaignReport) -> Result<Vec<u8>, RunError> {
        let Counts { summary, levels, contacts, metamorphic_checks, agreement, steps } = self.counts;
        let head = UnitHead {
            summary,
            levels: levels.0,
            contacts,
            metamorphic_checks,
            agreement,
            steps,
            candidates: [self.findings.candidates, self.steps.candidates],
            bytes: [self.findings.bytes.len(), self.steps.bytes.len()],
        };
        let message =
            postcard::to_extend(&head, encoded(&Report::Job(report))?).map_err(DistributeError::Unwritable)?;
        Ok([message, self.findings.bytes, self.steps.bytes].concat())
    }

    /// What follows upon the report of a worker.
    pub(super) fn read(rank: usize, bytes: &[u8]) -> Result<UnitResult, DistributeError> {
        let (head, rows): (UnitHead, &[u8]) = taken(rank, bytes)?;
        let [findings, steps] = head.bytes;
        let bad = |what: &str| DistributeError::Message { rank, what: what.to_owned() };
        if findings.checked_add(steps) != Some(rows.len()) {
            return Err(bad("rows are missing or too many"));
        }
        let (findings, steps) = rows.split_at(findings);
        let [of_findings, of_steps] = head.candidates;
        let found = |bytes: &[u8], candidates: Vec<Candidate>| match candidates
            .iter()
            .all(|one| one.bytes.start < one.bytes.end && one.bytes.end <= bytes.len())
        {
            true => Ok(FoundRows { bytes: bytes.to_vec(), candidates }),
            false => Err(bad("a row is where there are none")),
        };
        Ok(UnitResult {
            findings: found(findings, of_findings)?,
            steps: found(steps, of_steps)?,
            counts: Counts {
                summary: head.summary,
                levels: Levels(head.levels),
                contacts: head.contacts,
                metamorphic_checks: head.metamorphic_checks,
                agreement: head.agreement,
                steps: head.steps,
            },
        })
    }
}
