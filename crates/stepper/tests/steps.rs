//! The dynamics of the stepper (SPEC section 5): the golden steps of an independent implementation, closed forms, and what a
//! state must keep.

#[path = "steps/closed_forms.rs"]
mod closed_forms;
#[path = "steps/contacts.rs"]
mod contacts;
#[path = "steps/control.rs"]
mod control;
#[path = "steps/energy.rs"]
mod energy;
#[path = "steps/friction.rs"]
mod friction;
#[path = "steps/golden.rs"]
mod golden;
#[path = "steps/loads.rs"]
mod loads;
#[path = "steps/scenes.rs"]
mod scenes;
#[path = "steps/solve.rs"]
mod solve;
#[path = "steps/strength.rs"]
mod strength;
#[path = "steps/support.rs"]
mod support;
