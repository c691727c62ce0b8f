//! SPEC section 5: a step of discontinuous deformation analysis, as read in `docs/step.md`.
//!
//! [`Dynamics`] holds a scene and its state. A step finds the contacts ([`crate::contact`]), lets each continue one of the step
//! before (`transfer.rs`), and tries: `attempt.rs` is the open–close iteration at one Δt, `engine.rs` cuts Δt until an attempt is good, and
//! moves the blocks (`kinematics.rs`). `contact.rs` is a contact's springs, `rules.rs` every comparison. Of the system of equations
//! `island.rs` finds what is solved together, `order.rs` an order of elimination, `pattern.rs` where values stand; `assembly.rs` adds up
//! the matrix, `factor.rs` makes its factor, `solve.rs` solves by it.

mod alone;
mod area;
mod assembly;
mod attempt;
mod compiled;
mod contact;
mod control;
pub mod displacement;
mod engine;
mod factor;
mod friction;
mod given;
mod island;
mod kinematics;
mod layout;
mod material;
pub mod moments;
mod neighbours;
pub mod order;
pub mod pattern;
mod plane;
mod refine;
pub mod report;
pub mod rules;
mod setup;
pub mod solve;
pub mod state;
mod summed;
mod transfer;
mod update;

pub use engine::{Dynamics, Phases};
pub use given::{Given, GivenAttempt};
pub use report::{Concerned, Retry, RetryReason, Spent, StepReport, Stopped};
pub use rules::{Slip, StepRules};
pub use setup::{Limits, SetupError};
pub use solve::Solve;
pub use state::{BlockState, ContactState, Mode, State};
