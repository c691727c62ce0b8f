//! Passages from the command line: found, denied, kept, replayed, limited by a gate.

use crate::gates::gate;
use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Runs the program in a folder: its exit code, and what it printed on both streams.
fn rockproof(dir: &Path, arguments: &[&str]) -> (i32, String) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("rockproof"));
    let output = command.current_dir(dir).args(arguments).output().expect("it runs");
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().expect("an exit code"), String::from_utf8_lossy(&text).into_owned())
}

/// Making cases small is tried elsewhere; here it would take most of the time.
const CAMPAIGN: [&str; 4] = ["campaign", "settings.toml", "--out", "run"];
const SETTINGS: &str =
    "pairs = 16\nsteps_every = 1\nfamilies = [\"passage\"]\nengines = [\"stepper-f64\"]\nshrink_evaluations = 2\n";

#[test]
fn a_passage_is_found_denied_kept_and_replayed() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::write(dir.join("settings.toml"), SETTINGS).expect("written");
    let (code, out) = rockproof(dir, &[&CAMPAIGN[..], &["--deny", "passage"]].concat());
    assert_eq!(code, 1, "{out}");
    let (code, out) = rockproof(dir, &[&CAMPAIGN[..], &["--deny", "defect", "--overwrite"]].concat());
    assert_eq!(code, 0, "{out}");
    the_end_names_them(dir, &out);
    let table = fs::read_to_string(dir.join("run/step_findings.csv")).expect("findings");
    let kept = |change: &str| {
        let rows = || table.lines().filter(|row| row.split(',').nth(7) == Some(change) && row.ends_with(".json"));
        rows().next().unwrap_or_else(|| panic!("no case of {change} in\n{table}")).rsplit(',').next().unwrap_or("")
    };
    for (change, told) in [("passage", "pass through one another"), ("unseen", "overlap unseen")] {
        let file = format!("run/{}", kept(change));
        let (code, out) = rockproof(dir, &["replay", &file]);
        assert!(code == 0 && out.contains(told) && out.contains(&format!("{change} 0-1: none → {change}")), "{out}");
        // A case that records something else is objected to.
        let text = fs::read_to_string(dir.join(&file)).expect("a case");
        let other = text.replace(&format!("\"0-1 {change}\""), "\"0-1 other\"");
        assert_ne!(text, other);
        fs::write(dir.join("other.json"), other).expect("written");
        assert_eq!(rockproof(dir, &["replay", "other.json"]).0, 1);
    }
}

/// What a run with passages says at its end, to programs and in a pull request: how many, why, which to replay; and nothing is called well.
fn the_end_names_them(dir: &Path, out: &str) {
    let line = out
        .lines()
        .find(|line| line.contains(" passages and ") && line.contains(" where engines share it, by cause: "));
    let line = line.unwrap_or_else(|| panic!("no line on passages in\n{out}"));
    let (_, case) = line.split_once("worst: case ").expect("a case");
    let (case, _) = case.split_once(')').expect("its end");
    assert!(case.contains("-passage-"), "{case}");
    assert!(out.contains(&format!("rockproof replay run/{case}\n")), "{case}: {out}");
    assert!(!out.contains("No difference") && !out.contains("0 findings\n"), "{out}");
    let (code, told) =
        rockproof(dir, &["campaign", "settings.toml", "--out", "run", "--resume", "--quiet", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&told).expect("one document");
    let lines = document["verdict"].as_array().expect("lines");
    assert!(code == 0 && lines.iter().any(|told| told["text"] == line && told["severity"] == "fair"), "{told}");
    assert!(document["worst_step_case"] == case && document["step_findings"].as_u64() > Some(6), "{told}");
    let (code, text) = rockproof(dir, &["report", "run", "--format", "markdown"]);
    assert!(code == 0 && text.contains(line) && !text.contains('✅'), "{text}");
    assert!(text.contains("| setting | engine | watched | passages | passages oracle |"), "{text}");
    assert_eq!(rockproof(dir, &["report", "run", "--out", "page"]).0, 0);
    let page = fs::read_to_string(dir.join("page/report.html")).expect("a page");
    // Nothing was classified, so there is no empty chart of how often that is right.
    let titles = ["How often is the answer right?", "And if the pairs move?"].map(|title| page.contains(title));
    assert_eq!(titles, [false, true]);
    assert!(
        page.contains(" where engines share it, by cause: ") && dir.join("page/latex/steps_passages.tex").is_file()
    );
    // Findings that are gone must not make a run look well.
    let table = fs::read_to_string(dir.join("run/step_findings.csv")).expect("findings");
    let (shorter, _) = table.trim_end().rsplit_once('\n').expect("rows");
    fs::write(dir.join("run/step_findings.csv"), format!("{shorter}\n")).expect("written");
    let (code, told) = rockproof(dir, &["report", "run", "--format", "markdown"]);
    assert!(code == 2 && told.contains("step_findings.csv") && told.contains("run.json counts"), "{told}");
    fs::write(dir.join("run/step_findings.csv"), table).expect("written");
}

#[test]
fn a_merge_names_passages_too() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::write(dir.join("settings.toml"), SETTINGS).expect("written");
    assert_eq!(rockproof(dir, &["campaign", "settings.toml", "--out", "part", "--part", "1/1"]).0, 0);
    let (code, out) = rockproof(dir, &["merge", "part", "--out", "whole"]);
    assert!(code == 0 && out.contains(" where engines share it, by cause: "), "{out}");
    assert!(out.contains("rockproof replay whole/cases/step-") && !out.contains("No difference"), "{out}");
}

#[test]
fn a_gate_limits_passages_by_count_and_rate() {
    let dir = crate::place::folder();
    let campaign = "corpus = []\n[campaign]\npairs = 16\nsteps_every = 1\nshrink_evaluations = 0\nfamilies = [\"passage\"]\nengines = [\"stepper-f64\"]\n\
         tolerances = [\"auto@max_displacement*128\"]\n[[limit]]\nfamily = \"passage\"\n";
    for (limit, code) in [
        ("change = \"passage\"\ncount = 0\n", 1),
        ("change = \"passage\"\nrate = 1e-6\n", 1),
        ("change = \"passage\"\ncount = 3\n", 0),
        // So few pairs can never fail it: nothing is checked.
        ("change = \"passage\"\nrate = 0.9\n", 1),
        ("cause = \"step-length\"\ncount = 0\n", 1),
        ("cause = \"step-width\"\ncount = 0\n", 2),
        // No engine's mistake, but in the steps of this one.
        ("engine = \"stepper-f64\"\nchange = \"passage\"\ncount = 0\n", 1),
        ("engine = \"stepper-f64\"\ncause = \"step-length\"\ncount = 0\n", 1),
    ] {
        let ran = gate(dir.path(), &format!("{campaign}{limit}"), &[], false);
        assert_eq!(ran.code, code, "{limit}: {}{}", ran.out, ran.err);
        let told = ran.out.lines().any(|line| {
            line.starts_with("fixed campaign: ")
                && line.contains(" in 16 watched steps (")
                && line.contains(", by cause: ")
        });
        assert_eq!(told, code != 2, "{limit}: {}", ran.out);
    }
    let ran = rockproof(dir.path(), &["campaign", "--family", "passage", "--steps-every", "0"]);
    assert!(ran.0 == 2 && ran.1.contains("steps_every"), "{}", ran.1);
}

#[test]
fn a_baseline_holds_findings_about_steps() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let text = "corpus = []\n[campaign]\npairs = 16\nsteps_every = 1\nshrink_evaluations = 0\nfamilies = [\"passage\"]\nengines = [\"stepper-f64\"]\n\
         tolerances = [\"auto@max_displacement*128\"]\n[baseline]\nfile = \"known.toml\"\ncauses = [\"step-length\"]\nfields = [\"cause\", \"change\", \"family\"]\n";
    let ran = gate(dir, text, &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let known = fs::read_to_string(dir.join("known.toml")).expect("a baseline");
    let sort = "\"step | step-length | unseen | passage\" = { findings = ";
    assert!(known.contains(sort) && known.contains("\n[moved]\n\"passage\" = 16\n"), "{known}");
    let check = |known: &str, code: i32, told: &str| {
        fs::write(dir.join("known.toml"), known).expect("written");
        let ran = gate(dir, text, &[], false);
        assert!(ran.code == code && ran.out.contains(told), "{told}: {}{}", ran.out, ran.err);
    };
    check(&known, 0, "none new, none more often");
    // What it does not know, what has become more frequent, and what it never saw.
    let line = known.lines().find(|line| line.starts_with(sort)).expect("a line");
    check(&known.replace(line, ""), 1, "new: step | step-length | unseen | passage");
    let rare = "\"step | step-length | unseen | passage\" = { findings = 0, pairs = 0, squares = 0 }";
    let often = known.replace(line, rare).replace("[moved]\n\"passage\" = 16\n", "[moved]\n\"passage\" = 16000000\n");
    check(&often, 1, "fixed: more often: step | step-length | unseen | passage");
    let bare = known.replace("[moved]\n\"passage\" = 16\n", "");
    let bare: String =
        bare.lines().filter(|line| !line.starts_with("\"step ")).map(|line| format!("{line}\n")).collect();
    check(&bare, 0, "sorts of finding about steps: the baseline was written without steps");
}

/// One case of a cause may be kept here, and one of its passages and of its unseen overlaps beside it.
#[test]
fn passages_have_cases_whatever_else_has() {
    let dir = crate::place::folder();
    let settings = SETTINGS.replace(
        "pairs = 16",
        "pairs = 64\ncases_per_cause = 4\ntolerances = [\"auto\", \"auto@max_displacement*128\"]",
    );
    fs::write(dir.path().join("settings.toml"), settings).expect("written");
    let (code, out) = rockproof(dir.path(), &CAMPAIGN);
    assert_eq!(code, 0, "{out}");
    let table = csv::Reader::from_path(dir.path().join("run/step_findings.csv")).expect("a table");
    let mut cases: BTreeMap<(String, String), [u64; 2]> = BTreeMap::new();
    for row in table.into_deserialize::<BTreeMap<String, String>>().map(|row| row.expect("a row")) {
        let sort = if ["passage", "unseen"].contains(&&*row["change"]) { row["change"].clone() } else { String::new() };
        let of = cases.entry((row["cause"].clone(), sort)).or_default();
        of[0] += 1;
        of[1] += u64::from(!row["case"].is_empty());
    }
    assert!(cases.values().all(|[_, cases]| *cases == 1), "{cases:?}");
    let sorts = |cause: &str| cases.keys().filter(|(of, _)| of == cause).count();
    assert!(["not-held", "step-length"].map(sorts).iter().any(|sorts| *sorts > 1), "{cases:?}");
    assert!(cases.values().any(|[findings, _]| *findings > 1), "{cases:?}");
}

#[test]
fn a_passage_that_stays_undecided_is_not_said_to_recur() {
    let dir = crate::place::folder();
    let dir = dir.path();
    // A cube that falls in the notch of a U. No vertex of the U sees all of it, so that none passes through is not shown.
    fs::write(dir.join("case.json"), include_str!("../step_cases/undecided_passage.json")).expect("written");
    let undecided = "whether 0 and 1 pass through one another stayed undecided";
    let (code, out) = rockproof(dir, &["replay", "case.json"]);
    assert_eq!(code, 1, "{out}");
    assert!(out.ends_with(&format!("\nwhether the finding recurs is not known: {undecided}\n")), "{out}");
    let (code, out) = rockproof(dir, &["replay", "case.json", "--format", "json"]);
    let told: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((code, &told["recurs"], &told["not_known"]), (1, &false.into(), &undecided.into()), "{out}");
    let ran = gate(dir, "corpus = [\"case.json\"]\n[campaign]\npairs = 16\nengines = [\"stepper-f64\"]\n", &[], false);
    assert!(ran.code == 1 && ran.out.contains("skip") && ran.out.contains(undecided), "{}{}", ran.out, ran.err);
}
