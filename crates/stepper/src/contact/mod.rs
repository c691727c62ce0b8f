//! Contact classification (SPEC section 4): one file a pair of features, the same names as in the oracle.

pub(crate) mod asked;
pub mod boxes;
mod classify;
mod compiled;
pub mod contact_rules;
mod edge_edge;
mod entrance;
mod exit;
mod nearby_feature_search;
mod nearby_features;
mod pair;
pub mod prepared_block;
mod territory;
mod tolerances;
pub mod trace;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

pub use boxes::{Bounds, neighbours};
pub use classify::{ClassificationRequest, ComputedContact, classify, classify_traced, classify_with_kept};
pub use compiled::CompiledContacts;
pub use contact_rules::{ContactRules, SpecRules};
pub use nearby_features::NearbyFeatures;
pub use prepared_block::{Collapsed, PreparedBlock};
pub use tolerances::{ToleranceOverflow, Tolerances};
pub use trace::{Observer, Trace, Unobserved};
