//! SPEC section 5: a step of discontinuous deformation analysis, as read in `docs/step.md`.

pub mod report;
pub mod state;

pub use report::{Concerned, Retry, RetryReason, StepReport, Stopped};
pub use state::{BlockState, ContactState, Mode, State};
