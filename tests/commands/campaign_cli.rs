//! Pins what the commands `classify`, `campaign`, `replay` and `shrink` print, write and exit with.

use crate::place::rockproof;
use std::fs;
use std::path::{Path, PathBuf};

fn path(dir: &Path, name: &str) -> String {
    dir.join(name).to_string_lossy().into_owned()
}

/// A small campaign that finds something.
fn campaign(out: &str, more: &[&str]) -> (i32, String, String) {
    let mut args = vec!["campaign", "--pairs", "384", "--family", "sliver,edge_cross", "--out", out];
    args.extend(more);
    rockproof(&args)
}

const STACK: &str = r#"
[[block]]
box = { min = [0, 0, 1], max = [1, 1, 2] }
[[block]]
box = { min = [-1, -1, 0], max = [3, 3, 1] }
[[block]]
box = { min = [9, 9, 9], max = [10, 10, 10] }
"#;

#[test]
fn classify_writes_the_columns_of_every_contact() {
    let dir = crate::place::folder();
    let file = path(dir.path(), "stack.toml");
    fs::write(&file, STACK).expect("write");
    for engine in ["exact", "f64", "f32"] {
        let (code, out, err) = rockproof(&["classify", &file, "--engine", engine, "--format", "csv"]);
        assert_eq!(code, 0, "{err}");
        let lines: Vec<&str> = out.lines().collect();
        let header = "block_a,block_b,kind,feature_a,feature_b,entrance,entrance_a,entrance_b,gap_sign,gap_m";
        assert_eq!(lines[0], header);
        assert_eq!(lines.len(), 5, "four corners on a face: {out}");
        assert!(lines[1..].iter().all(|l| l.starts_with("0,1,v-f,") && l.ends_with(",0,0.0")), "{out}");
    }
    let (_, out, _) = rockproof(&["classify", &file]);
    assert!(out.contains("face-face") && out.contains("4 contacts in 1 pair; 1 pair of"), "{out}");
    let (code, out, _) = rockproof(&["classify", &file, "--pair", "0,2", "--format", "json"]);
    assert_eq!(code, 0, "nothing touches");
    assert_eq!(serde_json::from_str::<serde_json::Value>(&out).expect("JSON")["pairs"], serde_json::json!([]));
    // B first: the same contacts with features exchanged.
    let (_, out, _) = rockproof(&["classify", &file, "--pair", "1,0", "--format", "csv"]);
    assert!(out.lines().nth(1).is_some_and(|l| l.starts_with("1,0,f-v,")), "{out}");
}

#[cfg(not(feature = "mpi"))]
#[test]
fn without_mpi_a_build_says_how_to_have_it() {
    let dir = crate::place::folder();
    let out = path(dir.path(), "out");
    let (code, _, err) = campaign(&out, &["--mpi"]);
    assert!(code == 2 && err.contains("--features mpi") && err.contains("docs/scale.md"), "{code}: {err}");
    let (code, _, err) = campaign(&out, &["--mpi", "--part", "1/2"]);
    assert!(code == 2 && err.contains("cannot be used with"), "{code}: {err}");
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/real/smallEdge.dda");
    let (code, _, of_tune) = rockproof(&["tune", model, "--candidates", "2", "--mpi", "--out", &out]);
    let (_, _, of_campaign) = campaign(&out, &["--mpi"]);
    assert_eq!((code, of_tune), (2, of_campaign), "one text");
    assert!(!Path::new(&out).exists());
}

#[test]
fn bad_arguments_exit_with_2_and_say_what_is_allowed() {
    let dir = crate::place::folder();
    let file = path(dir.path(), "stack.toml");
    let bad = path(dir.path(), "bad.toml");
    fs::write(&file, STACK).expect("write");
    fs::write(&bad, "seed = 1\npears = 3\n").expect("write");
    let out = path(dir.path(), "out");
    for (args, told) in [
        (vec!["classify", &file, "--pair", "0,3"], "block 3"),
        (vec!["classify", &file, "--pair", "1,1"], "no pair with itself"),
        (vec!["classify", &file, "--tolerances", "none"], "auto, shi, zero"),
        (vec!["classify", &file, "--set", "serch=1"], "serch"),
        (vec!["classify", "missing.toml"], "missing.toml"),
        (vec!["campaign", "--out", &out, "--engine", "abacus"], "stepper-f32, stepper-f64"),
        (vec!["campaign", "--out", &out, "--family", "pyramids"], "sliver"),
        (vec!["campaign", "--out", &out, "--tolerances", "loose"], "auto, shi, zero"),
        (vec!["campaign", "--out", &out, "--deny", "rounding"], "representation"),
        (vec!["campaign", &bad, "--out", &out], "line 2"),
        (vec!["campaign", "--out", &out, "--real", &bad], "bad.toml"),
        (vec!["replay", &bad], "bad.toml"),
        (vec!["replay", "missing.toml"], "missing.toml"),
        (vec!["shrink", &bad], "bad.toml"),
    ] {
        let (code, _, err) = rockproof(&args);
        assert_eq!(code, 2, "{args:?}: {err}");
        assert!(err.contains(told), "{args:?}: {err}");
        assert!(!err.contains("panicked"), "{args:?}: {err}");
    }
    assert!(!Path::new(&out).exists(), "nothing is written before the arguments are known to be good");
}

#[test]
fn exact_ties_are_pairs_of_their_own() {
    let dir = crate::place::folder();
    let config = path(dir.path(), "ties.toml");
    fs::write(&config, "exact_ties = true\n").expect("write");
    let [usual, ties, same] = ["usual", "ties", "same"].map(|name| path(dir.path(), name));
    assert_eq!(campaign(&usual, &[]).0, 0);
    assert_eq!(campaign(&ties, &["--exact-ties"]).0, 0);
    assert_eq!(campaign(&same, &[&config]).0, 0);
    let findings = |out: &str| fs::read(Path::new(out).join("findings.csv")).expect("a table");
    assert!(findings(&usual) != findings(&ties) && findings(&ties) == findings(&same));
    let (code, _, err) = campaign(&ties, &["--resume"]);
    assert!(code == 2 && err.contains("exact_ties"), "{err}");
    let stress = |option: &str| rockproof(&["campaign", "--stress", option, "--out", &path(dir.path(), "stress")]);
    let (code, _, err) = stress("--exact-ties");
    assert!(code == 2 && err.contains("cannot be used with"), "{err}");
    let (code, _, err) = stress(&config);
    assert!(code == 2 && err.contains("ties.toml: the stress set has pairs of its own: no exact_ties"), "{err}");
}

#[test]
fn campaigns_do_not_depend_on_threads_and_go_on_where_they_were_killed() {
    let dir = crate::place::folder();
    let config = path(dir.path(), "campaign.toml");
    fs::write(&config, "chunk = 64\ncases_per_cause = 4\nshrink_evaluations = 40\n").expect("write");
    let [one, two, killed] = ["one", "two", "killed"].map(|name| path(dir.path(), name));
    let (code, out, err) = campaign(&one, &[&config, "--threads", "1"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("384 pairs in") && out.contains("stepper-f32") && out.contains("findings.csv"), "{out}");
    assert_eq!(campaign(&two, &[&config, "--threads", "2"]).0, 0);
    // A kill between the appended rows and the renamed progress, in the middle of a row.
    assert_eq!(campaign(&killed, &[&config, "--threads", "2"]).0, 0);
    let findings = PathBuf::from(&killed).join("findings.csv");
    let whole = fs::read(&findings).expect("read");
    fs::write(&findings, [&whole[..], b"384,sliver,ba"].concat()).expect("write");
    assert_eq!(campaign(&killed, &[&config, "--resume"]).0, 0);
    for name in ["findings.csv", "summary.csv"] {
        let read = |dir: &str| fs::read(Path::new(dir).join(name)).expect(name);
        assert!(read(&one) == read(&two), "{name} by one thread and by two");
        assert!(read(&one) == read(&killed), "{name} resumed");
    }
    assert_eq!(campaign(&one, &[&config]).0, 2, "a run is not overwritten");
    let (code, _, err) = campaign(&one, &[&config, "--resume", "--seed", "9"]);
    assert!(code == 2 && err.contains("seed: the run has 1, asked for is 9"), "{err}");
    let run = fs::read_to_string(Path::new(&one).join("run.json")).expect("run.json");
    let run: serde_json::Value = serde_json::from_str(&run).expect("JSON");
    assert_eq!((&run["pairs"], &run["findings"]["by_cause"]["defect"]), (&384.into(), &0.into()));
    assert!(run["oracle_levels"]["f64"].as_u64() > Some(1000));
}

#[test]
fn denied_kinds_exit_with_1() {
    let dir = crate::place::folder();
    let config = path(dir.path(), "campaign.toml");
    fs::write(&config, "cases_per_cause = 0\n").expect("write");
    let out = path(dir.path(), "out");
    let (code, _, err) = campaign(&out, &[&config, "--deny", "defect", "--deny", "arithmetic"]);
    assert_eq!(code, 1);
    assert!(err.contains("arithmetic") && !err.contains("defect"), "{err}");
    assert_eq!(campaign(&out, &[&config, "--overwrite", "--deny", "defect"]).0, 0);
}

#[test]
fn cases_replay_and_shrink() {
    let dir = crate::place::folder();
    let config = path(dir.path(), "campaign.toml");
    fs::write(&config, "cases_per_cause = 6\nshrink_evaluations = 3\n").expect("write");
    let out = path(dir.path(), "out");
    assert_eq!(campaign(&out, &[&config]).0, 0);
    let cases: Vec<String> = fs::read_dir(Path::new(&out).join("cases"))
        .expect("cases")
        .map(|e| e.expect("entry").path().to_string_lossy().into_owned())
        // Those of steps are state files, which are not shrunk.
        .filter(|case| case.ends_with(".toml"))
        .collect();
    assert!(cases.len() > 6, "cases of more than one cause");
    for case in &cases {
        let (code, text, err) = rockproof(&["replay", case]);
        assert_eq!(code, 0, "{case}: {err}");
        assert!(text.contains("stepper-f64") && text.contains("exact f32"), "{text}");
        let small = path(dir.path(), "small.toml");
        let (code, text, err) = rockproof(&["shrink", case, "--out", &small, "--evaluations", "60", "--overwrite"]);
        assert_eq!(code, 0, "{case}: {err}");
        assert!(text.starts_with("before: "), "{text}");
        let (code, _, err) = rockproof(&["replay", &small]);
        assert_eq!(code, 0, "{case} shrunk: {err}");
        let kind = |file: &str| {
            let text = fs::read_to_string(file).expect("read");
            text.lines().find(|line| line.starts_with("kind = ")).map(str::to_owned)
        };
        assert_eq!(kind(&small), kind(case), "{case} shrunk");
        // What it is made of; contacts there may be more.
        let length = |file: &str| {
            let text = fs::read_to_string(file).expect("read");
            text.len() - text.find("[tolerances]").expect("tolerances")
        };
        assert!(length(&small) <= length(case) + 200, "{case}");
    }
    // Another expected answer is told, and is no input error.
    let read = |case: &String| fs::read_to_string(case).expect("read");
    let text = cases.iter().map(read).find(|text| text.contains("[[case.expected]]")).expect("a case with contacts");
    let other = path(dir.path(), "other.toml");
    // It names features that are there.
    let (before, rest) = text.split_once("feature_a = ").expect("a contact");
    let (feature, after) = rest.split_once('\n').expect("a line");
    let another = if feature == "0" { 1 } else { 0 };
    fs::write(&other, format!("{before}feature_a = {another}\n{after}")).expect("write");
    let (code, _, err) = rockproof(&["replay", &other]);
    assert!(code == 1 && err.contains("not the one the case expects"), "{err}");
}

#[test]
fn real_blocks_may_be_as_far_from_planar_as_the_planarity_says() {
    let dir = crate::place::folder();
    let config = path(dir.path(), "campaign.toml");
    fs::write(&config, "cases_per_cause = 0\n").expect("write");
    let args = [&config, "--family", "real", "--real", "cases/real/voronoi_120.txt"];
    let (code, _, err) = campaign(&path(dir.path(), "strict"), &args);
    assert!(code == 2 && err.contains("voronoi_120.txt") && err.contains("planar"), "{code}: {err}");
    let (code, _, err) = campaign(&path(dir.path(), "loose"), &[&args[..], &["--planarity", "1e-4"]].concat());
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = campaign(&path(dir.path(), "none"), &["--planarity", "1e-4"]);
    assert!(code == 2 && err.contains("--real"), "{code}: {err}");
}
