//! Pins what `report` says of runs that made no step, and of a run that is named twice.

use crate::place::rockproof;
use crate::report_command::run;

#[test]
fn where_no_step_was_made_nothing_is_said_of_overlaps() {
    let dir = tempfile::tempdir().expect("a directory");
    let out = dir.path().join("still").display().to_string();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/approaching_vertices.toml");
    let (code, said, err) = rockproof(&["simulate", scene, "--steps", "0", "--out", &out]);
    assert!(code == 0 && said.contains("no step was made") && !said.contains(" m at most"), "{said}{err}");
    let (code, said, err) = rockproof(&["report", &out, "--format", "markdown"]);
    assert!(code == 0 && said.contains("still: no step was made, so nothing is known of overlaps."), "{said}{err}");
    assert!(!said.contains("✅") && !said.contains("--no-audit"), "{said}");
}

#[cfg(unix)]
#[test]
fn a_run_that_is_named_twice_is_refused() {
    let dir = tempfile::tempdir().expect("a directory");
    let run = run().to_str().expect("text");
    let link = dir.path().join("link");
    std::os::unix::fs::symlink(run, &link).expect("a link");
    for other in [run, &format!("{run}/."), link.to_str().expect("text")] {
        let (code, out, err) = rockproof(&["report", run, other, "--format", "markdown"]);
        assert!(code == 2 && err.contains("are the same run, which would count twice"), "{other}: {out}{err}");
    }
}
