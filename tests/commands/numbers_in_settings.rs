//! No number in a file of settings is taken that means nothing: each key of gates, campaigns, grids, engines and tolerances is tried with what is
//! no finite number or below 0. A limit beside NaN would hold whatever is found.

use crate::place::rockproof_in;
use std::fs;

/// What stands in place of a number.
const WRONG: [&str; 5] = ["nan", "inf", "-inf", "-1", "1e400"];

/// A file with `KEY = VALUE` where `{}` stands, the keys that may stand there, and the command that reads it.
type Sort = (&'static str, &'static [&'static str], &'static [&'static str]);

const SORTS: [Sort; 10] = [
    (
        "pairs = 16\n{}\n",
        &[
            "seed",
            "chunk",
            "metamorphic_every",
            "steps_every",
            "steps",
            "cases_per_fingerprint",
            "cases_per_cause",
            "shrink_evaluations",
            "planarity",
            "weld",
            "scale",
        ],
        &["campaign", "settings.toml", "--out", "run"],
    ),
    ("{}\n", &["pairs"], &["campaign", "settings.toml", "--out", "run"]),
    ("stress = true\n{}\n", &["pairs", "seed", "chunk"], &["campaign", "settings.toml", "--out", "run"]),
    (
        "pairs = 16\n[grid]\nbase = \"auto\"\n{}\n",
        &["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"],
        &["campaign", "settings.toml", "--out", "run"],
    ),
    (
        "pairs = 16\n[[external]]\nname = \"mine\"\ncommand = \"true\"\n{}\n",
        &["timeout_ms", "accuracy"],
        &["campaign", "settings.toml", "--out", "run"],
    ),
    (
        "corpus = []\n{}\n[campaign]\npairs = 16\n[[limit]]\ncount = 0\n",
        &["rotating_pairs"],
        &["gate", "settings.toml", "--out", "run"],
    ),
    (
        "corpus = []\n[campaign]\npairs = 16\n[[limit]]\ncount = 0\n{}\n",
        &["beyond_ulps"],
        &["gate", "settings.toml", "--out", "run"],
    ),
    (
        "corpus = []\n[campaign]\npairs = 16\n[[limit]]\n{}\n",
        &["count", "rate"],
        &["gate", "settings.toml", "--out", "run"],
    ),
    (
        "corpus = []\n[campaign]\npairs = 16\n[[limit]]\nrate = 0.5\n{}\n",
        &["confidence"],
        &["gate", "settings.toml", "--out", "run"],
    ),
    (
        "corpus = []\n[campaign]\npairs = 16\n[baseline]\nfile = \"known.toml\"\n{}\n",
        &["confidence"],
        &["gate", "settings.toml", "--out", "run"],
    ),
];

/// The keys of a file of tolerances; `check` and `tune` read it alike.
const TOLERANCES: [&str; 12] = [
    "search",
    "territory",
    "penetration",
    "overlap_angle",
    "overlap_sine",
    "parallel_angle",
    "parallel_sine",
    "equal",
    "open",
    "close",
    "max_displacement",
    "max_rotation",
];

#[test]
fn no_number_means_nothing() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let refused = |text: &str, key: &str, arguments: &[&str]| {
        let file = "settings.toml";
        fs::write(dir.join(file), text).expect("write");
        let (code, out, err) = rockproof_in(dir, arguments);
        assert!(code == 2 && err.contains(file) && err.contains(key), "{text}: {code}: {out}{err}");
    };
    for (text, keys, arguments) in SORTS {
        for key in keys {
            for value in WRONG {
                // A grid has lists of numbers.
                let value = if text.contains("[grid]") { format!("[{value}]") } else { value.to_owned() };
                refused(&text.replace("{}", &format!("{key} = {value}")), key, arguments);
            }
        }
    }
    fs::write(dir.join("model.obj"), include_str!("../fixtures/two_cubes.obj")).expect("write");
    for command in [&["check"][..], &["tune", "--out", "run"]] {
        for key in TOLERANCES {
            for value in WRONG {
                let arguments = [command, &["model.obj", "--tolerances", "settings.toml"]].concat();
                refused(&format!("preset = \"auto\"\n{key} = {value}\n"), key, &arguments);
            }
        }
    }
    assert!(!dir.join("run").exists(), "nothing is written");
}

/// Every number among the keys of the files is tried above.
#[test]
fn no_key_is_forgotten() {
    let config = rockproof_campaign::config::CampaignConfig {
        planarity: Some(rockproof_model::Number::from_integer(1)),
        weld: Some(rockproof_model::Number::from_integer(1)),
        scale: Some(rockproof_model::Number::from_integer(1)),
        ..Default::default()
    };
    let is_tried = |key: &str| SORTS.iter().any(|(_, keys, _)| keys.contains(&key));
    for (key, value) in config.identity().expect("a map") {
        // Exact numbers are written as texts or numbers.
        let is_number = value.is_number() || ["planarity", "weld", "scale"].contains(&key.as_str());
        assert!(!is_number || is_tried(&key), "{key}");
    }
    // What a limit knows stands in its refusal of what it does not.
    let error = rockproof_gate::config::GateConfig::from_toml("[[limit]]\nunknown = 0\n", "gate.toml");
    let error = error.expect_err("an unknown key");
    let texts = ["engine", "tolerances", "family", "cause", "change", "kind"];
    let keys = error.split_once("allowed are ").expect("keys").1.split(", ");
    let keys: Vec<&str> = keys.filter(|key| !texts.contains(key)).collect();
    assert!(keys.len() == 4 && keys.iter().all(|key| is_tried(key)), "{error}: {keys:?}");
    // So it is with tolerances.
    let error = rockproof_model::ToleranceSpec::empty().assign("unknown=0").expect_err("an unknown name").to_string();
    let names = error.split_once("known are ").expect("names").1.split(", ");
    let numbers: Vec<&str> = names.filter(|name| !["preset", "criteria"].contains(name)).collect();
    assert_eq!(numbers.len(), TOLERANCES.len(), "{error}");
    assert!(numbers.iter().all(|name| TOLERANCES.contains(name)), "{error}");
}

/// What is found in a chunk waits in memory until the chunk ends.
#[test]
fn a_chunk_is_bounded() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for chunk in [0, 65_537, i64::MAX] {
        for pairs in [16, i64::MAX] {
            let settings = format!("pairs = {pairs}\nchunk = {chunk}\n");
            fs::write(dir.join("settings.toml"), &settings).expect("write");
            fs::write(dir.join("gate.toml"), format!("corpus = []\n[campaign]\n{settings}")).expect("write");
            for arguments in [
                &["campaign", "settings.toml", "--out", "run"][..],
                &["campaign", "settings.toml", "--stress", "--out", "run"],
                &["campaign", "settings.toml", "--part", "1/2", "--out", "run"],
                &["gate", "gate.toml", "--out", "run"],
            ] {
                let (code, out, err) = rockproof_in(dir, arguments);
                let said = err.contains(arguments[1])
                    && err.contains(&format!("chunk is {chunk}; allowed are 1 to 65536 pairs"));
                assert!(code == 2 && said, "{arguments:?}: {code}: {out}{err}");
            }
        }
    }
    assert!(!dir.join("run").exists(), "nothing is written");
    fs::write(dir.join("settings.toml"), "pairs = 16\nchunk = 65536\n").expect("write");
    let (code, out, err) = rockproof_in(dir, &["campaign", "settings.toml", "--family", "sliver", "--out", "run"]);
    assert_eq!(code, 0, "{out}{err}");
}

/// As any other set that there is not.
#[test]
fn a_file_of_tolerances_that_cannot_be_read_is_told_with_the_line_that_names_it() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::write(dir.join("bad.toml"), "search = true\n").expect("write");
    for (file, why) in [("none.toml", "none.toml: No such file"), ("bad.toml", "bad.toml:1: ")] {
        fs::write(dir.join("settings.toml"), format!("pairs = 16\ntolerances = [\n\"auto\",\n\"{file}\"]\n"))
            .expect("write");
        let (code, _, err) = rockproof_in(dir, &["campaign", "settings.toml", "--out", "run"]);
        assert!(code == 2 && err.contains(&format!("settings.toml line 4: {why}")), "{err}");
    }
}
