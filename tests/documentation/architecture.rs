//! The rules of ARCHITECTURE.md that Cargo does not hold by itself: which crate's manifest may name which, which folders mirror each
//! other, how long a file may be, and that no default build reaches GMP.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The four feature pairs of SPEC section 4.
const FEATURE_PAIRS: [&str; 4] = ["edge_edge.rs", "vertex_edge.rs", "vertex_face.rs", "vertex_vertex.rs"];
/// Steps that every implementation has in a file of this name.
const SHARED_STEPS: [&str; 4] = ["classify.rs", "entrance.rs", "exit.rs", "territory.rs"];
/// The implementations of SPEC section 4: the oracle's fast path, its plain path, the stepper.
const IMPLEMENTATIONS: [&str; 3] = ["oracle/src/contact", "oracle/src/plain", "crates/stepper/src/contact"];
/// Lines of a file that can be read in one sitting; a longer one says why at its head, with [`REASON`].
const LONGEST_FILE: usize = 400;
const REASON: &str = "// Longer than 400 lines: ";

/// The crates of the workspace and those of its own that each may depend on. Cargo refuses every import that is not listed in a
/// manifest; this table says which manifests are right. The rule above all others: oracle and stepper do not know each other.
const MAY_DEPEND_ON: [(&str, &[&str]); 27] = [
    ("model", &[]),
    // Solves as a library does; nothing that it finds is claimed by the oracle.
    ("cholesky", &[]),
    ("oracle", &["cholesky", "model"]),
    ("stepper", &["cholesky", "model"]),
    ("results", &[]),
    ("simulate", &["model", "stepper", "results"]),
    ("differential", &["model", "oracle", "stepper", "simulate", "results"]),
    ("pairs", &["model", "differential"]),
    ("campaign", &["model", "oracle", "stepper", "simulate", "differential", "pairs", "results"]),
    ("gate", &["model", "differential", "pairs", "campaign"]),
    ("tune", &["model", "oracle", "stepper", "differential", "pairs", "campaign", "results"]),
    ("bench", &["model", "oracle", "stepper", "differential", "pairs", "campaign", "results"]),
    ("report", &["model", "oracle", "simulate", "differential", "pairs", "campaign", "gate", "results"]),
    ("examine", &["model", "oracle", "stepper", "simulate", "differential", "tune", "report", "results"]),
    // Nothing depends on it: C calls it.
    ("c", &["model", "oracle", "stepper", "differential"]),
    // The same of Python.
    ("python", &["model", "oracle", "stepper", "differential", "pairs", "campaign", "results", "report", "examine"]),
    // Tests and benches alone.
    ("benches", &[]),
    ("campaign-tests", &[]),
    ("cholesky-tests", &[]),
    ("differential-tests", &[]),
    ("model-tests", &[]),
    ("pairs-tests", &[]),
    ("oracle-tests", &[]),
    ("stepper-tests", &[]),
    // The stepper against closed forms, and the exact side against itself. Nothing depends on it but fuzz targets, tests and examples.
    (
        "validation",
        &["model", "oracle", "stepper", "results", "simulate", "differential", "pairs", "campaign", "bench"],
    ),
    // Nothing depends on it but tests and examples.
    (
        "fuzz",
        &[
            "model",
            "oracle",
            "stepper",
            "results",
            "simulate",
            "differential",
            "pairs",
            "campaign",
            "tune",
            "gate",
            "report",
            "validation",
        ],
    ),
    (
        "rockproof",
        &[
            "model",
            "oracle",
            "stepper",
            "results",
            "simulate",
            "differential",
            "pairs",
            "campaign",
            "gate",
            "tune",
            "bench",
            "report",
            "examine",
        ],
    ),
];

/// What C and Python call, and crates that only tests need, or that hold tests or benches alone.
const NOT_PUBLISHED: [&str; 12] = [
    "c",
    "python",
    "fuzz",
    "validation",
    "benches",
    "campaign-tests",
    "cholesky-tests",
    "differential-tests",
    "model-tests",
    "pairs-tests",
    "oracle-tests",
    "stepper-tests",
];

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder, in order.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .into_iter()
        .flat_map(|path| match path.is_dir() {
            // What Cargo makes is nobody's to read.
            true if path.ends_with("target") => Vec::new(),
            true => rust_files(&path),
            false if path.extension().is_some_and(|e| e == "rs") => vec![path],
            false => Vec::new(),
        })
        .collect()
}

/// What cargo prints, without the network.
pub(crate) fn cargo(arguments: &[&str]) -> String {
    let cargo = Command::new(env!("CARGO")).args(arguments).arg("--offline").current_dir(root()).output().unwrap();
    assert!(cargo.status.success(), "{}", String::from_utf8_lossy(&cargo.stderr));
    String::from_utf8(cargo.stdout).unwrap()
}

/// The manifests of the workspace and nothing else.
pub(crate) fn metadata() -> Value {
    serde_json::from_str(&cargo(&["metadata", "--no-deps", "--format-version", "1"])).unwrap()
}

#[test]
fn crates_depend_downwards_and_gmp_stays_optional() {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    assert_eq!(packages.len(), MAY_DEPEND_ON.len());
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let short = |name: &str| name.trim_start_matches("rockproof-").to_owned();
        let ours: BTreeSet<String> = dependencies(package).filter(|d| d.starts_with("rockproof")).map(short).collect();
        let (_, allowed) =
            MAY_DEPEND_ON.iter().find(|(of, _)| *of == short(name)).unwrap_or_else(|| panic!("{name} is new"));
        let beyond: Vec<&String> = ours.iter().filter(|d| !allowed.contains(&d.as_str())).collect();
        assert!(beyond.is_empty(), "{name} depends on {beyond:?}");
        let gmp = package["dependencies"].as_array().unwrap().iter().filter(|d| is_gmp(d["name"].as_str().unwrap()));
        for dependency in gmp {
            assert_eq!(dependency["optional"], true, "{name} depends on {} whether asked or not", dependency["name"]);
        }
        let features = package["features"].as_object().unwrap();
        let default = features.get("default").map(Value::to_string).unwrap_or_default();
        assert!(!default.contains("gmp") && !default.contains("rug"), "{name}: default features {default}");
    }
}

/// What a crate needs to be used; what its tests need is not asked.
fn dependencies(package: &Value) -> impl Iterator<Item = &str> {
    let all = package["dependencies"].as_array().unwrap().iter();
    all.filter(|d| d["kind"].is_null()).map(|d| d["name"].as_str().unwrap())
}

fn is_gmp(dependency: &str) -> bool {
    dependency == "rug" || dependency.starts_with("gmp")
}

#[test]
fn implementations_mirror_each_other() {
    for folder in IMPLEMENTATIONS {
        let files: BTreeSet<String> = rust_files(&root().join(folder))
            .iter()
            .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
            .collect();
        let features = ["vertex", "edge", "face"];
        let of_pairs: Vec<&str> = files
            .iter()
            .map(String::as_str)
            .filter(|name| {
                name.trim_end_matches(".rs")
                    .split_once('_')
                    .is_some_and(|(a, b)| features.contains(&a) && features.contains(&b))
            })
            .collect();
        assert_eq!(of_pairs, FEATURE_PAIRS, "{folder}: one file a feature pair");
        for step in SHARED_STEPS {
            assert!(files.contains(step), "{folder} has no {step}");
        }
    }
}

#[test]
fn files_can_be_read_in_a_sitting() {
    let folders = ["crates", "oracle", "src", "tests", "examples", "benches"];
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| rust_files(&root().join(folder))).collect();
    assert!(files.len() > 50, "found only {} files", files.len());
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let lines = text.lines().count();
        let reasoned = text.lines().take(20).any(|line| line.starts_with(REASON));
        assert!(lines <= LONGEST_FILE || reasoned, "{} has {lines} lines and does not say why", file.display());
    }
}

/// `.ci/run` looks at the packages that ask for GMP, with it; in the others there is nothing else to see.
#[test]
fn only_what_is_checked_with_gmp_asks_for_it() {
    let ci = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let checked = ["oracle", "crates/bench", "crates/validation", "src", "tests", "examples/self_comparison"];
    assert!(ci.contains("-p rockproof-oracle -p rockproof-oracle-tests -p rockproof-bench -p rockproof-validation -p rockproof --lib --bins --tests --example self_comparison"));
    let folders = ["crates", "oracle", "src", "tests", "examples", "benches"].map(|folder| root().join(folder));
    let mut asking = 0;
    for file in folders.iter().flat_map(|folder| rust_files(folder)) {
        if std::fs::read_to_string(&file).unwrap().contains(concat!("feature = ", "\"gmp\"")) {
            assert!(checked.iter().any(|folder| file.starts_with(root().join(folder))), "{}", file.display());
            asking += 1;
        }
    }
    assert!(asking > 5, "{asking} files");
}

/// Each file that ARCHITECTURE.md names in backquotes is there: by its path from the root, or as the end of a path.
#[test]
fn files_that_the_map_names_exist() {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let folders = ["crates", "oracle", "src", "tests", "examples", "benches"];
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| rust_files(&root().join(folder))).collect();
    let named: BTreeSet<&str> = page
        .split('`')
        .skip(1)
        .step_by(2)
        .filter(|name| name.ends_with(".rs") && !name.contains("NAME") && !name.contains(['{', '*', ' ']))
        .collect();
    assert!(named.len() > 60, "the page names only {} files", named.len());
    for name in named {
        let relative = Path::new(name.trim_start_matches("../"));
        assert!(files.iter().any(|file| file.ends_with(relative)), "ARCHITECTURE.md names {name}, which is not there");
    }
}

/// The folders of the crates that are published.
fn published() -> Vec<PathBuf> {
    let folders = MAY_DEPEND_ON.into_iter().map(|(name, _)| match name {
        "rockproof" => root().to_path_buf(),
        "benches" | "oracle" => root().join(name),
        "oracle-tests" => root().join("oracle/tests"),
        name => match name.strip_suffix("-tests") {
            Some(tested) => root().join("crates").join(tested).join("tests"),
            None => root().join("crates").join(name),
        },
    });
    let is_published = |folder: &PathBuf| {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let manifest: toml::Table = toml::from_str(&manifest).unwrap();
        manifest["package"].get("publish").is_none()
    };
    folders.filter(is_published).collect()
}

/// The one file that starts programs, and the one that takes a command to start it in a process group.
const STARTS_PROGRAMS: [&str; 2] =
    ["crates/differential/src/external/process.rs", "crates/differential/src/external/group.rs"];

/// Only what a user names as an engine is started as a program (docs/reliability.md).
#[test]
fn programs_are_started_in_one_place() {
    let outside = ["crates/c", "crates/python"].map(|folder| root().join(folder));
    let is_test = |file: &Path| file.ends_with("tests.rs") || file.components().any(|part| part.as_os_str() == "tests");
    let mut starting = BTreeSet::new();
    let mut importing = BTreeSet::new();
    let mut read = 0;
    for folder in published().into_iter().chain(outside) {
        let folder = folder.join("src");
        for file in rust_files(&folder).into_iter().filter(|file| !is_test(file.strip_prefix(&folder).unwrap())) {
            let text = std::fs::read_to_string(&file).unwrap();
            let name = file.strip_prefix(root()).unwrap().to_string_lossy().into_owned();
            if text.contains("Command::new(") {
                starting.insert(name.clone());
            }
            // An import may give it another name.
            let has_command = |part: &str| {
                let names = part.split_inclusive(';').next().unwrap_or_default();
                let names = names.strip_prefix('{').map_or(names, |list| list.split('}').next().unwrap_or_default());
                names.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "Command")
            };
            if text.split("std::process::").skip(1).any(has_command) {
                importing.insert(name);
            }
            read += 1;
        }
    }
    assert!(read > 200, "only {read} files");
    assert_eq!(Vec::from_iter(starting), STARTS_PROGRAMS[..1]);
    assert_eq!(importing, BTreeSet::from(STARTS_PROGRAMS.map(str::to_owned)));
}

/// A package holds its own folder alone: what sources include from elsewhere would be missing.
#[test]
fn packages_hold_what_their_sources_include() {
    let mut included = 0;
    let published = published();
    assert_eq!(published.len(), MAY_DEPEND_ON.len() - NOT_PUBLISHED.len(), "{NOT_PUBLISHED:?} are for tests");
    for folder in published {
        assert!(folder.join("README.md").is_file(), "{}", folder.display());
        let manifest: toml::Table =
            toml::from_str(&std::fs::read_to_string(folder.join("Cargo.toml")).unwrap()).unwrap();
        let kept: Vec<&str> =
            manifest["package"]["include"].as_array().unwrap().iter().map(|part| part.as_str().unwrap()).collect();
        for file in rust_files(&folder.join("src")) {
            let text = std::fs::read_to_string(&file).unwrap();
            for part in text.split("include_str!(\"").chain(text.split("include_bytes!(\"")).skip(1) {
                let Some((name, _)) = part.split_once('"').filter(|(name, _)| file.with_file_name(name).is_file())
                else {
                    continue;
                };
                let path = file.with_file_name(name).canonicalize().unwrap();
                let within = path.strip_prefix(&folder).unwrap_or_else(|_| panic!("{}: {name}", file.display()));
                let top = format!("/{}", within.components().next().unwrap().as_os_str().display());
                assert!(kept.contains(&top.as_str()), "{}: {name} is in none of {kept:?}", file.display());
                included += 1;
            }
        }
    }
    assert!(included >= 11, "only {included} files are included");
    for copy in std::fs::read_dir(root().join("crates/bench/cases")).unwrap() {
        let copy = copy.unwrap();
        let original = root().join("cases/handmade").join(copy.file_name());
        assert_eq!(std::fs::read(copy.path()).unwrap(), std::fs::read(&original).unwrap(), "{}", original.display());
    }
}

#[test]
fn all_crates_have_one_version() {
    let manifest: toml::Table = toml::from_str(&std::fs::read_to_string(root().join("Cargo.toml")).unwrap()).unwrap();
    let version = &manifest["workspace"]["package"]["version"];
    let own = manifest["workspace"]["dependencies"].as_table().unwrap().iter();
    let is_published =
        |name: &str| name.strip_prefix("rockproof-").is_some_and(|short| !NOT_PUBLISHED.contains(&short));
    let own: Vec<_> = own.filter(|(name, _)| is_published(name)).collect();
    // The program itself is nobody's dependency.
    assert_eq!(own.len(), MAY_DEPEND_ON.len() - NOT_PUBLISHED.len() - 1);
    for (name, dependency) in own {
        assert_eq!(dependency.get("version"), Some(version), "{name}");
    }
}
