//! What the tests of the oracle share.
#![allow(dead_code, reason = "each test binary uses its own part")]

#[path = "../../../tests/golden/golden_contacts.rs"]
pub(crate) mod golden;
pub(crate) mod golden_steps;
pub(crate) mod handworked;
pub(crate) mod random;
pub(crate) mod random_numbers;
pub(crate) mod shapes;
pub(crate) mod steps;
