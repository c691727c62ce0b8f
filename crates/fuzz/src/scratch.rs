//! Where targets write the files that are read: a folder of each thread, in memory where the system has that.

use std::cell::OnceCell;
use std::fs;
use std::path::PathBuf;
use std::sync::OnceLock;
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

/// A new folder for temporary files, in memory where the system has room there and nobody says otherwise by TMPDIR.
///
/// # Panics
/// When no folder can be made.
pub fn new_folder() -> TempDir {
    static IN_MEMORY: OnceLock<bool> = OnceLock::new();
    let in_memory = *IN_MEMORY.get_or_init(|| {
        let mounts = fs::read_to_string("/proc/mounts").unwrap_or_default();
        std::env::var_os("TMPDIR").is_none() && mounts.lines().any(is_roomy_memory)
    });
    let builder = || {
        let mut builder = Builder::new();
        builder.prefix("rockproof-");
        builder
    };
    let memory = if in_memory { builder().tempdir_in(MEMORY_FOLDER).ok() } else { None };
    let made = memory.map_or_else(|| builder().tempdir(), Ok);
    made.unwrap_or_else(|error| panic!("no folder for temporary files: {error}"))
}

const MEMORY_FOLDER: &str = "/dev/shm";

/// Whether a line of /proc/mounts is about a file system in memory of at least a GiB that starts programs: tests write some. A container has 64 MiB, and
/// starts none.
fn is_roomy_memory(line: &str) -> bool {
    let words: Vec<&str> = line.split(' ').collect();
    let [_, MEMORY_FOLDER, "tmpfs", options, ..] = words[..] else { return false };
    // Without a size it is half of the memory.
    let kib = options.split(',').find_map(|option| option.strip_prefix("size=")?.strip_suffix('k')?.parse().ok());
    kib.is_none_or(|kib: u64| kib >= 1 << 20) && !options.split(',').any(|option| ["noexec", "ro"].contains(&option))
}

#[cfg(test)]
mod tests {
    use super::is_roomy_memory;

    #[test]
    fn folders_are_in_memory_only_where_there_is_room() {
        let mount = |options: &str| is_roomy_memory(&format!("tmpfs /dev/shm tmpfs {options} 0 0"));
        assert!(mount("rw,relatime,size=24683656k") && mount("rw,nosuid,nodev") && mount("rw,size=1048576k"));
        assert!(!mount("rw,size=65536k") && !mount("rw,noexec,size=24683656k") && !mount("ro,relatime"));
        assert!(!is_roomy_memory("/dev/vda /dev/shm ext4 rw 0 0") && !is_roomy_memory("tmpfs /tmp tmpfs rw 0 0"));
    }
}
