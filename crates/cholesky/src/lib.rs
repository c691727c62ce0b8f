//! Cholesky factors of sparse symmetric matrices whose unknowns come in small groups, those of blocks.
//!
//! [`Graph`] says which blocks are tied together, [`elimination_order`] in which order they are eliminated, [`Pattern`] where values stand;
//! [`Scalar::factor`] and [`Scalar::substitute`] solve. The same bits on any number of threads, and on all
//! processors with fused products.

mod elimination_order;
mod factor;
mod kernels;
mod pattern;
mod scalar;
mod substitution;
mod subtrees;

pub use elimination_order::{Graph, Renumbered, elimination_order};
pub use factor::{Fill, Singular};
pub use pattern::{BlockSlot, Pattern, PatternEntry};
pub use scalar::Scalar;
pub use subtrees::Threads;
