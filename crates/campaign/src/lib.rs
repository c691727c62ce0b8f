//! Campaigns: pairs of blocks made to break contact classification, run through every engine and compared with the
//! oracle (DESIGN, "Campaigns").

mod cases;
pub mod config;
pub mod directed;
pub mod engine_counts;
pub mod engines;
pub mod families;
pub mod generic;
pub mod grid;
pub mod interval;
pub mod journal;
mod kept;
pub mod ladder;
pub mod merge;
pub mod pairs;
pub mod part;
pub mod run;
pub mod sets;
mod shake;
pub mod shapes;
pub mod shrink;
pub mod source;
pub mod steps;
pub mod stress;
pub mod summary;
