//! Exact classification.

pub mod combination;
pub mod plain;
pub mod rational;
