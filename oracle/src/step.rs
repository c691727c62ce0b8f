//! One step of SPEC section 5, exactly, as `docs/step.md` reads it: every decision of the open–close iteration is proved.
//!
//! A step is calculated in f64 balls first. A mode that these do not settle is asked of balls of two f64, of 128 and 256
//! bits, then of fractions, then of 512 and 1,024 bits (`cascade`); what even these leave open is counted as undecided and
//! changes nothing. Fractions fail only where a friction force or a length in the question is irrational, or where an island that bears forces has more
//! than `cascade::EXACT_UNKNOWNS` unknowns; of other islands they know all the same.

mod answer;
mod approximate;
mod attempt;
mod attempt_solve;
mod attempt_values;
mod cascade;
mod contact;
mod decisions;
mod frame;
mod friction;
mod islands;
mod known_neighbours;
mod margin;
mod open_close_iteration;
mod prepare;
mod run;
mod state;
mod strength;
mod system;
mod transfer;
mod update;

pub use answer::{
    CertifiedStep, EnclosedStep, FailedAttempt, GapChange, IterationEnd, RetryReason, SLIPPING_SOLVES, StepAnswer,
    StepFailure, StepModel, UNCHANGED_SOLVES,
};
pub use cascade::StepLevelCounts;
pub use known_neighbours::KnownNeighbours;
pub use margin::{DecidedAttempt, ModeMargin, friction_margins, mode_margins};
pub use prepare::{known_contacts, neighbours};
pub use run::{certified_step, certified_step_with, enclosed_step, exact_step, exact_step_with, first_system};
pub use state::{BlockState, ContactMemory, KeptPrecision, Mode, State};
