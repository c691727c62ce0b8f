//! Overlaps of two blocks, passages between two states, and the audit of steps.

#[path = "../support/mod.rs"]
mod support;

mod audit;
mod audit_bounded;
mod benchmark_set;
mod coinciding;
mod passage;
mod penetration;
mod penetration_limits;
mod unevenness;
