//! The file that a command is told to write: what is there already is replaced only where that is allowed.

use anyhow::Context;
use rockproof_model::files::read_text;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Whether a file may be replaced.
#[derive(clap::Args)]
pub(crate) struct OverwriteArgs {
    /// Replace the file if there is one
    #[arg(long)]
    overwrite: bool,
}

impl OverwriteArgs {
    /// Refuses a file that is there, unless `--overwrite` is given.
    pub(crate) fn allow(&self, file: &Path) -> anyhow::Result<()> {
        if !self.overwrite && is_there(file) {
            anyhow::bail!("{}: it is there already; --overwrite replaces it", file.display());
        }
        Ok(())
    }
}

/// Refuses a file that is there and not ours, as its text tells; `what` is what ours would be.
pub(crate) fn allow_ours(file: &Path, what: &str, is_ours: impl FnOnce(&str) -> bool) -> anyhow::Result<()> {
    if !is_there(file) {
        return Ok(());
    }
    let left_alone = || format!("{}: it is there already and no {what}, so it is left alone", file.display());
    let text = read_text(file).with_context(left_alone)?;
    anyhow::ensure!(is_ours(&text), left_alone());
    Ok(())
}

/// Removes a file of ours that is there, and makes its folder where there is none.
pub(crate) fn remove_ours(file: &Path, what: &str, is_ours: impl FnOnce(&str) -> bool) -> anyhow::Result<()> {
    allow_ours(file, what, is_ours)?;
    match fs::remove_file(file) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return Err(error).with_context(|| file.display().to_string());
        }
        _ => {}
    }
    let folder = file.parent().unwrap_or(file);
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())
}

/// A link that leads nowhere is there too.
fn is_there(file: &Path) -> bool {
    file.symlink_metadata().is_ok()
}

/// The file that GitHub shows beside a step, to be appended to, and its path; nothing elsewhere.
pub(crate) fn step_summary() -> anyhow::Result<Option<(PathBuf, fs::File)>> {
    let path = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()).map(PathBuf::from);
    let open = |path: PathBuf| {
        let file = fs::OpenOptions::new().append(true).create(true).open(&path);
        file.with_context(|| path.display().to_string()).map(|file| (path, file))
    };
    path.map(open).transpose()
}
