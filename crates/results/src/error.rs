//! Why a directory of results cannot be used.

use super::manifest::{MANIFEST, Owner};
use std::io;
use std::path::{Path, PathBuf};

/// Why a directory of results cannot be claimed, taken up or written.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The directory holds results of the same command.
    #[error(
        "{dir} holds {} already; {}--overwrite discards it, --out DIR writes elsewhere",
        owner.results(),
        if owner.resumes() { "--resume goes on with it, " } else { "" }
    )]
    Occupied {
        /// The directory.
        dir: PathBuf,
        /// The command.
        owner: Owner,
    },
    /// The directory belongs to another command, or to another program of this name.
    #[error(
        "{dir} belongs to `{}`, and `{}` leaves it alone; --out DIR writes elsewhere",
        found.command(),
        owner.command()
    )]
    OtherCommand {
        /// The directory.
        dir: PathBuf,
        /// The command that owns it.
        found: Owner,
        /// The command that asks for it.
        owner: Owner,
    },
    /// There can be no such directory, since its name, or that of one that should hold it, is taken.
    #[error("{taken} is no directory, so no results can be written to {dir}; --out DIR writes elsewhere")]
    NoDirectory {
        /// The directory.
        dir: PathBuf,
        /// What has the name: a file, or a link to one or to nothing.
        taken: PathBuf,
    },
    /// The directory is to be read, and is not one of the command's.
    #[error(
        "{dir} is no directory of `{}`: {}",
        owner.command(),
        match found {
            Some(found) => format!("its manifest says `{}`", found.command()),
            None if dir.is_dir() => format!("it has no {MANIFEST}"),
            None => "there is no such directory".to_owned(),
        }
    )]
    NotOf {
        /// The directory.
        dir: PathBuf,
        /// The command whose it should be.
        owner: Owner,
        /// The command that owns it, if there is one.
        found: Option<Owner>,
    },
    /// The run in the directory was started otherwise.
    #[error(
        "{dir} holds {} that was started otherwise, so it cannot go on:\n  {}\nrun it as it was started, or use --overwrite or --out DIR",
        owner.results(),
        differences.join("\n  ")
    )]
    OtherIdentity {
        /// The directory.
        dir: PathBuf,
        /// The command.
        owner: Owner,
        /// One line for each key that differs.
        differences: Vec<String>,
    },
    /// A file that we did not write has the name of one that we would write.
    #[error("{file} is in the way: no manifest says that `{}` wrote it; move it, or use --out DIR", owner.command())]
    Foreign {
        /// The file.
        file: PathBuf,
        /// The command.
        owner: Owner,
    },
    /// The lock or a folder of ours is a symbolic link.
    #[error("{file} is a symbolic link, and what it leads to is not ours to change; remove the link, or use --out DIR")]
    Link {
        /// The link.
        file: PathBuf,
    },
    /// An input is one of the results that are to be discarded.
    #[error(
        "{file} is an input and one of the results that are discarded to begin anew; copy it to another place, or use --out DIR"
    )]
    Input {
        /// The file.
        file: PathBuf,
    },
    /// Another process works in the directory.
    #[error("{dir} is in use by {holder}; wait until that has ended, or use --out DIR")]
    InUse {
        /// The directory.
        dir: PathBuf,
        /// The process: its number, its command and since when.
        holder: String,
    },
    /// A file that a run goes on from is damaged.
    #[error("{file}: {what}; it cannot be gone on from: put back the file as it was, or start anew with --overwrite")]
    Damaged {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// The manifest is damaged, so nobody knows which files are ours.
    #[error(
        "{file}: {what}; it says which files are ours, so nothing here is touched: put it back as it was, or use --out DIR"
    )]
    Manifest {
        /// The manifest.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// A file cannot be read or written.
    #[error("{file}: {source}")]
    Io {
        /// The file.
        file: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl ResultsError {
    /// Refuses a symbolic link.
    pub(crate) fn refuse_link(file: &Path) -> Result<(), ResultsError> {
        match file.symlink_metadata() {
            Ok(metadata) if metadata.is_symlink() => Err(ResultsError::Link { file: file.to_owned() }),
            _ => Ok(()),
        }
    }

    /// Adds the name of the file to an error of the operating system.
    pub fn at(file: &Path) -> impl FnOnce(io::Error) -> ResultsError {
        let file = file.to_owned();
        move |source| ResultsError::Io { file, source }
    }

    /// A damaged file.
    pub fn damaged(file: &Path, what: impl ToString) -> ResultsError {
        ResultsError::Damaged { file: file.to_owned(), what: what.to_string() }
    }
}
