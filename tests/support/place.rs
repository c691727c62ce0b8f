//! A folder in which a test runs the program.
#![allow(dead_code, reason = "each test uses its part")]

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The folder; it goes when the test ends.
pub(crate) struct Place(tempfile::TempDir);

/// What a run of the program gave: exit code, standard output and standard error.
pub(crate) type Ran = (i32, String, String);

impl Place {
    pub(crate) fn new() -> Place {
        Place(folder())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn file(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("write");
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// `rockproof …`, run here; nothing is on its stdin.
    pub(crate) fn run(&self, args: &[&str]) -> Ran {
        self.ran(&mut cargo_bin_cmd!("rockproof"), args)
    }

    /// The same with these bytes on its stdin.
    pub(crate) fn piped(&self, stdin: &[u8], args: &[&str]) -> Ran {
        self.ran(cargo_bin_cmd!("rockproof").write_stdin(stdin), args)
    }

    /// The same on so many threads.
    pub(crate) fn on_threads(&self, threads: u8, args: &[&str]) -> Ran {
        self.ran(cargo_bin_cmd!("rockproof").env("RAYON_NUM_THREADS", threads.to_string()), args)
    }

    /// The rows of a table by the names of their columns.
    pub(crate) fn rows(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let table = csv::Reader::from_path(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        table.into_deserialize().map(|row| row.expect("a row")).collect()
    }

    fn ran(&self, command: &mut Command, args: &[&str]) -> Ran {
        ran(command.current_dir(self.0.path()).args(args))
    }
}

/// A folder that goes when the test ends: in memory where there is room, since files that are made durable one by one, and thrown away, take an
/// eighth of the processor time of tests/commands on a disk, and waiting beside. What is kept for a whole test program, and stays behind, is no matter for
/// memory. Who sets TMPDIR has them there.
pub(crate) fn folder() -> tempfile::TempDir {
    static MEMORY: OnceLock<bool> = OnceLock::new();
    let memory = *MEMORY.get_or_init(|| {
        let mounts = fs::read_to_string("/proc/mounts").unwrap_or_default();
        std::env::var_os("TMPDIR").is_none() && mounts.lines().any(is_roomy_memory)
    });
    let made = if memory { tempfile::tempdir_in(MEMORY_FOLDER) } else { tempfile::tempdir() };
    made.expect("a directory")
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

#[test]
fn folders_are_in_memory_only_where_there_is_room() {
    let mount = |options: &str| is_roomy_memory(&format!("tmpfs /dev/shm tmpfs {options} 0 0"));
    assert!(mount("rw,relatime,size=24683656k") && mount("rw,nosuid,nodev") && mount("rw,size=1048576k"));
    assert!(!mount("rw,size=65536k") && !mount("rw,noexec,size=24683656k") && !mount("ro,relatime"));
    assert!(!is_roomy_memory("/dev/vda /dev/shm ext4 rw 0 0") && !is_roomy_memory("tmpfs /tmp tmpfs rw 0 0"));
}

/// `rockproof …`, run where the tests run.
pub(crate) fn rockproof(args: &[&str]) -> Ran {
    ran(cargo_bin_cmd!("rockproof").args(args))
}

/// `rockproof …`, run in this folder.
pub(crate) fn rockproof_in(dir: &Path, args: &[&str]) -> Ran {
    ran(cargo_bin_cmd!("rockproof").current_dir(dir).args(args))
}

fn ran(command: &mut Command) -> Ran {
    let output = command.output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("a code"), text(output.stdout), text(output.stderr))
}
