//! Chunks as workers examine them, for the loop that writes them.

use super::coordinator::{CaseDone, ExaminedUnit, Request};
use super::message::{CaseReply, CaseState, CaseTask, FoundRows, UnitResult};
use crate::case_writer::{CaseCounts, CaseFiles, MadeFiles, each, write_cases};
use crate::cases::{CaseFile, case_request, step_case_request};
use crate::engine_counts;
use crate::examiner::{Chosen, Counts, Examiner};
use crate::journal::{CampaignProgress, NewRows};
use crate::run::{Campaign, RunError};
use crate::steps::StepFindingRow;
use rockproof_differential::engine::EngineCounts;
use rockproof_differential::row::FindingRow;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::Duration;

/// The workers, behind whoever leads them.
pub(super) struct Remote<'c> {
    campaign: &'c Campaign<'c>,
    units: Receiver<ExaminedUnit>,
    requests: Sender<Request>,
    /// What `run.json` says of the ranks.
    told: Map<String, Value>,
    messages: Messages,
    engines: RefCell<BTreeMap<String, EngineCounts>>,
    unseen: Cell<u64>,
    /// Whether replies did not come, because the run is stopped or failed.
    abandoned: Cell<bool>,
}

/// Messages of this session.
#[derive(Default)]
struct Messages {
    units: u64,
    unit_bytes: u64,
    cases: Cell<u64>,
}

/// What was found in a chunk: rows of both tables.
pub(super) struct FoundChunk {
    findings: FoundRows,
    steps: FoundRows,
}

/// A candidate with its values.
pub(super) struct DecodedCandidate<R> {
    row: R,
    task: CaseTask,
}

impl<'c> Remote<'c> {
    pub(super) fn new(
        campaign: &'c Campaign<'c>,
        progress: &CampaignProgress,
        units: Receiver<ExaminedUnit>,
        requests: Sender<Request>,
        told: Map<String, Value>,
    ) -> Remote<'c> {
        // Whoever leads the workers is not gone before the writer is.
        let _ = requests.send(Request::State(CaseState::of(progress)));
        let engines = RefCell::new(progress.engines.clone());
        Remote {
            campaign,
            units,
            requests,
            told,
            messages: Messages::default(),
            engines,
            unseen: Cell::new(0),
            abandoned: Cell::new(false),
        }
    }

    /// Findings that a pair did not show again.
    pub(super) fn unseen(&self) -> u64 {
        self.unseen.get()
    }

    fn count(&self, engines: BTreeMap<String, EngineCounts>) {
        for (name, counts) in engines {
            engine_counts::add(&mut self.engines.borrow_mut(), name, &counts);
        }
    }

    /// Has case files made. Where the run is stopped meanwhile it is abandoned.
    fn made<R>(&self, granted: &[&DecodedCandidate<R>]) -> MadeFiles {
        let mut files = vec![None; granted.len()];
        if granted.is_empty() {
            return Ok(files);
        }
        let (sender, replies) = mpsc::channel();
        let _ = self.requests.send(Request::Cases(granted.iter().map(|one| one.task.clone()).collect(), sender));
        let mut missing = granted.len();
        self.messages.cases.update(|cases| cases + missing as u64);
        for CaseDone { at, reply, engines } in replies {
            missing -= 1;
            self.count(engines);
            match reply {
                CaseReply::Made(bytes) => files[at] = Some(bytes),
                CaseReply::Impossible => {}
                CaseReply::Unseen => self.unseen.set(self.unseen.get() + 1),
                CaseReply::Failed(what) => return Err(RunError::Case(what)),
            }
        }
        self.abandoned.set(self.abandoned.get() || missing > 0);
        Ok(files)
    }
}

impl Examiner for Remote<'_> {
    type Found = FoundChunk;

    /// The state is some megabytes, and many workers do a chunk in less time than writing that takes.
    const COMMIT_AFTER: Duration = Duration::from_secs(2);

    fn examine(&mut self, pairs: Range<u64>) -> Result<Option<(Counts, FoundChunk)>, RunError> {
        let mut counts = Counts::default();
        let mut found = FoundChunk { findings: FoundRows::default(), steps: FoundRows::default() };
        let mut done = pairs.start;
        while done < pairs.end {
            let Ok(unit) = self.units.recv() else { return Ok(None) };
            let result = UnitResult::read(unit.rank, &unit.message[unit.result..])?;
            let _ = self.requests.send(Request::Taken);
            self.messages.units += 1;
            self.messages.unit_bytes += unit.message.len() as u64;
            counts.add(result.counts);
            found.findings.append(result.findings);
            found.steps.append(result.steps);
            self.count(unit.engines);
            done = unit.pairs.end;
        }
        Ok(Some((counts, found)))
    }

    fn choose(&mut self, found: FoundChunk, progress: &mut CampaignProgress) -> Chosen {
        let (campaign, remote) = (self.campaign, &*self);
        let findings: Vec<DecodedCandidate<FindingRow>> = decoded(&found.findings, false)?;
        let counts = CaseCounts { alike: &mut progress.fingerprints, of_cause: &mut progress.cases };
        let make = |granted: &[&DecodedCandidate<FindingRow>]| remote.made(granted);
        let kept = write_cases(
            &findings,
            each(|one: &DecodedCandidate<FindingRow>| case_request(&one.row)),
            campaign.case_quota(),
            counts,
            make,
        )?;
        let steps: Vec<DecodedCandidate<StepFindingRow>> = decoded(&found.steps, true)?;
        let counts = CaseCounts { alike: &mut progress.step_fingerprints, of_cause: &mut progress.step_cases };
        let make = |granted: &[&DecodedCandidate<StepFindingRow>]| remote.made(granted);
        let kept_steps = write_cases(
            &steps,
            each(|one: &DecodedCandidate<StepFindingRow>| step_case_request(&one.row)),
            campaign.step_case_quota(),
            counts,
            make,
        )?;
        if self.abandoned.get() {
            return Ok(None);
        }
        let (new, new_steps) = (named(found.findings, &kept)?, named(found.steps, &kept_steps)?);
        let new = NewRows { findings: new, steps: new_steps, no_case: Vec::new() };
        let files: Vec<CaseFile> = kept.files.into_iter().chain(kept_steps.files).collect();
        if !files.is_empty() {
            let _ = self.requests.send(Request::State(CaseState::of(progress)));
        }
        Ok(Some((new, files)))
    }

    fn engines(&self) -> BTreeMap<String, EngineCounts> {
        self.engines.borrow().clone()
    }

    fn run_notes(&self) -> Map<String, Value> {
        let Messages { units, unit_bytes, cases } = &self.messages;
        let mut told = self.told.clone();
        told.extend(
            [("units", *units), ("unit_bytes", *unit_bytes), ("cases_asked", cases.get())]
                .map(|(key, count)| (key.to_owned(), count.into())),
        );
        Map::from_iter([("distributed".to_owned(), told.into())])
    }
}

/// The candidates among some rows.
pub(super) fn decoded<R: DeserializeOwned>(
    found: &FoundRows,
    about_step: bool,
) -> Result<Vec<DecodedCandidate<R>>, RunError> {
    let one = |candidate: &super::message::Candidate| {
        let bytes = &found.bytes[candidate.bytes.clone()];
        let task = CaseTask { about_step, row: bytes.to_vec(), place: candidate.place };
        Ok(DecodedCandidate { row: row(bytes)?, task })
    };
    found.candidates.iter().map(one).collect()
}

/// The values of a row.
pub(super) fn row<R: DeserializeOwned>(bytes: &[u8]) -> Result<R, csv::Error> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
    let mut record = csv::ByteRecord::new();
    reader.read_byte_record(&mut record)?;
    record.deserialize(None)
}

/// The rows with the case files of candidates, in the order of these. The case file is the last column.
fn named(found: FoundRows, kept: &CaseFiles) -> Result<Vec<u8>, csv::Error> {
    let mut rows = Vec::with_capacity(found.bytes.len());
    let mut from = 0;
    for (candidate, name) in found.candidates.iter().zip(&kept.names) {
        let Some(name) = name else { continue };
        // Before the end of the line.
        let at = candidate.bytes.end - 1;
        rows.extend(&found.bytes[from..at]);
        let mut writer = csv::Writer::from_writer(&mut rows);
        writer.write_field(format!("cases/{name}"))?;
        writer.flush()?;
        drop(writer);
        from = at;
    }
    rows.extend(&found.bytes[from..]);
    Ok(rows)
}
