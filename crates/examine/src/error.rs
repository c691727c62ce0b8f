//! Why a model cannot be examined.

use rockproof_model::SpecError;
use rockproof_report::error::ReportError;
use rockproof_results::ResultsError;
use rockproof_stepper::dynamics::SetupError;
use rockproof_tune::TuneError;

/// Why a model cannot be examined, or what was found not be written.
#[derive(Debug, thiserror::Error)]
pub enum ExamineError {
    /// Tolerances that cannot be derived.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// Steps that cannot begin.
    #[error("the model cannot be stepped: {0}")]
    Setup(#[from] SetupError),
    /// A number beyond all bounds.
    #[error("the state has a coordinate that is not finite")]
    NotFinite,
    /// A search for a set that cannot be made.
    #[error(transparent)]
    Tune(#[from] TuneError),
    /// No worker threads.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A directory that cannot be used, or a file in it not be written.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The page cannot be made.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A table cannot be made.
    #[error("cannot write a table: {0}")]
    Csv(#[from] csv::Error),
    /// The grid for ParaView cannot be made.
    #[error("cannot write blocks.vtu: {0}")]
    Grid(#[from] std::io::Error),
    /// The document cannot be made.
    #[error("cannot write examine.json: {0}")]
    Json(#[from] serde_json::Error),
    /// A case cannot be made.
    #[error("cannot write a case: {0}")]
    Case(#[from] toml::ser::Error),
}
