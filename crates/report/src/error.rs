//! What can be wrong with the results a report is made of.

use std::io;
use std::path::{Path, PathBuf};

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The directory holds nothing a report is made of.
    #[error(
        "{dir}: {found}; expected the directory of a campaign (run.json, findings.csv, agreement.csv, confusion.csv), of a lockstep run (lockstep.csv), of a run of simulate (run.json, checkpoint.jsonl), of a stress set (stress.csv), or of bench --error (bench.csv)"
    )]
    NoRun {
        /// The directory.
        dir: PathBuf,
        /// What is there instead.
        found: String,
    },
    /// A run of exact steps alone.
    #[error(
        "{dir}: a run of simulate --engine exact, of which there is no report: its steps are the truth and are audited by nobody; trajectory.csv and measured.csv hold them, and simulate --lockstep compares the stepper's steps with exact ones"
    )]
    ExactRun {
        /// The directory.
        dir: PathBuf,
    },
    /// A run named twice.
    #[error("{} and {} are the same run, which would count twice", dirs[0].display(), dirs[1].display())]
    Twice {
        /// The directories as given.
        dirs: [PathBuf; 2],
    },
    /// Runs of one campaign that have pairs in common.
    #[error(
        "{} and {} are runs of one campaign (the same seed and settings) and share pairs from {} to {}, which would count twice: name runs without common pairs, or one of these alone; rockproof compare shows what changed from one to the other", dirs[0].display(), dirs[1].display(), shared[0], shared[1]
    )]
    Shared {
        /// The directories as given.
        dirs: [PathBuf; 2],
        /// The numbers of the first and the last pair that both have.
        shared: [u64; 2],
    },
    /// Runs of one campaign of which neither has all pairs of the other, which can be compared neither pair by pair nor as independent ones.
    #[error(
        "{} and {} are runs of one campaign (the same seed and settings) that share pairs from {} to {} and have others each alone; of such runs one must have all pairs of the other to be compared", dirs[0].display(), dirs[1].display(), shared[0], shared[1]
    )]
    Overlap {
        /// The directories as given.
        dirs: [PathBuf; 2],
        /// The numbers of the first and the last pair that both have.
        shared: [u64; 2],
    },
    /// A campaign, or a run of steps, that is not at its end.
    #[error(
        "{dir}: there is no run.json, which is written at the end: it was killed, or still runs; finish it with --resume"
    )]
    NotWritten {
        /// The directory.
        dir: PathBuf,
    },
    /// A line of a file that says something it cannot.
    #[error("{file}: line {line}: {found}; expected {expected}")]
    Damaged {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// Files of a run that contradict each other.
    #[error("{file}: {found}; {other}")]
    Contradiction {
        /// The file.
        file: PathBuf,
        /// What it holds.
        found: String,
        /// What other files say.
        other: String,
    },
    /// A run of another version.
    #[error(
        "{file}: line {line}: the run was made by rockproof {found}, this is {ours}; run it again, or report on it with that version"
    )]
    Version {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: u64,
        /// The version that made the run.
        found: String,
        /// The version of this program.
        ours: &'static str,
    },
    /// A run to be compared that did not end.
    #[error("{dir}: the run is not finished ({pairs} pairs are done); finish it with --resume, or merge all its parts")]
    Unfinished {
        /// The directory.
        dir: PathBuf,
        /// Pairs done.
        pairs: u64,
    },
    /// The tables of a campaign that cannot be counted.
    #[error(transparent)]
    Tally(#[from] rockproof_gate::tally::TallyError),
    /// A case of the run that is none.
    #[error(transparent)]
    Case(#[from] rockproof_differential::case_file::CaseError),
    /// A file cannot be read or written.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Findings that are none of the results that they stand among.
    #[error(
        "{file}: the results here are of {}, and this is none of their files ({}): move it elsewhere",
        owner.command(), rockproof_results::MANIFEST
    )]
    Foreign {
        /// The file.
        file: PathBuf,
        /// Whose results these are.
        owner: rockproof_results::Owner,
    },
    /// The output directory cannot be used.
    #[error(transparent)]
    Results(#[from] rockproof_results::ResultsError),
    /// The page cannot be made.
    #[error("cannot write the page: {0}")]
    Page(#[from] minijinja::Error),
    /// The picture of a chart cannot be made.
    #[error("cannot draw a chart: {0}")]
    Drawing(io::Error),
    /// A table cannot be made.
    #[error("cannot write a table: {0}")]
    Csv(#[from] csv::Error),
}

/// Adds the name of the file to an error.
pub(super) fn at(file: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let file = file.to_owned();
    move |source| ReportError::Io { file, source }
}
