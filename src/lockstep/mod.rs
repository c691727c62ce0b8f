//! Stepper and oracle side by side: every step of a run in floats made exactly as well, from the same state, and compared
//! (SPEC section 6). `docs/lockstep.md` describes what comes of it.

pub mod answer;
pub mod scene;
pub mod state;
pub mod wide;

pub use answer::{Answer, Change, StepDifference, compare};
pub use scene::{ExactScene, Overflow};
