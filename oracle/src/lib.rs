//! The oracle: which contacts two blocks have, exactly (SPEC section 4).
//!
//! Every decision is the sign of a polynomial in coordinates and tolerances. [`Pair::classify`] finds each sign at the
//! cheapest level that proves it: f64 with a static error bound, f64 balls, integers of 128 bits, integers of 256 to
//! 1,024 bits, integers on the heap. No float takes a decision that its bound does not prove. [`plain`] does the same
//! in plain rationals, to be compared with.

pub mod audit;
mod boxes;
mod classification;
pub mod combination;
mod common_area;
mod contact;
mod convex_cells;
mod f64_vector;
mod field;
mod gap;
mod interiors;
mod levels;
mod mass;
mod number;
mod own_lattice;
mod pair;
pub mod passage;
pub mod penetration;
pub mod plain;
mod planar;
mod point_in_surface;
mod predicate;
mod prepared_block;
pub mod rational;
mod rule_variant;
mod scales;
mod separation;
mod sign_cascade;
pub mod solve;
#[cfg(test)]
mod soundness;
pub mod step;
mod trace;
mod unit_bounds;
mod view;

pub use contact::{Answer, NearbyFeatures};
pub use gap::Gap;
pub use levels::LevelCounts;
pub use pair::Pair;
pub use prepared_block::PreparedBlock;
pub use rule_variant::RuleVariant;
pub use trace::{Margin, TraceEntry};
