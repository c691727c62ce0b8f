//! How far the floats can be trusted: pairs of blocks made more extreme in one way at a time, level by level, until an engine and the
//! oracle part. The answer is a table an engineer can use: agreement down to this size, out to that distance.
//!
//! Pairs go through an ordinary campaign ([`StressSource`]), so that a run is seeded, resumable and replayable like any other;
//! [`table`] counts pairs instead of findings. What steps do at rest and with stiff neighbours beside soft ones has closed forms, and is
//! measured in [`steps`].

mod axis;
mod pairs;
mod scenes;
mod source;
pub mod steps;
pub mod table;

pub use axis::{CellKey, PairAlignment, StressAxis, StressLevel, cells};
pub use source::{PAIRS_PER_CELL, StressSource};
