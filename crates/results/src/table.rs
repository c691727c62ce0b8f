//! A table that grows while a run goes on, and that a resumed run goes on with.

use super::error::ResultsError;
use super::seal::{Seal, hex};
use sha2::{Digest, Sha256};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A growing table. Rows count once they are sealed: what comes after the last seal is cut off when a run goes on.
#[derive(Debug)]
pub struct AppendedTable {
    path: PathBuf,
    file: File,
    bytes: u64,
    hash: Sha256,
}

impl AppendedTable {
    /// A new table with its first line.
    pub(crate) fn begin(path: PathBuf, header: &[u8]) -> Result<AppendedTable, ResultsError> {
        let file = File::create(&path).map_err(ResultsError::at(&path))?;
        let mut table = AppendedTable { path, file, bytes: 0, hash: Sha256::new() };
        table.append(header)?;
        Ok(table)
    }

    /// Opens a table whose beginning must be what was sealed. Nothing is changed until [`AppendedTable::cut`].
    pub(crate) fn open(path: &Path, seal: &Seal) -> Result<AppendedTable, ResultsError> {
        let file = match OpenOptions::new().read(true).write(true).open(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(ResultsError::damaged(path, "it is missing"));
            }
            opened => opened.map_err(ResultsError::at(path))?,
        };
        let (file, hash) = sealed_part(path, file, seal)?;
        Ok(AppendedTable { path: path.to_owned(), file, bytes: seal.bytes, hash })
    }

    /// Cuts off what is not sealed.
    pub(crate) fn cut(&mut self) -> Result<(), ResultsError> {
        let cut = self.file.set_len(self.bytes).and_then(|()| self.file.seek(SeekFrom::End(0)));
        cut.map(drop).map_err(ResultsError::at(&self.path))
    }

    /// Appends rows.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn append(&mut self, rows: &[u8]) -> Result<(), ResultsError> {
        self.file.write_all(rows).map_err(ResultsError::at(&self.path))?;
        self.bytes += rows.len() as u64;
        self.hash.update(rows);
        Ok(())
    }

    /// Makes all rows durable and seals them.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn seal(&self) -> Result<Seal, ResultsError> {
        self.file.sync_data().map_err(ResultsError::at(&self.path))?;
        Ok(Seal { bytes: self.bytes, sha256: hex(self.hash.clone()) })
    }
}

/// Reads what was sealed of a file, and gives the file and the hash up to there.
pub(crate) fn sealed_part(path: &Path, mut file: File, seal: &Seal) -> Result<(File, Sha256), ResultsError> {
    let at = || ResultsError::at(path);
    let length = file.metadata().map_err(at())?.len();
    if length < seal.bytes {
        let what = format!("{length} bytes long, but {} were written", seal.bytes);
        return Err(ResultsError::damaged(path, what));
    }
    let mut hash = Sha256::new();
    let (mut left, mut buffer) = (seal.bytes, vec![0; 1 << 16]);
    while left > 0 {
        let most = buffer.len().min(usize::try_from(left).unwrap_or(usize::MAX));
        file.read_exact(&mut buffer[..most]).map_err(at())?;
        hash.update(&buffer[..most]);
        left -= most as u64;
    }
    if hex(hash.clone()) != seal.sha256 {
        return Err(ResultsError::damaged(path, "its rows are not as they were written"));
    }
    Ok((file, hash))
}
