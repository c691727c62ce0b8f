//! Exact shapes: blocks on an integer lattice, rational turns, convex hulls and cuts.

pub mod catalogue;
pub mod clip;
pub mod lattice_solid;
pub mod rotation;
mod round;

pub use clip::{ClipError, ClippedPolyhedron, HalfSpace};
pub use lattice_solid::LatticeSolid;
pub use rotation::RationalRotation;
