//! The examples and `boundary.c`, compiled by the system's compilers against the library as it is built, and run; and the lines of docs/c.md.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().expect("the project")
}

/// The static library, built by Cargo where the tests are built: it does not build one for tests by itself.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let test = std::env::current_exe().expect("a path");
        let target = test.ancestors().nth(3).expect("target/release/deps/programs");
        let manifest = root().join("crates/c/Cargo.toml");
        let mut cargo = Command::new(env!("CARGO"));
        run(cargo
            .args(["build", "--release", "--locked", "--quiet", "--target-dir"])
            .arg(target)
            .arg("--manifest-path")
            .arg(manifest));
        target.join("release/librockproof.a")
    })
}

/// Runs a command in a folder and answers what it prints.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}: {}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// A program made of a source, warnings being errors.
fn compiled(compiler: &str, standard: &str, source: &Path, folder: &Path) -> PathBuf {
    let program = folder.join(source.file_stem().expect("a name"));
    let mut command = Command::new(compiler);
    command.args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"]).arg(root().join("crates/c/include"));
    command.arg(source).arg(library()).args(["-lpthread", "-ldl", "-lm", "-o"]).arg(&program);
    run(&mut command);
    program
}

/// The lines of the page are those that a user types.
#[test]
fn the_lines_of_the_page_run() {
    let page = std::fs::read_to_string(root().join("docs/c.md")).expect("docs/c.md");
    let lines = page.split("```sh\n").nth(1).and_then(|rest| rest.split("```").next()).expect("lines to type");
    let folder = tempfile::tempdir().expect("a folder");
    // Built where everything else is, and the program beside nothing of the project.
    let target = library().ancestors().nth(2).expect("a target directory");
    let lines = lines.replace("target/release", &format!("{}/release", target.display()));
    let lines = lines.replace("-o classify", &format!("-o {}/classify", folder.path().display()));
    let lines = lines.replace("./classify", &format!("{}/classify", folder.path().display()));
    let mut shell = Command::new("sh");
    shell.args(["-ec", &lines]).current_dir(root()).env("CARGO_TARGET_DIR", target);
    let said = run(&mut shell);
    let shown = page.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("what it prints");
    assert_eq!(said, shown);
}

#[test]
fn what_c_does_wrong_is_answered() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled("cc", "-std=c11", &root().join("crates/c/tests/boundary.c"), folder.path());
    assert_eq!(
        run(Command::new(program).current_dir(&folder)),
        concat!("rockproof ", env!("CARGO_PKG_VERSION"), ": good\n")
    );
}

#[test]
fn the_example_in_c_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled("cc", "-std=c11", &root().join("examples/c/classify.c"), folder.path());
    let said = run(&mut Command::new(program));
    assert!(
        said.contains("exact: ") && said.contains("exactly -1/8 m") && said.contains("separation: -1/8 m"),
        "{said}"
    );
}

#[test]
fn the_example_in_cpp_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = compiled("c++", "-std=c++17", &root().join("examples/c/neighbours.cpp"), folder.path());
    let said = run(Command::new(&program).arg(root().join("cases/real/smallAngle.dda")));
    assert!(said.starts_with("0 and 1: "), "{said}");
    let output = Command::new(&program).arg("missing.dda").output().expect("runs");
    assert!(output.status.code() == Some(2) && String::from_utf8_lossy(&output.stderr).starts_with("missing.dda: "));
}
