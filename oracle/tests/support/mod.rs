//! What the tests of the oracle share.
#![allow(dead_code, reason = "each test binary uses its own part")]

#[path = "../../../tests/golden/golden_contacts.rs"]
pub(crate) mod golden;
pub(crate) mod golden_steps;
pub(crate) mod hand_worked;
pub(crate) mod random;
pub(crate) mod random_numbers;
pub(crate) mod shapes;
pub(crate) mod steps;

use std::path::{Path, PathBuf};

/// A file by its path from the root of the project. Two packages compile these tests (`Cargo.toml` beside them), one from a folder deeper than the other.
pub(crate) fn project_file(path: &str) -> PathBuf {
    let folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    folders.map(|folder| folder.join(path)).find(|file| file.exists()).expect("a file of the project")
}
