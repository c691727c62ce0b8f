//! Files of runs that have gigabytes are refused within a bounded memory. They are sparse: they take no room on the disk.

use crate::campaigns::WITHOUT_CASES;
use std::fs::{self, File};
use std::path::Path;
use std::process::Command;

/// Runs the program with 2 GiB of address space; its exit code and what it says on stderr.
fn bounded(dir: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let script = "ulimit -v 2097152; exec \"$0\" \"$@\"";
    let program = assert_cmd::cargo::cargo_bin("rockproof");
    let output =
        Command::new("sh").current_dir(dir).args(["-c", script]).arg(program).args(arguments).output().expect("runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Makes a file of a run so large that it does not fit; what it held stays its beginning.
fn enlarge(file: &Path, gigabytes: u64) {
    File::options().write(true).open(file).expect("a file").set_len(gigabytes << 30).expect("a sparse file");
}

#[test]
fn a_row_without_end_is_refused() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for run in ["was", "run"] {
        let (code, err) = bounded(dir, &["campaign", WITHOUT_CASES, "--pairs", "64", "--threads", "1", "--out", run]);
        assert_eq!(code, Some(0), "{err}");
    }
    let table = dir.join("run/findings.csv");
    let lines = fs::read_to_string(&table).expect("findings").lines().count();
    enlarge(&table, 3);
    let text = format!("the row that begins in line {} has more than 16777216 bytes", lines + 1);
    for arguments in [&["report", "run", "--out", "page"][..], &["compare", "was", "run"]] {
        let (code, err) = bounded(dir, arguments);
        assert!(
            code == Some(2) && err.contains("findings.csv") && err.contains(&text),
            "{arguments:?}: {code:?} {err}"
        );
    }
}

#[test]
fn files_that_are_read_whole_are_refused_unread() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let run = ["campaign", WITHOUT_CASES, "--pairs", "64", "--threads", "1", "--out", "run"];
    let (code, err) = bounded(dir, &run);
    assert_eq!(code, Some(0), "{err}");
    for name in ["progress.json", "rockproof.manifest.json"] {
        enlarge(&dir.join("run").join(name), 5);
        let (code, err) = bounded(dir, &[&run[..], &["--resume"]].concat());
        let text = format!("{name}: the file has 5368709120 bytes; at most 1073741824 are read");
        assert!(code == Some(2) && err.contains(&text), "{name}: {code:?} {err}");
    }
}
