//! What is built where, so that nothing is built twice: the members that a bare `cargo test` takes, and what the library for C and the package for
//! Python take of what is built for the program.

use crate::architecture::{cargo, metadata, root};
use std::collections::BTreeSet;

/// The members that a bare `cargo build` or `cargo test` leaves out.
const LEFT_OUT: [&str; 2] = ["benches", "c"];

#[test]
fn cargo_test_takes_every_crate_but_two() {
    let metadata = metadata();
    let ids = |key: &str| -> BTreeSet<&str> {
        metadata[key].as_array().unwrap().iter().map(|id| id.as_str().unwrap()).collect()
    };
    let (all, taken) = (ids("workspace_members"), ids("workspace_default_members"));
    let packages = metadata["packages"].as_array().unwrap().iter();
    let left_out: BTreeSet<&str> = packages
        .filter(|package| !taken.contains(package["id"].as_str().unwrap()))
        .map(|package| package["name"].as_str().unwrap().trim_start_matches("rockproof-"))
        .collect();
    assert!(taken.is_subset(&all));
    assert_eq!(Vec::from_iter(left_out), LEFT_OUT, "default-members of Cargo.toml");
}

/// The library for C takes what the program's build has made: it asks no dependency for other features.
#[test]
fn the_library_for_c_is_made_of_what_the_program_is() {
    let used = |package: &str| -> BTreeSet<String> {
        let shown = ["--edges", "normal,build", "--prefix", "none", "--format", "{p} {f}"];
        let tree = cargo(&[&["tree", "--locked", "--package", package][..], &shown].concat());
        tree.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
    };
    let (program, library) = (used("rockproof"), used("rockproof-c"));
    let own: Vec<&String> = library.difference(&program).filter(|line| !line.starts_with("rockproof-c ")).collect();
    assert!(own.is_empty(), "built for crates/c alone, whose manifest should name the program's features: {own:?}");
    assert!(library.len() > 50, "{library:?}");
}

/// The package for Python shares the workspace's target directory (`.ci/run`), where dependencies are compiled once as long as both compile them alike.
#[test]
fn the_package_for_python_is_compiled_like_the_workspace() {
    let read =
        |file: &str| -> toml::Table { toml::from_str(&std::fs::read_to_string(root().join(file)).unwrap()).unwrap() };
    let profile = |file: &str| {
        let mut profile = read(file)["profile"]["release"].as_table().unwrap().clone();
        let packages = profile.remove("package").unwrap().as_table().unwrap().clone();
        (profile, packages)
    };
    let (ours, our_packages) = profile("Cargo.toml");
    let folder = "crates/python";
    let (theirs, packages) = profile(&format!("{folder}/Cargo.toml"));
    let lock = read(&format!("{folder}/Cargo.lock"));
    let used: Vec<&str> =
        lock["package"].as_array().unwrap().iter().map(|package| package["name"].as_str().unwrap()).collect();
    let expected: toml::Table = our_packages.into_iter().filter(|(name, _)| used.contains(&name.as_str())).collect();
    assert!(expected.len() > 5, "{expected:?}");
    assert_eq!((theirs, packages), (ours, expected), "{folder}/Cargo.toml and the profile of Cargo.toml");
}
