//! The pairs of blocks that campaigns ask about: families made to break contact classification, tolerance sets, and what aims at
//! single decisions (docs/concepts.md).

pub mod batch;
pub mod directed;
pub mod families;
pub mod generic;
pub mod ladder;
pub mod motion;
pub mod passing;
mod perturbation;
pub mod shapes;
pub mod tolerance_grid;
pub mod tolerance_sets;
