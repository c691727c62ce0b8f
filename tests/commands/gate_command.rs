//! The gate passes on the clean tree and fails on each kind of regression, planted by an external engine that misbehaves;
//! its outputs are read by parsers; every error exits 2 with the place and what is allowed.

use crate::engines::client;
use crate::gates::{around, gate};
use assert_cmd::Command;
use std::fs;
use std::path::Path;

/// A gate around the client with a trick.
fn planted(trick: &str, rest: &str) -> String {
    around(&[&client(), trick], rest)
}

#[test]
#[ignore = "twenty seconds; .ci/run runs it"]
fn passes_on_what_is_known_and_fails_on_each_planted_regression() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let baseline = "[baseline]\nfile = \"known.toml\"\n";
    let ran = gate(dir, &planted("", baseline), &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let ran = gate(dir, &planted("", baseline), &[], false);
    assert_eq!(ran.code, 0, "the clean engine: {}{}", ran.out, ran.err);
    for (trick, message) in [
        ("crash", "crash"),
        ("malformed", "malformed"),
        ("unsupported", "unsupported"),
        ("none", "missing"),
        ("state", "state"),
    ] {
        let shrunk = planted(trick, baseline).replace("shrink_evaluations = 0\n", "");
        let ran = gate(dir, &shrunk, &[], false);
        assert!(ran.code == 1 && ran.out.contains(message) && ran.out.contains("gate failed"), "{trick}: {}", ran.out);
        let cases = fs::read_dir(dir.join("reports/gate/fixed/cases")).expect("cases").count();
        assert!(cases > 0, "{trick}: a case to replay");
        // One on all findings, so that the engine's answers are looked at in each case.
        let limit = |own: &str| {
            format!("[[limit]]\ncount = 9999\n[[limit]]\nengine = \"mine\"\nchange = \"{message}\"\n{own}\n")
        };
        assert_eq!(gate(dir, &planted(trick, &limit("count = 0")), &[], false).code, 1, "{trick} by count");
        assert_eq!(gate(dir, &planted(trick, &limit("rate = 1e-6")), &[], false).code, 1, "{trick} by rate");
        assert_eq!(gate(dir, &planted(trick, &limit("rate = 0.9")), &[], false).code, 0, "{trick} is allowed");
    }
}

#[test]
fn the_corpus_is_always_run() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/regressions");
    fs::create_dir_all(dir.join("cases/regressions")).expect("a folder");
    let mut names = Vec::new();
    for entry in fs::read_dir(from).expect("cases") {
        let entry = entry.expect("a case");
        if entry.path().extension().is_none_or(|extension| extension == "md") {
            continue;
        }
        fs::copy(entry.path(), dir.join("cases/regressions").join(entry.file_name())).expect("copied");
        names.push(entry.file_name());
    }
    let text = "[campaign]\npairs = 16\n";
    let ran = gate(dir, text, &[], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let xml = fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    assert!(names.iter().all(|name| xml.contains(&*name.to_string_lossy())), "{xml}");
    // The exact answer is another than the case says.
    let case = dir.join("cases/regressions/f-v-arithmetic-vertex-face-depth.toml");
    let changed = fs::read_to_string(&case).expect("a case").replace("expected = []", "expected = [{ kind = \"v-v\", feature_a = 0, feature_b = 0, entrance = \"v-f\", entrance_a = 0, entrance_b = 0, gap_sign = 1 }]");
    fs::write(&case, changed).expect("write");
    let ran = gate(dir, text, &[], false);
    assert!(ran.code == 1 && ran.out.contains("exact answer"), "{}", ran.out);
}

/// Shrunk findings about steps: a passage, at a tie that f64 does not see, and an unseen overlap.
const STEPS: [&str; 2] = ["step-step-length-passage.json", "step-step-length-unseen.json"];

#[test]
fn the_corpus_holds_steps_to_what_they_record() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let [passage, unseen] = STEPS.map(|name| {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/regressions").join(name);
        fs::read_to_string(from).expect("a case")
    });
    let text = |corpus: &str, more: &str| format!("corpus = [\"{corpus}\"]\n[campaign]\npairs = 16\n{more}");
    fs::create_dir(dir.join("steps")).expect("a folder");
    let run = |case: &str, more: &str| {
        fs::write(dir.join("steps/case.json"), case).expect("written");
        let ran = gate(dir, &text("steps", more), &[], false);
        (ran.code, ran.out + &ran.err)
    };
    assert_eq!((run(&passage, "").0, run(&unseen, "").0), (0, 0));
    let junit = fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    assert!(junit.contains("case.json"), "{junit}");
    let changed = |case: &str, from: &str, to: &str| {
        assert!(case.contains(from), "{from}");
        run(&case.replace(from, to), "")
    };
    for (case, from, to, why) in [
        (&unseen, "\"0-1 unseen\"", "\"0-1 passage\"", "the oracle's answer is not the one"),
        (&unseen, "step-length unseen", "not-held unseen", "has no longer its cause: not-held unseen"),
        (&passage, "iterations: 3 → 5", "iterations: 3 → 4", "nor what the case records: arithmetic iterations: 3 → 5"),
    ] {
        let (code, out) = changed(case, from, to);
        assert!(code == 1 && out.contains(why) && out.contains("case.json"), "{why}: {code} {out}");
    }
    // An engine that takes no part is not asked, so this gate checks nothing; what is no state file is an error that names the file.
    let (code, out) = run(&passage, "engines = [\"stepper-f32\"]\n");
    assert!(code == 1 && out.contains("engine stepper-f64 takes no part in this gate"), "{out}");
    assert!(out.contains("so nothing was checked") && out.contains("0 passed, 1 skipped, 1 failed"), "{out}");
    let (code, out) = changed(&passage, "rockproof-step-1", "rockproof-step-0");
    assert!(code == 2 && out.contains("case.json: the format is `rockproof-step-0`"), "{out}");
    let (code, out) = run("{}", "");
    assert!(code == 2 && out.contains("case.json: no state file"), "{out}");
}

#[test]
fn the_formats_are_what_their_readers_take() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let limit = "[[limit]]\nengine = \"mine\"\nchange = \"crash\"\ncount = 0\n[[limit]]\ncause = \"defect\"\ncount = 0\n[[limit]]\ncount = 9999\n";
    let ran = gate(dir, &planted("crash", limit), &["--rotating-seed", "7"], true);
    assert_eq!(ran.code, 1, "{}", ran.err);
    let text = fs::read_to_string(dir.join("junit.xml")).expect("JUnit");
    let xml = roxmltree::Document::parse(&text).expect("XML");
    let root = xml.root_element();
    assert_eq!(root.tag_name().name(), "testsuites");
    let number = |node: roxmltree::Node<'_, '_>, name: &str| node.attribute(name).and_then(|n| n.parse::<usize>().ok());
    let (mut tests, mut failures) = (0, 0);
    for suite in root.children().filter(roxmltree::Node::is_element) {
        assert!(suite.tag_name().name() == "testsuite" && suite.attribute("name").is_some());
        let cases: Vec<_> = suite.children().filter(|n| n.has_tag_name("testcase")).collect();
        assert!(cases.iter().all(|c| c.attribute("name").is_some() && c.attribute("classname").is_some()));
        let failed = cases.iter().filter(|c| c.children().any(|n| n.has_tag_name("failure"))).count();
        assert_eq!((number(suite, "tests"), number(suite, "failures")), (Some(cases.len()), Some(failed)));
        (tests, failures) = (tests + cases.len(), failures + failed);
    }
    assert_eq!((number(root, "tests"), number(root, "failures")), (Some(tests), Some(failures)));
    assert_eq!((tests, failures), (4, 1));
    assert!(quick_junit::Report::deserialize_from_str(&text).is_ok(), "a reader of JUnit takes it");
    let annotation = ran.out.lines().find(|line| line.starts_with("::error ")).expect("an annotation");
    assert!(
        annotation.contains("file=gate.toml,line=11,") && annotation.contains("title=rockproof limit::"),
        "{annotation}"
    );
    let summary = fs::read_to_string(dir.join("summary.md")).expect("a summary");
    assert!(
        summary.starts_with("## Rockproof gate: failed") && summary.contains("| FAIL | fixed: engine mine"),
        "{summary}"
    );
}

#[test]
fn the_action_is_yaml_and_asks_for_what_there_is() {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("action.yml")).expect("action.yml");
    let action = &yaml_rust2::YamlLoader::load_from_str(&text).expect("YAML")[0];
    assert_eq!(action["runs"]["using"].as_str(), Some("composite"));
    let steps = action["runs"]["steps"].as_vec().expect("steps");
    assert!(steps.iter().all(|s| s["uses"].as_str().is_some() || s["shell"].as_str() == Some("bash")), "{steps:?}");
    // A tag may be moved to other code; a commit may not.
    for uses in steps.iter().filter_map(|step| step["uses"].as_str()) {
        let commit = uses.split_once('@').map_or("", |(_, commit)| commit);
        let pinned = commit.len() == 40 && commit.chars().all(|c| c.is_ascii_hexdigit());
        assert!(pinned || uses.starts_with("./"), "{uses} is not held by its commit");
    }
    // Two gates of a job, or of a matrix, keep their results beside one another; the second does not build again.
    let with = |uses: &str, key: &str| {
        let step = steps.iter().find(|step| step["uses"].as_str().is_some_and(|used| used.starts_with(uses)));
        step.and_then(|step| step["with"][key].as_str()).map(str::to_owned)
    };
    assert_eq!(with("actions/cache@", "key").as_deref(), Some("${{ steps.name.outputs.build }}"));
    assert_eq!(with("actions/upload-artifact@", "name").as_deref(), Some("${{ steps.name.outputs.artifact }}"));
    #[cfg(unix)]
    {
        let named = |out: &str| {
            let script = steps[0]["run"].as_str().expect("a script");
            let dir = crate::place::folder();
            let file = dir.path().join("output");
            let status = std::process::Command::new("bash")
                .args(["-euo", "pipefail", "-c", script])
                .env("ACTION", env!("CARGO_MANIFEST_DIR"))
                .envs([("OUT", out), ("JOB", "test-0"), ("RUNNER_OS", "Linux"), ("RUNNER_ARCH", "X64")])
                .env("GITHUB_OUTPUT", &file)
                .status()
                .expect("bash runs");
            assert!(status.success());
            fs::read_to_string(file).expect("outputs")
        };
        let [one, other] = ["reports/gate", "reports/other gate"].map(named);
        let [one, other] = [&one, &other].map(|text| text.lines().collect::<Vec<_>>());
        assert_eq!([one.len(), other.len()], [2, 2]);
        assert!(one[0] == other[0] && one[0].starts_with("build=rockproof-Linux-X64-") && one[0].len() > 70, "{one:?}");
        assert_eq!(
            [one[1], other[1]],
            ["artifact=rockproof-gate-test-0-reports-gate", "artifact=rockproof-gate-test-0-reports-other-gate"]
        );
    }
    let help = Command::cargo_bin("rockproof").expect("the program").args(["gate", "--help"]).output().expect("runs");
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    for flag in ["--out", "--junit", "--rotating-seed"] {
        assert!(text.contains(flag) && help.contains(flag), "{flag}");
    }
}

#[test]
fn errors_exit_with_2_and_name_the_place_and_what_is_allowed() {
    let dir = crate::place::folder();
    for (text, message) in [
        ("pears = 3\n", vec!["line 1", "campaign"]),
        ("[campaign]\npears = 3\n", vec!["line 2", "pairs"]),
        (
            "corpus = []\n[[limit]]\ncause = \"rounding\"\ncount = 0\n",
            vec!["gate.toml line 2", "arithmetic, defect, engine"],
        ),
        ("corpus = []\n\n[[limit]]\nchange = \"lost\"\ncount = 0\n", vec!["line 3", "missing, extra"]),
        ("corpus = []\n[[limit]]\nkind = \"v-w\"\ncount = 0\n", vec!["v-v, v-e"]),
        ("corpus = []\n[[limit]]\nengine = \"abacus\"\ncount = 0\n", vec!["any, f32, f64, stepper-f32"]),
        ("corpus = []\n[[limit]]\nfamily = \"pyramids\"\ncount = 0\n", vec!["sliver"]),
        ("corpus = []\n[[limit]]\ntolerances = \"loose\"\ncount = 0\n", vec!["auto, shi, zero"]),
        ("corpus = []\n[[limit]]\nrate = 2\n", vec!["line 2", "0 to below 1"]),
        ("corpus = []\n[[limit]]\nrate = 1\n", vec!["line 2", "0 to below 1"]),
        (
            "corpus = []\n[[limit]]\nrate = 0.1\nconfidence = 1.0\n",
            vec!["line 2: confidence is 1; allowed are 0.5 to below 1"],
        ),
        ("corpus = []\n[[limit]]\ncause = \"defect\"\n", vec!["line 2: the limit has neither count nor rate"]),
        (
            "corpus = []\n[[limit]]\ncount = 1\nrate = 0.1\n",
            vec!["line 2: the limit has count and rate; allowed is one"],
        ),
        (
            "corpus = []\n[[limit]]\ncount = nan\n",
            vec!["gate.toml line 3: count is nan; allowed is a whole number from 0"],
        ),
        (
            "corpus = []\n[[limit]]\ncauses = 1\n",
            vec!["gate.toml line 3: \"causes\" is no key here; allowed are engine, "],
        ),
        ("corpus = []\n[baseline]\nfile = \"none.toml\"\n", vec!["none.toml", "--update-baseline"]),
        (
            "corpus = []\n[baseline]\nfile = \"x\"\ncauses = [\"luck\"]\n",
            vec!["line 4: baseline.causes has \"luck\"", "tolerance"],
        ),
        (
            "corpus = []\n[baseline]\nfile = \"x\"\nfields = [\"colour\"]\n",
            vec!["line 4: baseline.fields has \"colour\"", "predicate"],
        ),
        (
            "corpus = []\n[baseline]\nfile = \"x\"\ncauses = []\n",
            vec!["line 4: baseline.causes is empty, with none every run would pass; allowed are ", "defect"],
        ),
        ("corpus = []\n[baseline]\nfile = \"x\"\nfields = []\n", vec!["line 4: baseline.fields is empty", "predicate"]),
        ("", vec!["gate.toml: nothing stands in it; allowed are corpus, ", "[[limit]]"]),
        ("# nothing\n", vec!["nothing stands in it"]),
        ("corpus = [\"nowhere\"]\n", vec!["there is no nowhere", "corpus = []"]),
        ("[[limit]]\ncount = 0\n", vec!["there is no cases/regressions", "corpus = []"]),
        ("corpus = [\"gate.toml\"]\n", vec!["gate.toml", "case"]),
        ("corpus = []\n[campaign]\nengines = [\"abacus\"]\n", vec!["stepper-f32"]),
    ] {
        let ran = gate(dir.path(), text, &[], false);
        assert_eq!(ran.code, 2, "{text}: {}{}", ran.out, ran.err);
        assert!(message.iter().all(|t| ran.err.contains(t)) && !ran.err.contains("panicked"), "{text}: {}", ran.err);
    }
}

#[test]
fn a_campaign_of_other_settings_than_its_baseline_says_so() {
    let dir = crate::place::folder();
    let gate_of = |campaign: &str| {
        format!(
            "corpus = []\nrotating_pairs = 16\n[campaign]\nengines = [\"f64\"]\nfamilies = [\"sliver\"]\n{campaign}\n[baseline]\nfile = \"known.toml\"\n"
        )
    };
    let ran = gate(dir.path(), &gate_of("pairs = 16\nseed = 1"), &["--update-baseline"], false);
    assert_eq!(ran.code, 0, "{}{}", ran.out, ran.err);
    let known = fs::read_to_string(dir.path().join("known.toml")).expect("a baseline");
    assert!(known.contains("\n[settings]\n") && known.contains("\"seed\" = \"1\"\n"), "{known}");
    let ran = gate(dir.path(), &gate_of("pairs = 16\nseed = 1"), &[], false);
    assert!(!ran.out.contains("settings of the baseline"), "{}", ran.out);
    let ran = gate(dir.path(), &gate_of("pairs = 32\nseed = 2\ntolerances = [\"auto\"]"), &[], false);
    let rows: Vec<&str> = ran.out.lines().filter(|line| line.contains("settings of the baseline")).collect();
    assert_eq!(rows.len(), 2, "{}", ran.out);
    let [fixed, rotating] = [rows[0], rows[1]];
    assert!(fixed.contains("pairs is 32, in the baseline 16; seed is 2, in the baseline 1; tolerances is [\"auto\"], in the baseline []"), "{fixed}");
    assert!(rotating.contains("tolerances is") && !rotating.contains("seed is"), "{rotating}");
}
