//! What a gate leaves to those after it: no report of an earlier gate, a directory that says whose it is, and commands that replay when pasted.

use crate::engines::client;
use crate::gates::{around, gate};
use crate::place::rockproof_in;
use assert_cmd::Command;
use std::fs;

const PASSES: &str = "corpus = []\n[campaign]\npairs = 16\n[[limit]]\ncause = \"defect\"\ncount = 0\n";

/// A gate that ends before it has checked anything must not leave the green report of the gate before.
#[test]
fn no_report_of_an_earlier_gate_stays() {
    let dir = crate::place::folder();
    let report = dir.path().join("junit.xml");
    let ran = gate(dir.path(), PASSES, &[], false);
    assert!(ran.code == 0 && report.exists(), "{}{}", ran.out, ran.err);
    for (text, why) in [
        (around(&["./nothing"], "[[limit]]\ncount = 0\n"), "does not answer"),
        (PASSES.replace("defect", "luck"), "cause is \"luck\""),
    ] {
        fs::write(&report, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"rockproof gate\"/>\n")
            .expect("written");
        let ran = gate(dir.path(), &text, &[], false);
        assert!(ran.code == 2 && ran.err.contains(why), "{}", ran.err);
        assert!(!report.exists(), "{why}: the old report is still there");
    }
}

/// Nor may it put its report in the place of a file of its own, make minutes of work before it sees that it cannot write, or leave a folder unmade.
#[test]
fn reports_are_written_where_they_can_be() {
    let dir = crate::place::folder();
    let rockproof = |args: &[&str], summary: &str| {
        let mut command = Command::cargo_bin("rockproof").expect("the program");
        let command = command.current_dir(dir.path()).args(["gate", "gate.toml"]).args(args);
        let output = command.env("GITHUB_STEP_SUMMARY", summary).output().expect("runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    fs::write(dir.path().join("gate.toml"), PASSES).expect("written");
    let (code, err) = rockproof(&["--out", "one", "--junit", "one/fixed/findings.csv"], "");
    assert!(code == Some(2) && err.contains("findings.csv: it is there already and no JUnit report"), "{err}");
    let table = fs::read_to_string(dir.path().join("one/fixed/findings.csv")).expect("a table");
    assert!(table.starts_with("index,"), "{table}");
    let (code, err) = rockproof(&["--out", "two"], "none/summary.md");
    assert!(code == Some(2) && err.contains("none/summary.md") && !dir.path().join("two").exists(), "{err}");
    let (code, err) = rockproof(&["--out", "three", "--junit", "new/folder/gate.xml"], "summary.md");
    assert!(code == Some(0) && dir.path().join("new/folder/gate.xml").is_file(), "{err}");
    assert!(fs::read_to_string(dir.path().join("summary.md")).expect("a summary").contains("cause defect"));
}

#[test]
fn neither_takes_the_directory_of_the_other() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let rockproof = |args: &[&str]| {
        let output = Command::cargo_bin("rockproof").expect("the program").current_dir(dir).args(args).output();
        let output = output.expect("runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    fs::write(dir.join("gate.toml"), PASSES).expect("written");
    let campaign = ["campaign", "--pairs", "16", "--out"];
    assert_eq!(rockproof(&[&campaign[..], &["theirs"]].concat()).0, Some(0));
    let before = fs::read_dir(dir.join("theirs")).expect("results").count();
    let (code, err) = rockproof(&["gate", "gate.toml", "--out", "theirs"]);
    assert!(code == Some(2) && err.contains("theirs") && err.contains("campaign"), "{err}");
    assert_eq!(fs::read_dir(dir.join("theirs")).expect("results").count(), before, "nothing is written there");
    // Where a case cannot be read nothing is left.
    fs::write(dir.join("bad.toml"), "no case").expect("written");
    fs::write(dir.join("bad_gate.toml"), PASSES.replace("corpus = []", "corpus = [\"bad.toml\"]")).expect("written");
    let (code, err) = rockproof(&["gate", "bad_gate.toml", "--out", "unused"]);
    assert!(code == Some(2) && err.contains("bad.toml") && !dir.join("unused").exists(), "{err}");
    // A gate discards what a gate wrote there, and nobody else does.
    for _ in 0..2 {
        assert_eq!(rockproof(&["gate", "gate.toml", "--out", "ours"]).0, Some(0));
    }
    let (code, err) = rockproof(&[&campaign[..], &["ours"]].concat());
    assert!(code == Some(2) && err.contains("ours") && err.contains("gate"), "{err}");
}

#[cfg(unix)]
#[test]
fn the_command_that_replays_can_be_pasted() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let client = client();
    let text = around(&[&client, "none"], "[[limit]]\nengine = \"mine\"\ncount = 0\n").replace("256", "64");
    // A case that was made smaller.
    let text = text.replace("shrink_evaluations = 0\n", "");
    let ran = gate(dir, &text, &["--out", "o ut"], false);
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    let (_, told) = ran.err.split_once("to replay: ").expect("a command");
    let pasted = told.lines().next().expect("a line").strip_prefix("rockproof").expect("the program");
    assert!(pasted.contains("mine:timeout_ms:500="), "{pasted}");
    let program = assert_cmd::cargo::cargo_bin!("rockproof").display();
    let script = format!("'{program}'{pasted}");
    let output = std::process::Command::new("sh").current_dir(dir).args(["-c", &script]).output().expect("a shell");
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.code() == Some(0) && out.contains("the finding recurs"), "{script}: {out}{err}");
    let junit = fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    assert!(junit.contains("--engine-command") && junit.contains("o ut/fixed/cases/"), "{junit}");
    // An engine that answers nothing has not been mended.
    let case = pasted.split(" --engine-command").next().expect("the case");
    let script = format!("'{program}'{case} --engine-command mine=./nothing");
    let output = std::process::Command::new("sh").current_dir(dir).args(["-c", &script]).output().expect("a shell");
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && err.contains("does not answer a first question"), "{err}");
}

/// Of what is wrong with a value of the campaign the line is told, in a gate file as in the settings of a campaign.
#[test]
fn errors_about_values_of_the_campaign_have_their_line() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let external = |lines: &str| format!("chunk = 16\n[[external]]\nname = \"mine\"\n{lines}\n");
    for (text, line, wanted) in [
        ("engines = [\"stepper-f16\"]\n".to_owned(), 1, "engine \"stepper-f16\" does not exist"),
        ("seed = 1\nfamilies = [\n  \"sliver\",\n  \"nope\",\n]\n".to_owned(), 4, "family \"nope\" does not exist"),
        ("tolerances = [\"nope\"]\n".to_owned(), 1, "tolerance set \"nope\" does not exist"),
        ("\nchunk = 0\n".to_owned(), 2, "chunk is 0; allowed are 1 to 65536 pairs"),
        ("\n\nscale = \"0\"\n".to_owned(), 3, "scale is 0; allowed is above 0"),
        ("seed = \"x\"\n".to_owned(), 1, "seed is \"x\"; allowed is a whole number from 0"),
        (external("command = \"x\"\ntimeout_ms = 0"), 5, "engine \"mine\": timeout_ms is 0; allowed are 1 and more"),
        (external("command = \"x\"\n\naccuracy = 9000000000000"), 6, "engine \"mine\": accuracy is 9000000000000"),
        (
            external("command = 3"),
            4,
            "command is 3; allowed is a text in quotes, as \"python3 client.py\", or a list of texts",
        ),
        (external("command = [\"x\", 4]"), 4, "command is 4; allowed is a text in quotes"),
        (external("command = \"./nothing\""), 4, "engine \"mine\" (./nothing) does not answer a first question"),
    ] {
        let settings = text.replace("[[external]]", "[[campaign.external]]");
        let ran = gate(dir, &format!("corpus = []\n[campaign]\n{settings}[[limit]]\ncount = 0\n"), &[], false);
        let told = format!("error: gate.toml line {}: {wanted}", line + 2);
        assert!(ran.code == 2 && ran.err.starts_with(&told), "{told}: {}", ran.err);
        if wanted.contains("first question") {
            continue;
        }
        fs::write(dir.join("settings.toml"), &text).expect("written");
        let (code, _, err) = rockproof_in(dir, &["campaign", "settings.toml", "--out", "out"]);
        assert!(code == 2 && err.starts_with(&format!("error: settings.toml line {line}: {wanted}")), "{err}");
    }
}
