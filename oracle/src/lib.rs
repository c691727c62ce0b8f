//! Exact classification.

pub mod plain;
pub mod rational;
