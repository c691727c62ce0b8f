//! Campaigns: pairs of blocks made to break contact classification, run through every engine and compared with the
//! oracle (DESIGN, "Campaigns").

pub mod agreement;
pub mod attribution;
pub mod builtin;
pub mod case_file;
pub mod collapse;
pub mod compare;
pub mod config;
pub mod directed;
pub mod engine;
pub mod engines;
pub mod explain;
pub mod external;
pub mod families;
pub mod finding;
pub mod grid;
pub mod interval;
pub mod journal;
mod kept;
pub mod ladder;
pub mod mapped;
pub mod metamorphic;
pub mod pairs;
pub mod run;
pub mod sets;
mod shake;
pub mod shapes;
pub mod shrink;
pub mod source;
pub mod steps;
pub mod subject;
pub mod summary;
pub mod transform;
