//! Exact shapes: blocks on an integer lattice, rational turns, convex hulls and cuts.

pub mod catalogue;
pub mod clip;
mod round;
pub mod solid;
pub mod turn;

pub use clip::{ClipError, Cut, Plane};
pub use solid::Solid;
pub use turn::Turn;
