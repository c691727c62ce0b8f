//! Directories that nothing keeps a second process out of, because their file system has no locks.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Who is told.
static LISTENER: OnceLock<fn(&Path)> = OnceLock::new();
/// What was told.
static TOLD: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Has `listener` called, once a directory, for each that is claimed on a file system without locks: there nothing keeps a second process
/// out. A program says it once, at its beginning; a second listener is not heard. Without one nobody is told.
pub fn on_unprotected(listener: fn(&Path)) {
    LISTENER.get_or_init(|| listener);
}

/// Tells of a directory.
pub(crate) fn notify(dir: &Path) {
    let Some(listener) = LISTENER.get() else { return };
    if TOLD.lock().unwrap_or_else(PoisonError::into_inner).insert(dir.to_owned()) {
        listener(dir);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};

    static HEARD: AtomicU64 = AtomicU64::new(0);

    #[test]
    fn a_directory_is_told_once() {
        let dirs = [Path::new("told/a"), Path::new("told/b")];
        notify(dirs[0]);
        on_unprotected(|dir| {
            let is_ours = dir.starts_with("told");
            HEARD.fetch_add(is_ours.into(), Ordering::SeqCst);
        });
        on_unprotected(|_| panic!("a second listener"));
        for dir in [dirs[0], dirs[1], dirs[0], dirs[1]] {
            notify(dir);
        }
        assert_eq!(HEARD.load(Ordering::SeqCst), 2);
    }
}
