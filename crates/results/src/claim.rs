//! What a command asks of a directory.

use super::error::ResultsError;
use super::lock::Lock;
use super::manifest::{Manifest, Owner};
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

impl Start {
    /// Refuses a directory that [`Directory::claim`](super::directory::Directory::claim) would refuse for what it holds already, so that it is told before long work and not after it. It
    /// claims nothing: what is free now may be taken by then.
    ///
    /// # Errors
    /// When it can be no directory, somebody works there, it belongs to another command, or it holds results that were not asked for.
    pub fn refuse_held(self, dir: &Path, owner: Owner) -> Result<(), ResultsError> {
        refuse_taken(dir)?;
        if !dir.is_dir() || Manifest::read(dir)?.is_none() {
            return Ok(());
        }
        let _lock = Lock::take(dir, owner)?;
        self.held(dir, owner).map(drop)
    }

    /// The manifest of what a command finds in a directory that it holds, where it may begin so.
    pub(crate) fn held(self, dir: &Path, owner: Owner) -> Result<Option<Manifest>, ResultsError> {
        let held = Manifest::read(dir)?;
        if let Some(held) = &held {
            if held.owner != owner {
                return Err(ResultsError::OtherCommand { dir: dir.to_owned(), found: held.owner, owner });
            }
            // Who was stopped before writing anything left no results; a manifest lists files before they are written.
            if self == Start::Fresh && held.files.keys().any(|name| dir.join(name).symlink_metadata().is_ok()) {
                return Err(ResultsError::Occupied { dir: dir.to_owned(), owner });
            }
        }
        Ok(held)
    }
    /// Refuses to begin anew where a file that is read is one of the results that are discarded: the user may have changed it.
    ///
    /// # Errors
    /// [`ResultsError::Input`]; those of reading the manifest.
    pub fn refuse_inputs<'p>(self, dir: &Path, inputs: impl IntoIterator<Item = &'p Path>) -> Result<(), ResultsError> {
        if self != Start::Overwrite || !dir.is_dir() {
            return Ok(());
        }
        let Some(manifest) = Manifest::read(dir)? else { return Ok(()) };
        let listed: Vec<_> = manifest.files.keys().filter_map(|name| dir.join(name).canonicalize().ok()).collect();
        let is_listed = |input: &&Path| input.canonicalize().is_ok_and(|input| listed.contains(&input));
        match inputs.into_iter().find(is_listed) {
            Some(input) => Err(ResultsError::Input { file: input.to_owned() }),
            None => Ok(()),
        }
    }
}

/// Refuses a directory whose name, or that of one that should hold it, is taken by something else.
pub(crate) fn refuse_taken(dir: &Path) -> Result<(), ResultsError> {
    let there = dir.ancestors().find(|path| path.symlink_metadata().is_ok());
    match there.filter(|path| !path.is_dir()) {
        Some(taken) => Err(ResultsError::NoDirectory { dir: dir.to_owned(), taken: taken.to_owned() }),
        None => Ok(()),
    }
}
