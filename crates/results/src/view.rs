//! Reading a directory of results that another process, or another machine, wrote.

use super::error::ResultsError;
use super::manifest::{Manifest, Owner};
use super::seal::{Seal, read_sealed};
use super::table::sealed_part;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::{Read, Take};
use std::path::{Path, PathBuf};

/// A directory of results, to read only. It is not locked: what is sealed stays as it is while a run goes on.
#[derive(Clone, Debug)]
pub struct View {
    path: PathBuf,
}

impl View {
    /// Looks at the directory of a command.
    ///
    /// # Errors
    /// When it has no manifest, or that of another command, or it cannot be read.
    pub fn open(dir: &Path, owner: Owner) -> Result<View, ResultsError> {
        let found = Manifest::read(dir)?.map(|manifest| manifest.owner);
        if found != Some(owner) {
            return Err(ResultsError::NotOf { dir: dir.to_owned(), owner, found });
        }
        Ok(View { path: dir.to_owned() })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads what [`Directory::write_sealed`](super::Directory::write_sealed) wrote.
    ///
    /// # Errors
    /// When it cannot be read, or is not as it was written.
    pub fn read_sealed<T: DeserializeOwned>(&self, name: &str) -> Result<T, ResultsError> {
        read_sealed(&self.file(name)?)
    }

    /// Reads a table to its end, to see that what was sealed of it is as it was written.
    ///
    /// # Errors
    /// When it is not, or it cannot be read.
    pub fn check_table(&self, name: &str, seal: &Seal) -> Result<(), ResultsError> {
        let path = self.file(name)?;
        let file = File::open(&path).map_err(ResultsError::at(&path))?;
        sealed_part(&path, file, seal).map(drop)
    }

    /// What was sealed of a table, from its beginning. It is believed: see [`View::check_table`].
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn table(&self, name: &str, seal: &Seal) -> Result<Take<File>, ResultsError> {
        let path = self.file(name)?;
        Ok(File::open(&path).map_err(ResultsError::at(&path))?.take(seal.bytes))
    }

    /// A file by its name, unless it is something that may have no end.
    fn file(&self, name: &str) -> Result<PathBuf, ResultsError> {
        let path = self.path.join(name);
        match path.exists() && !path.is_file() {
            true => Err(ResultsError::damaged(&path, "it is a folder or a device, not a file")),
            false => Ok(path),
        }
    }
}
