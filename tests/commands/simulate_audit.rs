//! Pins `simulate --audit`: what it fills in and says, that it objects to blocks that pass through one another and to nothing
//! else, and that its bytes depend neither on threads nor on interruptions. And what `check` and `report` say of the same.

use crate::place::Place;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Blocks that fall on a floor, askew and one on the other.
const FALL: &str = r#"
[simulation]
gravity = [1, 0, -10]
time_step = 0.005
steps = 40
settle = 2

[[block]]
name = "floor"
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
name = "low"
box = { min = [0, 0, 0.01], max = [1, 1, 1] }
spin = [0.3, 0.1, 0]

[[block]]
name = "high"
box = { min = [0.3, 0.2, 1.01], max = [1.3, 1.2, 2] }
velocity = [0.5, 0, -1]
"#;

/// A cube of 10 cm at 50 m/s, and a fixed plate of 5 cm that it is before and behind at the ends of the second step.
const SHOT: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 0.01
steps = 3

[[block]]
name = "plate"
fixed = true
box = { min = [0.75, -1, -1], max = [0.8, 1, 1] }

[[block]]
name = "shot"
motion = "rigid"
box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }
velocity = [50, 0, 0]
"#;

fn step_rows(place: &Place, dir: &str) -> Vec<BTreeMap<String, String>> {
    place.rows(&format!("{dir}/steps.csv"))
}

fn totals_of(place: &Place, dir: &str) -> serde_json::Value {
    let run: serde_json::Value = serde_json::from_str(&place.read(&format!("{dir}/run.json"))).expect("JSON");
    run["totals"].clone()
}

const COLUMNS: [&str; 4] = ["unseen_pairs", "true_penetration_m", "passages", "undecided_passages"];

#[test]
fn a_sound_run_is_audited_to_the_same_bytes_whoever_does_it() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let args = ["simulate", "fall.toml", "--every", "7", "--audit", "--out"];
    let (code, out, err) = place.on_threads(1, &[&args[..], &["whole"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    assert!(
        out.contains("\naudit            contacts see every overlap after 42 steps, and no passage within one"),
        "{out}"
    );
    let steps = step_rows(&place, "whole");
    let depth = |row: &BTreeMap<String, String>| row["true_penetration_m"].parse::<f64>().expect("a depth");
    assert!(steps.len() == 42 && steps.iter().all(|row| row["unseen_pairs"] == "0" && row["passages"] == "0"));
    assert!(steps.iter().any(|row| depth(row) > 0.0), "something was hit");
    // In two sessions, on more threads.
    let halves = [&args[..], &["parts", "--resume", "--steps"]].concat();
    for until in ["17", "40"] {
        assert_eq!(place.on_threads(4, &[&halves[..], &[until]].concat()).0, 0);
    }
    let read = |dir: &str| fs::read(place.path(dir).join("steps.csv")).expect("steps.csv");
    assert!(read("whole") == read("parts"));
    assert_eq!(totals_of(&place, "whole")["audit"], totals_of(&place, "parts")["audit"]);
    // Without it the columns are empty, all others are the same, and one run is not taken for the other.
    assert_eq!(place.run(&["simulate", "fall.toml", "--every", "7", "--out", "bare"]).0, 0);
    for (mut audited, bare) in steps.into_iter().zip(step_rows(&place, "bare")) {
        assert!(COLUMNS.iter().all(|column| bare[*column].is_empty()), "{bare:?}");
        audited.extend(COLUMNS.map(|column| (column.to_owned(), String::new())));
        assert_eq!(audited, bare);
    }
    assert!(totals_of(&place, "bare").get("audit").is_none());
    let (code, _, err) = place.run(&[&args[..], &["bare", "--resume"]].concat());
    assert!(code == 2 && err.contains("audit: the run has"), "{err}");
    let (code, _, err) = place.run(&["simulate", "fall.toml", "--engine", "exact", "--audit"]);
    assert!(code == 2 && err.contains("--audit"), "{err}");
}

#[test]
fn a_block_that_passes_through_another_within_a_step_is_told() {
    let place = Place::new();
    place.file("shot.toml", SHOT);
    // Tolerances that break the rules: the step is far too long.
    let args =
        ["simulate", "shot.toml", "--force", "--set", "max_displacement=1", "--set", "penetration=1/100", "--out"];
    assert_eq!(place.run(&[&args[..], &["bare"]].concat()).0, 0, "nobody looks");
    let (code, out, err) = place.run(&[&args[..], &["shot", "--audit"]].concat());
    assert_eq!(code, 1, "{out}{err}");
    let told = "audit            blocks pass through one another: 1 passage within a step (worst 0–1, ";
    assert!(out.contains(told) && out.contains(" m, step 2); no overlap after any step"), "{out}");
    let passages: Vec<String> = step_rows(&place, "shot").into_iter().map(|row| row["passages"].clone()).collect();
    assert_eq!(passages, ["0", "1", "0"]);
    assert_eq!(totals_of(&place, "shot")["audit"]["worst_passage"]["step"], 2);
    // A report on it begins with that; on the other it says that nobody looked.
    let (code, out, err) = place.run(&["report", "shot", "--format", "markdown"]);
    assert!(code == 0 && out.contains("❌ shot: blocks pass through one another: 1 passage"), "{out}{err}");
    let (code, out, err) = place.run(&["report", "bare", "--format", "markdown"]);
    assert!(code == 0 && out.contains("bare: not audited"), "{out}{err}");
    let (code, out, err) = place.run(&["report", "shot", "bare", "--out", "page"]);
    assert_eq!(code, 0, "{out}{err}");
    let page = fs::read_to_string(place.path("page/report.html")).expect("a page");
    assert!(page.contains("Do blocks pass through one another?") && page.contains("bare: not audited"));
    let table = fs::read_to_string(place.path("page/tables/audit.csv")).expect("a table");
    assert!(table.lines().nth(1).is_some_and(|row| row.starts_with("shot,f64,finished,3,0,0,,,1,0,0-1,")), "{table}");
}

#[test]
fn overlaps_that_no_contact_sees_are_told_with_the_worst_pair_and_step() {
    let place = Place::new();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/real/slope_joints.dda");
    let args = ["simulate", model.to_str().expect("text"), "--force", "--steps", "2", "--out"];
    let (code, out, err) = place.run(&[&args[..], &["audited", "--audit"]].concat());
    assert_eq!(code, 1, "{out}{err}");
    let told = "blocks pass through one another: up to 19 pairs overlap where no contact sees it, after 2 of 2 steps (worst 2–3, 1.1694 m";
    assert!(out.contains(told), "{out}");
    assert!(step_rows(&place, "audited").iter().all(|row| row["unseen_pairs"] == "19"));
    // Without it the end says what the beginning said, and how to look.
    let (code, out, err) = place.run(&[&args[..], &["bare"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    assert!(
        out.contains("\nmodel            19 pairs (worst 2–3, 1.1694 m) overlap deeper") && out.contains("--audit"),
        "{out}"
    );
}

#[test]
fn check_warns_of_a_fall_and_does_not_object_to_it() {
    let place = Place::new();
    let soft =
        FALL.replace("[[block]]\nname = \"floor\"", "[[joint]]\nnormal_stiffness = 1e7\n\n[[block]]\nname = \"floor\"");
    place.file("soft.toml", &soft);
    place.file("stiff.toml", &soft.replace("1e7", "1e12"));
    let (code, out, err) = place.run(&["check", "soft.toml"]);
    assert!(code == 0 && out.contains("rules: all met"), "{out}{err}");
    assert!(
        out.contains("warning: a fall may end deeper than penetration") && out.contains("1.000000e7, needed is "),
        "{out}"
    );
    let (code, out, err) = place.run(&["check", "stiff.toml"]);
    assert!(code == 0 && !out.contains("warning"), "{out}{err}");
}
