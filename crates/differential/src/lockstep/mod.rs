//! Stepper and oracle side by side: every step of a run in floats made exactly as well, from the same state, and compared
//! (SPEC section 6). `docs/lockstep.md` describes what comes of it.

pub mod answer;
pub mod case_file;
mod classified;
pub mod cutout;
pub mod drift;
pub mod explain;
pub mod free;
pub mod intrusion;
pub mod intrusion_case;
mod intrusion_part;
pub mod penetration;
pub mod recorded;
pub mod replay;
pub mod run;
pub mod scene;
pub mod state;
pub mod state_errors;
pub mod stepping;
pub mod table;
pub mod trajectory;
pub mod wide;

pub use answer::{StepAnswerChange, StepDecisions, StepDifference, compare};
pub use case_file::StepCase;
pub use drift::{Drift, DriftQuantity};
pub use explain::{AttributedDifference, ComparedLinks};
pub use free::FreeStepping;
pub use intrusion::{Intrusion, StepCause, WatchedStep};
pub use replay::{ReplayError, ReplayedStep};
pub use run::{ComparedStep, Lockstep, LockstepError};
pub use scene::{ExactScene, NumberOverflow};
pub use stepping::LockstepStepping;
pub use trajectory::Trajectory;
