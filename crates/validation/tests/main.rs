//! The tests of this crate that calculate, in one program.

mod agreement;
mod closed_forms;
mod energy;
mod mistakes;
mod self_comparison;
