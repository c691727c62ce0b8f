//! Exact steps: the golden steps of an independent implementation, steps worked out by hand, and each way by which a decision can be proved.

#[path = "../support/mod.rs"]
mod support;

mod exact_step;
mod exact_step_bounds;
mod exact_step_friction;
mod exact_step_limits;
mod exact_step_paths;
mod exact_step_strength;
mod golden_steps;
