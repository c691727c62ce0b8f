//! Campaigns: pairs of blocks made to break contact classification, run through every engine and compared with the
//! oracle (DESIGN, "Campaigns").

pub mod attribution;
pub mod collapse;
pub mod compare;
pub mod engine;
pub mod explain;
pub mod finding;
pub mod metamorphic;
pub mod subject;
pub mod transform;
