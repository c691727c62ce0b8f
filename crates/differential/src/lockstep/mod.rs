//! Stepper and oracle side by side: every step of a run in floats made exactly as well, from the same state, and compared
//! (SPEC section 6). `docs/lockstep.md` describes what comes of it.

pub mod answer;
pub mod beside;
pub mod case_file;
pub mod effect;
pub mod errors;
pub mod free;
pub mod intrusion;
pub mod links;
pub mod run;
pub mod scene;
pub mod state;
pub mod table;
pub mod trajectory;
pub mod wide;

pub use answer::{Answer, Change, StepDifference, compare};
pub use beside::BesideRun;
pub use case_file::StepCase;
pub use free::FreeRun;
pub use intrusion::{Intrusion, StepCause, WatchedStep};
pub use links::{Caused, Links};
pub use run::{Compared, Lockstep, LockstepError};
pub use scene::{ExactScene, Overflow};
pub use trajectory::Trajectory;
