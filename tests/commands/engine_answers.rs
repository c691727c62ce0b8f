//! What is said of answers that are none, of those that nobody asked for, and of those to changed pairs.

use crate::engines::client;
use crate::place::rockproof_in;
use std::fs;
use std::path::Path;

/// Begins a loop over questions, with the number of each in `$id` and its search distance in `$search`. That stands near the end of the line: a shell that
/// looked for it from the beginning would take milliseconds for each.
const ASKED: &str = "n=0; while read -r line; do n=$((n+1)); id=${line#*\\\"id\\\":}; id=${id%%,*}; search=${line##*\\\"search\\\":}; search=${search%%,*};";
const NO_CONTACTS: &str = "echo \"{\\\"id\\\":$id,\\\"contacts\\\":[]}\";";

/// A campaign with a shell script for an engine, and what it printed.
fn campaign(dir: &Path, body: &str, more: &[&str]) -> String {
    fs::write(dir.join("mine.sh"), format!("{ASKED} {body} done\n")).expect("write");
    let few = "cases_per_cause = 64\nshrink_evaluations = 3\nsteps_every = 0\n";
    let changed = u8::from(body.contains("state"));
    fs::write(dir.join("few.toml"), format!("{few}metamorphic_every = {changed}\n")).expect("write");
    let start = ["campaign", "few.toml", "--tolerances", "auto", "--engine-command", "mine=sh mine.sh"];
    let rest = ["--engine", "mine", "--threads", "1", "--overwrite", "--out", "out"];
    let (code, said, err) = rockproof_in(dir, &[&start[..], &rest, more].concat());
    assert_eq!(code, 0, "{said}{err}");
    said
}

/// The case whose name holds this.
fn case(dir: &Path, what: &str) -> String {
    let names = fs::read_dir(dir.join("out/cases")).expect("cases").map(|case| case.expect("a case").file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    let name = names.iter().find(|name| name.contains(what)).unwrap_or_else(|| panic!("{what}: {names:?}"));
    format!("out/cases/{name}")
}

const FEW: [&str; 4] = ["--family", "face_stack", "--pairs", "32"];

#[test]
fn answers_that_cannot_be_read_are_not_diagnosed_and_no_contacts_are() {
    let dir = crate::place::folder();
    // Right about the first question, which is about two boxes far from each other.
    let boxes = "case \"$line\" in *'[[0.0,0.0,0.0],'*'[[2.0,0.0,0.0],'*)";
    for answer in ["echo hello world;", "echo \"{\\\"id\\\":$((id+1)),\\\"contacts\\\":[]}\";"] {
        let said = campaign(dir.path(), &format!("{boxes} {NO_CONTACTS} ;; *) {answer} ;; esac;"), &FEW);
        let table = fs::read_to_string(dir.path().join("out/diagnosis.csv")).expect("a table");
        assert!(said.contains("malformed") && !said.contains("differing answer"), "{said}");
        assert_eq!(table.lines().count(), 1, "{table}");
    }
    let said = campaign(dir.path(), NO_CONTACTS, &FEW);
    let table = fs::read_to_string(dir.path().join("out/diagnosis.csv")).expect("a table");
    assert!(table.lines().nth(1).is_some_and(|row| row.starts_with("mine,explains,no-contacts,")), "{table}");
    assert!(said.contains("are exact but that no contact at all is reported; no right answer of "), "{said}");
}

#[test]
fn what_a_fresh_process_does_not_say_is_no_case_to_begin_with() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let said = campaign(dir, &format!("[ $((n % 20)) = 0 ] && echo debug: pair $n; {NO_CONTACTS}"), &FEW);
    let malformed = case(dir, "-malformed-");
    let next = said.split("next: ").nth(1).expect("commands");
    assert!(next.contains("rockproof replay out/cases/") && !next.contains("malformed"), "{said}");
    let engine = ["--engine-command", "mine=sh mine.sh"];
    let (code, said, err) = rockproof_in(dir, &[&["replay", &malformed][..], &engine].concat());
    let why =
        "when it was found: malformed answer: output that nobody asked for, from a process that had answered before";
    assert!(code == 1 && said.contains(why), "{said}{err}");
    let (code, _, err) = rockproof_in(dir, &[&["shrink", &malformed, "--out", "small.toml"][..], &engine].concat());
    assert!(code == 2 && err.contains("its finding: engine malformed by mine") && !err.contains("()"), "{err}");
}

#[test]
fn the_answer_to_a_changed_pair_is_shown() {
    let dir = crate::place::folder();
    let dir = dir.path();
    // Apart, unless it is a thousandth of the usual size.
    let state = "case $search in 0.00*|*e-*) state=overlapping ;; *) state=apart ;; esac; echo \"{\\\"id\\\":$id,\\\"state\\\":\\\"$state\\\"}\";";
    campaign(dir, state, &FEW);
    let scaled = case(dir, "-scale-");
    let replay = ["replay", &scaled, "--engine-command", "mine=sh mine.sh"];
    let (code, said, err) = rockproof_in(dir, &replay);
    let told = [
        "scale: \"…, scale\" are answers to the same pair with all lengths",
        "\nmine: apart",
        "\nmine, scale: overlapping",
    ];
    assert!(code == 0 && told.iter().all(|told| said.contains(told)), "{said}{err}");
    assert!(said.contains("\nexact f64, scale: "), "{said}");
    let (_, said, _) = rockproof_in(dir, &[&replay[..], &["--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    let names: Vec<&str> =
        json["answers"].as_array().expect("a list").iter().filter_map(|a| a["name"].as_str()).collect();
    assert!(names.contains(&"mine, scale") && json["changed_pair"].is_string(), "{json}");
}

#[test]
fn who_misspells_an_engine_is_told_of_all() {
    let dir = crate::place::folder();
    let engine = format!("mine={}", client());
    let start =
        ["campaign", "--pairs", "8", "--out", "out", "--engine-command", &engine, "--engine-command", "other=x"];
    for more in [&["--engine", "your"][..], &["--engine", "mine", "--engine", "your"]] {
        let (code, _, err) = rockproof_in(dir.path(), &[&start[..], more].concat());
        let told = "engine \"your\" does not exist; there are stepper-f32, stepper-f64, mine, other";
        assert!(code == 2 && err.contains(told), "{err}");
    }
}

#[test]
fn what_recurs_is_told_and_what_came_instead_of_answers() {
    let dir = crate::place::folder();
    let dir = dir.path();
    // The first answer of a process is to its question, every other to the one before.
    let late = "last=$((id>0?id-1:0)); echo \"{\\\"id\\\":$last,\\\"contacts\\\":[]}\";";
    let said = campaign(dir, late, &FEW);
    let told =
        "mine: instead of answers it gave, among others:\n  malformed answer: output that nobody asked for, from";
    assert!(said.contains(told), "{said}");
    let replay = ["replay", &case(dir, "-malformed-"), "--engine-command", "mine=sh mine.sh"];
    let (code, said, err) = rockproof_in(dir, &replay);
    let again = said.split("the finding recurs\n").nth(1).unwrap_or_else(|| panic!("{said}{err}"));
    assert!(code == 0 && again.contains("  malformed answer: ") && again.contains("id is "), "{said}{err}");
    let (_, said, _) = rockproof_in(dir, &[&replay[..], &["--format", "json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&said).expect("JSON");
    assert!(json["said_again"][0].as_str().is_some_and(|note| note.contains("id is ")), "{json}");
}

#[test]
fn a_program_that_changed_before_the_run_goes_on_is_told() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let write = |words: &str| fs::write(dir.join("mine.sh"), format!("{ASKED} {NO_CONTACTS} done {words}\n"));
    let run = |pairs: &str, start: &str| {
        let engine = ["--engine", "mine", "--engine-command", "mine=sh mine.sh", "--out", "out"];
        let few =
            ["campaign", "no_cases.toml", "--family", "face_stack", "--tolerances", "auto", "--pairs", pairs, start];
        let (code, said, err) = rockproof_in(dir, &[&few[..], &engine].concat());
        assert_eq!(code, 0, "{said}{err}");
        said
    };
    let changed = "mine: its program, or the first file among its arguments, changed while the campaign went on: 2 different ones were asked";
    fs::write(dir.join("no_cases.toml"), "cases_per_cause = 0\n").expect("written");
    write("").expect("written");
    assert!(!run("16", "--overwrite").contains(changed));
    assert!(!run("32", "--resume").contains(changed));
    write("# built anew").expect("written");
    assert!(run("48", "--resume").contains(changed));
    let (_, said, err) = rockproof_in(dir, &["report", "out"]);
    assert!(said.contains(changed), "{said}{err}");
    let text = fs::read_to_string(dir.join("out/run.json")).expect("run.json");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(json["external_engines"]["mine"]["programs"].as_array().map(Vec::len), Some(2), "{json}");
    assert!(!run("16", "--overwrite").contains(changed));
}

/// Of an engine that refuses nearly all pairs nothing is found: what ended so must not pass for better.
#[test]
fn a_comparison_with_an_engine_that_hardly_answers_is_denied() {
    let dir = crate::place::folder();
    let place = dir.path();
    campaign(place, NO_CONTACTS, &FEW);
    fs::rename(place.join("out"), place.join("before")).expect("renamed");
    let refuses = "echo \"{\\\"id\\\":$id,\\\"unsupported\\\":\\\"no\\\"}\";";
    campaign(place, &format!("if [ $n = 1 ]; then {NO_CONTACTS} else {refuses} fi;"), &FEW);
    let told = "mine answered less than half of the pairs of the run after, and not so before";
    let (code, out, _) = rockproof_in(place, &["compare", "before", "out"]);
    assert!(code == 0 && out.contains(told), "{out}");
    let (code, _, err) = rockproof_in(place, &["compare", "before", "out", "--deny", "more"]);
    assert!(code == 1 && err.contains(&format!("note: denied: {told}, so little was compared\n")), "{err}");
    // An engine that never does most pairs, and says so, is none the worse.
    for runs in [["out", "before"], ["out", "out"]] {
        let (code, out, err) = rockproof_in(place, &["compare", runs[0], runs[1], "--deny", "other"]);
        assert!(code == 0 && !out.contains(told), "{out}{err}");
    }
}
