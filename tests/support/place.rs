//! A folder in which a test runs the program.
#![allow(dead_code, reason = "each test uses its part")]

use assert_cmd::Command;
use assert_cmd::cargo::cargo_bin_cmd;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

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

/// A folder that goes when the test ends, in memory where there is room: files that are made durable one by one, and thrown away, take an eighth of the
/// processor time of tests/commands on a disk, and waiting beside. What is kept for a whole test program stays behind, and is no matter for memory.
pub(crate) use rockproof_fuzz::new_folder as folder;

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
