//! The dynamics of the stepper (SPEC section 5): the golden steps of an independent implementation, closed forms, and what a
//! state must keep.

#[path = "../support/step_mistakes.rs"]
mod step_mistakes;

mod closed_forms;
mod contacts;
mod control;
mod damping;
mod energy;
mod features;
mod friction;
mod golden;
mod loads;
mod planted;
mod scenes;
mod skips;
mod solve;
mod solvers;
mod strength;
mod support;
