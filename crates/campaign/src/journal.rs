//! What a campaign leaves on disk while it runs, so that it can be killed at any moment and go on.
//!
//! After each chunk its findings are appended to `findings.csv` and made durable; then `progress.json`, which seals
//! `findings.csv` and holds every count, is replaced in one step. What was appended after the last such step is
//! cut off on resuming and made again, byte for byte, because it depends on seed and index alone.

use super::part::{Machine, Part, PartProgress};
use super::steps::{STEP_FINDING_COLUMNS, StepSummary};
use super::summary::Summary;
use rockproof_differential::agreement::Agreement;
use rockproof_differential::engine::{EngineCounts, Levels};
use rockproof_differential::finding::FINDING_COLUMNS;
use rockproof_results::{
    AppendedTable, Claim, Directory, FileKind, Owner, ResultsError, Seal, Start, identity_differences,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};

/// Everything a campaign knows between two chunks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CampaignProgress {
    /// The configuration and version of the run.
    pub configuration: Map<String, Value>,
    /// Pairs done; always whole chunks, but for the last.
    pub pairs_done: u64,
    /// What `findings.csv` held then.
    pub findings: Seal,
    /// Counts of pairs and findings.
    pub summary: Summary,
    /// Signs decided by each level of the oracle.
    pub levels: [u64; Levels::NAMES.len()],
    /// Contacts in the exact answers.
    pub contacts: u64,
    /// Metamorphic checks made.
    pub metamorphic_checks: u64,
    /// How often the links of the chain agree.
    pub agreement: Agreement,
    /// Case files written for each fingerprint.
    pub fingerprints: BTreeMap<String, u64>,
    /// Case files written for each cause.
    pub cases: BTreeMap<String, u64>,
    /// What `step_findings.csv` held then; none where no pair makes steps.
    pub step_findings: Option<Seal>,
    /// Counts of steps.
    pub steps: StepSummary,
    /// Case files of steps written for each fingerprint.
    pub step_fingerprints: BTreeMap<String, u64>,
    /// Case files of steps written for each cause.
    pub step_cases: BTreeMap<String, u64>,
    /// What external engines were put through, over all sessions.
    #[serde(default)]
    pub engines: BTreeMap<String, EngineCounts>,
    /// Seconds of work so far, over all sessions.
    pub seconds: f64,
    /// How often the run was taken up again.
    pub resumed: u64,
    /// What a part keeps for the merge; none for a whole campaign.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<PartProgress>,
    /// Whether the directory is being made of parts, and is not finished.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub merging: bool,
}

/// Rows that a commit appends.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NewRows {
    /// Of `findings.csv`.
    pub findings: Vec<u8>,
    /// Of `step_findings.csv`; none where no pair makes steps.
    pub steps: Vec<u8>,
    /// Of `no_case.csv`; only a part that makes steps has any.
    pub no_case: Vec<u8>,
}

impl NewRows {
    /// Adds rows after these.
    pub(super) fn append(&mut self, other: NewRows) {
        self.findings.extend(other.findings);
        self.steps.extend(other.steps);
        self.no_case.extend(other.no_case);
    }

    /// How many bytes they are.
    pub(super) fn bytes(&self) -> usize {
        self.findings.len() + self.steps.len() + self.no_case.len()
    }
}

/// What has been looked at since the program began, for whoever shows progress while a chunk is under way. It counts ahead of [`CampaignProgress`].
#[derive(Debug, Default)]
pub struct ProgressCounts {
    /// Pairs examined, those of earlier sessions among them.
    pub pairs: AtomicU64,
    /// Findings made, likewise.
    pub findings: AtomicU64,
    /// Whether findings are being shrunk, between the pairs of one chunk and those of the next.
    pub shrinking: AtomicBool,
}

/// A run on disk.
#[derive(Debug)]
pub struct Journal {
    directory: Directory,
    findings: AppendedTable,
    /// `step_findings.csv`, where pairs make steps.
    step_findings: Option<AppendedTable>,
    /// `no_case.csv`, in a part where pairs make steps.
    no_case: Option<AppendedTable>,
    progress: CampaignProgress,
    seen: Arc<ProgressCounts>,
}

/// The key of the configuration that may grow from one session to the next.
const PAIRS: &str = "pairs";
pub(super) const FINDINGS: &str = "findings.csv";
pub(super) const STEP_FINDINGS: &str = "step_findings.csv";
/// The findings about steps that cannot have a case file: those that were tried.
pub(super) const NO_CASE: &str = "no_case.csv";
/// Its columns: the pair, and the place of the finding among those of the pair, from 0.
const NO_CASE_COLUMNS: [&str; 2] = ["index", "finding"];
pub(super) const PROGRESS: &str = "progress.json";
/// The folder of the case files.
const CASES: &str = "cases";
/// The files of every campaign, those of steps and of stress sets among them.
const FILES: [&str; 14] = [
    FINDINGS,
    STEP_FINDINGS,
    NO_CASE,
    PROGRESS,
    "summary.csv",
    "step_summary.csv",
    "agreement.csv",
    "confusion.csv",
    super::engine_counts::ENGINES,
    super::diagnosis::DIAGNOSIS,
    "run.json",
    "stress.csv",
    "limits.csv",
    "steps.csv",
];

impl Journal {
    /// Opens the campaign in `dir`, or makes one.
    ///
    /// # Errors
    /// When the directory holds something that may not be touched, or cannot be written.
    pub fn open(dir: &Path, configuration: Map<String, Value>, start: Start) -> Result<Journal, ResultsError> {
        Journal::open_for(Owner::Campaign, dir, configuration, start)
    }

    /// Opens a part of a campaign in `dir`, or makes one, on this machine.
    ///
    /// # Errors
    /// As [`Journal::open`], and when the part was begun where the first pairs are answered otherwise.
    pub fn open_part(
        dir: &Path,
        mut configuration: Map<String, Value>,
        start: Start,
        part: Part,
        machine: Machine,
    ) -> Result<Journal, ResultsError> {
        configuration.insert(Part::KEY.to_owned(), part.to_string().into());
        let mut journal = Journal::open(dir, configuration, start)?;
        let progress = &mut journal.progress;
        if let Some(known) = &progress.part {
            if known.machine.answers != machine.answers {
                let differences = vec![format!(
                    "answers to the first pairs: the run has those of {}, this program on {machine} gives others",
                    known.machine
                )];
                return Err(ResultsError::OtherIdentity { dir: dir.to_owned(), owner: Owner::Campaign, differences });
            }
            return Ok(journal);
        }
        let (fingerprints, causes) = (BTreeMap::new(), BTreeMap::new());
        progress.part = Some(PartProgress { machine, no_case: None, fingerprints, causes });
        journal.directory.write_sealed(PROGRESS, &journal.progress)?;
        Ok(journal)
    }

    /// The same for a command that runs campaigns of its own.
    ///
    /// # Errors
    /// As [`Journal::open`].
    pub fn open_for(
        owner: Owner,
        dir: &Path,
        configuration: Map<String, Value>,
        start: Start,
    ) -> Result<Journal, ResultsError> {
        let mut directory = Directory::claim(Claim { dir, owner, start, files: &FILES })?;
        if directory.is_resumable(PROGRESS, FINDINGS)? {
            return Journal::resume(directory, &configuration);
        }
        directory.make_folder(CASES)?;
        let header = format!("{}\n", FINDING_COLUMNS.join(","));
        let findings = directory.begin_table(FINDINGS, header.as_bytes())?;
        let progress = CampaignProgress {
            configuration,
            pairs_done: 0,
            findings: findings.seal()?,
            summary: Summary::default(),
            levels: Levels::default().0,
            contacts: 0,
            metamorphic_checks: 0,
            agreement: Agreement::default(),
            fingerprints: BTreeMap::new(),
            cases: BTreeMap::new(),
            step_findings: None,
            steps: StepSummary::default(),
            step_fingerprints: BTreeMap::new(),
            step_cases: BTreeMap::new(),
            engines: BTreeMap::new(),
            seconds: 0.0,
            resumed: 0,
            part: None,
            merging: false,
        };
        directory.write_sealed(PROGRESS, &progress)?;
        Ok(Journal { directory, findings, step_findings: None, no_case: None, progress, seen: Arc::default() })
    }

    fn resume(directory: Directory, configuration: &Map<String, Value>) -> Result<Journal, ResultsError> {
        let mut progress: CampaignProgress = directory.read_sealed(PROGRESS)?;
        let known = &progress.configuration;
        let pairs = |configuration: &Map<String, Value>| configuration.get(PAIRS).and_then(Value::as_u64);
        // A pair is a function of seed and index, so that a longer run begins with the shorter one. Parts of more pairs are other parts, and
        // what is being made of parts has their counts already.
        let may_grow = !configuration.contains_key(Part::KEY) && !progress.merging;
        let mut asked = configuration.clone();
        if may_grow
            && pairs(configuration).zip(pairs(known)).is_some_and(|(now, was)| now > was)
            && let Some(was) = known.get(PAIRS)
        {
            asked.insert(PAIRS.to_owned(), was.clone());
        }
        let differences = identity_differences(known, &asked);
        if !differences.is_empty() {
            let (dir, owner) = (directory.path().to_owned(), directory.owner());
            return Err(ResultsError::OtherIdentity { dir, owner, differences });
        }
        let no_case = progress.part.as_ref().and_then(|part| part.no_case.as_ref());
        let seals = [
            (FINDINGS, Some(&progress.findings)),
            (STEP_FINDINGS, progress.step_findings.as_ref()),
            (NO_CASE, no_case),
        ];
        let seals: Vec<(&str, &Seal)> = seals.into_iter().filter_map(|(name, seal)| Some((name, seal?))).collect();
        let tables = directory.resume_tables(seals.iter().copied())?;
        let mut tables: BTreeMap<&str, AppendedTable> = seals.iter().map(|(name, _)| *name).zip(tables).collect();
        let findings = tables.remove(FINDINGS);
        let findings = findings.ok_or_else(|| ResultsError::damaged(&directory.path().join(FINDINGS), "missing"))?;
        let (step_findings, no_case) = (tables.remove(STEP_FINDINGS), tables.remove(NO_CASE));
        progress.configuration.clone_from(configuration);
        progress.resumed += 1;
        let seen = ProgressCounts {
            pairs: progress.pairs_done.into(),
            findings: progress.summary.total().into(),
            shrinking: false.into(),
        };
        Ok(Journal { directory, findings, step_findings, no_case, progress, seen: Arc::new(seen) })
    }

    /// What is done.
    pub fn progress(&self) -> &CampaignProgress {
        &self.progress
    }

    /// What has been looked at, kept up to date while a campaign runs.
    pub fn seen(&self) -> Arc<ProgressCounts> {
        Arc::clone(&self.seen)
    }

    /// The directory of the run.
    pub fn dir(&self) -> &Path {
        self.directory.path()
    }

    /// The error that `progress.json` is damaged in this way.
    pub(super) fn damaged(&self, what: impl ToString) -> ResultsError {
        ResultsError::damaged(&self.dir().join(PROGRESS), what)
    }

    /// Begins `step_findings.csv`, and `no_case.csv` of a part, if they have not begun. Until the next commit it counts for nothing.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep_steps(&mut self) -> Result<(), ResultsError> {
        if self.step_findings.is_none() {
            let header = format!("{}\n", STEP_FINDING_COLUMNS.join(","));
            self.step_findings = Some(self.directory.begin_table(STEP_FINDINGS, header.as_bytes())?);
            if self.progress.part.is_some() {
                let header = format!("{}\n", NO_CASE_COLUMNS.join(","));
                self.no_case = Some(self.directory.begin_table(NO_CASE, header.as_bytes())?);
            }
        }
        Ok(())
    }

    /// Appends rows to the tables and makes `progress` the state to resume from. The seals of the tables are seen to here; rows of
    /// tables that have not begun are left out.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn commit(&mut self, rows: &NewRows, mut progress: CampaignProgress) -> Result<(), ResultsError> {
        let appended = |table: &mut AppendedTable, rows: &[u8]| {
            table.append(rows)?;
            table.seal()
        };
        progress.findings = appended(&mut self.findings, &rows.findings)?;
        progress.step_findings = self.step_findings.as_mut().map(|table| appended(table, &rows.steps)).transpose()?;
        if let Some(part) = &mut progress.part {
            part.no_case = self.no_case.as_mut().map(|table| appended(table, &rows.no_case)).transpose()?;
        }
        self.progress = progress;
        self.directory.write_sealed(PROGRESS, &self.progress)
    }

    /// Writes a table or `run.json`, beside its final name first.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), ResultsError> {
        let kind = if name.ends_with(".csv") { FileKind::Table } else { FileKind::Run };
        self.directory.write(name, kind, bytes)
    }

    /// Writes case files.
    ///
    /// # Errors
    /// When a file that is not ours is in the way, or one cannot be written.
    pub fn write_cases(&mut self, cases: Vec<(String, Vec<u8>)>) -> Result<(), ResultsError> {
        let case = |(name, bytes): (String, Vec<u8>)| (format!("{CASES}/{name}"), FileKind::Case, bytes);
        self.directory.write_all(cases.into_iter().map(case))
    }
}
