//! Contact classification (SPEC section 4): one file a pair of features, the same names as in the oracle.

pub mod broad;
mod classify;
mod edge_edge;
mod entrance;
mod exit;
mod pair;
pub mod rules;
pub mod solid;
mod territory;
mod tolerances;
pub mod trace;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

pub use broad::{Bounds, neighbouring_pairs, neighbours};
pub use classify::{Found, Request, classify, classify_keeping, classify_observed, classify_traced};
pub use rules::{Rules, Spec};
pub use solid::{Collapsed, Solid};
pub use tolerances::{ToleranceOverflow, Tolerances};
pub use trace::{Observer, Trace, Unobserved};
