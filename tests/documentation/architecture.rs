//! The rules of ARCHITECTURE.md that a compiler does not hold: who may name whom, which folders mirror each other, how
//! long a file may be, and that no default build reaches GMP. The scanner is itself tested on planted text.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The four feature pairs of SPEC section 4.
const FEATURE_PAIRS: [&str; 4] = ["edge_edge.rs", "vertex_edge.rs", "vertex_face.rs", "vertex_vertex.rs"];
/// Steps that every implementation has in a file of this name.
const SHARED_STEPS: [&str; 4] = ["classify.rs", "entrance.rs", "exit.rs", "territory.rs"];
/// The implementations of SPEC section 4: the oracle's fast path, its plain path, the stepper.
const IMPLEMENTATIONS: [&str; 3] = ["oracle/src/contact", "oracle/src/plain", "src/stepper/contact"];
const LONGEST_FILE: usize = 500;

/// Words that may not occur in the code of a folder (comments and texts may).
const FORBIDDEN: [(&str, &[&str]); 3] = [
    // The stepper shares no arithmetic with the oracle and knows nothing that is built on both.
    ("src/stepper", &["oracle", "rockproof_oracle", "ruint", "rug", "Ring", "ExactRing", "campaign", "cli"]),
    ("oracle/src", &["rockproof", "stepper", "crypto_bigint", "campaign", "cli"]),
    ("model/src", &["rockproof", "rockproof_oracle", "stepper", "campaign", "cli"]),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder, in order.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .into_iter()
        .flat_map(|path| match path.is_dir() {
            true => rust_files(&path),
            false if path.extension().is_some_and(|e| e == "rs") => vec![path],
            false => Vec::new(),
        })
        .collect()
}

/// The identifiers of Rust code with their lines; comments, texts and characters are left out.
fn words(code: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut rest = code;
    let mut line = 1;
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            block_comment(rest)
        } else if let Some(length) = raw_text(rest) {
            length
        } else if c == '"' || rest.starts_with("b\"") || rest.starts_with("c\"") {
            quoted(rest)
        } else if c == '\'' {
            character(rest)
        } else if c.is_alphabetic() || c == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            found.push((line, rest[..length].to_owned()));
            length
        } else if c.is_ascii_digit() {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        line += rest[..length].matches('\n').count();
        rest = &rest[length..];
    }
    found
}

/// Length of a block comment; they nest.
fn block_comment(text: &str) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at < text.len() {
        match &text.as_bytes()[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

/// Length of `r"…"` or `r#"…"#`, if the text begins with one.
fn raw_text(text: &str) -> Option<usize> {
    let after = ["br", "cr", "r"].iter().find_map(|prefix| text.strip_prefix(prefix))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let inside = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let length = inside.find(&end).map_or(inside.len(), |at| at + end.len());
    Some(text.len() - inside.len() + length)
}

/// Length of `"…"`, perhaps with a prefix of one letter.
fn quoted(text: &str) -> usize {
    let open = text.find('"').unwrap_or(0) + 1;
    let mut escaped = false;
    for (at, c) in text[open..].char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return open + at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Length of a character such as `'x'`, or of the quote alone where it begins a lifetime.
fn character(text: &str) -> usize {
    let mut inside = text[1..].char_indices();
    match (inside.next(), inside.next()) {
        (Some((_, '\\')), Some((after, escape))) => {
            let searched = 1 + after + escape.len_utf8();
            text[searched..].find('\'').map_or(text.len(), |at| searched + at + 1)
        }
        (Some(_), Some((end, '\''))) => 1 + end + 1,
        _ => 1,
    }
}

/// Where code uses one of the words, as `line: word`.
fn uses(code: &str, forbidden: &[&str]) -> Vec<String> {
    let found = words(code).into_iter().filter(|(_, word)| forbidden.contains(&word.as_str()));
    found.map(|(line, word)| format!("{line}: {word}")).collect()
}

#[test]
fn the_scanner_finds_what_is_planted_and_nothing_else() {
    let planted = "use crate::{model::Block,\n oracle::Pair};\nlet x = rockproof_oracle::Solid::new(&block);";
    assert_eq!(uses(planted, FORBIDDEN[0].1), ["2: oracle", "3: rockproof_oracle"]);
    assert_eq!(
        uses("let c = '\\''; type T<'a> = &'a oracle::Pair; 'o' 'oracle", &["oracle"]),
        ["1: oracle", "1: oracle"]
    );
    let innocent =
        "// oracle\n/* a /* nested */ oracle */ \"oracle \\\" oracle\" r#\"\"oracle\"\"# b\"oracle\" oracles my_oracle";
    assert_eq!(uses(innocent, &["oracle"]), [""; 0]);
    assert_eq!(uses(&format!("{innocent}\n\noracle"), &["oracle"]), ["4: oracle"]);
}

#[test]
fn the_two_implementations_do_not_know_each_other() {
    for (folder, forbidden) in FORBIDDEN {
        let files = rust_files(&root().join(folder));
        assert!(files.len() > 5, "{folder} holds only {} files", files.len());
        for file in files {
            let found = uses(&std::fs::read_to_string(&file).unwrap(), forbidden);
            assert!(found.is_empty(), "{} names what {folder} may not know: {found:?}", file.display());
        }
    }
}

#[test]
fn crates_depend_downwards_and_gmp_stays_optional() {
    // --no-deps reads the manifests of the workspace and nothing else, so it needs no network.
    let cargo = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(cargo.status.success(), "{}", String::from_utf8_lossy(&cargo.stderr));
    let metadata: Value = serde_json::from_slice(&cargo.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap();
    assert_eq!(packages.len(), 4);
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let ours: BTreeSet<&str> = dependencies(package).filter(|d| d.starts_with("rockproof")).collect();
        let allowed: &[&str] = match name {
            "rockproof-model" => &[],
            "rockproof-oracle" => &["rockproof-model"],
            // It runs the stepper; what a closed form says needs no oracle.
            "rockproof-validation" => &["rockproof"],
            _ => &["rockproof-model", "rockproof-oracle"],
        };
        assert_eq!(ours, allowed.iter().copied().collect(), "{name}");
        let gmp = package["dependencies"].as_array().unwrap().iter().filter(|d| is_gmp(d["name"].as_str().unwrap()));
        for dependency in gmp {
            assert_eq!(dependency["optional"], true, "{name} depends on {} whether asked or not", dependency["name"]);
        }
        let features = package["features"].as_object().unwrap();
        let default = features.get("default").map(Value::to_string).unwrap_or_default();
        assert!(!default.contains("gmp") && !default.contains("rug"), "{name}: default features {default}");
    }
}

fn dependencies(package: &Value) -> impl Iterator<Item = &str> {
    package["dependencies"].as_array().unwrap().iter().map(|d| d["name"].as_str().unwrap())
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
    let folders = ["model", "oracle", "src", "tests", "examples", "benches", "fuzz", "validation"];
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| rust_files(&root().join(folder))).collect();
    assert!(files.len() > 50, "found only {} files", files.len());
    for file in files {
        let lines = std::fs::read_to_string(&file).unwrap().lines().count();
        assert!(lines <= LONGEST_FILE, "{} has {lines} lines, more than {LONGEST_FILE}", file.display());
    }
}
