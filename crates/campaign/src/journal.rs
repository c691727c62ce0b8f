//! What a campaign leaves on disk while it runs, so that it can be killed at any moment and go on.
//!
//! After each chunk its findings are appended to `findings.csv` and made durable; then `progress.json`, which says how
//! long `findings.csv` is and holds every count, is replaced in one step. What was appended after the last such step is
//! cut off on resuming and made again, byte for byte, because it depends on seed and index alone.

use super::steps::{STEP_FINDING_COLUMNS, StepSummary};
use super::summary::Summary;
use rockproof_differential::agreement::Agreement;
use rockproof_differential::engine::Levels;
use rockproof_differential::finding::FINDING_COLUMNS;
use rockproof_model::files::write_atomically;
use rockproof_results::identity_differences;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Everything a campaign knows between two chunks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// The configuration and version of the run.
    pub configuration: Map<String, Value>,
    /// Pairs done; always whole chunks, but for the last.
    pub pairs_done: u64,
    /// Length of `findings.csv`.
    pub findings_bytes: u64,
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
    /// Length of `step_findings.csv`; 0 where no pair makes steps.
    #[serde(default)]
    pub step_findings_bytes: u64,
    /// Counts of steps.
    #[serde(default)]
    pub steps: StepSummary,
    /// Case files of steps written for each fingerprint.
    #[serde(default)]
    pub step_fingerprints: BTreeMap<String, u64>,
    /// Case files of steps written for each cause.
    #[serde(default)]
    pub step_cases: BTreeMap<String, u64>,
    /// Seconds of work so far, over all sessions.
    pub seconds: f64,
    /// How often the run was taken up again.
    pub resumed: u64,
}

/// How to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// In a directory that holds no run.
    Fresh,
    /// Where a run with the same configuration stopped; from the beginning if there is none.
    Resume,
    /// From the beginning, discarding the run in the directory.
    Force,
}

/// Why a run cannot be started, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The directory holds another run.
    #[error(
        "{dir} holds a campaign already; --resume goes on with it, --force discards it, --out DIR writes elsewhere"
    )]
    Occupied {
        /// The directory.
        dir: PathBuf,
    },
    /// The run in the directory was started otherwise.
    #[error(
        "{dir} holds a campaign with another configuration, so it cannot go on:\n  {}\nrun it as it was started, or use --force or --out DIR",
        differences.join("\n  ")
    )]
    OtherConfiguration {
        /// The directory.
        dir: PathBuf,
        /// One line for each key.
        differences: Vec<String>,
    },
    /// A file of the run is damaged.
    #[error("{file}: {what}; --force starts again")]
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
        source: io::Error,
    },
}

/// Adds the name of the file to an error.
pub(super) fn at(file: &Path) -> impl FnOnce(io::Error) -> JournalError {
    let file = file.to_owned();
    move |source| JournalError::Io { file, source }
}

/// A run on disk.
#[derive(Debug)]
pub struct Journal {
    dir: PathBuf,
    findings: File,
    /// `step_findings.csv`, where pairs make steps.
    step_findings: Option<File>,
    progress: Progress,
}

const FINDINGS: &str = "findings.csv";
const STEP_FINDINGS: &str = "step_findings.csv";
const PROGRESS: &str = "progress.json";
const CASES: &str = "cases";
const FILES: [&str; 8] = [
    FINDINGS,
    STEP_FINDINGS,
    PROGRESS,
    "summary.csv",
    "step_summary.csv",
    "agreement.csv",
    "confusion.csv",
    "run.json",
];

impl Journal {
    /// Opens the run in `dir`, or makes one.
    ///
    /// # Errors
    /// When the directory holds a run that may not be touched, or cannot be written.
    pub fn open(dir: &Path, configuration: Map<String, Value>, start: Start) -> Result<Journal, JournalError> {
        let held = FILES.iter().any(|name| dir.join(name).exists());
        match start {
            Start::Fresh if held => return Err(JournalError::Occupied { dir: dir.to_owned() }),
            Start::Resume if dir.join(PROGRESS).exists() => return Journal::resume(dir, &configuration),
            Start::Force | Start::Resume if held => discard(dir)?,
            _ => {}
        }
        fs::create_dir_all(dir.join(CASES)).map_err(at(dir))?;
        let path = dir.join(FINDINGS);
        let mut findings = File::create(&path).map_err(at(&path))?;
        let header = format!("{}\n", FINDING_COLUMNS.join(","));
        findings.write_all(header.as_bytes()).map_err(at(&path))?;
        let progress = Progress {
            configuration,
            pairs_done: 0,
            findings_bytes: 0,
            summary: Summary::default(),
            levels: Levels::default().0,
            contacts: 0,
            metamorphic_checks: 0,
            agreement: Agreement::default(),
            fingerprints: BTreeMap::new(),
            cases: BTreeMap::new(),
            step_findings_bytes: 0,
            steps: StepSummary::default(),
            step_fingerprints: BTreeMap::new(),
            step_cases: BTreeMap::new(),
            seconds: 0.0,
            resumed: 0,
        };
        let mut journal = Journal { dir: dir.to_owned(), findings, step_findings: None, progress: progress.clone() };
        journal.commit(&[], &[], Progress { findings_bytes: header.len() as u64, ..progress })?;
        Ok(journal)
    }

    fn resume(dir: &Path, configuration: &Map<String, Value>) -> Result<Journal, JournalError> {
        let path = dir.join(PROGRESS);
        let text = fs::read(&path).map_err(at(&path))?;
        let mut progress: Progress = serde_json::from_slice(&text)
            .map_err(|e| JournalError::Damaged { file: path, what: format!("not the progress of a campaign ({e})") })?;
        let differences = identity_differences(&progress.configuration, configuration);
        if !differences.is_empty() {
            return Err(JournalError::OtherConfiguration { dir: dir.to_owned(), differences });
        }
        let findings = cut(dir.join(FINDINGS), progress.findings_bytes)?;
        let step_findings = match progress.step_findings_bytes {
            0 => None,
            bytes => Some(cut(dir.join(STEP_FINDINGS), bytes)?),
        };
        progress.resumed += 1;
        Ok(Journal { dir: dir.to_owned(), findings, step_findings, progress })
    }

    /// What is done.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// The directory of the run.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The directory of the case files.
    pub fn cases_dir(&self) -> PathBuf {
        self.dir.join(CASES)
    }

    /// Begins `step_findings.csv`, if it has not begun. Until the next commit it counts for nothing.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn keep_steps(&mut self) -> Result<(), JournalError> {
        if self.step_findings.is_some() {
            return Ok(());
        }
        let path = self.dir.join(STEP_FINDINGS);
        let mut file = File::create(&path).map_err(at(&path))?;
        let header = format!("{}\n", STEP_FINDING_COLUMNS.join(","));
        file.write_all(header.as_bytes()).map_err(at(&path))?;
        self.progress.step_findings_bytes = header.len() as u64;
        self.step_findings = Some(file);
        Ok(())
    }

    /// Appends rows to `findings.csv` and `step_findings.csv` and makes `progress` the state to resume from. The lengths of both
    /// are seen to here; rows of steps are for a journal that keeps them.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn commit(&mut self, rows: &[u8], step_rows: &[u8], progress: Progress) -> Result<(), JournalError> {
        let path = self.dir.join(FINDINGS);
        self.findings.write_all(rows).map_err(at(&path))?;
        self.findings.sync_data().map_err(at(&path))?;
        let mut step_findings_bytes = progress.step_findings_bytes;
        if let Some(file) = &mut self.step_findings {
            let path = self.dir.join(STEP_FINDINGS);
            file.write_all(step_rows).map_err(at(&path))?;
            file.sync_data().map_err(at(&path))?;
            step_findings_bytes += step_rows.len() as u64;
        }
        let findings_bytes = progress.findings_bytes + rows.len() as u64;
        self.progress = Progress { findings_bytes, step_findings_bytes, ..progress };
        let text = serde_json::to_vec(&self.progress)
            .map_err(|e| JournalError::Io { file: self.dir.join(PROGRESS), source: e.into() })?;
        self.write(PROGRESS, &text)
    }

    /// Writes a file of the run beside its final name and renames it.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), JournalError> {
        let path = self.dir.join(name);
        write_atomically(&path, bytes).map_err(at(&path))
    }
}

/// Opens a table to go on with, without what was appended after the last commit.
fn cut(path: PathBuf, bytes: u64) -> Result<File, JournalError> {
    let mut file = OpenOptions::new().read(true).write(true).open(&path).map_err(at(&path))?;
    let length = file.metadata().map_err(at(&path))?.len();
    if length < bytes {
        let what = format!("{length} bytes long, but {bytes} were written");
        return Err(JournalError::Damaged { file: path, what });
    }
    file.set_len(bytes).map_err(at(&path))?;
    file.seek(SeekFrom::End(0)).map_err(at(&path))?;
    Ok(file)
}

/// Removes the files of a run, and nothing else.
fn discard(dir: &Path) -> Result<(), JournalError> {
    for name in FILES {
        let path = dir.join(name);
        if path.exists() {
            fs::remove_file(&path).map_err(at(&path))?;
        }
    }
    let cases = dir.join(CASES);
    if cases.is_dir() {
        for entry in fs::read_dir(&cases).map_err(at(&cases))? {
            let path = entry.map_err(at(&cases))?.path();
            if path.extension().is_some_and(|e| e == "toml" || e == "json") {
                fs::remove_file(&path).map_err(at(&path))?;
            }
        }
    }
    Ok(())
}
