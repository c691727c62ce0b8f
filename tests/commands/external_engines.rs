//! External engines over the line protocol: the right client agrees with the built-in stepper; every kind of misbehaviour is a
//! finding and never the end of the run; threads and resuming change nothing; nonsense never panics.

use crate::campaigns::CASES_AS_FOUND;
use crate::engines::{client, cpp_client, example, skipped, there};
use crate::place::rockproof;
use assert_cmd::Command;
use proptest::prelude::*;
use rockproof_differential::engine::{Answer, EngineFailure};
use rockproof_differential::external::protocol;
use rockproof_model::Topology;
use std::fs;
use std::path::Path;

/// Runs a campaign with one external engine alone and gives the rows about it.
fn rows(dir: &Path, name: &str, command: &str, more: &[&str]) -> Vec<Vec<String>> {
    let out = dir.join(name);
    let (engine, out_text) = (format!("mine={command}"), out.to_string_lossy().into_owned());
    let mut args = vec!["campaign", "--pairs", "256", "--family", "face_stack,edge_cross", "--engine-command", &engine];
    args.extend(["--out", &out_text]);
    args.extend(more);
    let (code, _, err) = rockproof(&args);
    assert_eq!(code, 0, "{name}: {err}");
    findings(&out, "mine")
}

fn findings(out: &Path, engine: &str) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_path(out.join("findings.csv")).expect("findings");
    let all = reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect::<Vec<_>>());
    all.filter(|row| row[4] == engine).collect()
}

const ONLY: [&str; 2] = ["--engine", "mine"];

#[test]
fn a_client_around_the_stepper_finds_what_the_stepper_finds() {
    let dir = crate::place::folder();
    let beside = rows(dir.path(), "beside", &client(), &[CASES_AS_FOUND]);
    let kept = |rows: Vec<Vec<String>>| -> Vec<Vec<String>> {
        rows.into_iter().map(|row| [&row[0..4], &row[6..9]].concat()).collect()
    };
    let builtin = findings(&dir.path().join("beside"), "stepper-f64");
    assert!(beside.iter().all(|row| row[5] == "engine"), "{beside:?}");
    assert_eq!(kept(beside), kept(builtin));
}

#[test]
#[ignore = "half a minute; .ci/run runs it"]
fn every_misbehaviour_is_a_finding() {
    let dir = crate::place::folder();
    for (trick, change, more) in [
        ("crash", "crash", &[][..]),
        // Each third question is waited for.
        ("hang", "timeout", &["--engine-timeout", "0.2"]),
        ("malformed", "malformed", &[]),
        ("unasked", "malformed", &[]),
        ("endless", "malformed", &[]),
        ("unsupported", "unsupported", &[]),
        ("none", "missing", &[]),
        ("state", "state", &[]),
    ] {
        let args = [&ONLY[..], more].concat();
        let found = rows(dir.path(), trick, &format!("{} {trick}", client()), &args);
        let count = found.iter().filter(|row| row[6] == change).count();
        assert!(count > 0, "{trick}: {found:?}");
        let cases = fs::read_dir(dir.path().join(trick).join("cases")).expect("cases").count();
        assert!(cases > 0, "{trick}: a case to replay");
    }
    // A line too many is told as such.
    let cases = fs::read_dir(dir.path().join("unasked/cases")).expect("cases");
    let mut cases = cases.map(|case| case.expect("a case").path());
    let case = cases.find(|case| case.to_string_lossy().contains("malformed")).expect("a case of it");
    let mine = format!("mine={} unasked", client());
    let mut replay = Command::cargo_bin("rockproof").expect("the program");
    replay.arg("replay").arg(case).args(["--engine-command", &mine]);
    let said = String::from_utf8(replay.output().expect("runs").stdout).expect("text");
    // To the pair as it stands, or changed as a check changes it.
    let is_told = |line: &str| line.starts_with("mine") && line.contains(" gave no answer: malformed");
    assert!(said.lines().any(is_told) && said.contains("nobody asked for"), "{said}");
}

#[test]
fn threads_and_resuming_change_nothing() {
    let dir = crate::place::folder();
    let command = format!("{} crash", client());
    let found = [CASES_AS_FOUND, "--engine", "mine", "--threads"];
    rows(dir.path(), "one", &command, &[&found[..], &["1"]].concat());
    rows(dir.path(), "two", &command, &[&found[..], &["2"]].concat());
    rows(dir.path(), "two", &command, &[&found[..], &["2", "--resume"]].concat());
    for name in ["findings.csv", "summary.csv"] {
        let read = |run: &str| fs::read(dir.path().join(run).join(name)).expect(name);
        assert!(read("one") == read("two"), "{name}");
    }
}

/// The campaign about a client that decides by separating axes has no finding far from a tie.
fn agrees_wherever_rounding_cannot_matter(dir: &Path, command: &str) {
    let found = rows(dir, "sat", command, &[&[CASES_AS_FOUND][..], &ONLY].concat());
    let run = fs::read_to_string(dir.join("sat/run.json")).expect("run.json");
    let run: serde_json::Value = serde_json::from_str(&run).expect("JSON");
    let asked = run["external_engines"]["mine"]["asked"].as_u64();
    assert!(asked.is_some_and(|asked| asked >= 256), "{run}");
    for row in &found {
        let far = row[12].parse::<f64>().is_ok_and(|ulps| ulps.abs() > 1e6);
        assert!(row[6] == "unsupported" || !far, "{row:?}");
    }
}

#[test]
fn the_python_client_agrees_wherever_rounding_cannot_matter() {
    if !there("python3") {
        return skipped("there is no python3 to run examples/engines/client.py with");
    }
    let dir = crate::place::folder();
    agrees_wherever_rounding_cannot_matter(dir.path(), &format!("python3 {}", example("client.py").display()));
}

#[test]
fn the_cpp_client_agrees_wherever_rounding_cannot_matter() {
    let dir = crate::place::folder();
    if let Some(client) = cpp_client() {
        agrees_wherever_rounding_cannot_matter(dir.path(), &client);
    }
}

/// What a client answers to lines, parsed, and its exit code.
fn answers(command: &[&str], lines: &[u8]) -> (Option<i32>, Vec<serde_json::Value>) {
    let output = Command::new(command[0]).args(&command[1..]).write_stdin(lines).output().expect("runs");
    let text = String::from_utf8(output.stdout).expect("text");
    let answers = text.lines().map(|line| serde_json::from_str(line).expect("JSON"));
    (output.status.code(), answers.collect())
}

/// A value with every number as the f64 it is: 1 and 1.0 are the same.
fn floats(value: &serde_json::Value) -> serde_json::Value {
    use serde_json::Value;
    match value {
        Value::Number(number) => number.as_f64().map_or(Value::Null, Value::from),
        Value::Array(list) => list.iter().map(floats).collect(),
        Value::Object(object) => object.iter().map(|(key, value)| (key.clone(), floats(value))).collect(),
        other => other.clone(),
    }
}

#[test]
fn the_cpp_client_and_the_python_client_say_the_same() {
    let dir = crate::place::folder();
    let Some(cpp) = cpp_client() else { return };
    if !there("python3") {
        return skipped("there is no python3 to run examples/engines/client.py with");
    }
    // The questions of a campaign, kept on their way to an engine.
    let kept = dir.path().join("questions");
    let command = format!("sh -c \"tee -a '{}' | '{cpp}'\"", kept.display());
    let families = ["--family", "joint_cut,quasi_parallel_edges,concave_notch", "--threads", "1", "--engine", "mine"];
    // Those of cases that are made smaller too: of the pairs as they are drawn none touch.
    rows(dir.path(), "keeping", &command, &families);
    let questions = fs::read(kept).expect("questions");
    let python = example("client.py");
    let (code, of_cpp) = answers(&[&cpp], &questions);
    let (_, of_python) = answers(&["python3", &python.to_string_lossy()], &questions);
    assert!(code == Some(0) && of_cpp.len() > 250, "{code:?}, {} answers", of_cpp.len());
    for state in ["apart", "touching", "overlapping"] {
        assert!(of_cpp.iter().any(|answer| answer["state"] == state), "no pair is {state}");
    }
    assert!(of_cpp.iter().any(|answer| answer["unsupported"].is_string()));
    for (number, (one, other)) in of_cpp.iter().zip(&of_python).enumerate() {
        assert_eq!(floats(one), floats(other), "question {number}");
    }
    assert_eq!(of_cpp.len(), of_python.len());
}

#[test]
fn the_cpp_client_refuses_nonsense() {
    let Some(client) = cpp_client() else { return };
    let block = |vertices: &str, faces: &str| format!(r#"{{"vertices":{vertices},"faces":{faces},"reflex":[]}}"#);
    let empty = block("[]", "[]");
    for line in [
        "hello".to_owned(),
        "{".to_owned(),
        "[[[".to_owned(),
        "{\"id\":1}".to_owned(),
        "{\"id\":1,\"a\":\"\\".to_owned(),
        format!("{{\"id\":1,\"a\":{empty},\"b\":{empty}}} more"),
        format!("{{\"id\":1,\"a\":{empty},\"b\":{}}}", block("[[0,0]]", "[]")),
        format!("{{\"id\":1,\"a\":{empty},\"b\":{}}}", block("[[0,0,0]]", "[[0,1,2]]")),
        format!("{{\"id\":1,\"a\":{empty},\"b\":{}}}", block("[[0,0,0]]", "[[0,-1,0]]")),
        format!("{{\"id\":1,\"a\":{empty},\"b\":{}}}", block("[[0,0,0]]", "[[0]]")),
    ] {
        assert_eq!(answers(&[&client], line.as_bytes()), (Some(1), Vec::new()), "{line}");
    }
}

#[test]
fn an_engine_that_never_answers_is_told_of_at_once() {
    for (command, told) in [
        ("mine=no-such-program-anywhere", "cannot start"),
        ("mine=true", "exit code 0"),
        ("mine=sh -c 'while read question; do echo hello; done'", "not JSON"),
        ("mine", "NAME=COMMAND"),
        ("stepper-f32=true", "none of any"),
    ] {
        let (code, _, err) = rockproof(&["campaign", "--pairs", "16", "--out", "unused", "--engine-command", command]);
        assert!(code == 2 && err.contains(told), "{command}: {code} {err}");
    }
    assert!(!Path::new("unused").exists());
}

fn cube() -> Topology {
    let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    Topology::new(8, faces.map(|f| f.to_vec()).to_vec()).expect("a cube")
}

#[test]
fn signs_and_lengths_of_a_gap_must_not_contradict_each_other() {
    let cube = cube();
    let of = |gap: &str| {
        let start = "\"kind\":\"v-f\",\"feature_a\":0,\"feature_b\":1";
        let entrance = "\"entrance\":\"v-f\",\"entrance_a\":0,\"entrance_b\":1";
        let line = format!("{{\"id\":0,\"contacts\":[{{{start},{entrance}{gap}}}]}}");
        match protocol::answer(line.as_bytes(), 0, [&cube, &cube]) {
            Ok(Answer::Contacts(contacts)) => Ok(contacts[0].gap.as_i8()),
            Err(EngineFailure::Malformed(what)) => Err(what),
            other => panic!("{other:?}"),
        }
    };
    for (gap, sign) in [
        (",\"gap_m\":-0.01", -1),
        (",\"gap_m\":0", 0),
        (",\"gap_sign\":1,\"gap_m\":0.01", 1),
        (",\"gap_sign\":0,\"gap_m\":1e-17", 0),
        (",\"gap_sign\":-1,\"gap_m\":0.0", -1),
    ] {
        assert_eq!(of(gap), Ok(sign), "{gap}");
    }
    for (gap, told) in [
        (",\"gap_sign\":-1,\"gap_m\":0.01", "gap_sign -1 contradicts gap_m 0.01"),
        (",\"gap_sign\":1,\"gap_m\":-2", "gap_sign 1 contradicts gap_m -2"),
        (",\"gap_m\":\"0.01\"", "gap_m is there, but it is a text; expected a number"),
        (",\"gap_sign\":1,\"gap_m\":\"0.01\"", "gap_m is there, but it is a text; expected a number"),
        (",\"gap_sign\":2", "gap_sign is 2; allowed are -1, 0, 1, or the number gap_m instead"),
        ("", "gap_sign is absent; allowed are -1, 0, 1, or the number gap_m instead"),
    ] {
        let what = of(gap).expect_err(gap);
        assert!(what.contains(told), "{gap}: {what}");
    }
}

#[test]
fn an_entrance_is_named_with_its_numbers_or_not_at_all() {
    let cube = cube();
    let of = |entrance: &str| {
        let start = "\"kind\":\"v-f\",\"feature_a\":0,\"feature_b\":1,\"gap_sign\":1";
        let line = format!("{{\"id\":0,\"contacts\":[{{{start}{entrance}}}]}}");
        protocol::answer(line.as_bytes(), 0, [&cube, &cube])
    };
    for entrance in ["", ",\"entrance\":\"v-f\",\"entrance_a\":0,\"entrance_b\":1"] {
        assert!(matches!(of(entrance), Ok(Answer::Contacts(_))), "{entrance}");
    }
    for (entrance, there) in [
        (",\"entrance_a\":0,\"entrance_b\":1", "entrance_a"),
        (",\"entrance_b\":1", "entrance_b"),
        (",\"entrence\":\"v-f\",\"entrance_a\":0,\"entrance_b\":1", "entrance_a"),
    ] {
        let Err(EngineFailure::Malformed(what)) = of(entrance) else { panic!("{entrance}") };
        assert!(what.contains(&format!("contact 0: entrance is absent, but {there} is there")), "{what}");
    }
}

proptest! {
    #[test]
    fn nonsense_is_malformed(line in proptest::collection::vec(any::<u8>(), 0..200)) {
        let cube = cube();
        prop_assert!(matches!(protocol::answer(&line, 0, [&cube, &cube]), Err(EngineFailure::Malformed(_))));
    }

    #[test]
    fn almost_an_answer_never_panics(
        id in prop_oneof![Just("0".to_owned()), "[0-9.e-]{1,4}"],
        key in prop_oneof![Just("contacts"), Just("state"), Just("unsupported"), Just("x")],
        value in prop_oneof![
            Just("[]".to_owned()), Just("\"apart\"".to_owned()), Just("null".to_owned()),
            (any::<i64>(), any::<i64>(), "v-[vef]").prop_map(|(a, b, kind)| format!(
                "[{{\"kind\":\"{kind}\",\"feature_a\":{a},\"feature_b\":{b}}}]"
            )),
        ],
    ) {
        let cube = cube();
        let line = format!("{{\"id\":{id},\"{key}\":{value}}}");
        let right = id == "0" && ((key == "contacts" && value == "[]") || (key == "state" && value == "\"apart\""));
        let said_unable = id == "0" && key == "unsupported" && value == "\"apart\"";
        match protocol::answer(line.as_bytes(), 0, [&cube, &cube]) {
            Ok(_) => prop_assert!(right || value.contains("kind")),
            Err(EngineFailure::Unsupported(_)) => prop_assert!(said_unable),
            Err(failure) => prop_assert!(!right && matches!(failure, EngineFailure::Malformed(_))),
        }
    }
}
