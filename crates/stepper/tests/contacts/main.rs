//! Contact classification (SPEC section 4) in floats: hand-worked pairs, the golden pairs of an independent implementation,
//! preparation and traces, the wide scalar, and one planted mistake at a time.

#[path = "../../../../tests/golden/golden_contacts.rs"]
mod golden_contacts;
#[path = "../support/mistakes.rs"]
mod mistakes;
#[path = "../support/pairs.rs"]
mod pairs;

mod bent;
mod golden;
mod hand_worked;
mod kept;
mod nearby_features;
mod planted;
mod prepared_block;
mod traces;
mod true_exits;
mod wide;
