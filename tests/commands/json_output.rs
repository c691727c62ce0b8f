//! Pins `--format json`: one document on stdout, messages elsewhere, and the values of the table that it stands for.

use crate::place::rockproof_in;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The document that a command prints, and nothing else.
fn document(place: &Path, expected: i32, args: &[&str]) -> Value {
    let (code, out, _) = rockproof_in(place, &[args, &["--format", "json"]].concat());
    assert_eq!(code, expected, "{args:?}: {out}");
    assert!(out.ends_with("}\n"), "{out}");
    serde_json::from_str(&out).unwrap_or_else(|e| panic!("{args:?}: {e}: {out}"))
}

fn model(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/real").join(name).display().to_string()
}

#[test]
fn check_says_the_same_to_programs() {
    let place = crate::place::folder();
    let file = model("slope_joints.dda");
    let args = ["check", &file, "--tolerances", "shi"];
    let (code, text, _) = rockproof_in(place.path(), &args);
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
    let pairs = overlaps["pairs"].as_array().expect("pairs");
    assert_eq!(pairs.len(), 19);
    let counts = ["seen", "shallow", "unseen"].map(|sight| {
        assert_eq!(overlaps[sight], pairs.iter().filter(|pair| pair["contacts_see_it"] == sight).count(), "{sight}");
        format!("{} {sight}", overlaps[sight])
    });
    assert!(text.contains(&format!("pass through one another ({})", counts.join(", "))), "{text}");
    let classified = document(place.path(), 0, &["classify", &file, "--tolerances", "shi"]);
    assert_eq!(classified["overlaps"], *overlaps);
    let search = found["tolerances"]["search"].as_f64().expect("a length");
    assert!(text.contains(&format!("\n  search            {search:>13.6e}\n")), "{text}");
    assert_eq!(found["tolerances"]["criteria"], "classic");
}

#[test]
fn campaigns_and_gates_say_the_same_to_programs() {
    let place = crate::place::folder();
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
    assert_eq!(found["verdict"].as_array().map(Vec::len), Some(4));
    let steps = found["steps"].as_array().expect("rows");
    assert!(steps.iter().all(|row| row["engine"].is_string() && row["other_contacts"].is_u64()));

    let gate = "corpus = []\n[campaign]\npairs = 64\nfamilies = [\"sliver\"]\n[[limit]]\ncause = \"defect\"\ncount = 0\n[[limit]]\ncause = \"tolerance\"\ncount = 0\n";
    fs::write(place.path().join("gate.toml"), gate).expect("write");
    let (_, text, _) = rockproof_in(place.path(), &["gate", "gate.toml"]);
    let found = document(place.path(), 1, &["gate", "gate.toml"]);
    let checks = found["checks"].as_array().expect("checks");
    assert!(
        found["passed"] == false
            && found["skipped"] == 0
            && text.contains(&format!("gate failed: 1 passed, 0 skipped, {} failed", found["failed"]))
            && checks.len() == 2
    );
    assert!(checks.iter().all(|check| text.contains(check["check"].as_str().expect("a name"))));
}

#[test]
fn the_stress_set_is_one_document() {
    let (dir, printed) = crate::stress_command::whole();
    assert!(printed.ends_with("}\n"), "{printed}");
    let found: Value = serde_json::from_str(printed).unwrap_or_else(|e| panic!("{e}: {printed}"));
    let rows = |name: &str| {
        let text = fs::read_to_string(dir.join(name)).expect("a table");
        text.lines().count() - 1
    };
    for (name, table) in [("cells", "stress.csv"), ("limits", "limits.csv"), ("steps", "steps.csv")] {
        assert_eq!(found["stress"][name].as_array().map(Vec::len), Some(rows(table)), "{name}");
    }
    let stopped =
        found["stress"]["steps"].as_array().expect("steps").iter().filter_map(|step| step["stopped"].as_str());
    assert!(
        stopped.clone().count() > 0
            && stopped.clone().all(|why| why.starts_with("settling step -19 (the last is 0): "))
    );
    // 16 pairs a cell: one that differs proves nothing.
    let limits = found["stress"]["limits"].as_array().expect("limits");
    let once: Vec<&Value> = limits.iter().filter(|limit| limit["share_beyond"] == 0.0625).collect();
    assert!(!once.is_empty() && once.iter().all(|limit| limit["beyond_is"] == "too few pairs"), "{once:?}");
}

#[test]
fn a_search_says_the_same_to_programs() {
    let place = crate::place::folder();
    let file = model("smallEdge.dda");
    let args = ["tune", &file, "--candidates", "3", "--steps", "4", "--out", "found"];
    let (code, out, _) = rockproof_in(place.path(), &[&args[..], &["--format", "json"]].concat());
    let found: Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}"));
    assert_eq!((code == 0, &found["candidates"]), (found["clean"] == true, &Value::from(3)));
    let set = place.path().join("found/tolerances.toml").display().to_string();
    let checked = document(place.path(), 0, &["check", &file, "--tolerances", &set]);
    assert_eq!(checked["tolerances"], found["recommended"]["tolerances"]);
}

/// The document of a command, run in the folder of the project, and its exit code.
fn answer(args: &[&str]) -> (i32, Value) {
    let (code, out, _) = rockproof_in(Path::new(env!("CARGO_MANIFEST_DIR")), &[args, &["--format", "json"]].concat());
    (code, serde_json::from_str(&out).unwrap_or_else(|e| panic!("{args:?}: {e}: {out}")))
}

#[test]
fn runs_say_the_same_to_programs() {
    let place = crate::place::folder();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/handmade/incline_1_4_settled.toml");
    let scene = scene.display().to_string();
    let run = |args: &[&str]| document(place.path(), 0, &[&["simulate", &scene, "--steps", "4"], args].concat());
    let found = run(&["--lockstep", "--audit", "--out", "both"]);
    let kept: Value =
        serde_json::from_slice(&fs::read(place.path().join("both/run.json")).expect("run.json")).expect("JSON");
    let totals = &kept["totals"];
    assert!(found["ending"] == "finished" && found["reason"].is_null() && found["steps"] == 4);
    for (name, kept) in
        [("iterations", "iterations"), ("most_iterations", "most_iterations"), ("settling_steps", "settling")]
    {
        assert_eq!(found[name], totals[kept], "{name}");
    }
    assert_eq!(found["contacts"]["locked"], totals["contacts"][2]);
    assert_eq!(found["deepest_contact_m"]["step"], totals["deepest"]["step"]);
    assert!(found["lockstep"]["differences"]["arithmetic"].is_u64() && found["audit"]["objects"] == false);
    assert_eq!(found["lockstep"]["steps"].as_u64(), Some(4 + found["settling_steps"].as_u64().expect("a count")));
    let usual = run(&["--out", "usual"]);
    assert!(usual["audit"]["deepest"] == found["audit"]["deepest"] && usual["audit"]["passages"].is_null());
    let bare = run(&["--no-audit", "--out", "bare"]);
    assert!(bare["lockstep"].is_null() && bare["audit"].is_null() && bare["kinetic_j"] == found["kinetic_j"]);
    let exact = run(&["--engine", "exact", "--out", "exact"]);
    assert!(exact["ending"] == "finished" && exact["steps"] == 4 && exact["kept"].is_string());
    // What is not run says why.
    let model = model("slope_joints.dda");
    let refused = document(place.path(), 1, &["simulate", &model, "--steps", "1", "--out", "none"]);
    assert!(refused["ending"] == "not run" && refused["overlaps"]["lost"] == 19, "{refused}");
    assert!(!place.path().join("none").exists());
}

#[test]
fn a_replayed_case_says_the_same_to_programs() {
    let case = "cases/regressions/v-e-arithmetic-foot-region.toml";
    let (_, text, _) = rockproof_in(Path::new(env!("CARGO_MANIFEST_DIR")), &["replay", case]);
    let (code, found) = answer(&["replay", case]);
    assert!(code == 0 && found["recurs"] == true && found["exact_answer_as_recorded"] == true, "{found}");
    assert!(found["finding"]["cause"] == "arithmetic" && found["finding"]["predicate"] == "foot-region");
    let answers = found["answers"].as_array().expect("answers");
    let names: Vec<&str> = answers.iter().map(|answer| answer["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["ideal", "exact", "exact f32", "stepper-f32", "exact f64", "stepper-f64"]);
    let engine = names.iter().position(|name| found["finding"]["engine"] == *name).expect("the engine");
    assert_ne!(answers[engine]["contacts"], answers[engine - 1]["contacts"]);
    for parting in found["partings"].as_array().expect("partings") {
        assert!(text.contains(parting["between"].as_str().expect("a title")));
        for decision in parting["decisions"].as_array().expect("decisions") {
            assert!(
                text.contains(decision["decision"].as_str().expect("a decision")) && decision["margin"].is_number()
            );
        }
    }
}

#[test]
fn a_replayed_step_says_the_same_to_programs() {
    let case = "fuzz/corpus/state/step_000002.json";
    let (code, text, _) = rockproof_in(Path::new(env!("CARGO_MANIFEST_DIR")), &["replay", case]);
    let (same, found) = answer(&["replay", case]);
    assert!(code == same && found["step"] == 2);
    assert_eq!(found["recurs"] == true, text.contains("the finding recurs"));
    for side in ["oracle", "stepper"] {
        let contacts = found[side]["contacts"].as_array().expect("contacts");
        let solves = found[side]["solves"].as_u64().expect("a count") as usize;
        assert!(contacts.iter().all(|contact| contact["modes"].as_array().map(Vec::len) == Some(solves)), "{found}");
    }
    for difference in found["differences"].as_array().expect("differences") {
        assert!(text.contains(difference["before"].as_str().expect("words")));
    }
}

#[test]
fn measurements_are_objects_of_numbers() {
    let (code, found) = answer(&["bench", "--quick"]);
    assert!(code == 0 && found["measure"] == "classification");
    let rows = found["rows"].as_array().expect("rows");
    let timed = rows.iter().filter(|row| row["measure"] != "campaign");
    assert!(
        timed.clone().count() > 10 && timed.clone().all(|row| row["pairs"].is_u64() && row["us_per_pair"].is_number())
    );
    assert!(
        rows.iter()
            .any(|row| row["measure"] == "campaign" && row["findings"].is_u64() && row["ratio_to_f64"].is_null())
    );
    let (code, found) = answer(&["bench", "--stack", "20", "--steps", "2"]);
    let row = &found["rows"][0];
    assert!(code == 0 && found["measure"] == "steps" && row["scene"] == "stack" && row["blocks"] == 21, "{found}");
    assert!(row["ms_a_step"].is_number() && row["us_a_block"].is_number(), "{row}");
}
