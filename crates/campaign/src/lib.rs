//! Campaigns: pairs of blocks made to break contact classification, run through every engine and compared with the
//! oracle (docs/concepts.md).

mod case_writer;
mod cases;
pub mod config;
pub mod diagnosis;
pub mod distribute;
pub mod engine_counts;
pub mod engines;
mod examiner;
pub mod in_memory;
pub mod journal;
pub mod merge;
pub mod part;
pub mod proportion;
pub mod run;
pub mod shrink;
pub mod source;
pub mod steps;
pub mod stress;
pub mod summary;
