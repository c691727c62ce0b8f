//! What is built where, so that nothing is built twice: the members that a bare `cargo test` takes, and what the library for C and the package for
//! Python take of what is built for the program.

use crate::architecture::{cargo, metadata};
use std::collections::BTreeSet;

/// The members that a bare `cargo build` or `cargo test` leaves out.
const LEFT_OUT: [&str; 3] = ["benches", "c", "python"];

#[test]
fn cargo_test_takes_every_crate_but_three() {
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

/// The library for C and the package for Python take what the program's build has made: they ask no dependency for other features.
#[test]
fn what_other_languages_call_is_made_of_what_the_program_is() {
    let used = |package: &str| -> BTreeSet<String> {
        let shown = ["--edges", "normal,build", "--prefix", "none", "--format", "{p} {f}"];
        let tree = cargo(&[&["tree", "--locked", "--package", package][..], &shown].concat());
        tree.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
    };
    let program = used("rockproof");
    for (package, alone) in [
        ("rockproof-c", &["rockproof-c "][..]),
        ("rockproof-python", &["rockproof-python ", "pyo3", "target-lexicon "]),
    ] {
        let used = used(package);
        let own: Vec<&String> =
            used.difference(&program).filter(|line| !alone.iter().any(|name| line.starts_with(name))).collect();
        assert!(
            own.is_empty(),
            "built for {package} alone, whose manifest should name the program's features: {own:?}"
        );
        assert!(used.len() > 50, "{used:?}");
    }
}
