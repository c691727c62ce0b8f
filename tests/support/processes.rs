//! The program in the background: begun, waited for, told to end.
#![allow(dead_code, reason = "each test uses its part")]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// `rockproof …`, begun in this folder; what it says is read by nobody.
pub(crate) fn begin(dir: &Path, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rockproof"));
    command.current_dir(dir).args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().expect("starts")
}

/// Sends a signal: `INT`, `TERM`, `KILL`.
pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([format!("-{name}"), child.id().to_string()]).status();
    assert!(sent.is_ok_and(|status| status.success()), "{name}");
}

/// Waits until something is so, two minutes at most.
pub(crate) fn until(what: &str, mut so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !so() {
        assert!(begin.elapsed() < Duration::from_secs(120), "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}
