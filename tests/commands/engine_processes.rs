//! External engines as processes: none outlives the program, a signal is answered at once although an engine hangs, what a fresh process mends
//! is told, and nothing an engine says reaches the terminal as a command.
#![cfg(target_os = "linux")]

use crate::campaigns::CASES_AS_FOUND;
use crate::engines::client;
use crate::gates::{around, gate};
use crate::place::rockproof_in;
use crate::processes::{begin, signal, until};
use assert_cmd::Command;
use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

/// The numbers of processes in a file, once there is one.
fn numbers(file: &Path) -> Vec<String> {
    let text = || fs::read_to_string(file).unwrap_or_default();
    until("no engine was started", || text().ends_with('\n'));
    text().lines().map(str::to_owned).collect()
}

/// Whether a process still runs after the moment that a kill may take; what has ended and is not reaped does not.
fn runs(number: &str) -> bool {
    let begin = Instant::now();
    loop {
        let state = fs::read_to_string(format!("/proc/{number}/stat")).unwrap_or_default();
        if state.rsplit_once(") ").is_none_or(|(_, rest)| rest.starts_with('Z')) {
            return false;
        }
        if begin.elapsed() > Duration::from_secs(5) {
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// The end of a child within a time that no engine's patience fits in.
fn ended(mut child: Child, what: &str) -> Option<i32> {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a child") {
            return status.code();
        }
        if begin.elapsed() > Duration::from_secs(20) {
            child.kill().expect("kill");
            panic!("{what}: still runs 20 s after the signal");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_signal_ends_hanging_engines_at_once() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let hanging = "sh -c 'echo $$ >>numbers; exec sleep 1000'".to_owned();
    let midway = format!("sh -c 'echo $$ >>numbers; exec {} hang'", client());
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/regressions/f-v-arithmetic-vertex-face-depth.toml");
    let campaign =
        ["campaign", "--engine", "mine", "--engine-timeout", "600", "--family", "face_stack", "--out", "out"];
    let words = ["sh", "-c", "echo $$ >>numbers; exec sleep 1000"];
    let gate = around(&words, "[[limit]]\ncount = 0\n").replace("timeout_ms = 500", "timeout_ms = 600000");
    // `shrink` asks the engine alone that a case is about.
    let text = fs::read_to_string(case).expect("a case");
    let about = "engine = \"stepper-f32\"";
    assert!(text.contains(about), "{text}");
    let mine = text.replacen(about, "engine = \"mine\"", 1);
    let shrink = ["shrink", "mine.toml", "--out", "small.toml", "--engine-timeout", "600"];
    let replay = ["replay", case, "--engine-timeout", "600"];
    let runs_of: [(&[&str], &String, &[&str]); 13] = [
        (&["INT"], &midway, &campaign),
        (&["TERM"], &midway, &campaign),
        (&["HUP"], &hanging, &campaign),
        (&["INT", "INT"], &midway, &campaign),
        (&["INT", "INT"], &hanging, &campaign),
        (&["HUP", "TERM"], &hanging, &campaign),
        (&["TERM"], &hanging, &["gate", "gate.toml"]),
        (&["HUP"], &hanging, &["gate", "gate.toml"]),
        (&["INT"], &hanging, &replay),
        (&["HUP"], &hanging, &replay),
        (&["INT"], &hanging, &shrink),
        (&["TERM"], &hanging, &shrink),
        (&["HUP"], &hanging, &shrink),
    ];
    // All at a time, since they wait most of theirs.
    let ends = &|(at, (signals, command, arguments)): (usize, (&[&str], &String, &[&str]))| {
        let what = format!("{} to {}", signals.join(" and "), arguments[0]);
        let dir = &dir.join(at.to_string());
        fs::create_dir(dir).expect("a folder");
        fs::write(dir.join("gate.toml"), &gate).expect("write");
        fs::write(dir.join("mine.toml"), &mine).expect("write");
        let engine = format!("mine={command}");
        let mut all = arguments.to_vec();
        if arguments[0] != "gate" {
            all.extend(["--engine-command", &engine]);
        }
        let child = begin(dir, &all);
        numbers(&dir.join("numbers"));
        if *command == midway {
            // Into the first chunk, where a third of the questions is never answered.
            std::thread::sleep(Duration::from_secs(1));
        }
        // The second finds the program as the first left it, or about to end.
        signals.iter().for_each(|name| signal(&child, name));
        assert_eq!(ended(child, &what), Some(130), "{what}");
        for number in numbers(&dir.join("numbers")) {
            assert!(!runs(&number), "{what}: engine {number} runs on");
        }
    };
    std::thread::scope(|scope| {
        for run in runs_of.into_iter().enumerate() {
            scope.spawn(move || ends(run));
        }
    });
}

#[test]
fn failures_that_do_not_repeat_are_told_and_can_be_denied() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let engine = format!("mine={} second", client());
    let pairs = ["campaign", CASES_AS_FOUND, "--family", "face_stack", "--pairs", "64"];
    let campaign = [&pairs[..], &["--engine", "mine", "--engine-command", &engine]].concat();
    let (code, out, err) = rockproof_in(dir, &[&campaign[..], &["--out", "run", "--deny", "crash"]].concat());
    assert!(code == 0 && out.contains("were answered by a fresh process"), "{out}{err}");
    let engines = || fs::read_to_string(dir.join("run/engines.csv")).expect("engines.csv");
    let counts = || {
        let table = engines();
        let row: Vec<&str> = table.lines().nth(1).expect("a row").split(',').collect();
        [1, 3].map(|at: usize| row[at].parse::<u64>().expect("a count"))
    };
    let (table, [asked, recovered]) = (engines(), counts());
    assert!(
        table.starts_with(
            "engine,asked,processes_started,recovered,not_compared,first_failures,contacts,entrances,gap_m,\
             apart,apart_gaps,apart_normals,touching,touching_gaps,touching_normals,overlapping,overlapping_gaps,overlapping_normals,contact_answers\nmine,"
        ),
        "{table}"
    );
    assert!(recovered > 60 && asked >= 2 * recovered, "{table}");
    // What they were: of a kind, with the program's last words where it has any, each once.
    let crash = "crashed: it ended with exit code 3";
    assert!(table.contains(&format!(",{crash},")) && out.contains(&format!("  {crash}\n")), "{table}{out}");
    // Sums go on where a run does.
    let more: Vec<&str> = campaign.iter().map(|word| if *word == "64" { "80" } else { *word }).collect();
    let (code, _, err) = rockproof_in(dir, &[&more[..], &["--out", "run", "--resume", "--deny", "recovered"]].concat());
    assert!(code == 1 && err.contains("recovered"), "{err}");
    let [asked_since, recovered_since] = counts();
    assert!(recovered_since > recovered && asked_since > asked, "{asked_since} {recovered_since}");
    let (code, out, err) = rockproof_in(dir, &["report", "run", "--out", "page"]);
    assert!(code == 0 && out.contains("were answered by a fresh process"), "{out}{err}");

    // One limit on what it answers in each.
    let gated = |limit: &str| {
        let limits = format!("[[limit]]\ncount = 9999\n{limit}");
        // Each second question costs two processes.
        gate(dir, &around(&[&client(), "second"], &limits).replace("pairs = 256", "pairs = 32"), &[], true)
    };
    let ran = gated("[[limit]]\nchange = \"crash\"\ncount = 0\n");
    assert!(ran.code == 0 && ran.out.contains("no limit names them"), "{}{}", ran.out, ran.err);
    let summary = fs::read_to_string(dir.join("summary.md")).expect("a summary");
    assert!(summary.contains("no limit names them"), "{summary}");
    let ran = gated("[[limit]]\nengine = \"mine\"\nchange = \"recovered\"\ncount = 0\n");
    assert!(ran.code == 1 && ran.out.contains("a fresh process did not repeat, at most 0"), "{}", ran.out);
    assert!(!ran.out.contains("no limit names them"), "{}", ran.out);
    assert_eq!(gated("[[limit]]\nchange = \"recovered\"\ncount = 100000\n").code, 0);
    for limit in ["rate = 0.1", "count = 0\nfamily = \"face_stack\"", "count = 0\nbeyond_ulps = 1"] {
        let ran = gated(&format!("[[limit]]\nchange = \"recovered\"\n{limit}\n"));
        assert!(ran.code == 2 && ran.err.contains("it may name engine, and needs count"), "{limit}: {}", ran.err);
    }
}

#[test]
fn what_an_engine_says_is_shown_and_not_done() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let engine = format!("mine={} escape", client());
    let campaign =
        ["campaign", "--pairs", "64", "--family", "edge_cross", "--engine", "mine", "--engine-command", &engine];
    let (code, out, err) = rockproof_in(dir, &[&campaign[..], &["--out", "run"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    let mut cases = fs::read_dir(dir.join("run/cases")).expect("cases").map(|case| case.expect("a case").path());
    let case = cases.find(|case| case.to_string_lossy().contains("unsupported")).expect("a case of it");
    let (code, out, err) = rockproof_in(dir, &["replay", &case.to_string_lossy(), "--engine-command", &engine]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("mine gave no answer: unsupported: \\u{1b}[31mred\\n::error::\\0"), "{out}");
    let noted = fs::read_to_string(&case).expect("a case");
    assert!(noted.contains("[31mred"), "{noted}");
    for text in [out, err, noted] {
        assert!(!text.contains(['\u{1b}', '\0']) && !text.lines().any(|l| l.trim_start().starts_with("::")), "{text}");
    }
}

#[test]
fn a_line_after_each_answer_is_malformed_and_not_recovered() {
    let answer = "echo \"{\\\"id\\\":$n,\\\"contacts\\\":[]}\"; n=$((n+1))";
    let scripts = [
        format!("n=0; while read line; do {answer}; sleep 0.05; echo late; done"),
        format!("n=0; while read line; do [ $n -gt 0 ] && echo late && sleep 0.005; {answer}; done"),
    ];
    let is_malformed = |script: &str| {
        let dir = crate::place::folder();
        let config = around(&["sh", "-c", script], "[[limit]]\nchange = \"malformed\"\ncount = 0\n");
        let config = config.replace("pairs = 256", "pairs = 32").replace("timeout_ms = 500", "timeout_ms = 20000");
        let ran = gate(dir.path(), &config, &[], true);
        assert!(ran.code == 1 && ran.out.contains("malformed"), "{}{}", ran.out, ran.err);
        // Of failures that a fresh process did not repeat it would be said that no limit names them.
        assert!(!ran.out.contains("no limit names them"), "{}", ran.out);
    };
    // Both at a time, since they wait most of theirs.
    std::thread::scope(|scope| scripts.iter().for_each(|script| drop(scope.spawn(|| is_malformed(script)))));
}

#[test]
fn what_this_program_lacks_is_no_finding_about_an_engine() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let engine = format!("mine={}", client());
    let run = |limit: &str, more: &[&str]| {
        let script = format!("{limit}exec \"$0\" \"$@\"");
        let mut shell = Command::new("sh");
        shell.current_dir(dir).args(["-c", &script]).arg(assert_cmd::cargo::cargo_bin("rockproof"));
        shell.args(["campaign", CASES_AS_FOUND, "--pairs", "256", "--family", "edge_cross"]).args([
            "--engine",
            "mine",
            "--threads",
            "6",
        ]);
        let output = shell.args(["--engine-command", &engine]).args(more).output().expect("runs");
        (output.status.code().expect("a code"), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, err) = run("ulimit -n 14; ", &["--out", "run"]);
    let told = ["\"mine\" cannot be asked", "Too many open files", "fewer --threads", "ulimit -n"];
    assert!(code == 2 && told.iter().all(|part| err.contains(part)), "{code}: {err}");
    let (code, err) = run("", &["--out", "run", "--resume"]);
    assert_eq!(code, 0, "{err}");
    let (code, err) = run("", &["--out", "undisturbed"]);
    assert_eq!(code, 0, "{err}");
    let findings = ["run", "undisturbed"].map(|out| fs::read(dir.join(out).join("findings.csv")).expect("findings"));
    assert!(findings[0] == findings[1], "{}", String::from_utf8_lossy(&findings[0]));
}
