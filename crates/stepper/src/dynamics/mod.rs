//! SPEC section 5: a step of discontinuous deformation analysis, as read in `docs/step.md`.
//!
//! [`Dynamics`] holds a scene and its state. A step finds the contacts ([`crate::contact`]), lets each continue one of the step
//! before (`transfer.rs`), and tries: `attempt.rs` is the open–close iteration at one Δt, `step.rs` cuts Δt until an attempt is good, and
//! moves the blocks (`kinematics.rs`). `contact.rs` is a contact's springs, `step_rules.rs` every comparison. Of the system of equations
//! `island.rs` finds what is solved together, `layout.rs` where its unknowns stand, `system.rs` which contact bears on which block; `assembly.rs`
//! adds up the matrix, `rockproof_cholesky` makes its factor and solves by it; `solve.rs` says so of each scalar, and holds what solves small systems;
//! `enclosed_solve.rs` solves large ones in scalars with a bound on their errors.

mod area;
mod assembly;
mod attempt;
mod block_inverse;
mod block_system;
mod closed_contacts;
mod compiled;
mod conjugate_gradients;
mod contact;
mod control;
mod decided;
pub mod displacement;
mod double_steps;
mod enclosed_solve;
mod filtered_contacts;
mod friction;
mod groups;
mod island;
mod kinematics;
mod layout;
mod material;
pub mod moments;
mod neighbour_list;
mod neighbours;
mod plane;
mod prescribed;
mod pressed_blocks;
mod products;
pub mod report;
mod setup;
pub mod solve;
pub mod state;
mod step;
pub mod step_rules;
mod step_totals;
mod system;
mod transfer;
mod two_level;
mod unchanged;
mod update;

pub use closed_contacts::ClosedContacts;
pub use decided::DecidedStep;
pub use double_steps::{DoubleDecisions, DoubleSteps};
pub(crate) use enclosed_solve::Enclosing;
pub use filtered_contacts::BlockContacts;
pub use neighbour_list::skin;
pub use prescribed::{PrescribedAttempt, PrescribedStep};
pub use pressed_blocks::{PressedBlocks, yielding_size};
pub use report::{IterationTimes, ModeChange, Retry, RetryReason, StepError, StepReport};
pub use rockproof_model::simulation::Skips;
pub use setup::{SetupError, StepLimits};
pub use solve::Solve;
pub use state::{BlockState, ContactState, Mode, State};
pub use step::{Dynamics, PhaseTimes};
pub use step_rules::{StepRules, TangentialState};
