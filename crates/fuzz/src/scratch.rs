//! Where targets write the files that are read: a folder of each thread, in memory where the system has that.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};
use tempfile::{Builder, TempDir};

thread_local! {
    static SCRATCH: OnceCell<TempDir> = const { OnceCell::new() };
}

/// The folder of this thread.
///
/// # Panics
/// When no folder can be made.
pub(crate) fn scratch() -> PathBuf {
    SCRATCH.with(|cell| cell.get_or_init(new_folder).path().to_owned())
}

/// A new folder for temporary files, in memory where the system has that.
///
/// # Panics
/// When no folder can be made.
pub fn new_folder() -> TempDir {
    let builder = || {
        let mut builder = Builder::new();
        builder.prefix("rockproof-fuzz-");
        builder
    };
    let memory = Path::new("/dev/shm");
    let made = builder().tempdir_in(memory).or_else(|_| builder().tempdir());
    made.unwrap_or_else(|error| panic!("no folder for temporary files: {error}"))
}
