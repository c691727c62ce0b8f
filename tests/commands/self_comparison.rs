//! Pins `examples/self_comparison`: its exit codes, that parts add up to the whole, what it refuses, and that the program reads its cases.

use crate::engines::built_example;
use crate::place::Place;
#[cfg(unix)]
use crate::processes::{signal, until};
use rockproof_model::Contact;
use rockproof_pairs::batch::PairConfig;
use rockproof_results::Start;
use rockproof_stepper::engine::EngineError;
use rockproof_validation::self_comparison::paths::{BuiltIn, Paths, Question};
use rockproof_validation::self_comparison::record::{ComparisonPlan, ComparisonRecord, PairsMark};
use rockproof_validation::self_comparison::run::{Comparison, ProgressCounts};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::AtomicBool;

/// Exit code, standard output and standard error.
fn ran(place: &Place, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(built_example("self_comparison"));
    let output = command.args(arguments).current_dir(place.path("")).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn works(place: &Place, arguments: &[&str]) -> String {
    let (code, out, err) = ran(place, arguments);
    assert_eq!(code, Some(0), "{arguments:?}: {out}{err}");
    out
}

fn refused(place: &Place, arguments: &[&str], wanted: &[&str]) {
    let (code, out, err) = ran(place, arguments);
    assert!(code == Some(2) && wanted.iter().all(|part| err.contains(part)), "{arguments:?}: {code:?}: {out}{err}");
}

#[test]
#[ignore = "eight seconds; .ci/run runs it"]
fn parts_add_up_and_what_is_wrong_exits_2() {
    let place = Place::new();
    let pairs = ["run", "--pairs", "160", "--seed", "2", "--plain-every", "0", "--threads", "1"];
    let run = |more: &[&str]| works(&place, &[&pairs[..], more].concat());
    run(&["--part", "1/2", "--out", "parts/1"]);
    run(&["--part", "2/2", "--out", "parts/2"]);
    run(&["--out", "whole"]);
    let totals = |dirs: &[&str]| {
        let out = works(&place, &[&["total", "--format", "json"], dirs].concat());
        let document: Value = serde_json::from_str(&out).expect("JSON");
        let signs: u64 =
            document["totals"]["levels"].as_array().expect("levels").iter().filter_map(Value::as_u64).sum();
        (document["totals"]["families"].clone(), signs)
    };
    let whole = totals(&["whole"]);
    assert!(whole.0.as_object().is_some_and(|families| families.len() == 10) && whole.1 > 160, "{whole:?}");
    let parts = totals(&["parts/1", "parts/2"]);
    assert_eq!(parts.0, whole.0);
    // The first signs of a process are not decided as those that follow.
    assert!(parts.1.abs_diff(whole.1) * 20 < whole.1, "{} and {}", parts.1, whole.1);
    let told = works(&place, &["total", "parts/1"]);
    assert!(told.contains("no disagreement in 90 comparisons; 80 of 80 pairs done, seed 2"), "{told}");

    refused(&place, &["total", "parts/1", "whole"], &["parts/1", "whole", "0 to 79 of seed 2"]);
    refused(&place, &["total", "nowhere"], &["nowhere", "there is no such directory"]);
    let again = |more: &[&'static str]| [&pairs[..], more].concat();
    refused(&place, &again(&["--out", "whole"]), &["whole holds a comparison already"]);
    refused(&place, &["run", "--pairs", "100", "--out", "x"], &["'100'", "multiples of 16"]);
    refused(&place, &again(&["--part", "3/2", "--out", "x"]), &["\"3/2\" is no part"]);
    if cfg!(not(feature = "gmp")) {
        refused(&place, &again(&["--gmp-every", "1", "--out", "x"]), &["--gmp-every", "without GMP", "--features gmp"]);
    }
    let campaign = place.run(&["campaign", "--pairs", "16", "--tolerances", "auto", "--out", "campaign"]);
    assert_eq!(campaign.0, 0, "{campaign:?}");
    refused(&place, &again(&["--out", "campaign", "--overwrite"]), &["belongs to `rockproof campaign`"]);
    let (code, _, err) = place.run(&["campaign", "--pairs", "16", "--out", "whole", "--overwrite"]);
    assert!(code == 2 && err.contains("belongs to `cargo run --example self_comparison`"), "{err}");
    let state = place.read("whole/comparison.json");
    place.file("whole/comparison.json", &state.replacen("160", "176", 1));
    refused(&place, &again(&["--out", "whole", "--resume"]), &["whole/comparison.json", "not as it was written"]);
    refused(&place, &["total", "whole"], &["whole/comparison.json", "not as it was written"]);
    assert!(!place.path("x").exists());
}

/// The stepper in 512 bits loses its last contact.
struct Loses;

impl Paths for Loses {
    fn wide(&self, asked: Question<'_>) -> Result<(Vec<Contact>, u64), EngineError> {
        BuiltIn.wide(asked).map(|(mut contacts, unsettled)| {
            contacts.pop();
            (contacts, unsettled)
        })
    }
}

const PLAN: ComparisonPlan = ComparisonPlan { seed: 2, pairs: 32, plain_every: 0, gmp_every: 0, part: None };

fn record(dir: &Path) -> ComparisonRecord {
    ComparisonRecord::open(dir, PLAN, &PairsMark::of(&PairConfig::default()), Start::Fresh).expect("a directory")
}

/// As after a stop at once.
#[test]
fn nothing_compared_is_no_agreement() {
    let place = Place::new();
    drop(record(&place.path("begun")));
    let (code, out, err) = ran(&place, &["total", "begun"]);
    assert!(code == Some(2) && out.contains("no verdict yet in 0 comparisons; 0 of 32 pairs done"), "{out}{err}");
    assert!(err.contains("nothing is compared yet: there is no verdict"), "{err}");
}

fn mistaken_comparison(dir: &Path) {
    let config = PairConfig::default();
    let mut record = record(dir);
    let comparison = Comparison { paths: &Loses, config: &config, threads: 1 };
    comparison.run(&mut record, &AtomicBool::new(false), &ProgressCounts::default()).expect("runs");
}

#[test]
fn disagreements_exit_1_and_their_cases_are_read() {
    let place = Place::new();
    mistaken_comparison(&place.path("wrong"));
    let rows = place.rows("wrong/disagreements.csv");
    let row = rows.iter().find(|row| row["path"] == "wide" && row["input"] == "exact").expect("a row");
    let case = format!("wrong/{}", row["case"]);
    let (code, out, err) = ran(&place, &["total", "wrong"]);
    assert!(code == Some(1) && out.contains("DISAGREEMENTS in 36 comparisons"), "{out}{err}");
    assert!(
        out.contains(&format!("wide says missing {} of seed 2", row["kind"])) && out.contains("wrong/cases/wide-"),
        "{out}"
    );
    let finished = ["run", "--pairs", "32", "--seed", "2", "--plain-every", "0", "--out", "wrong", "--resume"];
    assert_eq!(ran(&place, &finished).0, Some(1), "a run that has ended with disagreements says so again");
    // The paths as they are have no mistake.
    assert!(works(&place, &["check", &case]).contains("all paths agree"));
    refused(&place, &["check", "wrong/disagreements.csv"], &["wrong/disagreements.csv"]);
    let (code, out, err) = place.run(&["replay", &case]);
    assert!(code == 1 && out.contains("does not recur") && !err.contains("not the one the case expects"), "{out}{err}");
    let (code, out, err) = place.run(&["classify", &case]);
    assert!(code == 0 && out.contains(&row["kind"]), "{out}{err}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_done_and_says_how_to_go_on() {
    let place = Place::new();
    let arguments = ["run", "--pairs", "1600000", "--plain-every", "0", "--out", "long", "--threads", "1"];
    let mut command = Command::new(built_example("self_comparison"));
    let child = command.args(arguments).current_dir(place.path("")).stdout(std::process::Stdio::piped());
    let mut child = child.stderr(std::process::Stdio::piped()).spawn().expect("runs");
    let done = || {
        let state = std::fs::read_to_string(place.path("long/comparison.json")).unwrap_or_default();
        let state: Value = serde_json::from_str(&state).unwrap_or_default();
        state["pairs_done"].as_u64().unwrap_or(0)
    };
    until("a first chunk is done", || done() > 0 || child.try_wait().expect("a child").is_some());
    let before = done();
    signal(&child, "INT");
    let output = child.wait_with_output().expect("ends");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(130), "{out}{err}");
    assert!(err.contains("--out long --threads 1 --resume") && before > 0 && done() >= before, "{before}: {err}");
    assert!(out.contains("no disagreement") && out.contains("of 1\u{202f}600\u{202f}000 pairs done"), "{out}");
}
