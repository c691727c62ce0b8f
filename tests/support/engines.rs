//! The example engines, for tests that run them as programs.
#![allow(dead_code, reason = "each test uses its part")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The Rust client.
pub(crate) fn client() -> String {
    built_example("engine_client")
}

/// An example as a program, built by `cargo test`, or now if only one test was built.
pub(crate) fn built_example(name: &str) -> String {
    let mut folder = std::env::current_exe().expect("a test");
    folder.pop();
    folder.pop();
    let path = folder.join("examples").join(name);
    if !path.exists() {
        let profile: &[&str] = if cfg!(debug_assertions) { &[] } else { &["--release"] };
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--example", name])
            .args(profile)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .status();
        assert!(built.is_ok_and(|status| status.success()), "the example {name} cannot be built");
    }
    path.to_string_lossy().into_owned()
}

/// The C++ client, built once as docs/engines.md says, warnings being errors, sums in the order written; `None` where there is no
/// compiler.
pub(crate) fn cpp_client() -> Option<String> {
    static CLIENT: OnceLock<Option<tempfile::TempDir>> = OnceLock::new();
    let dir = CLIENT.get_or_init(|| {
        let dir = tempfile::tempdir().expect("a directory");
        built_with_cpp(&example("client.cpp"), dir.path()).then_some(dir)
    });
    dir.as_ref().map(|dir| dir.path().join("client").to_string_lossy().into_owned())
}

/// The C++ client with one text in its source replaced by another, built in a directory; `None` as above.
pub(crate) fn changed_cpp_client(dir: &Path, text: &str, by: &str) -> Option<String> {
    let source = std::fs::read_to_string(example("client.cpp")).expect("the client");
    assert!(source.contains(text), "{text}");
    std::fs::create_dir_all(dir).expect("a directory");
    std::fs::write(dir.join("client.cpp"), source.replace(text, by)).expect("write");
    built_with_cpp(&dir.join("client.cpp"), dir).then(|| dir.join("client").to_string_lossy().into_owned())
}

fn built_with_cpp(source: &Path, dir: &Path) -> bool {
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    if !there(&compiler) {
        skipped(&format!("there is no {compiler} to build examples/engines/client.cpp with"));
        return false;
    }
    let built = Command::new(compiler)
        .args(["-std=c++17", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off", "-o", "client"])
        .arg(source)
        .current_dir(dir)
        .output()
        .expect("runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    true
}

/// A file under examples/engines.
pub(crate) fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("examples/engines").join(name)
}

/// Whether a program is there.
pub(crate) fn there(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Says that a test could not be made, which `.ci/run` does not accept.
pub(crate) fn skipped(why: &str) {
    assert!(std::env::var_os("ROCKPROOF_NO_SKIP").is_none(), "skipped: {why}");
    eprintln!("SKIPPED: {why}");
}
