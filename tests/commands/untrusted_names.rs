//! Names of files and directories that a terminal, a runner or a spreadsheet would obey: in JSON they are escaped as JSON has it, tables and pages
//! of reports show them, and no tolerance set is called so.

use crate::campaigns::CASES_AS_FOUND;
use crate::gates::gate;
use crate::place::rockproof_in;
use crate::untrusted_input::{CASE, change, refused};
use rockproof_model::text::{escaped, is_harmful};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A line break with a command behind it, colours, characters that JSON need not escape, and another command.
const NASTY: &str = "a\n::error::b \u{1b}[31m\u{7f}\u{85}\u{202e}##[x]";

/// Whether a text somewhere in a document holds another.
fn holds(document: &Value, text: &str) -> bool {
    match document {
        Value::String(found) => found.contains(text),
        Value::Array(all) => all.iter().any(|one| holds(one, text)),
        Value::Object(all) => all.iter().any(|(key, one)| key.contains(text) || holds(one, text)),
        _ => false,
    }
}

/// What a command prints is one document, and a command to nobody.
fn document(dir: &Path, arguments: &[&str]) -> Value {
    let (code, out, err) = rockproof_in(dir, &[arguments, &["--format", "json"]].concat());
    assert!(code < 2, "{arguments:?}: {code}: {out}{err}");
    let is_plain = |text: &str| {
        !text.contains(|c: char| is_harmful(c) && c != '\n' && c != '\t')
            && !text.contains("##[")
            && !text.lines().any(|line| line.trim_start().starts_with("::"))
    };
    assert!(is_plain(&out) && is_plain(&err), "{arguments:?}: {out:?} {err:?}");
    serde_json::from_str(&out).unwrap_or_else(|error| panic!("{arguments:?}: {error}: {out}"))
}

#[test]
fn documents_hold_names_as_they_are() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (model, case, out) = (format!("{NASTY}.obj"), format!("{NASTY}.toml"), format!("out {NASTY}"));
    fs::write(dir.join(&model), include_str!("../fixtures/two_cubes.obj")).expect("write");
    let mut described: toml::Table = CASE.parse().expect("a case");
    described["case"]["origin"] = toml::Value::String(NASTY.to_owned());
    fs::write(dir.join(&case), described.to_string()).expect("write");
    let at = |name: &str| format!("{name} {out}");
    let (tuned, examined, stepped, exact) = (at("tuned"), at("examined"), at("stepped"), at("exact"));
    let (run, other, merged) = (at("run"), at("other"), at("merged"));
    let pairs = ["--pairs", "32", "--family", "sliver", "--tolerances", "auto", "--steps-every", "0"];
    let campaign = [&["campaign", CASES_AS_FOUND], &pairs[..]].concat();
    for (number, out) in [("1/2", "half 1"), ("2/2", "half 2")] {
        let (code, _, err) = rockproof_in(dir, &[&campaign[..], &["--part", number, "--out", &at(out)]].concat());
        assert_eq!(code, 0, "{err}");
    }
    let expected = "expected = [{ kind = \"v-v\", feature_a = 0, feature_b = 0, entrance = \"v-f\", entrance_a = 0, entrance_b = 0, gap_sign = 1 }]";
    let corpus = format!("corpus {NASTY}.toml");
    fs::write(dir.join(&corpus), change(CASE, "expected = []", expected)).expect("write");
    let text = format!("corpus = [{}]\n[campaign]\npairs = 16\n", toml::Value::from(corpus.as_str()));
    fs::write(dir.join("gate.toml"), text).expect("write");
    let commands: [(&[&str], Option<&str>); 14] = [
        (&["check", &model], Some(&model)),
        (&["classify", &model], None),
        (&["examine", &model, "--steps", "0", "--out", &examined], Some(&model)),
        (&["tune", &model, "--candidates", "1", "--steps", "1", "--out", &tuned], Some(&tuned)),
        (&["simulate", &model, "--steps", "1", "--force", "--out", &stepped], Some(&stepped)),
        (&["simulate", &model, "--steps", "1", "--force", "--engine", "exact", "--out", &exact], Some(&exact)),
        (&[&campaign[..], &["--out", &run]].concat(), Some(&run)),
        (&[&campaign[..], &["--out", &other]].concat(), Some(&other)),
        (&["merge", &at("half 1"), &at("half 2"), "--out", &merged], Some(&merged)),
        (&["compare", &run, &other], Some(&run)),
        (&["compare", &run, &run], Some(&run)),
        (&["replay", &case], Some(NASTY)),
        (&["gate", "gate.toml", "--out", &at("gated")], Some(&corpus)),
        (&["bench", "--stack", "7", "--steps", "2"], None),
    ];
    for (arguments, name) in commands {
        let document = document(dir, arguments);
        assert!(name.is_none_or(|name| holds(&document, name)), "{arguments:?}: {document}");
    }
}

/// Tables of campaigns hold the names of sets as they are, so no set has one that does something else than to show.
#[test]
fn no_set_is_called_like_a_command() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for stem in ["esc\u{1b}[31mx", "a\nb", "a\rb", "a\u{7f}", "a\u{202e}b"] {
        let name = format!("{stem}.toml");
        fs::write(dir.join(&name), "preset = \"auto\"\n").expect("write");
        let settings = format!("pairs = 16\ntolerances = [{}]\n", toml::Value::from(name.as_str()));
        fs::write(dir.join("settings.toml"), &settings).expect("write");
        let called = format!("its set would be called \"{}\"", escaped(stem));
        let parts = [called.as_str(), "and control characters", "rename the file"];
        let inline = format!("--tolerances={name}");
        for arguments in [
            &["campaign", "settings.toml", "--out", "run"][..],
            &["campaign", "--pairs", "16", &inline, "--out", "run"],
            &["campaign", "--stress", "--pairs", "16", &inline, "--out", "run"],
        ] {
            refused(dir, arguments, &parts);
        }
        let ran = gate(dir, &format!("corpus = []\n[campaign]\n{settings}"), &[], false);
        assert!(ran.code == 2 && ran.err.contains(parts[0]), "{stem:?}: {}", ran.err);
    }
    assert!(!dir.join("run").exists(), "nothing is written");
}

/// All files of a folder and its folders.
fn files(dir: &Path) -> Vec<std::path::PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(dir).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}

#[cfg(unix)]
#[test]
fn reports_show_the_names_of_runs() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (run, other) = (format!("run {NASTY}"), format!("other {NASTY}"));
    for (out, seed) in [(&run, "1"), (&other, "2")] {
        let campaign =
            ["campaign", CASES_AS_FOUND, "--pairs", "64", "--family", "sliver", "--seed", seed, "--out", out];
        let (code, _, err) = rockproof_in(dir, &campaign);
        assert_eq!(code, 0, "{err}");
    }
    let (code, out, err) = rockproof_in(dir, &["report", &run, &other, "--title", NASTY, "--out", "page"]);
    assert_eq!(code, 0, "{out}{err}");
    let (code, out, err) = rockproof_in(dir, &["compare", &run, &other, "--out", "compared"]);
    assert_eq!(code, 0, "{out}{err}");
    let shown = escaped(&run);
    for (folder, least) in [("page", 8), ("compared", 1)] {
        let mut named = 0;
        for file in files(&dir.join(folder)) {
            let text = fs::read_to_string(&file).expect("a text");
            // The name as it is: nothing of it does anything.
            assert!(!text.contains('\u{1b}') && !text.contains("a\n::error"), "{}", file.display());
            assert!(!text.contains("\u{7f}\u{85}") && !text.contains("\u{202e}##"), "{}", file.display());
            named += usize::from(text.contains(&shown));
        }
        assert!(named >= least, "{folder}: {named}");
    }
}
