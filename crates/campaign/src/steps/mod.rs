//! Steps in a campaign: a share of its pairs is set in motion, and stepper and oracle make the same steps from the same states
//! (`lockstep`), under every tolerance set of the pair and for every built-in engine. `docs/campaign_steps.md` describes what comes
//! of it.

pub mod case;
pub mod engine;
pub mod examine;
pub mod finding;
pub mod shrink;
pub mod summary;

pub use engine::{ComparedPairStep, StepEngine, StepperStepEngine, engines};
pub use examine::{StepExamination, examine, examine_all};
pub use finding::{STEP_FINDING_COLUMNS, StepChange, StepFinding, StepFindingRow};
pub use summary::{STEP_SUMMARY_COLUMNS, StepSummary, StepSummaryRow};
