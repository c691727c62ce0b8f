//! The dynamics of the stepper (SPEC section 5): the golden steps of an independent implementation, closed forms, and what a
//! state must keep.

mod closed_forms;
mod contacts;
mod control;
mod energy;
mod friction;
mod golden;
mod loads;
mod scenes;
mod solve;
mod strength;
mod support;
