//! The mutants, as `cargo mutants --list --json` gives them.

use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::Path;

/// One mistake that cargo-mutants would plant.
#[derive(Clone, Debug, Deserialize)]
pub struct Mutant {
    /// What it is, in words: file, place, change.
    pub name: String,
    /// The file, from the root of the project.
    pub file: String,
    /// What kind of change it is.
    pub genre: Genre,
    /// What is put in.
    pub replacement: String,
    /// What is taken out.
    pub span: Span,
}

/// Kinds of changes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub enum Genre {
    /// The body of a function gives a constant.
    FnValue,
    /// Another operator between two values.
    BinaryOperator,
    /// No operator before a value.
    UnaryOperator,
    /// An arm of a match is left out.
    MatchArm,
    /// The guard of an arm is always true or never.
    MatchArmGuard,
    /// A field is left out where a base gives it.
    StructField,
}

/// From a place to another, the end not included.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
pub struct Span {
    pub start: Place,
    pub end: Place,
}

/// A place in a file; both count from 1, columns in characters.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    pub line: usize,
    pub column: usize,
}

/// Reads a list.
pub fn read(path: &Path) -> Result<Vec<Mutant>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}
