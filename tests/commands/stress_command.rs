//! Pins `campaign --stress`: what it writes, that it is a function of seed and pairs alone, and that it produces byte-identical files.

use crate::place::rockproof;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// One batch for each of the 84 cells.
pub(crate) const PAIRS: &str = "1344";

/// The directory of a run by two threads, made once, and the document that it printed.
pub(crate) fn whole() -> (PathBuf, &'static str) {
    static RUN: OnceLock<(tempfile::TempDir, String)> = OnceLock::new();
    let (dir, document) = RUN.get_or_init(|| {
        let dir = crate::place::folder();
        let (code, document, err) = run(&dir.path().join("whole"), &["--threads", "2", "--format", "json"]);
        assert_eq!(code, 0, "{err}");
        (dir, document)
    });
    (dir.path().join("whole"), document)
}

const TABLES: [&str; 3] = ["stress.csv", "limits.csv", "steps.csv"];

fn run(out: &Path, more: &[&str]) -> (i32, String, String) {
    let mut args = vec!["campaign", "--stress", "--pairs", PAIRS, "--out", out.to_str().expect("UTF-8")];
    args.extend(more);
    rockproof(&args)
}

#[test]
fn the_tables_are_those_kept_in_reports_and_do_not_depend_on_threads() {
    let dir = crate::place::folder();
    let (code, printed, err) = run(&dir.path().join("one"), &["--threads", "1"]);
    assert_eq!(code, 0, "{err}");
    for word in ["safe to", "offset", "sliver", "contrast", "limits.csv"] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
    let (two, _) = whole();
    for table in TABLES {
        let read = |folder: &Path| fs::read_to_string(folder.join(table)).expect("a table");
        let one = read(&dir.path().join("one"));
        assert_eq!(one, read(&two), "{table}");
        let kept = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/stress_quick"));
        assert_eq!(one, kept, "{table}: after a change that is meant, run reports/regenerate");
    }
}

#[test]
fn a_stress_run_goes_on_and_refuses_families() {
    let dir = crate::place::folder();
    let out = dir.path().join("run");
    let path = out.to_str().expect("UTF-8");
    let (code, _, err) = rockproof(&["campaign", "--stress", "--pairs", "96", "--out", path]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = rockproof(&["campaign", "--stress", "--pairs", "96", "--out", path]);
    assert!(code == 2 && err.contains("--resume"), "{err}");
    let (code, _, err) = rockproof(&["campaign", "--pairs", "96", "--out", path, "--resume"]);
    assert!(code == 2 && err.contains("stress"), "{err}");
    let (code, _, err) = rockproof(&["campaign", "--stress", "--pairs", "96", "--out", path, "--resume"]);
    assert_eq!(code, 0, "{err}");
    for wrong in [["--family", "sliver"], ["--tolerances", "nothing"]] {
        let mut args = vec!["campaign", "--stress", "--pairs", "96", "--out", "/nonexistent/no"];
        args.extend(wrong);
        let (code, _, err) = rockproof(&args);
        assert!(code == 2 && !err.is_empty(), "{wrong:?}: {err}");
    }
}
