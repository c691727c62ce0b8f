//! Which tolerances should this model use? A search over tolerance sets for one that the engine and the oracle answer alike, that lets
//! blocks overlap least in steps, and that is far from breaking a rule (SPEC section 3).
//!
//! Candidate `n` is a function of the seed, `n`, and what was measured of the candidates before it; a measurement is a function of the
//! candidate. So a search of `n` candidates always comes to the same end: the time budget decides only how many are tried.

mod candidate;
mod cluster;
pub mod distribute;
mod evaluator;
mod given_overlaps;
mod pair_check;
mod probes;
mod record;
pub mod report;
mod rule_warnings;
mod search;
mod steps;
mod unseen_overlaps;

pub use candidate::{ModelLengths, PlaceFault, SetParameters};
pub use cluster::{Cluster, ClusterSupport, hold_lowest};
pub use evaluator::{Evaluator, Measurement, UnauditedEvaluator};
pub use probes::{Differences, Probes};
pub use record::{COLUMNS, RecordError, SearchRecord};
pub use rule_warnings::rule_warnings;
pub use search::{AbsentPreset, CandidateOrigin, EvaluatedCandidate, PendingCandidate, Search};
pub use steps::{LockstepMeasures, Overlaps, StepMeasures};
pub use unseen_overlaps::UnseenOverlaps;

use rockproof_campaign::distribute::{DistributeError, WorkerPanic};
use rockproof_model::SpecError;
use rockproof_stepper::dynamics::SetupError;

/// Why a scene cannot be tuned.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// No two blocks are near one another.
    #[error("no two blocks are near enough to be in contact; there is nothing to measure")]
    NoNeighbours,
    /// The author's tolerances, or `auto`, cannot be derived.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// The scene cannot be stepped.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A value overflows in the engine's precision.
    #[error("{what} overflows when rounded to {precision}")]
    Overflow {
        /// What overflows.
        what: String,
        /// The precision.
        precision: rockproof_model::Precision,
    },
    /// No worker threads.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A candidate cannot be measured, as the rank said that tried.
    #[error("{0}")]
    Candidate(String),
    /// A thread of this process panicked.
    #[error(transparent)]
    Panic(#[from] WorkerPanic),
    /// The processes of the search do not work together.
    #[error(transparent)]
    Distribute(#[from] DistributeError),
    /// The record cannot be used.
    #[error(transparent)]
    Record(#[from] RecordError),
}
