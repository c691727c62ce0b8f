//! A few seconds of the soak: it finds nothing wrong with the program, and does with one that loses a byte, or does not see the clock it sets.
#![cfg(target_os = "linux")]

use crate::engines::{built_example, client};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// Exit code and everything that was printed.
fn soak(program: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    // It starts this engine.
    client();
    let output = Command::new(built_example("soak")).args(arguments).env("ROCKPROOF", program).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code(), text(output.stdout) + &text(output.stderr))
}

#[test]
#[ignore = "six seconds; .ci/run runs it"]
fn a_short_soak_finds_nothing_wrong() {
    let (code, said) = soak(&assert_cmd::cargo::cargo_bin("rockproof"), &["--minutes", "0.1", "--seed", "5"]);
    assert!(code == Some(0) && said.contains("; 0 failures"), "{said}");
    assert!(!said.contains(": 0 kills") && !said.contains(" 0 comparisons"), "nothing was done: {said}");
    assert!(said.contains(" clocks (") && !said.contains("(0 told by the program)"), "no clock was set: {said}");
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn a_program_that_loses_a_byte_is_found() {
    let dir = crate::place::folder();
    let lossy = dir.path().join("lossy");
    let program = assert_cmd::cargo::cargo_bin("rockproof");
    let script = format!(
        "#!/bin/sh\n'{}' \"$@\"\ncode=$?\nfor table in out/summary.csv out/steps.csv out/tune.md; do\n  \
         case \"$*\" in *--resume*) [ -e $table ] && echo >> $table ;; esac\ndone\nexit $code\n",
        program.display()
    );
    fs::write(&lossy, script).expect("write");
    fs::set_permissions(&lossy, fs::Permissions::from_mode(0o755)).expect("a program");
    let (code, said) = soak(&lossy, &["--minutes", "0.2", "--seed", "5"]);
    assert!(code == Some(1), "{said}");
    assert!(said.contains("not the bytes of an undisturbed run") && said.contains("--seed 5 --step"), "{said}");
}

#[test]
fn a_clock_that_does_not_reach_the_program_is_found() {
    let dir = crate::place::folder();
    let own = dir.path().join("own");
    let program = assert_cmd::cargo::cargo_bin("rockproof");
    fs::write(&own, format!("#!/bin/sh\nunset LD_PRELOAD\nexec '{}' \"$@\"\n", program.display())).expect("write");
    fs::set_permissions(&own, fs::Permissions::from_mode(0o755)).expect("a program");
    let (code, said) = soak(&own, &["--minutes", "0"]);
    assert!(code == Some(1) && said.contains("the shifted clock does not reach the program"), "{said}");
}
