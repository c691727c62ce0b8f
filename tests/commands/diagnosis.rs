//! The diagnosis of external engines: each planted mistake is told, and told the same however the campaign was run.

use crate::campaigns::WITHOUT_CASES;
use crate::engines::{changed_cpp_client, client};
use assert_cmd::Command;
use rockproof_differential::diagnosis::{DiagnosisRow, DiagnosisVerdict};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

fn rockproof(args: &[&str]) -> (i32, String) {
    let output = Command::cargo_bin("rockproof").expect("the program").args(args).output().expect("runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().expect("a code"), text(&output.stdout) + &text(&output.stderr))
}

fn rows(dir: &Path) -> Vec<DiagnosisRow> {
    let mut reader = csv::Reader::from_path(dir.join("diagnosis.csv")).expect("a diagnosis");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

/// A campaign with the client that makes a mistake, and its diagnosis.
fn diagnosed(dir: &Path, mistake: &str, more: &[&str]) -> (Vec<DiagnosisRow>, String) {
    diagnosed_engine(dir, mistake, &format!("{} {mistake}", client()), more)
}

/// The same with another program.
fn diagnosed_engine(dir: &Path, mistake: &str, program: &str, more: &[&str]) -> (Vec<DiagnosisRow>, String) {
    let out = dir.join(mistake);
    let config = dir.join("few.toml");
    fs::write(&config, "cases_per_cause = 2\nshrink_evaluations = 3\nsteps_every = 0\nmetamorphic_every = 0\n")
        .expect("write");
    let engine = format!("mine={program}");
    let (config, out_text) = (config.to_string_lossy(), out.to_string_lossy());
    let start = ["campaign", &*config, "--engine-command", &engine, "--engine", "mine", "--out", &*out_text];
    let (code, said) = rockproof(&[&start[..], more].concat());
    assert_eq!(code, 0, "{mistake}: {said}");
    (rows(&out), said)
}

/// The first explanation: its name, and how many answers of how many.
fn first(rows: &[DiagnosisRow]) -> (&str, u64, u64) {
    let row = rows.first().expect("something differs");
    assert_eq!(row.verdict, DiagnosisVerdict::Explains, "{rows:#?}");
    (&row.hypothesis, row.answers, row.differing)
}

#[test]
#[ignore = "fifteen seconds; .ci/run runs it"]
fn each_mistake_is_told() {
    let dir = crate::place::folder();
    for (mistake, hypothesis, pairs) in [
        ("f32", "input-in-f32", "512"),
        ("territory", "territory-times-1.01", "2048"),
        ("epsilon", "equal-ignored", "2048"),
        ("sign", "gap-sign-turned", "512"),
        ("exchanged", "exchanged", "512"),
        // No gap of these pairs is exactly 0, so the same as `gap-sign-always-positive`, which is told as well.
        ("positive", "depth-positive", "512"),
        ("zero", "gap-sign-always-zero", "512"),
        ("negative", "gap-sign-always-negative", "512"),
        ("v-f", "entrance-always-v-f", "512"),
        ("late", "one-answer-late", "512"),
        ("corners", "corners-of-5-edges-left-out", "2048"),
        ("four", "at-most-4-contacts", "512"),
    ] {
        let (rows, said) = diagnosed(dir.path(), mistake, &["--pairs", pairs]);
        let (found, answers, differing) = first(&rows);
        assert_eq!(found, hypothesis, "{mistake}: {rows:#?}");
        // The client rounds as the stepper does.
        assert!(answers * 2 >= differing, "{mistake}: {rows:#?}");
        assert!(said.contains(&format!("{answers} of {differing} differing answers are exact ")), "{said}");
    }
}

#[test]
fn rounding_is_no_mistake_and_a_rare_mistake_is_not_explained_away() {
    let dir = crate::place::folder();
    let (rows, _) = diagnosed(dir.path(), "order", &["--pairs", "1024"]);
    let (found, answers, differing) = first(&rows);
    assert_eq!((found, answers), ("sums-in-another-order", differing), "{rows:#?}");

    let (rows, said) = diagnosed(dir.path(), "thousandth", &["--pairs", "2048"]);
    let (found, answers, differing) = first(&rows);
    assert_eq!(found, "calculated-in-f64", "{rows:#?}");
    let rest = rows.iter().find(|row| row.verdict == DiagnosisVerdict::Unexplained).expect("the rare mistake");
    assert!(rest.answers > 0 && rest.answers + answers == differing, "{rows:#?}");
    assert!(said.contains("mine: no hypothesis explains ") && said.contains(&rest.example), "{said}");
}

/// The C++ client with the mistake that its environment names. One program for all of them: to compile it takes longer than to ask it.
fn mistaken_cpp_client(mistake: &str) -> Option<String> {
    static CLIENT: OnceLock<Option<(tempfile::TempDir, String)>> = OnceLock::new();
    let said = r#"",\"gap_m\":%.17g,\"normal\":[%.17g,%.17g,%.17g]", said.gap_m, n[0]"#;
    let (format, gap) = said.rsplit_once(", said").expect("a format");
    let gap = format!("said{gap}").replace(", n[0]", "");
    let is = |letter: char| format!("std::getenv(\"WRONG\")[0] == '{letter}'");
    let wrong = format!(
        "{} ? {} : {format}, {} ? {gap} + 1e-6 : {} ? {gap} * 1.5 : {} ? (float)({gap} + 1e-6) : {gap}, n[0]",
        is('d'),
        format.replace("%.17g", "%.7g"),
        is('l'),
        is('f'),
        is('s'),
    );
    let client = CLIENT.get_or_init(|| {
        let dir = tempfile::tempdir().expect("a directory");
        changed_cpp_client(dir.path(), said, &wrong).map(|client| (dir, client))
    });
    client.as_ref().map(|(_, client)| format!("env WRONG={mistake} {client}"))
}

#[test]
fn an_array_that_is_full_is_told() {
    let dir = crate::place::folder();
    let many = ["--pairs", "128", "--tolerances", "auto", "--family", "coplanar_slide,concave_notch"];
    let (rows, _) = diagnosed(dir.path(), "four", &many);
    let (found, answers, differing) = first(&rows);
    assert!(found == "at-most-4-contacts" && answers == differing && answers > 20, "{rows:#?}");
}

#[test]
fn a_collision_code_in_f32_is_told_to_be_declared_so() {
    let dir = crate::place::folder();
    let pairs = ["--pairs", "256", "--tolerances", "auto"];
    let Some(single) = changed_cpp_client(&dir.path().join("1"), "double", "float") else { return };
    let (rows, said) = diagnosed_engine(dir.path(), "in-f32", &single, &pairs);
    let (found, answers, differing) = first(&rows);
    assert!(found == "state-in-f32" && answers * 10 >= differing * 9, "{rows:#?}");
    assert!(said.contains("If it is meant to calculate in f32, declare it as mine:f32."), "{said}");
    let is_told =
        |row: &DiagnosisRow| matches!(row.verdict, DiagnosisVerdict::Explains | DiagnosisVerdict::Unexplained);
    assert_eq!(rows.iter().filter(|row| is_told(row)).count(), 1, "the rest is next to a tie: {rows:#?}");

    // Gaps and normals in seven digits are no worse than in f32, but far better where blocks are near one another.
    let digits = mistaken_cpp_client("digits").expect("there is a compiler");
    let (rows, _) = diagnosed_engine(dir.path(), "digits", &digits, &pairs);
    let (found, answers, differing) = first(&rows);
    assert!(found == "gap-in-7-digits" && answers * 10 >= differing * 9, "{rows:#?}");
    let in_single = rows.iter().find(|row| row.hypothesis == "state-in-f32");
    assert!(in_single.is_none_or(|row| row.verdict == DiagnosisVerdict::Contradicted), "{rows:#?}");
}

/// Gaps that are all too large by one length, or overlaps that are too deep by one factor, are no doing of f32.
#[test]
fn one_length_or_factor_too_many_is_not_told_to_be_f32() {
    let dir = crate::place::folder();
    let pairs = ["--pairs", "256", "--tolerances", "auto", "--family", "edge_cross,corner_corner"];
    for name in ["length", "factor", "single"] {
        let Some(mine) = mistaken_cpp_client(name) else { return };
        let (rows, said) = diagnosed_engine(dir.path(), &format!("of-{name}"), &mine, &pairs);
        assert!(rows.first().is_some_and(|row| row.differing > 60), "{name}: {rows:#?}");
        let told = rows.iter().find(|row| row.hypothesis == "state-in-f32");
        assert!(told.is_none_or(|row| row.verdict == DiagnosisVerdict::Contradicted), "{name}: {rows:#?}");
        assert!(!said.contains("declare it as"), "{name}: {said}");
    }
}

#[test]
fn the_diagnosis_is_the_same_however_the_campaign_was_run() {
    let dir = crate::place::folder();
    let read = |name: &str| fs::read(dir.path().join(name).join("diagnosis.csv")).expect("a diagnosis");
    let families = ["--pairs", "96", "--family", "face_stack,edge_cross"];
    diagnosed(dir.path(), "sign", &[&families[..], &["--threads", "1"]].concat());
    let whole = read("sign");
    diagnosed(dir.path(), "sign", &[&families[..], &["--threads", "2", "--overwrite"]].concat());
    assert!(read("sign") == whole, "threads");
    let fewer = ["--pairs", "48", "--family", "face_stack,edge_cross", "--overwrite"];
    diagnosed(dir.path(), "sign", &fewer);
    assert!(read("sign") != whole, "fewer pairs");
    diagnosed(dir.path(), "sign", &[&families[..], &["--resume"]].concat());
    assert!(read("sign") == whole, "gone on with");

    let text = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    let engine = format!("mine={} sign", client());
    for part in ["1/2", "2/2"] {
        let out = text(&part.replace('/', "-"));
        let start = ["campaign", &text("few.toml"), "--engine-command", &engine, "--engine", "mine", "--out", &out];
        let (code, said) = rockproof(&[&start[..], &families, &["--part", part]].concat());
        assert_eq!(code, 0, "{said}");
        assert!(!Path::new(&out).join("diagnosis.csv").exists(), "a part has none");
    }
    let (code, said) = rockproof(&["merge", &text("1-2"), &text("2-2"), "--out", &text("merged")]);
    assert!(code == 0 && said.contains("differing answers are exact with the sign of every gap turned"), "{said}");
    assert!(read("merged") == whole, "merged");

    let (code, page) = rockproof(&["report", &text("sign"), "--format", "markdown"]);
    assert!(
        code == 0 && page.contains("What is wrong with the external engines?") && page.contains("gap-sign-turned"),
        "{page}"
    );
    let (code, json) =
        rockproof(
            &[
                &[
                    "campaign",
                    &text("few.toml"),
                    "--engine-command",
                    &engine,
                    "--engine",
                    "mine",
                    "--out",
                    &text("sign"),
                ][..],
                &families,
                &["--resume", "--format", "json"],
            ]
            .concat(),
        );
    let json: serde_json::Value =
        serde_json::from_str(json.lines().take_while(|l| !l.starts_with("note")).collect::<String>().as_str())
            .expect("JSON");
    assert!(code == 0 && json["diagnosis"][0]["hypothesis"] == "gap-sign-turned", "{json}");
}

#[test]
fn without_external_engines_there_is_none() {
    let dir = crate::place::folder();
    let out = dir.path().join("out").to_string_lossy().into_owned();
    let (code, said) = rockproof(&[
        "campaign",
        WITHOUT_CASES,
        "--pairs",
        "32",
        "--steps-every",
        "0",
        "--format",
        "json",
        "--out",
        &out,
    ]);
    assert!(code == 0 && !said.contains("diagnosis"), "{said}");
    assert!(!Path::new(&out).join("diagnosis.csv").exists());
}

#[test]
fn replay_says_whether_the_finding_recurs() {
    let dir = crate::place::folder();
    diagnosed(dir.path(), "sign", &["--pairs", "64", "--family", "edge_cross"]);
    let cases = fs::read_dir(dir.path().join("sign/cases")).expect("cases").map(|case| case.expect("a case").path());
    let case = cases.map(|case| case.to_string_lossy().into_owned()).find(|case| case.contains("engine-gap-sign"));
    let case = case.expect("a case about it");
    for (mistake, code, told) in
        [("sign", 0, "the finding recurs"), ("", 1, "the finding does not recur: nothing differs there now")]
    {
        let engine = format!("mine={} {mistake}", client());
        let (found, said) = rockproof(&["replay", &case, "--engine-command", &engine]);
        assert!(found == code && said.contains(told), "{mistake}: {found} {said}");
    }
    // Another mistake in its place is told.
    let (found, said) = rockproof(&["replay", &case, "--engine-command", &format!("mine={} none", client())]);
    let other = said.contains("does not recur: now it is engine missing by mine") || said.contains("nothing differs");
    assert!(found == 1 && other, "{found} {said}");
}
