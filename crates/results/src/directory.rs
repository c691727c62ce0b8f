//! A directory of results that a command has claimed.

use super::atomic::{unfinished, write_atomically};
use super::bounded_read::has_rows;
use super::claim::{Claim, Start, refuse_taken};
use super::error::ResultsError;
use super::lock::Lock;
use super::manifest::{FileKind, MANIFEST, Manifest, Owner};
use super::seal::{Seal, read_sealed, sealed};
use super::table::AppendedTable;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A claimed directory. Nobody else writes to it until it is dropped.
#[derive(Debug)]
pub struct Directory {
    path: PathBuf,
    manifest: Manifest,
    resumes: bool,
    is_new: bool,
    lock: Lock,
}

impl Directory {
    /// Claims a directory. On [`Start::Overwrite`] what the manifest lists is discarded, and nothing else.
    ///
    /// # Errors
    /// When it can be no directory, somebody works there, it belongs to another command, it holds results that were not asked for, a file that is not ours
    /// has a name that we need, or a folder of ours is a link. Then nothing has been changed.
    pub fn claim(claim: Claim<'_>) -> Result<Directory, ResultsError> {
        let Claim { dir, owner, start, files } = claim;
        let is_new = dir.symlink_metadata().is_err();
        refuse_taken(dir)?;
        fs::create_dir_all(dir).map_err(ResultsError::at(dir))?;
        let lock = Lock::take(dir, owner)?;
        let mut held = start.held(dir, owner)?;
        if let Some(held) = held.as_mut().filter(|_| start == Start::Fresh) {
            held.files.clear();
        }
        let resumes = held.is_some() && start == Start::Resume;
        let manifest = held.unwrap_or(Manifest { owner, files: BTreeMap::new() });
        let mut directory = Directory { path: dir.to_owned(), manifest, resumes, is_new, lock };
        directory.refuse_links(directory.manifest.files.keys().map(String::as_str).chain(files.iter().copied()))?;
        directory.refuse_foreign(files.iter().copied())?;
        directory.remove_unfinished()?;
        if start == Start::Overwrite {
            directory.remove(|_| true)?;
        }
        directory.manifest.write(dir)?;
        Ok(directory)
    }

    /// Whether there are results to go on with, which was asked for.
    pub fn resumes(&self) -> bool {
        self.resumes
    }

    /// Leaves the directory as it was before it was claimed, but for results that were discarded, where nothing was written into it: one that was not there goes, unless
    /// somebody put something into it meanwhile. For a command that came to nothing, so what cannot be removed stays.
    pub fn give_up(self) {
        let Directory { path, manifest, is_new, lock, .. } = self;
        if manifest.files.is_empty() {
            let _ = fs::remove_file(path.join(MANIFEST));
        }
        drop(lock);
        if is_new {
            // Fails where it is not empty.
            let _ = fs::remove_dir(&path);
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The command that it belongs to.
    pub fn owner(&self) -> Owner {
        self.manifest.owner
    }

    /// Whether there are results to go on from `checkpoint`. Where there are results but no checkpoint, it was taken away: a run
    /// writes it before the first row of `table`. What a run left that was killed before that is discarded.
    ///
    /// # Errors
    /// When the checkpoint is missing, or what is left cannot be removed.
    pub fn is_resumable(&mut self, checkpoint: &str, table: &str) -> Result<bool, ResultsError> {
        if !self.resumes {
            return Ok(false);
        }
        if self.has(checkpoint) {
            return Ok(true);
        }
        let table = self.path.join(table);
        let has_rows = table.is_file() && has_rows(&table).map_err(ResultsError::at(&table))?;
        if has_rows || self.has("run.json") {
            return Err(ResultsError::damaged(&self.path.join(checkpoint), "it is missing"));
        }
        self.remove(|_| true)?;
        Ok(false)
    }

    /// Whether there is a file of ours by this name.
    pub fn has(&self, name: &str) -> bool {
        self.manifest.files.contains_key(name) && self.path.join(name).is_file()
    }

    /// Makes a folder for files of ours, if there is none.
    ///
    /// # Errors
    /// When it is a link, or cannot be made.
    pub fn make_folder(&self, name: &str) -> Result<(), ResultsError> {
        let folder = self.path.join(name);
        ResultsError::refuse_link(&folder)?;
        fs::create_dir_all(&folder).map_err(ResultsError::at(&folder))
    }

    /// Writes a file of ours, beside its final name first.
    ///
    /// # Errors
    /// When a file that is not ours is in the way, or it cannot be written.
    pub fn write(&mut self, name: &str, kind: FileKind, bytes: &[u8]) -> Result<(), ResultsError> {
        self.write_all([(name.to_owned(), kind, bytes)])
    }

    /// Writes many files; the manifest is written once.
    ///
    /// # Errors
    /// When a file that is not ours is in the way of any of them, or one cannot be written.
    pub fn write_all<B: AsRef<[u8]>>(
        &mut self,
        files: impl IntoIterator<Item = (String, FileKind, B)>,
    ) -> Result<(), ResultsError> {
        let files: Vec<_> = files.into_iter().collect();
        self.list(files.iter().map(|(name, kind, _)| (name.clone(), *kind)))?;
        for (name, _, bytes) in files {
            let path = self.path.join(name);
            if let Some(folder) = path.parent().filter(|folder| !folder.is_dir()) {
                fs::create_dir_all(folder).map_err(ResultsError::at(folder))?;
            }
            write_atomically(&path, bytes).map_err(ResultsError::at(&path))?;
        }
        Ok(())
    }

    /// Writes a JSON object whose last value seals the others.
    ///
    /// # Errors
    /// As [`Directory::write`].
    pub fn write_sealed(&mut self, name: &str, object: &impl Serialize) -> Result<(), ResultsError> {
        let text = serde_json::to_string(object).map_err(|e| ResultsError::at(&self.path.join(name))(e.into()))?;
        self.write(name, FileKind::Run, sealed(&text).as_bytes())
    }

    /// Reads what [`Directory::write_sealed`] wrote.
    ///
    /// # Errors
    /// When it cannot be read, or is not as it was written.
    pub fn read_sealed<T: DeserializeOwned>(&self, name: &str) -> Result<T, ResultsError> {
        read_sealed(&self.path.join(name))
    }

    /// Begins a growing table with its first line.
    ///
    /// # Errors
    /// As [`Directory::write`].
    pub fn begin_table(&mut self, name: &str, header: &[u8]) -> Result<AppendedTable, ResultsError> {
        self.list([(name.to_owned(), FileKind::Table)])?;
        AppendedTable::begin(self.path.join(name), header)
    }

    /// Opens tables to go on with what was sealed of them. What comes after it is cut off, once all of them are found to be whole.
    ///
    /// # Errors
    /// When one is damaged, or cannot be read or written.
    pub fn resume_tables<'t>(
        &self,
        tables: impl IntoIterator<Item = (&'t str, &'t Seal)>,
    ) -> Result<Vec<AppendedTable>, ResultsError> {
        let open = |(name, seal): (&str, &Seal)| AppendedTable::open(&self.path.join(name), seal);
        let mut tables: Vec<AppendedTable> = tables.into_iter().map(open).collect::<Result<_, _>>()?;
        tables.iter_mut().try_for_each(AppendedTable::cut)?;
        Ok(tables)
    }

    /// Removes those of our files that `unwanted` names.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub fn remove(&mut self, unwanted: impl Fn(&str) -> bool) -> Result<(), ResultsError> {
        let names: BTreeSet<String> = self.manifest.files.keys().filter(|name| unwanted(name)).cloned().collect();
        for name in &names {
            let file = self.path.join(name);
            match fs::remove_file(&file) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(ResultsError::at(&file)(error)),
                _ => {}
            }
        }
        if !names.is_empty() {
            self.manifest.files.retain(|name, _| !names.contains(name));
            self.manifest.write(&self.path)?;
        }
        Ok(())
    }

    /// Lists files before they are written.
    fn list(&mut self, files: impl IntoIterator<Item = (String, FileKind)>) -> Result<(), ResultsError> {
        let is_new = |name: &str| !self.manifest.files.contains_key(name);
        let new: Vec<(String, FileKind)> = files.into_iter().filter(|(name, _)| is_new(name)).collect();
        if new.is_empty() {
            return Ok(());
        }
        self.refuse_links(new.iter().map(|(name, _)| name.as_str()))?;
        self.refuse_foreign(new.iter().map(|(name, _)| name.as_str()))?;
        self.manifest.files.extend(new);
        self.manifest.write(&self.path)
    }

    /// Refuses folders of these files that are links: what is written and removed through them is elsewhere, and not ours.
    fn refuse_links<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Result<(), ResultsError> {
        let folders: BTreeSet<&Path> = names.into_iter().flat_map(|name| Path::new(name).ancestors().skip(1)).collect();
        let inside = folders.into_iter().filter(|folder| !folder.as_os_str().is_empty());
        inside.map(|folder| self.path.join(folder)).try_for_each(|folder| ResultsError::refuse_link(&folder))
    }

    fn refuse_foreign<'n>(&self, names: impl IntoIterator<Item = &'n str>) -> Result<(), ResultsError> {
        let new = names.into_iter().filter(|name| !self.manifest.files.contains_key(*name));
        match new.map(|name| self.path.join(name)).find(|file| file.symlink_metadata().is_ok()) {
            Some(file) => Err(ResultsError::Foreign { file, owner: self.manifest.owner }),
            None => Ok(()),
        }
    }

    /// Removes what a killed process left of files of ours that it was writing.
    fn remove_unfinished(&self) -> Result<(), ResultsError> {
        let folder_of = |name: &str| name.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let folders: BTreeSet<String> =
            self.manifest.files.keys().map(|name| folder_of(name)).chain([String::new()]).collect();
        for folder in folders {
            let path = self.path.join(&folder);
            if !path.is_dir() {
                continue;
            }
            for entry in fs::read_dir(&path).map_err(ResultsError::at(&path))? {
                let file = entry.map_err(ResultsError::at(&path))?.path();
                let of = file.file_name().and_then(|name| unfinished(name.to_str()?)).map(|of| format!("{folder}{of}"));
                if of.is_some_and(|of| of == MANIFEST || self.manifest.files.contains_key(&of)) {
                    fs::remove_file(&file).map_err(ResultsError::at(&file))?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
