//! Rockproof for C and C++: blocks, exact and floating-point classification, separation, penetration, and the rules on tolerances.
//!
//! `include/rockproof.h` is made from `exports.rs`, where every function stands; docs/c.md says how to build and use it. This crate converts
//! arguments and answers and decides nothing.
//!
//! Handles that go out are `Option<Box<…>>` and come back as `Option<&…>`, which C sees as pointers that may be null, so no pointer to a
//! handle is followed by hand. What is left of `unsafe` are arrays and texts from C (`boundary.rs`) and the names exported.

mod block;
mod boundary;
mod check;
mod contacts;
mod distance;
mod exports;
mod tolerances;

pub use block::{Block, Edge, Model, Point};
pub use check::Check;
pub use contacts::{Contact, ContactKind, Contacts, EntranceKind};
pub use distance::Distance;
pub use exports::*;
pub use tolerances::Tolerances;
