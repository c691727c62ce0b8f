//! The rules of a step (SPEC section 5, docs/step.md) against closed forms and sums by hand, one subject a file; the scenes of the paper's
//! examples; energy over a thousand steps.

mod contacts;
mod control;
mod energy;
mod loads;
mod scenes;
mod solve;
mod strength;
mod support;
