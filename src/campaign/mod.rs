//! Campaigns.
pub mod families;
pub mod shapes;
