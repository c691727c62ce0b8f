//! Exact classification.
