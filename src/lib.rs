//! Rockproof tells whether contact analysis of polyhedral blocks can be trusted.

pub use rockproof_model as model;
pub use rockproof_oracle as oracle;

pub mod campaign;
pub mod gate;
pub mod lockstep;
pub mod plot;
pub mod report;
pub mod simulate;
pub mod speed;
pub mod stepper;
pub mod stress;
pub mod tune;
