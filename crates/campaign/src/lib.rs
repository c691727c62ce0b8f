//! Campaigns: pairs of blocks made to break contact classification, run through every engine and compared with the
//! oracle (docs/concepts.md).

mod case_writer;
mod cases;
pub mod config;
pub mod diagnosis;
pub mod directed;
pub mod distribute;
pub mod engine_counts;
pub mod engines;
mod examiner;
pub mod families;
pub mod generic;
pub mod in_memory;
pub mod journal;
pub mod ladder;
pub mod merge;
pub mod pairs;
pub mod part;
mod perturbation;
pub mod proportion;
pub mod run;
pub mod shapes;
pub mod shrink;
pub mod source;
pub mod steps;
pub mod stress;
pub mod summary;
pub mod tolerance_grid;
pub mod tolerance_sets;
