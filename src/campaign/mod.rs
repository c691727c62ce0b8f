//! Campaigns: pairs of blocks made to break contact classification.

pub mod directed;
pub mod families;
pub mod ladder;
pub mod pairs;
pub mod sets;
pub mod shapes;
