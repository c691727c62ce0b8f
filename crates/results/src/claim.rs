//! What a command asks of a directory.

use super::manifest::Owner;
use std::path::Path;

/// How to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// In a directory that holds no results of ours.
    Fresh,
    /// From the results in the directory; from the beginning if there are none.
    Resume,
    /// From the beginning, discarding our results in the directory.
    Overwrite,
}

impl Start {
    /// What `--resume` and `--overwrite` ask for; a command line allows only one of them.
    pub fn of(resume: bool, overwrite: bool) -> Start {
        match (resume, overwrite) {
            (true, _) => Start::Resume,
            (_, true) => Start::Overwrite,
            _ => Start::Fresh,
        }
    }
}

/// A claim to a directory.
#[derive(Clone, Copy, Debug)]
pub struct Claim<'c> {
    /// The directory; it is made if there is none.
    pub dir: &'c Path,
    /// The command.
    pub owner: Owner,
    /// How to begin.
    pub start: Start,
    /// The files that the command will write whatever it finds, by their path within the directory. One that is there and not ours is
    /// told before any work is done.
    pub files: &'c [&'c str],
}
