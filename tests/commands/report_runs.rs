//! Pins what `report` says of runs that made no step, of a run that is named twice, of tables of counts that were cut off, and of a damaged case.

use crate::campaigns::{Campaigns, SETTINGS};
use crate::place::{Place, rockproof};
use crate::report_command::{copy, run};
use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn where_no_step_was_made_nothing_is_said_of_overlaps() {
    let dir = crate::place::folder();
    let out = dir.path().join("still").display().to_string();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/approaching_vertices.toml");
    let (code, said, err) = rockproof(&["simulate", scene, "--steps", "0", "--out", &out]);
    assert!(code == 0 && said.contains("no step was made") && !said.contains(" m at most"), "{said}{err}");
    let (code, said, err) = rockproof(&["report", &out, "--format", "markdown"]);
    assert!(code == 0 && said.contains("still: no step was made, so nothing is known of overlaps."), "{said}{err}");
    assert!(!said.contains("✅") && !said.contains("--no-audit"), "{said}");
}

/// Two blocks that loads press 3 cm deep into a wall, and the same as exact steps, which have no report.
#[test]
fn the_verdict_says_how_deep_audited_runs_went_and_names_exact_runs() {
    let dir = crate::place::folder();
    let path = |name: &str| dir.path().join(name).display().to_string();
    let scene = "[simulation]\ngravity = [0, 0, 0]\nsteps = 9\ndynamic = 0\n[[joint]]\nfriction = 0\nnormal_stiffness = 1e9\n\
        [[block]]\nfixed = true\nbox = { min = [0, -2, -2], max = [1, 2, 2] }\n\
        [[block]]\nbox = { min = [-1, 0, 0], max = [0, 1, 1] }\n\
        [[load]]\nblock = 1\nat = [-1, \"1/2\", \"1/2\"]\nforce = [12e7, 0, 0]\n";
    fs::write(path("pressed.toml"), scene).expect("written");
    for name in ["one", "two"] {
        let (code, said, err) = rockproof(&["simulate", &path("pressed.toml"), "--audit", "--out", &path(name)]);
        assert!(code == 0 && said.contains("deeper than penetration after"), "{said}{err}");
    }
    let (code, said, err) = rockproof(&["report", &path("one"), &path("two"), "--format", "markdown"]);
    let line = said.lines().find(|line| line.contains("No passage")).unwrap_or_else(|| panic!("{said}{err}"));
    let told = "in 18 audited steps of 2 of 2 runs; blocks overlap deeper than `penetration` after ";
    assert!(code == 0 && line.starts_with("- ℹ️ ") && line.contains(told), "{line}");
    assert!(line.contains(" of 18 steps (at most 0.0") && line.ends_with(" m, in one)."), "{line}");
    let exact = path("exact");
    let args = ["simulate", &path("pressed.toml"), "--engine", "exact", "--steps", "1", "--out", &exact];
    assert_eq!(rockproof(&args).0, 0);
    let (code, _, err) = rockproof(&["report", &exact]);
    assert!(code == 2 && err.contains("a run of simulate --engine exact, of which there is no report"), "{err}");
}

#[cfg(unix)]
#[test]
fn a_run_that_is_named_twice_is_refused() {
    let dir = crate::place::folder();
    let run = run().to_str().expect("text");
    let link = dir.path().join("link");
    std::os::unix::fs::symlink(run, &link).expect("a link");
    for other in [run, &format!("{run}/."), link.to_str().expect("text")] {
        let (code, out, err) = rockproof(&["report", run, other, "--format", "markdown"]);
        assert!(code == 2 && err.contains("are the same run, which would count twice"), "{other}: {out}{err}");
    }
}

/// A copy of a run, or a part beside the whole, has the same pairs under another path.
#[test]
fn runs_of_one_campaign_may_not_share_pairs() {
    // Steps would take most of the time.
    let settings = SETTINGS.replace("cases_per_cause = 60", "cases_per_cause = 0");
    let campaigns = Campaigns::new(&settings.replace("steps_every = 3", "steps_every = 0"));
    let dirs = campaigns.parts(2, &[]);
    campaigns.campaign("whole", &["--engine", "stepper-f64"]);
    campaigns.campaign("again", &["--engine", "stepper-f64,stepper-f32"]);
    campaigns.campaign("single", &["--engine", "stepper-f32"]);
    let report = |one: &str, two: &str| campaigns.run(&["report", one, two, "--format", "markdown"]);
    for (one, two, [first, last]) in
        [("whole", "again", [0, 249]), (&dirs[0], "whole", [0, 127]), ("again", &dirs[1], [128, 249])]
    {
        let (code, out, err) = report(one, two);
        let why = format!(
            "{one} and {two} are runs of one campaign (the same seed and settings) and share pairs from {first} to {last},"
        );
        assert!(code == 2 && err.contains(&why) && out.is_empty(), "{one} {two}: {out}{err}");
    }
    // Other pairs, or another engine.
    for (one, two) in [(dirs[0].as_str(), dirs[1].as_str()), ("whole", "single")] {
        let (code, out, err) = report(one, two);
        assert!(code == 0 && !out.is_empty(), "{one} {two}: {out}{err}");
    }
}

#[test]
fn a_campaign_that_was_killed_is_said_to_be_one() {
    let (dir, path) = copy();
    fs::remove_file(dir.path().join("run.json")).expect("removed");
    fs::write(dir.path().join("progress.json"), "{}").expect("written");
    for arguments in [["report", &path, "--quiet"], ["compare", &path, &path]] {
        let (code, _, err) = rockproof(&arguments);
        let told =
            "there is no run.json, which is written at the end: it was killed, or still runs; finish it with --resume";
        assert!(code == 2 && err.contains(told), "{arguments:?}: {err}");
    }
}

#[test]
fn a_run_of_steps_that_has_not_ended_is_said_to_be_one() {
    let place = Place::new();
    place.file("one.toml", "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n");
    assert_eq!(place.run(&["simulate", "one.toml", "--steps", "2", "--out", "run"]).0, 0);
    fs::remove_file(place.path("run/run.json")).expect("removed");
    let (code, _, err) = place.run(&["report", "run"]);
    assert!(
        code == 2
            && err.contains("run: there is no run.json, which is written at the end: it was killed, or still runs"),
        "{err}"
    );
}

/// The number of their rows is known where this version made them.
#[test]
fn tables_of_counts_that_were_cut_off_are_refused() {
    for name in ["agreement.csv", "confusion.csv", "step_summary.csv", "summary.csv"] {
        let (dir, path) = copy();
        let file = dir.path().join(name);
        let text = fs::read_to_string(&file).expect("read");
        let lines: Vec<&str> = text.lines().collect();
        fs::write(&file, lines[..lines.len() - 3].join("\n") + "\n").expect("written");
        let (code, _, err) = rockproof(&["report", &path]);
        let (found, all) = (format!("{} rows; ", lines.len() - 4), format!("run.json counts {}:", lines.len() - 1));
        assert!(code == 2 && err.contains(name) && err.contains(&found) && err.contains(&all), "{err}");
        let about = dir.path().join("run.json");
        let mut run: serde_json::Value = serde_json::from_slice(&fs::read(&about).expect("read")).expect("JSON");
        run.as_object_mut().and_then(|run| run.remove("table_rows")).expect("counts");
        fs::write(&about, run.to_string()).expect("written");
        assert_eq!(rockproof(&["report", &path]).0, 0, "of an earlier version");
    }
}

/// A case that is none is named, and all the rest is shown.
#[test]
fn a_damaged_case_does_not_cost_the_report() {
    let (dir, path) = copy();
    let page = || {
        let (code, _, err) = rockproof(&["report", &path, "--overwrite"]);
        assert_eq!(code, 0, "{err}");
        (fs::read_to_string(dir.path().join("report/report.html")).expect("a page"), err)
    };
    let (whole, err) = page();
    assert!(!err.contains("cannot be shown"), "{err}");
    let replays = |page: &str| page.matches("rockproof replay ").count();
    let cases = fs::read_dir(dir.path().join("cases")).expect("cases").map(|case| case.expect("a case").path());
    let name = |case: &Path| case.file_name().expect("a name").to_string_lossy().into_owned();
    let shown = |case: &PathBuf| {
        let named = |rest: &str| rest.split("</code>").next().is_some_and(|command| command.contains(&name(case)));
        whole.split("rockproof replay ").skip(1).any(named)
    };
    let case = cases.filter(|case| case.extension().is_some_and(|end| end == "toml")).find(shown).expect("a case");
    // A contact of features that its blocks do not have.
    let text = fs::read_to_string(&case).expect("text");
    let damaged = text.replacen("feature_a = ", "feature_a = 99", 1);
    assert!(damaged != text, "{text}");
    fs::write(&case, damaged).expect("written");
    let (rest, err) = page();
    assert_eq!(replays(&rest), replays(&whole) - 1);
    let told =
        ["A case cannot be shown: ", &name(&case), "allowed are the vertices, edges and faces of the two blocks"];
    assert!(told.iter().all(|told| err.contains(told)) && rest.contains(told[0]), "{err}");
}

/// Of another program, among the results of simulate: it is no campaign because of its name.
#[test]
fn a_foreign_table_of_findings_is_told_as_that() {
    let dir = crate::place::folder();
    let out = dir.path().join("still").display().to_string();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/approaching_vertices.toml");
    assert_eq!(rockproof(&["simulate", scene, "--steps", "0", "--out", &out]).0, 0);
    fs::write(dir.path().join("still/findings.csv"), "hi\n").expect("written");
    let (code, _, err) = rockproof(&["report", &out]);
    let told = "findings.csv: the results here are of rockproof simulate, and this is none of their files (rockproof.manifest.json)";
    assert!(code == 2 && err.contains(told), "{err}");
}
