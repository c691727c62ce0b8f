//! Tests that `cargo test` leaves out somewhere are run elsewhere: by `.ci/run`, or by another package.

use crate::architecture::{root, rust_files};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A filter of names passes where no test has the name any more, so each test that says `.ci/run` runs it is looked for there.
#[test]
fn tests_left_to_ci_are_run_there() {
    let ci = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    // All long tests of commands, and those of campaigns by the beginnings of their names.
    assert!(ci.contains("ignored_tests all at_full_size\n"));
    assert!(ci.contains("ignored_tests commands --skip at_full_size\n"));
    let filters = ci.lines().find_map(|line| line.trim().strip_prefix("ignored_tests differential "));
    let filters: Vec<&str> = filters.expect("the long tests of campaigns").split_whitespace().collect();
    let (mut found, mut used) = (0, BTreeSet::<&str>::new());
    for file in ["crates", "oracle", "tests"].iter().flat_map(|folder| rust_files(&root().join(folder))) {
        let text = std::fs::read_to_string(&file).unwrap();
        for after in text.split("; .ci/run runs it\"]\n").skip(1) {
            let name = after.split("fn ").nth(1).and_then(|name| name.split('(').next()).expect("a test");
            let filter = filters.iter().find(|filter| name.starts_with(**filter));
            let of_commands = file.starts_with(root().join("tests/commands"));
            assert!(name.ends_with("at_full_size") || of_commands || filter.is_some(), "{name} is not run by .ci/run");
            used.extend(filter);
            found += 1;
        }
    }
    assert!(found > 20 && used.len() == filters.len(), "{found} tests; of the filters {filters:?} only {used:?}");
}

/// Crates whose examples in comments `cargo test` does not look for have none.
#[test]
fn no_example_in_a_comment_is_left_out() {
    let mut without = 0;
    for folder in std::fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path()) {
        let manifest: toml::Table =
            toml::from_str(&std::fs::read_to_string(folder.join("Cargo.toml")).unwrap()).unwrap();
        let doctest = manifest.get("lib").and_then(|lib| lib.get("doctest")).and_then(toml::Value::as_bool);
        if doctest != Some(false) {
            continue;
        }
        without += 1;
        for file in rust_files(&folder.join("src")) {
            let text = std::fs::read_to_string(&file).unwrap();
            let is_example = |line: &str| line.trim_start().starts_with("//") && line.contains("```");
            assert!(!text.lines().any(is_example), "{} has an example: its crate's doctest must be on", file.display());
        }
    }
    assert!(without > 10, "{without} crates");
}

/// The files beside a program that it declares as modules.
fn modules(program: &Path) -> Vec<PathBuf> {
    let text = std::fs::read_to_string(program).unwrap();
    let names = text.lines().filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
    names.map(|name| program.with_file_name(name).with_extension("rs")).collect()
}

/// What `cargo test` does not compile with a library, tests in its sources and test programs, the package in its folder `tests` compiles.
#[test]
fn no_test_is_left_out() {
    let read = |folder: &Path| toml::from_str(&std::fs::read_to_string(folder.join("Cargo.toml")).unwrap()).unwrap();
    let crates = std::fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    // Those for other languages are tested in these.
    let crates = crates.filter(|folder| !folder.ends_with("c") && !folder.ends_with("python"));
    let mut packages = 0;
    for folder in crates.chain([root().join("oracle")]) {
        let manifest: toml::Table = read(&folder);
        let off = |table: Option<&toml::Value>, key: &str| table.and_then(|t| t.get(key)?.as_bool()) == Some(false);
        let tests = folder.join("tests");
        let has_package = tests.join("Cargo.toml").is_file();
        let listing = if has_package { &tests } else { &folder };
        let lists: toml::Table = read(listing);
        let programs = match has_package || off(lists.get("package"), "autotests") {
            true => lists.get("test").and_then(toml::Value::as_array).into_iter().flatten().collect(),
            false => Vec::new(),
        };
        let programs: Vec<PathBuf> =
            programs.iter().map(|program| listing.join(program["path"].as_str().unwrap())).collect();
        let compiled: BTreeSet<PathBuf> =
            programs.iter().flat_map(|program| modules(program)).chain(programs.iter().cloned()).collect();
        packages += usize::from(has_package);
        let unit = compiled.contains(&tests.join("../src/lib.rs"));
        assert_eq!(off(manifest.get("lib"), "test"), unit, "{}: tests in its sources", folder.display());
        let programs: Vec<PathBuf> =
            std::fs::read_dir(&tests).into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
        let left_out = |program: &Path| {
            let listed = manifest.get("test").and_then(toml::Value::as_array).into_iter().flatten();
            let mut listed = listed.filter(|test| folder.join(test["path"].as_str().unwrap()) == program);
            off(manifest.get("package"), "autotests") || listed.any(|test| off(Some(test), "test"))
        };
        for program in programs.into_iter().map(|path| if path.is_dir() { path.join("main.rs") } else { path }) {
            if program.is_file() && program.extension().is_some_and(|e| e == "rs") {
                assert_eq!(left_out(&program), compiled.contains(&program), "{}", program.display());
            }
        }
    }
    assert!(packages >= 5, "{packages} packages of tests");
}
