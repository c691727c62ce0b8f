//! Pins how a campaign is asked for, goes on, is stopped, and what it says at its end.

use crate::campaigns::{CASES_AS_FOUND, WITHOUT_CASES};
use crate::place::rockproof;
#[cfg(unix)]
use crate::processes::{signal, until};
use std::fs;
use std::path::Path;

/// A small campaign in `dir/name`.
fn campaign(dir: &Path, name: &str, more: &[&str]) -> (i32, String, String) {
    let out = dir.join(name);
    let args = ["campaign", "--family", "sliver,edge_cross", "--out", out.to_str().expect("text")];
    rockproof(&[&args[..], more].concat())
}

fn written(dir: &Path, name: &str, text: &str) -> String {
    let file = dir.join(name);
    fs::write(&file, text).expect("written");
    file.to_str().expect("text").to_owned()
}

#[test]
fn the_end_is_the_verdict_a_short_table_and_what_to_do_next() {
    let dir = crate::place::folder();
    let (code, out, err) = campaign(dir.path(), "run", &["--pairs", "256"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.starts_with("Exactly right on hard pairs: stepper-f32 "), "{out}");
    // Settings made for ties are in the report's tables; a case may be of one.
    let told = out.split("next: ").next().expect("text");
    assert!(out.lines().count() < 40 && !told.contains("dyadic") && !told.contains("fractional"), "{out}");
    for words in ["tolerance", "every engine", "No mistake in code", "next: rockproof report "] {
        assert!(out.contains(words), "{words}: {out}");
    }
    // What it says to do next can be done.
    let replay = out.lines().find_map(|line| line.trim().strip_prefix("rockproof replay ")).expect("a case");
    let (code, said, err) = rockproof(&["replay", replay]);
    assert!(code == 0 && said.contains("decided by"), "{err}");
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn a_run_goes_on_to_more_pairs() {
    let dir = crate::place::folder();
    let dir = dir.path();
    assert_eq!(campaign(dir, "whole", &["--pairs", "384"]).0, 0);
    assert_eq!(campaign(dir, "grown", &["--pairs", "192"]).0, 0);
    let (code, _, err) = campaign(dir, "grown", &["--pairs", "96", "--resume"]);
    assert!(code == 2 && err.contains("pairs: the run has 192, asked for is 96"), "{err}");
    let (code, _, err) = campaign(dir, "grown", &["--pairs", "384", "--resume"]);
    assert_eq!(code, 0, "{err}");
    for name in ["summary.csv", "agreement.csv", "confusion.csv", "step_summary.csv"] {
        let read = |run: &str| fs::read(dir.join(run).join(name)).expect(name);
        assert!(read("whole") == read("grown"), "{name}");
    }
    // Which findings have a case may depend on when a session ended; nothing else does.
    let findings = |run: &str| -> Vec<String> {
        let text = fs::read_to_string(dir.join(run).join("findings.csv")).expect("findings");
        text.lines().map(|line| line.rsplit_once(',').expect("columns").0.to_owned()).collect()
    };
    assert!(findings("whole").len() > 50 && findings("whole") == findings("grown"));
    let run = fs::read_to_string(dir.join("grown/run.json")).expect("run.json");
    let run: serde_json::Value = serde_json::from_str(&run).expect("JSON");
    assert_eq!((&run["pairs"], &run["configuration"]["pairs"]), (&384.into(), &384.into()));
    // Inside a batch nothing can be added without doing the batch again.
    assert_eq!(campaign(dir, "odd", &["--pairs", "40"]).0, 0);
    let (code, _, err) = campaign(dir, "odd", &["--pairs", "384", "--resume"]);
    assert!(code == 2 && err.contains("inside a batch of 16"), "{err}");
}

#[test]
fn no_pairs_are_no_campaign() {
    let dir = crate::place::folder();
    let (code, _, err) = campaign(dir.path(), "none", &["--pairs", "0"]);
    assert!(code == 2 && err.contains("--pairs"), "{err}");
    let config = written(dir.path(), "none.toml", "pairs = 0\n");
    let (code, _, err) = campaign(dir.path(), "none", &[&config]);
    assert!(code == 2 && err.contains("pairs is 0"), "{err}");
    let gate = written(
        dir.path(),
        "gate.toml",
        "corpus = []\n[campaign]\npairs = 0\n[[limit]]\ncause = \"defect\"\ncount = 0\n",
    );
    let (code, _, err) = rockproof(&["gate", &gate]);
    assert!(code == 2 && err.contains("gate.toml") && err.contains("pairs is 0"), "{err}");
    assert!(!dir.path().join("none").exists());
}

#[test]
fn tolerances_come_from_a_file_too() {
    let dir = crate::place::folder();
    let tolerances = written(dir.path(), "mytol.toml", "preset = \"auto\"\nparallel_angle = 5\n");
    let run = |name, more: &[&str]| {
        campaign(dir.path(), name, &[&[WITHOUT_CASES, "--pairs", "64", "--tolerances", &tolerances][..], more].concat())
    };
    let (code, _, err) = run("run", &[]);
    assert_eq!(code, 0, "{err}");
    let mut summary = csv::Reader::from_path(dir.path().join("run/summary.csv")).expect("summary");
    let sets: Vec<String> = summary.records().map(|row| row.expect("a row")[2].to_owned()).collect();
    assert!(!sets.is_empty() && sets.iter().all(|set| set.starts_with("mytol")), "{sets:?}");
    // The same run is one with the same file.
    assert_eq!(run("run", &["--resume"]).0, 0);
    fs::write(&tolerances, "preset = \"auto\"\nparallel_angle = 6\n").expect("written");
    let (code, _, err) = run("run", &["--resume"]);
    assert!(code == 2 && err.contains("content of") && err.contains("mytol.toml"), "{err}");
    for (name, text, told) in [
        ("auto.toml", "preset = \"auto\"\n", "rename the file"),
        ("bad.toml", "serch = 1\n", "serch"),
        ("little.toml", "search = 1\n", "no preset is named"),
    ] {
        let file = written(dir.path(), name, text);
        let (code, _, err) = campaign(dir.path(), "wrong", &["--pairs", "64", "--tolerances", &file]);
        assert!(code == 2 && err.contains(told), "{name}: {err}");
    }
    let (code, _, err) = campaign(dir.path(), "missing", &["--pairs", "64", "--tolerances", "no/such.toml"]);
    assert!(code == 2 && err.contains("no/such.toml"), "{err}");
}

#[cfg(unix)]
#[test]
fn engines_in_a_file_may_be_external() {
    let dir = crate::place::folder();
    let command = r#"sed -u -E 's/^."id":([0-9]+),.*/{"id":\\1,"state":"apart"}/'"#;
    let config = format!(
        "pairs = 32\nengines = [\"mine\"]\nshrink_evaluations = 0\n[[external]]\nname = \"mine\"\ncommand = '''{}'''\n",
        command.replace("\\\\", "\\")
    );
    let config = written(dir.path(), "mine.toml", &config);
    let (code, out, err) = campaign(dir.path(), "mine", &[&config]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("mine: ") && !out.contains("stepper-"), "{out}");
    assert!(out.contains("--engine-command"), "the case is replayed with the engine: {out}");
    let gate = written(
        dir.path(),
        "gate.toml",
        &format!(
            "corpus = []\n[campaign]\n{}[[limit]]\ncause = \"engine\"\ncount = 0\n",
            fs::read_to_string(&config).expect("read").replace("[[external]]", "[[campaign.external]]")
        ),
    );
    let out = dir.path().join("gate");
    let (code, said, err) = rockproof(&["gate", &gate, "--out", out.to_str().expect("text")]);
    assert!(code == 1 && said.contains("failed"), "{said}{err}");
    // A short name is the engine's.
    let (code, out, err) = campaign(dir.path(), "short", &[WITHOUT_CASES, "--pairs", "32", "--engine", "f32"]);
    assert!(code == 0 && out.contains("stepper-f32") && !out.contains("stepper-f64"), "{out}{err}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_is_acknowledged_and_a_second_one_ends() {
    use std::io::{BufRead, BufReader};
    let dir = crate::place::folder();
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_rockproof"))
        .args(["campaign", "--pairs", "1000000", "--threads", "1", "--out"])
        .arg(dir.path().join("run"))
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("runs");
    until("listens to signals once it has results", || dir.path().join("run/progress.json").exists());
    std::thread::sleep(std::time::Duration::from_millis(200));
    let mut lines = BufReader::new(child.stderr.take().expect("piped")).lines();
    signal(&child, "INT");
    let said = lines.find(|line| line.as_ref().is_ok_and(|line| line.contains("stopping in good order")));
    assert!(said.is_some_and(|line| line.expect("text").contains("again")));
    signal(&child, "INT");
    // The first may have ended it before the second came.
    assert_eq!(child.wait().expect("ended").code(), Some(130));
}

/// A campaign that is stopped within its first chunk knows nothing, and must not call the engines good.
#[test]
#[cfg(unix)]
fn what_is_stopped_before_its_first_chunk_ends_has_no_verdict() {
    let dir = crate::place::folder();
    let settings = written(dir.path(), "settings.toml", "pairs = 1000000\nchunk = 65536\n");
    let child = std::process::Command::new(env!("CARGO_BIN_EXE_rockproof"))
        .args(["campaign", &settings, "--threads", "1", "--out"])
        .arg(dir.path().join("run"))
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("runs");
    until("listens to signals once it has results", || dir.path().join("run/progress.json").exists());
    signal(&child, "INT");
    let output = child.wait_with_output().expect("ended");
    let out = String::from_utf8(output.stdout).expect("UTF-8");
    assert_eq!(output.status.code(), Some(130), "{out}");
    assert!(out.contains("No pair has been examined to its end") && !out.contains("No difference"), "{out}");
    assert!(out.contains("interrupted: 0 pairs are kept, those of the chunk under way are not"), "{out}");
    assert!(out.contains("--resume begins with the first pair") && !out.contains("could be compared"), "{out}");
}

#[test]
fn the_report_to_come_next_can_be_made_where_there_is_one() {
    let dir = crate::place::folder();
    let out = dir.path().join("run");
    let path = out.to_str().expect("text");
    let next = |said: &str| {
        let line = said.lines().find_map(|line| line.strip_prefix("next: rockproof ")).expect("a command");
        line.split(' ').map(str::to_owned).collect::<Vec<_>>()
    };
    for (start, flag) in [("--resume", false), ("--overwrite", true), ("--resume", true)] {
        let (code, said, err) =
            campaign(dir.path(), "run", &[CASES_AS_FOUND, "--pairs", "32", "--steps-every", "0", start]);
        assert_eq!(code, 0, "{err}");
        let words = next(&said);
        assert_eq!(words.contains(&"--overwrite".to_owned()), flag, "{said}");
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (code, _, err) = rockproof(&words);
        assert!(code == 0 && words.contains(&path), "{words:?} {err}");
    }
}
