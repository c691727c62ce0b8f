//! Pins `compare`: what it says of runs over the same pairs and over others, what it leaves out, what it refuses.

use crate::campaigns::{CASES_AS_FOUND, Campaigns, SETTINGS, WITHOUT_CASES};
use crate::engines::client;
use crate::place::rockproof_in;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// A small campaign with an engine `mine` that answers right, or as the client does when it is told to misbehave so.
fn campaign(dir: &Path, out: &str, trick: &str, more: &[&str]) {
    let mine = format!("mine={} {trick}", client());
    let settings = [
        CASES_AS_FOUND,
        "--family",
        "sliver,face_stack",
        "--tolerances",
        "auto",
        "--engine",
        "mine",
        "--engine-command",
        &mine,
        "--out",
        out,
    ];
    let (code, _, err) = rockproof_in(dir, &[&["campaign"], &settings[..], more].concat());
    assert_eq!(code, 0, "{err}");
}

/// The settings of campaigns in parts, but that no case is made, which none of these comparisons reads.
fn without_cases() -> String {
    SETTINGS.replace("cases_per_cause = 60", "cases_per_cause = 0")
}

/// How the sorts of findings fared.
fn trends(of: &Value) -> Vec<String> {
    let classes = of["findings"]["classes"].as_array().expect("classes");
    classes.iter().map(|class| class["trend"].as_str().expect("a trend").to_owned()).collect()
}

fn document(text: &str) -> Value {
    serde_json::from_str(text).expect("a document")
}

#[test]
fn the_same_pairs_tell_everything() {
    let dir = crate::place::folder();
    let dir = dir.path();
    campaign(dir, "before", "kinds", &["--pairs", "128"]);
    campaign(dir, "after", "none", &["--pairs", "128"]);
    campaign(dir, "shorter", "none", &["--pairs", "64"]);

    let (code, text, err) = rockproof_in(dir, &["compare", "before", "before", "--deny", "new,more,other"]);
    assert_eq!(code, 0, "{err}");
    assert!(
        text.contains("same 128 pairs") && text.contains("0 new, 0 more frequent") && !text.contains("gone │"),
        "{text}"
    );

    let (code, text, _) = rockproof_in(dir, &["compare", "before", "after", "--deny", "new"]);
    assert!(code == 1 && text.contains("new") && text.contains("mine") && text.contains("external:"), "{code}: {text}");
    let worse = document(&rockproof_in(dir, &["compare", "before", "after", "--format", "json"]).1);
    let better = document(&rockproof_in(dir, &["compare", "after", "before", "--format", "json"]).1);
    let count = |of: &Value, trend: &str| trends(of).iter().filter(|found| *found == trend).count();
    assert!(count(&worse, "new") > 0 && count(&worse, "gone") == count(&better, "new"), "{worse:#}");
    assert_eq!(count(&worse, "new"), count(&better, "gone"));
    assert_eq!(worse["same_pairs"], 128);
    // What findings.csv of both runs says of one engine, counted here.
    let rows = |run: &str| {
        fs::read_to_string(dir.join(run).join("findings.csv")).expect("a table").matches(",mine,").count() as u64
    };
    let sums = |side: usize| -> u64 {
        let classes = worse["findings"]["classes"].as_array().expect("classes");
        classes
            .iter()
            .filter(|class| class["engine"] == "mine")
            .filter_map(|class| class["findings"][side].as_u64())
            .sum()
    };
    assert_eq!([sums(0), sums(1)], ["before", "after"].map(rows));

    // Of the longer run only the pairs that the shorter has.
    let prefix = document(&rockproof_in(dir, &["compare", "after", "shorter", "--format", "json"]).1);
    assert_eq!(
        (prefix["same_pairs"].as_u64(), trends(&prefix).iter().all(|trend| trend == "same")),
        (Some(64), true),
        "{prefix:#}"
    );

    let (code, text, err) = rockproof_in(dir, &["compare", "before", "after", "--format", "markdown", "--out", "page"]);
    assert!(code == 0 && text.starts_with("## Rockproof: before → after") && text.contains("| new |"), "{text}{err}");
    let page = fs::read_to_string(dir.join("page/report.html")).expect("a page");
    assert!(page.contains("Which findings changed?") && dir.join("page/tables/changed.csv").is_file());
    let (code, _, err) = rockproof_in(dir, &["compare", "before", "after", "--out", "page"]);
    assert!(code == 2 && err.contains("--overwrite"), "{err}");
}

#[test]
fn a_part_is_compared_with_the_whole_pair_by_pair() {
    let campaigns = Campaigns::new(&without_cases());
    let thirds = campaigns.parts(3, &[]);
    campaigns.campaign("half", &["--part", "2/2"]);
    campaigns.campaign("whole", &[]);
    let compare = |one: &str, two: &str| campaigns.run(&["compare", one, two, "--format", "json", "--deny", "new"]);
    // Sixteen batches: parts of five, five and six.
    for (part, pairs) in thirds.iter().zip([80, 80, 90]) {
        let (code, out, err) = compare("whole", part);
        let found = document(&out);
        assert_eq!((code, found["same_pairs"].as_u64()), (0, Some(pairs)), "{part}: {out}{err}");
        assert!(!trends(&found).is_empty() && trends(&found).iter().all(|trend| trend == "same"), "{part}: {out}");
    }
    let (code, out, err) = compare(&thirds[1], "half");
    assert!(code == 2 && err.contains("share pairs from 128 to 159 and have others each alone"), "{out}{err}");
    assert_eq!(document(&compare(&thirds[0], &thirds[1]).1)["same_pairs"], Value::Null);
}

#[test]
fn other_pairs_are_compared_by_chance_and_what_one_run_has_is_left_out() {
    let dir = crate::place::folder();
    let dir = dir.path();
    campaign(dir, "one", "kinds", &["--pairs", "64"]);
    campaign(dir, "two", "kinds", &["--pairs", "64", "--seed", "2"]);
    let (code, text, _) = rockproof_in(dir, &["compare", "one", "two"]);
    assert!(code == 0 && text.contains("different pairs") && text.contains("seed: 1 → 2"), "{text}");
    let found = document(&rockproof_in(dir, &["compare", "one", "two", "--format", "json"]).1);
    assert_eq!(found["same_pairs"], Value::Null);
    let classes = found["findings"]["classes"].as_array().expect("classes");
    assert!(!classes.is_empty() && classes.iter().all(|class| class["chance"].is_number()), "{found:#}");

    let built_in = [
        "campaign",
        WITHOUT_CASES,
        "--pairs",
        "32",
        "--family",
        "edge_cross",
        "--tolerances",
        "auto",
        "--out",
        "three",
    ];
    assert_eq!(rockproof_in(dir, &built_in).0, 0);
    let (code, text, _) = rockproof_in(dir, &["compare", "one", "three", "--deny", "new"]);
    assert!(code == 1 && text.contains("nothing is known") && text.contains("engine mine"), "{code}: {text}");
}

#[test]
fn a_code_that_says_only_how_blocks_lie_is_as_often_right_as_its_answers() {
    let dir = crate::place::folder();
    let dir = dir.path();
    campaign(dir, "before", "apart", &["--pairs", "128"]);
    campaign(dir, "after", "apart", &["--pairs", "128"]);
    let found = document(&rockproof_in(dir, &["compare", "before", "after", "--format", "json", "--out", "page"]).1);
    let of_mine: Vec<&Value> = found["agreement"]
        .as_array()
        .expect("shares")
        .iter()
        .filter(|share| share["engine"] == "mine" && share["setting"] == "auto")
        .collect();
    assert_eq!(of_mine.len(), 1, "{found:#}");
    let (before, after) = (of_mine[0]["before"][0].as_f64(), of_mine[0]["after"][0].as_f64());
    assert!(before > Some(0.0) && before == after, "{found:#}");
    // What it does not take is no column of the map by family, and not the first finding to look at while there are others.
    assert_eq!(rockproof_in(dir, &["report", "before"]).0, 0);
    let chart = fs::read_to_string(dir.join("before/report/charts/families.svg")).expect("a chart");
    assert!(chart.contains("mine, arithmetic") && !chart.contains(">mine<"), "{chart}");
    let worst = fs::read_to_string(dir.join("before/report/tables/worst.csv")).expect("a table");
    let changes: Vec<&str> = worst.lines().filter(|line| line.contains(",engine,")).collect();
    assert!(changes.len() > 1 && !changes[0].contains("unsupported"), "{worst}");
}

#[test]
fn what_is_no_finished_campaign_is_refused() {
    let dir = crate::place::folder();
    let dir = dir.path();
    campaign(dir, "run", "kinds", &["--pairs", "32"]);
    fs::create_dir(dir.join("empty")).expect("a folder");
    for (other, wanted) in [("empty", "an empty directory"), ("nowhere", "no such directory")] {
        let (code, out, err) = rockproof_in(dir, &["compare", "run", other]);
        assert!(code == 2 && out.is_empty() && err.contains(wanted), "{err}");
    }
    let file = dir.join("run/run.json");
    let text = fs::read_to_string(&file).expect("a file");
    fs::write(&file, text.replace("\"finished\": true", "\"finished\": false")).expect("write");
    let (code, _, err) = rockproof_in(dir, &["compare", "run", "run"]);
    assert!(code == 2 && err.contains("not finished (32 pairs are done)"), "{err}");
}

#[test]
fn a_quiet_command_says_nothing_but_its_result_and_a_verbose_one_its_cost() {
    let dir = crate::place::folder();
    campaign(dir.path(), "run", "kinds", &["--pairs", "32"]);
    let page = |more: &[&str]| {
        rockproof_in(dir.path(), &[&["compare", "run", "run", "--out", "page", "--overwrite"], more].concat())
    };
    let [plain, quiet, verbose] = [page(&[]), page(&["-q"]), page(&["-v"])];
    assert!(plain.2.contains("written to"), "{}", plain.2);
    assert_eq!((quiet.0, quiet.1, quiet.2.as_str()), (0, plain.1, ""));
    assert!(
        verbose.2.lines().last().is_some_and(|line| line.starts_with("note: ") && line.contains(" s")),
        "{}",
        verbose.2
    );
    assert_eq!(rockproof_in(dir.path(), &["-q", "compare", "run", "nowhere"]).2.lines().count(), 1, "errors are told");
}

#[test]
fn shells_and_man_know_every_command() {
    let dir = crate::place::folder();
    let help = rockproof_in(dir.path(), &["--help"]).1;
    let commands: Vec<&str> = help
        .lines()
        .skip_while(|line| !line.starts_with("Commands:"))
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty() && *name != "help")
        .collect();
    assert!(commands.len() >= 15, "{help}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, text, _) = rockproof_in(dir.path(), &["completions", shell]);
        assert!(code == 0 && commands.iter().all(|command| text.contains(command)), "{shell}");
    }
    let (code, _, err) = rockproof_in(dir.path(), &["man", "man1"]);
    assert_eq!(code, 0, "{err}");
    for command in commands {
        let text = fs::read_to_string(dir.path().join(format!("man1/rockproof-{command}.1"))).expect(command);
        assert!(text.contains(".SH OPTIONS") && text.contains(&format!("rockproof\\-{command}")), "{command}: {text}");
    }
    assert!(fs::read_to_string(dir.path().join("man1/rockproof.1")).expect("a page").contains(".SH SUBCOMMANDS"));
}

/// Under a set that depends on the precision a tolerance concerns `any` where one precision takes part, and one of two where both do.
#[test]
fn findings_about_all_precisions_are_not_compared_where_these_differ() {
    let campaigns = Campaigns::new(&without_cases());
    campaigns.campaign("both", &["--engine", "stepper-f32,stepper-f64"]);
    campaigns.campaign("one", &["--engine", "stepper-f64"]);
    let (code, out, err) = campaigns.run(&["compare", "one", "both", "--format", "json", "--deny", "new,more,other"]);
    let found = document(&out);
    let classes = found["findings"]["classes"].as_array().expect("classes");
    assert!(code == 0 && !classes.is_empty(), "{out}{err}");
    assert!(classes.iter().all(|class| class["cause"] != "tolerance" && class["trend"] == "same"), "{out}");
    let (code, out, _) = campaigns.run(&["compare", "both", "one"]);
    assert!(code == 0 && out.contains("So are findings of the cause tolerance"), "{out}");
    // What is denied cannot be seen of an engine that takes no part any more.
    let (code, _, err) = campaigns.run(&["compare", "both", "one", "--deny", "new"]);
    let told = "note: denied: f32, stepper-f32 take part in the run before alone, so nothing is known of what is denied there\n";
    assert!(code == 1 && err.contains(told), "{err}");
}
