//! The exact side against itself: every path to an answer asked about the same pairs, those of a campaign, boundary-directed ones included.
//!
//! A wrong verdict of the oracle is the worst that can happen here, for everything is measured by it. So its fast path is held against the
//! stepper in 512 bits and against the plain path in fractions, on as many pairs as there is time for: `examples/self_comparison` runs for days,
//! in parts, and goes on where it was stopped ([`record`]); [`total`] adds up what is there. The tests use [`compare`] alone.

pub mod compare;
pub mod disagreement;
pub mod paths;
pub mod record;
pub mod run;
pub mod tally;
pub mod total;
