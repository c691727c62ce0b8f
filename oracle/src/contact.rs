//! SPEC section 4, one file per feature pair.

pub(crate) mod certified_reject;
mod classify;
mod culling;
mod edge_edge;
mod entrance;
mod exit;
mod nearby_feature_search;
mod nearby_features;
mod no_overlap;
mod territory;
mod vertex_edge;
mod vertex_face;
mod vertex_vertex;

pub use classify::Answer;
pub use nearby_features::NearbyFeatures;
