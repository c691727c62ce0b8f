//! Pins `--format json`: one document on stdout, messages elsewhere, and the values of the table that it stands for.

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Exit code and standard output of `rockproof …`, run in `place`.
fn rockproof(place: &Path, args: &[&str]) -> (i32, String) {
    let output = cargo_bin_cmd!("rockproof").current_dir(place).args(args).output().expect("runs");
    (output.status.code().expect("a code"), String::from_utf8(output.stdout).expect("UTF-8"))
}

/// The document that a command prints, and nothing else.
fn document(place: &Path, expected: i32, args: &[&str]) -> Value {
    let (code, out) = rockproof(place, &[args, &["--format", "json"]].concat());
    assert_eq!(code, expected, "{args:?}: {out}");
    assert!(out.ends_with("}\n"), "{out}");
    serde_json::from_str(&out).unwrap_or_else(|e| panic!("{args:?}: {e}: {out}"))
}

fn model(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/real").join(name).display().to_string()
}

#[test]
fn check_says_the_same_to_programs() {
    let place = tempfile::tempdir().expect("a directory");
    let file = model("slope_joints.dda");
    let args = ["check", &file, "--tolerances", "shi"];
    let (code, text) = rockproof(place.path(), &args);
    let found = document(place.path(), code, &args);
    for name in ["blocks", "fixed", "concave", "vertices", "edges", "faces"] {
        let line = format!("\n  {name:<9} {:>12}\n", found[name].as_u64().expect("a count"));
        assert!(text.contains(&line), "{line}{text}");
    }
    let rules = found["rules_violated"].as_array().expect("rules");
    assert!(!rules.is_empty() && text.contains(&format!("\nrules: {} violated\n", rules.len())));
    assert!(rules.iter().all(|rule| text.contains(rule["rule"].as_str().expect("a rule"))));
    let overlaps = &found["overlaps"];
    assert!(text.contains(&format!("\noverlaps: {} pairs (worst 2–3, 1.1694 m) overlap deeper", overlaps["lost"])));
    assert_eq!(overlaps["pairs"].as_array().map(Vec::len), Some(19));
    let search = found["tolerances"]["search"].as_f64().expect("a length");
    assert!(text.contains(&format!("\n  search            {search:>13.6e}\n")), "{text}");
    assert_eq!(found["tolerances"]["criteria"], "classic");
}

#[test]
fn campaigns_and_gates_say_the_same_to_programs() {
    let place = tempfile::tempdir().expect("a directory");
    let args = ["campaign", "--pairs", "128", "--family", "sliver", "--tolerances", "auto", "--out", "found"];
    let found = document(place.path(), 0, &args);
    let run: Value =
        serde_json::from_slice(&fs::read(place.path().join("found/run.json")).expect("run.json")).expect("JSON");
    assert!(found["finished"] == true && found["pairs"] == 128 && found["pairs"] == run["pairs"]);
    assert!(found["findings"].as_u64() > Some(0) && found["findings"] == run["findings"]["total"]);
    for (cause, count) in run["findings"]["by_cause"].as_object().expect("causes") {
        let of = found["causes"].as_array().expect("rows").iter().filter(|row| row["cause"] == cause.as_str());
        let sum: u64 = of.map(|row| row["findings"].as_u64().expect("a count")).sum();
        assert_eq!(Some(sum), count.as_u64(), "{cause}");
    }
    assert_eq!(found["verdict"].as_array().map(Vec::len), Some(3));
    let steps = found["steps"].as_array().expect("rows");
    assert!(steps.iter().all(|row| row["engine"].is_string() && row["other_contacts"].is_u64()));

    let gate = "corpus = []\n[campaign]\npairs = 64\nfamilies = [\"sliver\"]\n[[limit]]\ncause = \"defect\"\ncount = 0\n[[limit]]\ncause = \"tolerance\"\ncount = 0\n";
    fs::write(place.path().join("gate.toml"), gate).expect("write");
    let (_, text) = rockproof(place.path(), &["gate", "gate.toml"]);
    let found = document(place.path(), 1, &["gate", "gate.toml"]);
    let checks = found["checks"].as_array().expect("checks");
    assert!(
        found["passed"] == false
            && text.contains(&format!("gate failed: {} of {} checks", found["failed"], checks.len()))
    );
    assert!(checks.iter().all(|check| text.contains(check["check"].as_str().expect("a name"))));
}

#[test]
fn a_search_says_the_same_to_programs() {
    let place = tempfile::tempdir().expect("a directory");
    let file = model("smallEdge.dda");
    let args = ["tune", &file, "--candidates", "3", "--steps", "4", "--out", "found"];
    let (code, out) = rockproof(place.path(), &[&args[..], &["--format", "json"]].concat());
    let found: Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}"));
    assert_eq!((code == 0, &found["candidates"]), (found["clean"] == true, &Value::from(3)));
    let set = place.path().join("found/tolerances.toml").display().to_string();
    let checked = document(place.path(), 0, &["check", &file, "--tolerances", &set]);
    assert_eq!(checked["tolerances"], found["recommended"]["tolerances"]);
}
