//! Classification of pairs by both of the oracle's implementations, the fast one and the one in plain fractions: golden and hand-worked pairs,
//! random ones, ties and what lies beside them.

#[path = "../support/mod.rs"]
mod support;

mod fast_golden;
mod fast_hand_worked;
mod fast_properties;
mod grids;
mod near_ties;
mod plain_combination;
mod plain_golden;
mod plain_hand_worked;
mod plain_properties;
mod plain_rational;
mod rule_variant;
mod traces;
